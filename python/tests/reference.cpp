// Answers all queries of a scene with the library itself: the tests compare Python's bytes with these.
//
// reference NAME SPHERES TRIANGLES SCENE: writes a scene of io/scenes.hpp, of doubles
// reference one: what calls with one sphere and one triangle take, in microseconds of processor time: bench/host.py
// reference SCENE RESULTS: answers. A scene is eight numbers of 64 bits - bytes of a scalar, vertices, triangles,
// spheres, 1 if each has a radius, 1 if they move, precision 0 exact, 1 double, 2 single, and steps of a simulation -
// and the arrays. The results are one after the other, each with its number of bytes before it.
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <iostream>
#include <string>
#include <vector>

#include <collide/bucket.cuh>
#include <collide/bvh.cuh>
#include <collide/effects/bounce.hpp>
#include <collide/effects/gravity.hpp>
#include <collide/karabassi_swept.hpp>
#include <collide/simulation.cuh>
#include <collide/sinks/csr.hpp>
#include <collide/sinks/earliest.hpp>
#include <collide/sinks/impacts.hpp>
#include <collide/sinks/k_nearest.hpp>
#include <collide/sinks/signed_distance.hpp>

#include "io/scenes.hpp"

using namespace collide;

struct files {
  std::ifstream scene;
  std::ofstream results;

  template <class T>
  std::vector<T> read(std::size_t n) {
    std::vector<T> values(n);
    scene.read(reinterpret_cast<char*>(values.data()), static_cast<std::streamsize>(n * sizeof(T)));
    return values;
  }
  template <class T>
  void write(std::vector<T> const& values) {
    std::uint64_t const bytes = values.size() * sizeof(T);
    results.write(reinterpret_cast<char const*>(&bytes), sizeof bytes);
    results.write(reinterpret_cast<char const*>(values.data()), static_cast<std::streamsize>(bytes));
  }
};

template <class Detector, class Spheres>
void answer_all(Detector& detector, Spheres const& spheres, files& f) {
  f.write(std::vector<std::uint64_t>{detector.query(spheres, count()).total()});
  f.write(detector.query(spheres, any_hit()).to_host());
  f.write(detector.query(spheres, pairs(order::canonical)).to_host());
  auto const rows = detector.query(spheres, csr(order::canonical)).to_host();
  f.write(rows.offsets);
  f.write(rows.triangles);
  f.write(detector.query(spheres, contacts<typename Detector::scalar>(order::canonical)).to_host());
}

template <class S>
void answer_points(mesh_view<S> const& mesh, point_view<S> const& points, files& f) {
  detector<bvh, karabassi<>, host, S> nearby;
  nearby.build(mesh);
  f.write(nearby.query(points, nearest<S>()).to_host());
  f.write(nearby.query(points, k_nearest<S>(3)).to_host());
  f.write(nearby.query(points, signed_distance<S>()).to_host());
  f.write(nearby.query(points, contains()).to_host());
}

template <class S, class Precision>
void answer(std::vector<std::uint64_t> const& numbers, files& f) {
  auto const vertices = f.read<S>(3 * numbers[1]);
  auto const triangles = f.read<std::uint32_t>(3 * numbers[2]);
  auto const centres = f.read<S>(3 * numbers[3]);
  auto const radii = f.read<S>(numbers[4] != 0 ? numbers[3] : 1);
  auto const displacements = f.read<S>(numbers[5] != 0 ? 3 * numbers[3] : 0);
  auto const mesh = indexed_mesh(vertices.data(), numbers[1], triangles.data(), numbers[2]);
  auto const spheres = numbers[4] != 0 ? spheres_xyz(centres.data(), numbers[3], radii.data())
                                       : spheres_xyz(centres.data(), numbers[3], radii[0]);
  if (numbers[5] != 0) {
    detector<bucket, karabassi_swept<>, host, S> swept;
    swept.build(mesh);
    auto const moving = with_displacements(spheres, displacements.data());
    answer_all(swept, moving, f);
    f.write(swept.query(moving, impacts<S>(order::canonical)).to_host());
    f.write(swept.query(moving, earliest_impact<S>()).to_host());
  } else {
    detector<bucket, karabassi<Precision>, host, S> at_rest;
    at_rest.build(mesh);
    answer_all(at_rest, spheres, f);
    f.write(at_rest.query(spheres, closest_contact<S>()).to_host());
    if (numbers[6] == 0) answer_points<S>(mesh, spheres.centres(), f);
  }
  if (numbers[7] == 0) return;
  simulation<detector<bucket, karabassi<>, host, S>, gravity, bounce> scene(host(), gravity{0, 0, -9.81}, bounce{0.5});
  scene.set_mesh(mesh);
  scene.set(spheres);
  scene.steps(numbers[7], S(0.001));
  f.write(scene.template to_host<position>());
  f.write(scene.template to_host<velocity>());
}

