/// \file
/// Saves a simulation to a file, and goes on from it in another process.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <initializer_list>
#include <istream>
#include <ostream>
#include <string>
#include <type_traits>
#include <typeinfo>
#include <vector>

#include <cxxabi.h>

#include <collide/simulation.cuh>
#include <collide/simulation/detail/checkpoint_format.hpp>

namespace collide {

namespace detail {

/// The name of a type, such as "collide::gravity".
template <class T>
std::string type_name() {
  int status = 0;
  char* const readable = abi::__cxa_demangle(typeid(T).name(), nullptr, nullptr, &status);
  std::string const name = status == 0 ? readable : typeid(T).name();
  std::free(readable);
  return name;
}

/// The names that functions return, with commas.
inline std::string list_of_names(std::initializer_list<std::string (*)()> names) {
  std::string list;
  for (auto const name : names) list += (list.empty() ? "" : ", ") + name();
  return list;
}

/// The names of the blocks that an effect's parameters and a column have in a checkpoint.
template <class E>
std::string parameters_name() {
  return "parameters of " + type_name<E>();
}
template <class C>
std::string column_name() {
  return "column " + type_name<C>();
}

/// A column of particles in memory of a space, whatever the type of its elements.
struct saved_column {
  std::string (*name)();  ///< of its block
  unsigned char* data;
  std::size_t element;  ///< bytes of one
  std::size_t width;    ///< elements of a particle

  std::size_t bytes() const { return element * width; }  ///< of a particle
};
template <class S, class State, class... C>
std::array<saved_column, sizeof...(C)> saved_columns(State const& state, columns<C...>) {
  return {{{column_name<C>, reinterpret_cast<unsigned char*>(state.at(C{})), sizeof(column_element<C, S>),
            std::size_t(column_layout<C, S>::width)}...}};
}

using saved_bytes = std::vector<std::vector<unsigned char>>;

/// An effect's parameters are bytes in a checkpoint if it has some, and does not say otherwise.
template <class E>
constexpr bool has_bytes = [] {
  static_assert(std::is_trivially_destructible<E>::value || !saves_parameters<E>,
                "collide: save and load: the parameters of this effect are no plain values: what they own cannot be "
                "saved; give it a member static constexpr bool saves_parameters = false, and set them after load");
  return saves_parameters<E> && !std::is_empty<E>::value;
}();

/// The bytes of an effect's parameters, or of their parts if there is padding between them.
template <class E>
std::vector<unsigned char> bytes_of_parameters(E const& effect) {
  std::vector<unsigned char> bytes;
  for_each_part_of(const_cast<E&>(effect), [&](auto const& part) {  // reads them only
    std::size_t const before = bytes.size();
    bytes.resize(before + sizeof part);
    std::memcpy(bytes.data() + before, &part, sizeof part);
  });
  return bytes;
}
struct no_part {
  template <class Part>
  void operator()(Part&) const {}
};
template <class E>
std::size_t size_of_parameters() {
  if constexpr (is_valid<for_each_part_call, E, no_part>) return bytes_of_parameters(E()).size();
  return sizeof(E);
}

template <class E>
void write_parameters([[maybe_unused]] checkpoint_writer& to, [[maybe_unused]] E const& effect) {
  if constexpr (has_bytes<E>) {
    auto const bytes = bytes_of_parameters(effect);
    to.block(parameters_name<E>(), bytes.data(), bytes.size());
  }
}
template <class E>
void read_parameters([[maybe_unused]] checkpoint_reader& from, [[maybe_unused]] saved_bytes& to) {
  if constexpr (has_bytes<E>) to.push_back(from.block<unsigned char>(parameters_name<E>(), size_of_parameters<E>()));
}
/// Takes the next of the parameters.
template <class E>
void restore_parameters([[maybe_unused]] saved_bytes::const_iterator& next, [[maybe_unused]] E& effect) {
  if constexpr (has_bytes<E>) {
    unsigned char const* from = (next++)->data();
    for_each_part_of(effect, [&](auto& part) {
      std::memcpy(static_cast<void*>(&part), from, sizeof part);
      from += sizeof part;
    });
  }
}

/// The numbers of a simulation besides its columns and the parameters of its effects.
template <class S, bool HasSource>
struct saved_numbers {
  std::uint64_t triangles = 0, places = 0, placed = 0;
  S common_radius = 0, smallest_radius = 0, largest_radius = 0;
  double time = 0, clock[clock_size] = {};
  std::uint8_t reverse_order = 0, next_meeting = 0, bodies_are_placed = 0;

