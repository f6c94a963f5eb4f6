/// \file
/// A simulation as Python sees it, whatever its list of effects: what the package, and code that was compiled on the
/// machine of the user, know of each other.
#pragma once

#include <cstddef>
#include <memory>
#include <memory_resource>
#include <string>
#include <vector>

namespace collide_python {

/// A column of particles in memory of the space.
struct column {
  std::string name;
  std::size_t width;  ///< 3, or 1
  bool is_float;      ///< or else an integer
  std::size_t bytes;  ///< of one number
  void* data;
  void (*assign)(void* to, void const* values);  ///< gives a collide::simulation such values
};

/// Where a simulation runs: threads on the host; stream and memory on a GPU.
struct whereabouts {
  int threads;
  void* stream;
  std::pmr::memory_resource* memory;
};

/// Energy, contact report and files of a list of effects: a library of their own, compiled when one of them is first
/// asked for. `of` is a collide::simulation.
class bookkeeping {
 public:
  virtual ~bookkeeping() = default;

  /// Kinetic, rotational, elastic, potential and the others of collide::energy_sums, in their order.
  virtual std::vector<double> energy(void const* of, double density) const = 0;
  /// The numbers of collide::contact_counts, in their order.
  virtual std::vector<double> contact_report(void const* of) const = 0;
  virtual void save(void const* of, std::string const& path) const = 0;
  virtual void load(void* of, std::string const& path) const = 0;
};

inline constexpr std::size_t all_effects = static_cast<std::size_t>(-1);

class simulation_base {
 public:
  virtual ~simulation_base() = default;

  /// The collide::simulation.
  virtual void* whole() = 0;
  /// On which stream, or with how many threads, from now on.
  virtual void use(whereabouts const& w) = 0;
  /// Sets a parameter of the effect of a number; false if it has none of that name and size.
  virtual bool set_parameter(std::size_t effect, std::string const& name, std::vector<double> const& values) = 0;
  /// `mesh` is a collide::mesh_view, `bodies` are collide::body.
  virtual void set_mesh(void const* mesh, void const* bodies, std::size_t body_count) = 0;
  /// `spheres` is a collide::sphere_view; velocities are packed, or null.
  virtual void set(void const* spheres, void const* velocities, std::size_t capacity) = 0;
  /// Puts clumps in place of all particles. Of each shape: how many spheres, the volume, three moments of inertia, the
  /// quaternion of its frame, and x, y, z, r of the spheres; of each clump: its shape, centre, quaternion, velocity,
  /// angular velocity and scale, 15 numbers; the last ones wait. False, and nothing has changed, in a list without
  /// clumps.
  virtual bool set_clumps(std::vector<double> const& shapes, std::vector<double> const& placed,
                          std::size_t waiting) = 0;
  virtual void steps(std::size_t n, double dt) = 0;
  virtual std::size_t size() = 0;
  virtual double time() = 0;
  virtual double largest_time_step() = 0;
  /// What the effect of a number has summed up since `clear`; nothing if it does not.
  virtual std::vector<double> sums(std::size_t effect) = 0;
  virtual void clear(std::size_t effect) = 0;
  /// What has come due, what of it overlapped, and what was not born; nothing without a source.
  virtual std::vector<double> births() = 0;
  /// Writes the particles to a collide::sphere_view.
  virtual void spheres(void* to) = 0;
  /// The states of all driven bodies, 16 numbers each: those of collide::body_state. False if none is driven.
  virtual bool drive(std::vector<double> const& states) = 0;
  virtual std::vector<column> columns() = 0;

  std::unique_ptr<bookkeeping> books;  ///< what the others need
  std::vector<double> energy(double density) { return books->energy(whole(), density); }
  std::vector<double> contact_report() { return books->contact_report(whole()); }
  void save(std::string const& path) { books->save(whole(), path); }
};

/// The memory in which an effect sums up; most have none. See sums.hpp.
template <class Effect>
struct sums_of {
  template <class Space>
  void make(Space const&, Effect&, std::size_t, std::size_t) {}
  template <class Space>
  void clear(Space const&) {}
  template <class Space>
  std::vector<double> read(Space const&) const {
    return {};
  }
};

/// What compiled lists of effects export under the names `collide_simulation` and `collide_bookkeeping`.
using make_simulation = simulation_base*(whereabouts const&);
using make_bookkeeping = bookkeeping*();

}  // namespace collide_python
