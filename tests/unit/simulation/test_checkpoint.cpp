/// Checkpoints on the host.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <new>

#include <collide/effects/emit.hpp>
#include <collide/effects/wind.hpp>

#include "compositions.hpp"
#include "simulation/checkpoint.hpp"

namespace {

using collide::bounce;
using collide::gravity;
using collide::host;
using collide::karabassi;

using falls = collide::simulation<tests::meets_mesh<host>, gravity, bounce>;

/// A small simulation that has been saved, and another with a state of its own, into which nothing is loaded.
struct two_simulations {
  tests::world<float> w = tests::layers<float>(2, 1, 0.05);
  tests::running<falls> first{host(1), w, gravity{}, bounce{0.25}}, next{host(1), w, gravity{}, bounce{0.5}};
  std::string file, before;

  two_simulations() {
    first.simulation.steps(20, 1e-2f);
    next.simulation.steps(3, 1e-2f);
    file = tests::saved(first.simulation);
    before = tests::bits_of(next.simulation);
  }

  /// True if the file is refused with a sentence that has this word, and nothing else happens.
  bool refused(std::string const& bytes, std::string const& word = "load: ") {
    std::string const why = tests::fails_to_load(bytes, next.simulation);
    INFO(why);
    bool const said = why.find("collide: load: ") == 0 && why.find(word) != why.npos;
    CHECK(said);
    return said && tests::bits_of(next.simulation) == before && next.simulation.effect<bounce>().restitution == 0.5;
  }
};

/// The checksum of a file as another program computes it: FNV-1a.
std::string with_checksum(std::string bytes) {
  std::uint64_t sum = 14695981039346656037u;
  bytes.resize(bytes.size() - 8);
  for (char const c : bytes) {
    sum ^= static_cast<unsigned char>(c);
    sum *= 1099511628211u;
  }
  return bytes.append(reinterpret_cast<char const*>(&sum), 8);
}

/// Functions without a state: of no byte that anyone sets.
struct calm {
  template <class S>
  COLLIDE_HD collide::vec3<S> operator()(collide::vec3<S> const&) const {
    return {S(0), S(0), S(0)};
  }
};
struct from_above {
  template <class S>
  COLLIDE_HD void operator()(std::uint64_t number, collide::vec3<S>& x, collide::vec3<S>& v) const {
    x = {S(0), S(0), S(1 + number)};
    v = {S(0), S(0), S(-1)};
  }
};

/// An effect in memory that was full of `byte`.
template <class E>
E& made_in(unsigned char byte) {
  alignas(E) static unsigned char memory[sizeof(E)];
  std::fill(std::begin(memory), std::end(memory), byte);
  return *new (memory) E;
}

/// A checkpoint of a scene whose effects have been in such memory.
std::string saved_from(unsigned char byte) {
  auto& wind = made_in<collide::wind<calm>>(byte);
  auto& source = made_in<collide::emit_from<from_above>>(byte);
  auto const& moving = made_in<collide::moving_bodies<collide::driven>>(byte);
  wind.linear = 1;
  source.rate = 10;
  using scene = collide::simulation<tests::meets_mesh<host>, collide::wind<calm>, collide::emit_from<from_above>,
                                    collide::moving_bodies<collide::driven>>;
  tests::world<float> const w = tests::layers<float>(2, 1, 0.05);
  tests::running<scene> made{host(1), w, wind, source, moving};
  made.simulation.steps(3, 1e-2f);
  return tests::saved(made.simulation);
}

std::string read_file(std::string const& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace

TEST_CASE("checkpoint: a simulation that is loaded goes on in the same bits") { tests::check_scenes_go_on(host(2)); }

TEST_CASE("checkpoint: pointers are not saved") { tests::check_pointers_stay(host(1)); }

TEST_CASE("checkpoint: bodies go on from where they were") {
  tests::check_bodies_go_on<host, karabassi<>, collide::body_motion>(host(1));
  tests::check_bodies_go_on<host, collide::karabassi_swept<>, collide::body_motion>(host(1));
  tests::check_bodies_go_on<host, karabassi<>, collide::driven>(host(1));
  tests::check_bodies_go_on<host, collide::karabassi_swept<>, collide::driven>(host(1));
}

TEST_CASE("checkpoint: from one space to another, and the same bytes again") {
  tests::check_other_space(host(1), tests::lockstep<256, false>());
  tests::check_other_space(tests::lockstep<64, true>(), host(2));
}

TEST_CASE("checkpoint: each byte that is damaged, and each cut, is found, and nothing changes") {
  two_simulations s;
  CHECK(with_checksum(s.file) == s.file);
  bool all = true;
  for (std::size_t i = 0; i < s.file.size(); ++i) {
    for (int const damage : {1, 0x80, 0xff}) {
      std::string bytes = s.file;
      bytes[i] = static_cast<char>(bytes[i] ^ damage);
      all = all && s.refused(bytes);
    }
    all = all && s.refused(s.file.substr(0, i));
  }
  CHECK(all);
  CHECK(tests::fails_to_load(s.file, s.next.simulation).empty());
  CHECK(tests::bits_of(s.next.simulation) == tests::bits_of(s.first.simulation));
  CHECK(s.next.simulation.effect<bounce>().restitution == 0.25);
}

TEST_CASE("checkpoint: no byte is of memory that no one has set") { CHECK(saved_from(0) == saved_from(0xff)); }

TEST_CASE("checkpoint: what is another's is refused by name") {
  two_simulations s;
  auto const of = [&](auto simulation) {
    using type = decltype(simulation);
    using S = typename type::scalar;
    tests::running<type> made(host(1), tests::layers<S>(2, 1, 0.05));
    return tests::saved(made.simulation);
  };
  using collide::simulation;
  CHECK(s.refused(of(simulation<tests::meets_mesh<host, karabassi<>, double>, gravity, bounce>()),
                  "scalar: the file has double, the simulation float"));
  CHECK(s.refused(of(simulation<tests::meets_mesh<host, collide::karabassi_swept<>>, gravity, bounce>()),
                  "narrow phase: the file has collide::karabassi_swept<"));
  CHECK(s.refused(of(simulation<tests::meets_mesh<host>, gravity>()),
                  "effects: the file has collide::gravity, the simulation collide::gravity, collide::bounce"));
  CHECK(s.refused(of(simulation<tests::meets_mesh<host>, gravity, collide::drag, bounce>()), "effects"));

  std::string bytes = s.file;
  bytes[8] = 2;
  CHECK(s.refused(with_checksum(bytes), "version: the file has 2, this program reads 1"));
  std::reverse(&bytes[8], &bytes[12]);
  std::reverse(&bytes[12], &bytes[16]);
  CHECK(s.refused(with_checksum(bytes), "byte order"));
  bytes = s.file;
  std::memset(&bytes[bytes.find("places") + 6 + 12], 0xff, 8);
  CHECK(s.refused(with_checksum(bytes), "places: a simulation has at most 2^32 - 2 particles"));
  bytes = s.file;
  bytes[bytes.find("placed") + 6 + 12] = 5;
  CHECK(s.refused(with_checksum(bytes), "placed: more than there are places"));
  CHECK(s.refused("", "head: the file ends there"));
  CHECK(s.refused("# vtk DataFile Version 3.0", "head: this is no checkpoint"));

  auto larger = s.w;
  tests::add_cube(larger, 3, 1);
  tests::running<falls> const with_cube(host(1), larger);
  CHECK(s.refused(tests::saved(with_cube.simulation), "triangles: the file has 140, the mesh of the simulation 128"));
}

TEST_CASE("checkpoint: before set there is nothing to save, and a mesh comes before load") {
  two_simulations s;
  falls nothing{host(1)};
  CHECK_THROWS_WITH_AS(tests::saved(nothing), "collide: save: the simulation has no particles: call set before it",
                       collide::error);
  CHECK(tests::fails_to_load(s.file, nothing) ==
        "collide: load: triangles: the file has 128, the mesh of the simulation 0");
  collide::simulation<tests::meets_mesh<host>, gravity> free{host(1)}, other{host(1)};
  free.set(collide::spheres_xyz<float>(nullptr, 0, 0.1f));
  tests::load_from(tests::saved(free), other);
  other.step(0.1f);
  CHECK(other.size() == 0);
  CHECK(other.time() == doctest::Approx(0.1));
}

TEST_CASE("checkpoint: several in a stream, and one that takes nothing") {
  two_simulations s;
  std::stringstream both(std::ios::in | std::ios::out | std::ios::binary);
  collide::save(s.next.simulation, both);
  collide::save(s.first.simulation, both);
  s.next.simulation.steps(7, 1e-2f);
  collide::load(s.next.simulation, both);
  CHECK(tests::bits_of(s.next.simulation) == s.before);
  collide::load(s.next.simulation, both);
  CHECK(tests::bits_of(s.next.simulation) == tests::bits_of(s.first.simulation));
  std::ostringstream full;
  full.setstate(std::ios::badbit);
  CHECK_THROWS_WITH_AS(collide::save(s.first.simulation, full),
                       "collide: save: the stream does not take what is written: is it full?", collide::error);
}

TEST_CASE("checkpoint: files") {
  two_simulations s;
  std::string const path = "test_checkpoint.file", part = path + ".part";
  collide::save(s.first.simulation, path);
  CHECK(read_file(path) == s.file);
  CHECK(!std::ifstream(part));
  falls nothing{host(1)};
  CHECK_THROWS_AS(collide::save(nothing, path), collide::error);
  CHECK(read_file(path) == s.file);  // it stays
  CHECK(!std::ifstream(part));
  CHECK_THROWS_WITH_AS(collide::save(s.first.simulation, "no/such/folder"),
                       "collide: save: no/such/folder cannot be written", collide::error);
  CHECK_THROWS_WITH_AS(collide::load(s.next.simulation, "no/such/folder"),
                       "collide: load: no/such/folder cannot be read", collide::error);
  collide::load(s.next.simulation, path);
  CHECK(tests::bits_of(s.next.simulation) == tests::bits_of(s.first.simulation));
  s.next.simulation.step(1e-2f);
  s.before = tests::bits_of(s.next.simulation);
  std::ofstream(path, std::ios::binary | std::ios::app) << 'x';
  CHECK_THROWS_WITH_AS(collide::load(s.next.simulation, path),
                       "collide: load: test_checkpoint.file goes on behind the checkpoint", collide::error);
  CHECK(tests::bits_of(s.next.simulation) == s.before);
  std::remove(path.c_str());
}

TEST_CASE("checkpoint: files behind links, with permissions, and on a full disk") {
  namespace fs = std::filesystem;
  two_simulations s;
  fs::path const folder = "test_checkpoint.links";
  fs::remove_all(folder);
  fs::create_directories(folder / "far");
  fs::create_symlink("middle", folder / "link");
  fs::create_symlink(fs::path("far") / "file", folder / "middle");
  std::string const link = (folder / "link").string(), file = (folder / "far" / "file").string();
  collide::save(s.first.simulation, link);  // there is no file yet
  CHECK(read_file(file) == s.file);
  fs::permissions(file, fs::perms::owner_read | fs::perms::owner_write);
  collide::save(s.next.simulation, link);
  CHECK(read_file(file) == tests::saved(s.next.simulation));
  CHECK(fs::is_symlink(link));
  CHECK(fs::is_symlink(folder / "middle"));
  CHECK(fs::status(file).permissions() == (fs::perms::owner_read | fs::perms::owner_write));
  CHECK(!fs::exists(file + ".part"));
  collide::load(s.next.simulation, link);
  if (fs::exists("/dev/full")) {
    fs::create_symlink("/dev/full", folder / "full");
    std::string const full = (folder / "full").string();
    CHECK_THROWS_WITH_AS(collide::save(s.first.simulation, full),
                         ("collide: save: " + full + " does not take what is written: is it full?").c_str(),
                         collide::error);
    CHECK(fs::is_character_file("/dev/full"));
  }
  fs::remove_all(folder);
}
