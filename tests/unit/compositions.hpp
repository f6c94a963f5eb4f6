/// The one list of what is composed and tested. A new policy is tested in every combination by a line here.
#pragma once

#include <algorithm>
#include <cstring>
#include <type_traits>

#include <collide/all_pairs.cuh>
#include <collide/bucket.cuh>
#include <collide/bvh.cuh>
#include <collide/sinks/any_hit.hpp>
#include <collide/sinks/closest.hpp>
#include <collide/sinks/contacts.hpp>
#include <collide/sinks/count.hpp>
#include <collide/sinks/csr.hpp>
#include <collide/sinks/pairs.hpp>
#include <collide/sinks/visit.hpp>

#include "execution/lockstep.hpp"
#include "type_erased_detector.hpp"

namespace tests {

template <class... T>
struct list {};

using broad_phases = list<collide::all_pairs, collide::bucket, collide::bvh>;

using host_spaces = list<collide::host, lockstep<256, false>, lockstep<64, true>>;
#if defined(__CUDACC__)
using cuda_spaces = list<collide::cuda, collide::cuda_shared>;
#endif

inline char const* name_of(list<collide::all_pairs>) { return "all_pairs"; }
inline char const* name_of(list<collide::bucket>) { return "bucket"; }
inline char const* name_of(list<collide::bvh>) { return "bvh"; }
inline char const* name_of(list<collide::single_precision>) { return "single"; }
inline char const* name_of(list<collide::double_precision>) { return "double"; }
inline char const* name_of(list<collide::exact>) { return "exact"; }

inline collide::all_pairs configure(list<collide::all_pairs>, options const&) { return {}; }
inline collide::bvh configure(list<collide::bvh>, options const&) { return {}; }
inline collide::bucket configure(list<collide::bucket>, options const& o) { return {o.cell_width, o.memory_budget}; }

/// Device memory or host memory, as the space has it.
template <class Space>
std::pmr::memory_resource* memory_of_space() {
#if defined(__CUDACC__)
  if constexpr (!Space::host_accessible) return collide::cuda_memory::get();
#endif
  return std::pmr::new_delete_resource();
}

/// Makes a space with the default stream, with `threads` if it is the host.
template <class Space>
Space make_space(int threads, std::pmr::memory_resource* resource) {
  if constexpr (Space::host_accessible) {
    return Space(threads, resource);
  } else {
    return Space(nullptr, resource);
  }
}

/// An array in memory of the space.
template <class T>
class array {
 public:
  template <class Space>
  T* assign(Space& space, T const* from, std::size_t n) {
    T* const to = memory_.reserve(memory_of_space<Space>(), n + 1);  // never null
    space.copy_from_host(to, from, n);
    return to;
  }
  template <class Space>
  T* assign(Space& space, std::vector<T> const& from) {
    return assign(space, from.data(), from.size());
  }

 private:
  collide::buffer<T> memory_;
};

/// A visitor that writes down what it sees.
template <class S>
struct note {
  collide::contact<S>* seen;
  std::size_t capacity;
  unsigned* count;

  template <class Hit>
  COLLIDE_HD void operator()(Hit const& hit) const {
#if defined(__CUDA_ARCH__)
    unsigned const slot = atomicAdd(count, 1u);
#else
    unsigned const slot = __atomic_fetch_add(count, 1u, __ATOMIC_RELAXED);
#endif
    if (slot >= capacity) return;
    seen[slot] = hit.contact();
    seen[slot].sphere = hit.sphere;
    seen[slot].triangle = hit.triangle;
  }
};

template <class Broad, class Precision, class Space, class S>
class typed_subject final : public subject<S> {
 public:
  explicit typed_subject(options const& o)
      : space_(make_space<Space>(o.threads, &memory_)), detector_(space_, configure(list<Broad>{}, o)) {}

  bool exact() const override { return std::is_same<Precision, collide::exact>::value; }

  void build(mesh<S> const& m, mesh_form form) override { detector_.build(view(m, form)); }
  void build(mesh<S> const& m, mesh_form form, S radius) override { detector_.build(view(m, form), radius); }

