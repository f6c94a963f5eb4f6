/// \file
/// Tutorial 4: the same scene at the origin and far from it, with the four precisions. Half of the spheres come within
/// rounding of a triangle.

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <vector>

#include <collide/bucket.cuh>

namespace {

constexpr unsigned cells = 60;  // of the terrain, along each side

/// A hilly terrain, and for each of its vertices a sphere that touches it, as closely as a float can say.
template <class S>
struct scene {
  std::vector<S> vertices, centres, radii;
  std::vector<unsigned> triangles;

  explicit scene(double offset) {
    for (unsigned y = 0; y <= cells; ++y)
      for (unsigned x = 0; x <= cells; ++x) {
        double const height = std::sin(0.7 * x) * std::cos(0.9 * y), to[] = {0.1, 0.2, 2};
        add(vertices, {x + offset, y + offset, height + offset});
        add(centres, {x + to[0] + offset, y + to[1] + offset, height + to[2] + offset});
        radii.push_back(static_cast<S>(static_cast<float>(std::sqrt(to[0] * to[0] + to[1] * to[1] + to[2] * to[2]))));
      }
    for (unsigned y = 0; y < cells; ++y)
      for (unsigned x = 0; x < cells; ++x) {
        unsigned const a = y * (cells + 1) + x, b = a + 1, c = a + cells + 1, d = c + 1;
        triangles.insert(triangles.end(), {a, b, d, a, d, c});
      }
  }

 private:
  static void add(std::vector<S>& to, std::array<double, 3> const& xyz) {
    for (double const coordinate : xyz) to.push_back(static_cast<S>(coordinate));
  }
};

/// The colliding pairs, and how long build and query took, in ms.
template <class Precision, class S>
std::vector<collide::pair> pairs_of(scene<S> const& s, double& ms) {
  collide::detector<collide::bucket, collide::karabassi<Precision>, collide::host, S> detector(collide::host(1));
  auto const begin = std::chrono::steady_clock::now();
  detector.build(
      collide::indexed_mesh(s.vertices.data(), s.vertices.size() / 3, s.triangles.data(), s.triangles.size() / 3));
  auto const spheres = collide::spheres_xyz(s.centres.data(), s.radii.size(), s.radii.data());
  auto pairs = detector.query(spheres, collide::pairs(collide::order::canonical)).to_host();
  ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
  return pairs;
}

/// In how many pairs two results differ.
std::size_t differences(std::vector<collide::pair> const& a, std::vector<collide::pair> const& b) {
  std::vector<collide::pair> different;
  std::set_symmetric_difference(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(different));
  return different.size();
}

template <class Precision>
void report(char const* name, scene<float> const& s, std::vector<collide::pair> const& right) {
  double ms = 0;
  std::size_t const wrong = differences(pairs_of<Precision>(s, ms), right);
  std::printf("%-17s %6.1f ms  %zu wrong\n", name, ms, wrong);
}

}  // namespace

int main() {
  for (double const offset : {0.0, 1e5}) {
    scene<float> const s(offset);
    double ms = 0;
    std::vector<collide::pair> const right = pairs_of<collide::exact>(s, ms);
    std::printf("%.0f from the origin, %zu pairs\n", offset, right.size());
    report<collide::baseline>("baseline", s, right);
    report<collide::single_precision>("single_precision", s, right);
    report<collide::double_precision>("double_precision", s, right);
    report<collide::exact>("exact", s, right);

    std::vector<collide::pair> const unrounded = pairs_of<collide::exact>(scene<double>(offset), ms);
    std::printf("coordinates in double: %zu pairs differ\n", differences(right, unrounded));
  }
}