  saved_numbers() = default;
  /// The numbers of a simulation, or of a rank's part of one with so many particles of all ranks. Waits.
  template <class State>
  saved_numbers(State const& s, std::uint64_t all_places, std::uint64_t all_placed)
      : triangles{s.mesh.size()},
        places{all_places},
        placed{all_placed},
        common_radius{s.particles.common_radius},
        smallest_radius{s.radii.smallest},
        largest_radius{s.radii.largest},
        time{s.time},
        reverse_order{s.reverse_order},
        next_meeting{static_cast<std::uint8_t>(s.next_meeting)},
        bodies_are_placed{s.bodies.are_placed()} {
    if constexpr (State::has_begin_step) s.space.copy_to_host(clock, s.particles.time, clock_size);
  }

  meeting meeting_between_steps() const { return static_cast<meeting>(min(int{next_meeting}, int(meeting::of_woken))); }

  /// Writes or reads all of them.
  template <class Archive>
  void pass(Archive& archive) {
    archive.value("triangles", triangles);
    archive.value("places", places);
    archive.value("placed", placed);
    archive.value("common radius", common_radius);
    archive.value("smallest radius", smallest_radius);
    archive.value("largest radius", largest_radius);
    archive.value("time", time);
    archive.value("time on the device", clock[0]);
    if (HasSource) archive.value("particles of the source", clock[clock_made]);
    if (HasSource) archive.value("part of its next one", clock[clock_fraction]);
    if (HasSource) archive.value("those that overlapped others", clock[clock_overlapping]);
    if (HasSource) archive.value("those that were not born", clock[clock_not_born]);
    archive.value("reverse order", reverse_order);
    archive.value("next meeting", next_meeting);
    archive.value("bodies are placed", bodies_are_placed);
  }
};

/// A simulation's state: how it becomes blocks of a checkpoint, and is made of them.
template <class Detector, class... Effect>
class checkpoint {
  using simulated = simulation<Detector, Effect...>;
  using S = typename simulated::scalar;
  using column_list = typename simulated::columns;
  using state_type = simulation_state<Detector, Effect...>;

 public:
  using numbers_type = saved_numbers<S, (is_source<Effect> || ...)>;
  /// Writes all blocks. A column is on the host while it is written.
  static void write(simulated const& from, std::ostream& stream, std::string const& name = "the stream") {
    state_type const& s = from.internals();
    if (!s.is_set) throw error("collide: save: the simulation has no particles: call set before it");
    checkpoint_writer to(stream, name);
    numbers_type numbers(s, s.particles.size, s.particles.placed);
    begin(to, numbers, s.effects);
    check_contacts(s);
    std::size_t const n = s.particles.size;
    for (saved_column const& column : saved_columns<S>(s.particles, column_list()))
      to.block(column.name(), bytes_on_host(s.space, column.data, n * column.bytes()).data(), n * column.width,
               column.element);
    end(to, from);
    saved_contacts<S> pairs, surfaces;
    if constexpr (remembers_pairs) pairs = contacts_between_particles(s);
    if constexpr (remembers_surfaces) surfaces = s.surfaces.save_contacts(s.space, s.particles.size);
    write_contacts(to, pairs, surfaces);
    to.finish();
  }

  /// The memory of contacts between particles. Waits.
  static saved_contacts<S> contacts_between_particles(state_type const& s) {
    check_contacts(s);
    return s.neighbours.save_contacts(s.space, s.particles.size);
  }

  /// Writes what is before the columns; then each column follows, and `end`.
  template <class Effects>
  static void begin(checkpoint_writer& to, numbers_type& numbers, Effects const& effects) {
    pass_types(to);
    numbers.pass(to);
    (write_parameters(to, effects.template of<Effect>()), ...);
  }
  template <class Simulation>
  static void end(checkpoint_writer& to, Simulation const& from) {
    if constexpr (state_type::has_bodies) {
      from.bodies().for_each_saved([&](std::string const& name, auto const* elements, std::size_t n) {
        auto const copy = bytes_on_host(from.space(), elements, n * sizeof(*elements));
        to.block(name, copy.data(), copy.size());
      });
    }
  }

  /// Writes what contacts remember, behind all else.
  static void write_contacts(checkpoint_writer& to, saved_contacts<S> const& pairs, saved_contacts<S> const& surfaces) {
    if constexpr (remembers_pairs) write_contacts(to, "contacts between particles", pairs);
    if constexpr (remembers_surfaces) write_contacts(to, "contacts with the mesh", surfaces);
  }