template <class S>
void answer(std::vector<std::uint64_t> const& numbers, files& f) {
  if (numbers[6] == 0) answer<S, exact>(numbers, f);
  if (numbers[6] == 1) answer<S, double_precision>(numbers, f);
  if (numbers[6] == 2) answer<S, single_precision>(numbers, f);
}

template <class T>
void append(std::ofstream& to, std::vector<T> const& values) {
  to.write(reinterpret_cast<char const*>(values.data()), static_cast<std::streamsize>(values.size() * sizeof(T)));
}

int make(char** argv) {
  io::scene_kind const* const kind = io::find_scene(argv[1]);
  if (kind == nullptr) return 2;
  auto const scene = kind->make(std::strtoull(argv[2], nullptr, 10), std::strtoull(argv[3], nullptr, 10), 0);
  std::ofstream to(argv[4], std::ios::binary);
  append(to, std::vector<std::uint64_t>{8, scene.vertices.size() / 3, scene.triangle_count(), scene.sphere_count(),
                                        !scene.radii.empty(), 0, 0, 0});
  append(to, scene.vertices);
  append(to, scene.corners);
  append(to, scene.centres);
  append(to, scene.radii.empty() ? std::vector<double>{scene.radius} : scene.radii);
  return 0;
}

/// Prints the least mean of 500 calls, of 20 such means.
template <class Call>
void show_time(char const* name, Call const& call) {
  double least = 1e9;
  for (int k = 0; k < 20; ++k) {
    std::clock_t const begin = std::clock();
    for (int i = 0; i < 500; ++i) call();
    least = std::min(least, 1e6 / CLOCKS_PER_SEC / 500 * static_cast<double>(std::clock() - begin));
  }
  std::cout << name << ' ' << least << '\n';
}

void show_times() {
  float const corners[] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, centre[] = {0, 0, 0};
  auto const mesh = triangle_soup(corners, 1);
  auto const spheres = spheres_xyz(centre, 1, 1.0f);
  detector<bucket> touching;
  detector<bvh> nearby;
  touching.build(mesh);
  nearby.build(mesh);
  show_time("any", [&] { touching.query(spheres, any_hit()); });
  show_time("count", [&] { touching.query(spheres, count()); });
  show_time("query", [&] { touching.query(spheres, pairs()); });
  show_time("contacts", [&] { touching.query(spheres, contacts<>()); });
  show_time("nearest", [&] { nearby.query(spheres.centres(), nearest<>()); });
  show_time("contains", [&] { nearby.query(spheres.centres(), contains()); });
  show_time("signed_distance", [&] { nearby.query(spheres.centres(), signed_distance<>()); });
}

int main(int argc, char** argv) {
  if (argc == 2) show_times();
  if (argc == 5) return make(argv);
  if (argc != 3) return 2;
  files f{std::ifstream(argv[1], std::ios::binary), std::ofstream(argv[2], std::ios::binary)};
  auto const numbers = f.read<std::uint64_t>(8);
  numbers[0] == 4 ? answer<float>(numbers, f) : answer<double>(numbers, f);
}