  void place(spheres<S> const& s, sphere_form form) override {
    std::size_t const n = s.size();
    S const radius = n == 0 ? S(1) : s.radii[0];
    switch (form) {
      case sphere_form::xyz:
        spheres_ = collide::spheres_xyz(centres_.assign(space_, s.centres), n,
                                        static_cast<S const*>(radii_.assign(space_, s.radii)));
        break;
      case sphere_form::xyz_one:
        spheres_ = collide::spheres_xyz(centres_.assign(space_, s.centres), n, radius);
        break;
      case sphere_form::soa:
      case sphere_form::soa_one: {
        std::vector<S> xyz(3 * n);
        for (std::size_t i = 0; i < 3 * n; ++i) xyz[i % 3 * n + i / 3] = s.centres[i];
        S const* const x = centres_.assign(space_, xyz);
        spheres_ =
            form == sphere_form::soa_one
                ? collide::spheres_soa(x, x + n, x + 2 * n, n, radius)
                : collide::spheres_soa(x, x + n, x + 2 * n, n, static_cast<S const*>(radii_.assign(space_, s.radii)));
        break;
      }
      case sphere_form::xyzr: {
        std::vector<S> quadruples;
        for (std::size_t i = 0; i < n; ++i) {
          quadruples.insert(quadruples.end(), &s.centres[3 * i], &s.centres[3 * i] + 3);
          quadruples.push_back(s.radii[i]);
        }
        spheres_ = collide::spheres_xyzr(static_cast<S const*>(centres_.assign(space_, quadruples)), n);
        break;
      }
    }
  }

  std::uint64_t count() override { return detector_.query(spheres_, count_).total(); }
  std::vector<std::uint8_t> any() override { return detector_.query(spheres_, any_).to_host(); }
  std::vector<collide::pair> pairs(collide::order o) override {
    return complete(detector_.query(spheres_, o == collide::order::canonical ? sorted_pairs_ : pairs_));
  }
  std::vector<collide::contact<S>> contacts(collide::order o) override {
    return complete(detector_.query(spheres_, o == collide::order::canonical ? sorted_contacts_ : contacts_));
  }
  std::vector<collide::contact<S>> closest() override {
    auto const entries = detector_.query(spheres_, closest_).to_host();
    auto const found = detector_.query(spheres_, closest_contacts_).to_host();
    bool const alike =
        std::equal(entries.begin(), entries.end(), found.begin(), found.end(), [](auto const& e, auto const& c) {
          return e.triangle == c.triangle && std::memcmp(&e.distance, &c.distance, sizeof(S)) == 0;
        });
    if (!alike) throw std::runtime_error("closest and closest_contact differ");
    return found;
  }
  rows csr(collide::order o) override {
    auto const& sink = detector_.query(spheres_, o == collide::order::canonical ? sorted_rows_ : rows_);
    auto copy = sink.to_host();
    if (sink.rows() != spheres_.size() || sink.size() != copy.triangles.size())
      throw std::runtime_error("csr has other sizes than it says");
    return {std::move(copy.offsets), {std::move(copy.triangles), sink.total(), sink.complete(), true}};
  }

  std::vector<collide::contact<S>> visit() override {
    std::size_t const room = count() + 1;
    array<collide::contact<S>> seen;
    array<unsigned> seen_count;
    std::vector<collide::contact<S>> copy(room);
    unsigned n = 0;
    note<S> const f{seen.assign(space_, copy), room, seen_count.assign(space_, &n, 1)};
    detector_.query(spheres_, collide::visit<note<S>>(f));
    space_.copy_to_host(&n, f.count, 1);
    if (n > room)
      throw std::runtime_error("visit was called " + std::to_string(n) + " times for " + std::to_string(room - 1) +
                               " pairs");
    space_.copy_to_host(copy.data(), f.seen, n);
    copy.resize(n);
    return copy;
  }

  bounded<collide::pair> pairs_within(std::size_t capacity, collide::order o) override {
    return within<collide::pair>(
        capacity, [&](collide::pair* to) { return detector_.query(spheres_, collide::pairs(to, capacity, o)); });
  }
  bounded<collide::contact<S>> contacts_within(std::size_t capacity, collide::order o) override {
    using contact = collide::contact<S>;
    return within<contact>(
        capacity, [&](contact* to) { return detector_.query(spheres_, collide::contacts<S>(to, capacity, o)); });
  }

  rows csr_within(std::size_t capacity, collide::order o) override {
    array<std::uint64_t> memory;
    std::vector<std::uint64_t> offsets(spheres_.size() + 3, 77);
    std::uint64_t* const to = memory.assign(space_, offsets);
    auto triangles = within<collide::id>(
        capacity, [&](collide::id* ids) { return detector_.query(spheres_, collide::csr(to + 1, ids, capacity, o)); });
    space_.copy_to_host(offsets.data(), to, offsets.size());
    if (offsets.front() != 77 || offsets.back() != 77) triangles.guards_intact = false;
    return {{offsets.begin() + 1, offsets.end() - 1}, std::move(triangles)};
  }