  checkpoint(simulated const& into, std::istream& stream) : checkpoint(into.internals().mesh.size(), into, stream) {}
  /// Reads and checks all blocks, for a simulation with so many triangles and such bodies. Changes nothing.
  template <class Simulation>
  checkpoint(std::size_t triangles, Simulation const& into, std::istream& stream) {
    checkpoint_reader from(stream);
    pass_types(from);
    numbers_.pass(from);
    if (state_type::asks_mesh && numbers_.triangles != triangles) {
      from.refuse("triangles", "the file has " + std::to_string(numbers_.triangles) + ", the mesh of the simulation " +
                                   std::to_string(triangles));
    }
    if (numbers_.places >= no_id) from.refuse("places", "a simulation has at most 2^32 - 2 particles");
    if (numbers_.placed > numbers_.places) from.refuse("placed", "more than there are places");
    (read_parameters<Effect>(from, parameters_), ...);
    for (saved_column const& column : saved_columns<S>(into.state(), column_list()))
      columns_.push_back(from.block(column.name(), numbers_.places * column.width, column.element));
    if constexpr (state_type::has_bodies) {
      into.bodies().for_each_saved([&](std::string const& name, auto const* elements, std::size_t n) {
        bodies_.push_back(from.block<unsigned char>(name, n * sizeof(*elements)));
      });
    }
    if constexpr (remembers_pairs) read_contacts(from, "contacts between particles", contact_width, pair_contacts_);
    if constexpr (remembers_surfaces)
      read_contacts(from, "contacts with the mesh", contact_width + 3, surface_contacts_);
    from.finish();
  }

  numbers_type const& numbers() const { return numbers_; }
  saved_contacts<S> const& pair_contacts() const { return pair_contacts_; }
  saved_contacts<S> const& surface_contacts() const { return surface_contacts_; }
  /// The values of a column, of all places.
  template <class C>
  column_element<C, S> const* column() const {
    return reinterpret_cast<column_element<C, S> const*>(columns_[index_of<C>(column_list())].data());
  }

  /// Gives the simulation this state.
  void restore(simulated& to) const {
    state_type& s = to.internals();
    preparation prepare(s);
    auto const places = static_cast<std::size_t>(numbers_.places);
    prepare.reserve(places);
    auto particles = s.memory.state(places, static_cast<std::size_t>(numbers_.placed), numbers_.common_radius);
    if constexpr (state_type::has_begin_step) particles.time = s.device_time.data();
    s.space.for_each(
        padded_size(places),
        init_particles<S, column_list>{particles, spheres_xyz<S>(nullptr, 0, numbers_.common_radius), nullptr, S(0)});
    restore_columns(s.space, particles, 0, 0, places);
    s.particles = particles;
    s.reverse_order = numbers_.reverse_order != 0;
    s.radii = {numbers_.smallest_radius, numbers_.largest_radius, S(0)};
    if constexpr (state_type::effects_type::any_pair_contact) s.neighbours.clear(s.space, places, s.radii);
    s.is_set = true;
    restore_rest(s, numbers_.clock);
    if constexpr (remembers_pairs) s.neighbours.restore_contacts(s.space, pair_contacts_);
    if constexpr (remembers_surfaces) s.surfaces.restore_contacts(s.space, surface_contacts_);
  }

  /// Gives a simulation, or a rank's part of one, whose particles are there, all that is not known of each: the time,
  /// effects and bodies.
  template <class State>
  void restore_rest(State& s, double const* clock) const {
    if constexpr (State::has_begin_step) s.space.copy_from_host(s.particles.time, clock, clock_size);
    [[maybe_unused]] auto parameters = parameters_.begin();
    (restore_parameters(parameters, s.effects.template of<Effect>()), ...);
    s.time = numbers_.time;
    s.next_meeting = numbers_.meeting_between_steps();
    preparation prepare(s);
    prepare.know_smallest();
    prepare.bodies_and_index();
    if constexpr (State::has_bodies) {
      std::size_t next = 0;
      s.bodies.for_each_saved([&](std::string const&, auto* elements, std::size_t) {
        auto const& saved = bodies_[next++];
        s.space.copy_from_host(reinterpret_cast<unsigned char*>(elements), saved.data(), saved.size());
      });
    }
    s.bodies.place(numbers_.bodies_are_placed != 0);
  }

  /// Gives places from `place` on the columns of `n` particles from number `first` on.
  template <class Space, class State>
  void restore_columns(Space const& space, State const& state, std::size_t place, std::size_t first,
                       std::size_t n) const {
    std::size_t k = 0;
    for (saved_column const& column : saved_columns<S>(state, column_list())) {
      std::size_t const bytes = column.bytes();
      space.copy_from_host(column.data + bytes * place, columns_[k++].data() + bytes * first, bytes * n);
    }
  }

