/// A detector under test whose composition is hidden behind virtual functions: every test case is compiled once and
/// runs against all compositions, and only slices and the files that include compositions.hpp instantiate templates of
/// the library.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <collide/core/contact.hpp>

#include "io/counting.hpp"
#include "scenes.hpp"

namespace tests {

/// How a mesh lies in memory.
enum class mesh_form { indexed, soup };

/// How spheres lie in memory; `_one` is with one radius for all.
enum class sphere_form { xyz, xyz_one, soa, soa_one, xyzr };

/// The parameters of policies that tests vary.
struct options {
  double cell_width = 0;
  std::size_t memory_budget = 0;
  int threads = 2;
};

/// The result of a sink with room for `capacity` elements.
template <class T>
struct bounded {
  std::vector<T> stored;
  std::uint64_t total;
  bool complete;
  bool guards_intact;  ///< nothing was written before or behind the buffer
};

/// The result of a `csr` sink.
struct rows {
  std::vector<std::uint64_t> offsets;
  bounded<collide::id> triangles;
};

using io::counting_resource;

template <class S>
class subject {
 public:
  virtual ~subject() = default;

  /// Must every verdict be right?
  virtual bool exact() const = 0;

  virtual void build(mesh<S> const& m, mesh_form form) = 0;
  virtual void build(mesh<S> const& m, mesh_form form, S radius) = 0;
  /// Puts spheres where the space reads them: what the queries below look at.
  virtual void place(spheres<S> const& s, sphere_form form) = 0;

  virtual std::uint64_t count() = 0;
  virtual std::vector<std::uint8_t> any() = 0;
  virtual std::vector<collide::pair> pairs(collide::order o) = 0;
  virtual std::vector<collide::contact<S>> contacts(collide::order o) = 0;
  /// Of `closest_contact`; with the triangles and distances that `closest` gives.
  virtual std::vector<collide::contact<S>> closest() = 0;
  virtual rows csr(collide::order o) = 0;
  /// The contacts that a visitor saw: the contact of each hit, with the ids of the hit itself.
  virtual std::vector<collide::contact<S>> visit() = 0;

  virtual bounded<collide::pair> pairs_within(std::size_t capacity, collide::order o) = 0;
  virtual bounded<collide::contact<S>> contacts_within(std::size_t capacity, collide::order o) = 0;

  virtual rows csr_within(std::size_t capacity, collide::order o) = 0;

  /// Makes room in the detector and all sinks above.
  virtual void reserve(std::size_t spheres, std::size_t pairs) = 0;

  virtual double cell_width() = 0;
  /// The memory that the detector and its sinks take; none of what the tests themselves upload.
  virtual counting_resource& memory() = 0;
};

/// An entry of the list of compositions.
template <class S>
struct composition {
  std::string broad, precision, space;
  std::function<std::unique_ptr<subject<S>>(options const&)> make;
  /// The narrow phase alone, on the host, for every sphere and every triangle.
  std::function<std::vector<collide::pair>(scene<S> const&)> narrow_phase;

  std::string name() const { return broad + " x " + precision + " x " + space; }
};

/// Where the slices of the list put their compositions before main runs.
template <class S>
std::vector<composition<S>>& registry() {
  static std::vector<composition<S>> all;
  return all;
}

/// The names of the precisions that are tested in every composition.
inline constexpr char const* precisions[] = {"exact", "single", "double"};

/// All compositions that this program tests, in the order of their names; of `precision` only, if it is not empty.
template <class S>
std::vector<composition<S>> compositions(std::string const& precision = "");

}  // namespace tests
