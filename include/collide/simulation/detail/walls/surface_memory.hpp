/// \file
/// The memory of particles' contacts with the mesh from step to step.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <collide/broad/detail/mesh_lookup.hpp>
#include <collide/effects/detail/contact_memory.hpp>

namespace collide::detail {

/// The memory of a contact with the mesh, and its key: a sphere that slides over a surface goes from triangle to
/// triangle, maybe to that of another body, and its contact goes on; that of another wall has another normal.
template <class S, class List>
struct surface_record {
  contact_record<S, List> record;
  S normal[3];
  id body;
};

/// The memory of contacts with the mesh, by numbers of particles.
template <class S, class List>
struct surface_memory_ref {
  static constexpr int max_contacts = 4;  ///< contacts of a particle that are remembered: the deepest

  surface_record<S, List>* records;  ///< contact k of particle i is at k * capacity + i
  std::uint8_t* counts;
  std::size_t capacity;
};
template <class S, class List>
class surface_memory {
 public:
  void reserve(std::pmr::memory_resource* resource, std::size_t n) {
    records_.reserve(resource, n * surface_memory_ref<S, List>::max_contacts);
    counts_.reserve(resource, n);
  }
  template <class Space>
  void clear(Space& space, std::size_t n) {
    if (n != 0) space.fill(counts_.data(), 0, n);
  }
  std::size_t bytes() const { return records_.bytes() + counts_.bytes(); }
  surface_memory_ref<S, List> ref(std::size_t n) const { return {records_.data(), counts_.data(), n}; }

  /// f(array with a value of each of `n` particles) for all that is used; on the host.
  template <class F>
  void for_each_array(std::size_t n, F const& f) const {
    std::size_t const most = n == 0 ? 0 : *std::max_element(counts_.data(), counts_.data() + n);
    for (std::size_t k = 0; k < most; ++k) f(records_.data() + k * n);
    f(counts_.data());
  }

  /// For a checkpoint: the contacts of each of `n` particles; the others are bodies. Waits.
  template <class Space>
  saved_contacts<S> save_contacts(Space const& space, std::size_t n) const {
    std::vector<surface_record<S, List>> records(max_contacts * n);
    std::vector<std::uint8_t> counts(n);
    if (n != 0) space.copy_to_host(records.data(), records_.data(), records.size());
    if (n != 0) space.copy_to_host(counts.data(), counts_.data(), n);
    saved_contacts<S> saved;
    for (std::size_t i = 0; i < n; ++i) {
      saved.counts.push_back(counts[i]);
      for (std::size_t k = 0; k < counts[i]; ++k) {
        auto const& r = records[k * n + i];
        saved.others.push_back(r.body);
        saved.values.insert(saved.values.end(), r.normal, r.normal + 3);
        saved.values.insert(saved.values.end(), r.record.numbers, r.record.numbers + width);
      }
    }
    return saved;
  }
  /// May wait.
  template <class Space>
  void restore_contacts(Space& space, saved_contacts<S> const& saved) {
    std::size_t const n = saved.counts.size();
    std::vector<surface_record<S, List>> records(max_contacts * n);
    std::vector<std::uint8_t> counts;
    std::size_t at = 0;
    for (std::size_t i = 0; i < n; ++i) {
      counts.push_back(static_cast<std::uint8_t>(saved.counts[i]));
      for (std::size_t k = 0; k < saved.counts[i]; ++k, ++at) {
        auto& r = records[k * n + i];
        S const* from = saved.values.data() + at * std::size_t(saved_width);
        r.body = saved.others[at];
        for (int c = 0; c < 3; ++c) r.normal[c] = *from++;
        for (int c = 0; c < width; ++c) r.record.numbers[c] = *from++;
      }
    }
    if (n == 0) return;
    space.copy_from_host(records_.data(), records.data(), records.size());
    space.copy_from_host(counts_.data(), counts.data(), n);
  }
  static constexpr int width = contact_values<S, List>::width, saved_width = width + 3;
  static constexpr std::size_t widest = sizeof(surface_record<S, List>);  ///< bytes of a value of an array

 private:
  static constexpr std::size_t max_contacts = surface_memory_ref<S, List>::max_contacts;
  buffer<surface_record<S, List>> records_;
  buffer<std::uint8_t> counts_;
};
template <class S>
class surface_memory<S, columns<>> {
 public:
  static constexpr std::size_t widest = 0;
  void reserve(std::pmr::memory_resource*, std::size_t) {}
  template <class Space>
  void clear(Space&, std::size_t) {}
  std::size_t bytes() const { return 0; }
  absent ref(std::size_t) const { return {}; }
  template <class F>
  void for_each_array(std::size_t, F const&) const {}
};

}  // namespace collide::detail