 private:
  /// The type of the simulation: written, or compared with what was.
  template <class Archive>
  static void pass_types(Archive& archive) {
    archive.text("scalar", type_name<S>());
    archive.text("narrow phase", type_name<typename state_type::narrow_phase>());
    archive.text("effects", list_of_names({type_name<Effect>...}));
  }

  using remembered = typename simulated::effects_type::remembered;
  static constexpr bool remembers_pairs = remembered::size != 0 && simulated::effects_type::any_pair_contact;
  static constexpr bool remembers_surfaces = simulated::effects_type::remembers_surfaces;
  static constexpr std::uint64_t contact_width = std::uint64_t(contact_values<S, remembered>::width);

  static void write_contacts(checkpoint_writer& to, std::string const& name, saved_contacts<S> const& saved) {
    to.block(name, saved.counts.data(), saved.counts.size());
    to.block("others of " + name, saved.others.data(), saved.others.size());
    to.block("values of " + name, saved.values.data(), saved.values.size());
  }
  void read_contacts(checkpoint_reader& from, std::string const& name, std::uint64_t width,
                     saved_contacts<S>& saved) const {
    saved.counts = from.block<std::uint32_t>(name, numbers_.places);
    std::uint64_t all = 0;
    for (std::uint32_t const count : saved.counts) all += count;
    saved.others = from.block<id>("others of " + name, all);
    saved.values = from.block<S>("values of " + name, all * width);
  }

  template <class Column, class... C>
  static constexpr std::size_t index_of(columns<C...>) {
    std::size_t k = 0;
    ((std::is_same<C, Column>::value || (++k, false)) || ...);
    return k;
  }

  numbers_type numbers_;
  saved_contacts<S> pair_contacts_, surface_contacts_;
  saved_bytes parameters_;  ///< of the effects that have some
  saved_bytes columns_;
  saved_bytes bodies_;  ///< poses, and what else is known of them
};

}  // namespace detail

/// Writes all that the next steps of a simulation depend on: columns, time, poses of bodies, and the parameters of the
/// effects. The mesh is not in it, nor the space: what was saved on the host can be loaded on a GPU. A stream must be
/// binary.
///
/// An effect's parameters are saved as the bytes that they are. One with pointers, which mean nothing in another
/// process, has a member `static constexpr bool saves_parameters = false`, and is left out; so has a source of
/// `emit_from` and a field of `wind`.
///
/// Throws `error` if there are no particles yet, or the stream or the file does not take it. Waits. O(particles); takes
/// memory of the host for a copy of the largest column.
template <class Detector, class... Effect>
void save(simulation<Detector, Effect...> const& from, std::ostream& to) {
  detail::checkpoint<Detector, Effect...>::write(from, to);
}

/// Writes a checkpoint to a file, first under the name `path` + ".part": an older file stays until the new one is
/// complete, which has its permissions. If `path` is a link, that is the file that it leads to.
template <class Detector, class... Effect>
void save(simulation<Detector, Effect...> const& from, std::string const& path) {
  detail::checkpoint_file file(path);
  detail::checkpoint<Detector, Effect...>::write(from, file.stream(), path);
  file.complete();
}

/// Gives a simulation the state that `save` has written: the particles that it had are gone, the parameters of its
/// effects are those of the file. Steps from here on give the bits that they would have given there. Comes after
/// `set_mesh` where an effect touches the mesh, with the mesh that the steps had there, of which only the number of
/// triangles is compared. A graph that was captured before is good no longer.
///
/// Throws `error`, which names what is wrong, if the file is cut off or damaged, or of another version of the format,
/// another scalar, narrow phase or list of effects, or another number of triangles: the simulation is as it was. If the
/// space has no memory for it, it has no particles, as after a `set` that finds none. Reads no farther than the
/// checkpoint goes. Waits. O(particles); takes memory of the host for a copy of all columns.
template <class Detector, class... Effect>
void load(simulation<Detector, Effect...>& into, std::istream& from) {
  detail::checkpoint<Detector, Effect...>(into, from).restore(into);
}

/// Reads a checkpoint from a file, which has nothing else in it. Throws `error` if it cannot be read, and what `load`
/// of a stream throws.
template <class Detector, class... Effect>
void load(simulation<Detector, Effect...>& into, std::string const& path) {
  detail::read_checkpoint_file(path, [&](std::istream& file) {
    return detail::checkpoint<Detector, Effect...>(into, file);
  }).restore(into);
}

}  // namespace collide