  void reserve(std::size_t spheres, std::size_t pairs) override {
    detector_.reserve(spheres, pairs, count_, any_, pairs_, sorted_pairs_, contacts_, sorted_contacts_, closest_,
                      closest_contacts_, rows_, sorted_rows_);
  }

  double cell_width() override { return detector_.cell_width(); }
  counting_resource& memory() override { return memory_; }

 private:
  collide::mesh_view<S> view(mesh<S> const& m, mesh_form form) {
    if (form == mesh_form::indexed)
      return collide::indexed_mesh(vertices_.assign(space_, m.vertices), m.vertices.size() / 3,
                                   corners_.assign(space_, m.corners), m.size());
    std::vector<S> soup;
    for (auto corner : m.corners) soup.insert(soup.end(), &m.vertices[3 * corner], &m.vertices[3 * corner] + 3);
    return collide::triangle_soup(static_cast<S const*>(vertices_.assign(space_, soup)), m.size());
  }

  template <class Sink>
  static auto complete(Sink const& sink) {
    auto const copy = sink.to_host();
    if (!sink.complete() || sink.total() != copy.size() || sink.size() != copy.size())
      throw std::runtime_error("a sink without a limit is incomplete");
    return copy;
  }

  /// The elements of type `T` that the sink of `query(memory)` has written.
  template <class T, class Query>
  bounded<T> within(std::size_t capacity, Query const& query) {
    constexpr std::size_t guard = 64;
    constexpr unsigned char pattern = 0xa5;
    std::vector<unsigned char> bytes(capacity * sizeof(T) + 2 * guard, pattern);
    array<unsigned char> memory;
    unsigned char* const raw = memory.assign(space_, bytes);
    auto const sink = query(reinterpret_cast<T*>(raw + guard));
    space_.copy_to_host(bytes.data(), raw, bytes.size());
    bounded<T> result{std::vector<T>(sink.size()), sink.total(), sink.complete(), true};
    if (sink.size() != 0)
      std::memcpy(static_cast<void*>(result.stored.data()), bytes.data() + guard, sink.size() * sizeof(T));
    for (std::size_t i = 0; i < guard; ++i)
      result.guards_intact = result.guards_intact && bytes[i] == pattern && bytes[bytes.size() - 1 - i] == pattern;
    return result;
  }

  counting_resource memory_{memory_of_space<Space>()};
  array<S> vertices_, centres_, radii_;
  array<std::uint32_t> corners_;
  Space space_;
  collide::detector<Broad, collide::karabassi<Precision>, Space, S> detector_;
  collide::sphere_view<S> spheres_;
  collide::count count_;
  collide::any_hit any_;
  collide::pairs pairs_, sorted_pairs_{collide::order::canonical};
  collide::contacts<S> contacts_, sorted_contacts_{collide::order::canonical};
  collide::closest<S> closest_;
  collide::closest_contact<S> closest_contacts_;
  collide::csr rows_, sorted_rows_{collide::order::canonical};
};

template <class Narrow, class S>
std::vector<collide::pair> pairs_of_narrow_phase(scene<S> const& made) {
  auto const mesh = collide::indexed_mesh(made.mesh.vertices.data(), made.mesh.vertices.size() / 3,
                                          made.mesh.corners.data(), made.mesh.size());
  auto const balls = collide::spheres_xyz(made.spheres.centres.data(), made.spheres.size(), made.spheres.radii.data());
  std::vector<collide::pair> hits;
  for (collide::id s = 0; s < balls.size(); ++s)
    for (collide::id t = 0; t < mesh.size(); ++t)
      if (Narrow::intersects(mesh[t], balls[s])) hits.push_back({s, t});
  return hits;
}

/// Appends `Broad` with `Precision` in every one of the spaces.
template <class S, class Precision, class Broad, class... Spaces>
void add_spaces(list<Spaces...>) {
  (registry<S>().push_back({name_of(list<Broad>{}), name_of(list<Precision>{}), Spaces::name(),
                            [](options const& o) -> std::unique_ptr<subject<S>> {
                              return std::make_unique<typed_subject<Broad, Precision, Spaces, S>>(o);
                            },
                            pairs_of_narrow_phase<collide::karabassi<Precision>, S>}),
   ...);
}

/// Appends one slice of the list: all broad phases in all of the spaces. A slice is a file of its own
/// (composition_slice.cpp.in), so that slices compile in parallel.
template <class S, class Precision, class SpaceList, class... Broad>
bool add_slice(list<Broad...>) {
  (add_spaces<S, Precision, Broad>(SpaceList{}), ...);
  return true;
}

}  // namespace tests
