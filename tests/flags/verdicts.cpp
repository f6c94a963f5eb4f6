/// verdicts (float|double FILE)...: judges the cases in files with the columns of tests/data with `exact`, once as the
/// program starts and once with subnormal numbers flushed to zero, and prints how many verdicts are wrong. Files of
/// floats are read as doubles, too. Is compiled with flags that change arithmetic: it compares and calculates with
/// integers only. As CUDA it judges on the device.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <limits>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

#include <collide/all_pairs.cuh>
#include <collide/bucket.cuh>
#include <collide/sinks/pairs.hpp>
#include <collide/spaces/upload.hpp>

#include "../flush_to_zero.hpp"

#if defined(__CUDACC__)
using space_type = collide::cuda;
using bucket_space = collide::cuda_shared;
#else
using space_type = collide::host;
using bucket_space = collide::host;
#endif

/// The number of `S` that is +-0xH.HHHp+-D, inf, -inf or nan; its bits are put together here, nothing is rounded.
template <class S>
S number(std::string text) {
  using bits_type = std::conditional_t<sizeof(S) == 4, std::uint32_t, std::uint64_t>;
  constexpr int digits = std::numeric_limits<S>::digits,
                least = std::numeric_limits<S>::min_exponent - digits;  // the exponent of the last place of subnormals
  constexpr std::uint64_t hidden = std::uint64_t{1} << (digits - 1),
                          infinity = (std::uint64_t{1} << (8 * sizeof(S) - 1)) - hidden;
  std::uint64_t const sign = text[0] == '-' ? std::uint64_t{1} << (8 * sizeof(S) - 1) : 0;
  if (sign != 0) text.erase(0, 1);
  std::uint64_t magnitude = 0;
  if (text == "inf") {
    magnitude = infinity;
  } else if (text == "nan") {
    magnitude = infinity | hidden >> 1;
  } else {
    auto const dot = text.find('.'), p = text.find('p');
    if (text.compare(0, 2, "0x") != 0 || p == std::string::npos) throw std::runtime_error(text + ": not a number");
    std::string const hex = text.substr(2, std::min(dot, p) - 2) + (dot < p ? text.substr(dot + 1, p - dot - 1) : "");
    int exponent = std::stoi(text.substr(p + 1)) - (dot < p ? 4 * static_cast<int>(p - dot - 1) : 0);
    std::uint64_t mantissa = std::stoull(hex, nullptr, 16);
    while (mantissa != 0 && mantissa < hidden && exponent > least) mantissa <<= 1, --exponent;
    while (mantissa >= 2 * hidden || (mantissa != 0 && exponent < least)) {
      if (mantissa % 2 != 0) throw std::runtime_error(text + ": has too many digits");
      mantissa >>= 1, ++exponent;
    }
    if (mantissa != 0) magnitude = mantissa + static_cast<std::uint64_t>(exponent - least) * hidden;
    if (magnitude >= infinity) throw std::runtime_error(text + ": too large");
  }
  auto const bits = static_cast<bits_type>(sign | magnitude);
  S value;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

/// The cases of a file: triangle i and sphere i, and whether they touch.
template <class S>
struct table {
  std::vector<S> corners, spheres;  ///< 9 and 4 numbers each
  std::vector<std::uint8_t> hit;

  explicit table(std::string const& path) {
    std::ifstream file(path);
    std::string line;
    if (!std::getline(file, line)) throw std::runtime_error(path + ": cannot read it");
    auto const names = cells(line);
    auto const column = [&](char const* name) {
      return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
    };
    while (std::getline(file, line)) {
      auto const row = cells(line);
      for (auto name : {"ax", "ay", "az", "bx", "by", "bz", "cx", "cy", "cz"})
        corners.push_back(number<S>(row.at(column(name))));
      for (auto name : {"px", "py", "pz", "R"}) spheres.push_back(number<S>(row.at(column(name))));
      hit.push_back(row.at(column("hit")) == "1");
    }
    if (hit.empty()) throw std::runtime_error(path + ": no rows");
  }

  std::size_t size() const { return hit.size(); }
  collide::mesh_view<S> mesh(std::size_t first, std::size_t n) const {
    return collide::triangle_soup(corners.data() + 9 * first, n);
  }
  collide::sphere_view<S> balls(std::size_t first, std::size_t n) const {
    return collide::spheres_xyzr(spheres.data() + 4 * first, n);
  }

 private:
  static std::vector<std::string> cells(std::string const& line) {
    std::vector<std::string> found(1);
    for (char c : line) {
      if (c == ',')
        found.emplace_back();
      else
        found.back() += c;
    }
    return found;
  }
};

/// Writes for sphere i / n and triangle i % n whether they touch.
template <class S>
struct judge {
  collide::mesh_view<S> mesh;
  collide::sphere_view<S> spheres;
  std::uint8_t* hit;
  COLLIDE_HD void operator()(std::size_t i) const {
    auto const sphere = static_cast<collide::id>(i / mesh.size()), triangle = static_cast<collide::id>(i % mesh.size());
    hit[i] = collide::karabassi<collide::exact>::intersects(mesh[triangle], spheres[sphere]) ? 1 : 0;
  }
};

template <class S, class BroadPhase, class Space>
std::vector<collide::pair> detected(collide::mesh_view<S> mesh, collide::sphere_view<S> spheres) {
  collide::detector<BroadPhase, collide::karabassi<collide::exact>, Space, S> detector;
  return detector.detect(mesh, spheres, collide::pairs(collide::order::canonical)).to_host();
}

/// Judges cases in scenes of 16, every sphere with every triangle. Wrong is a verdict that is not that of the file, and
/// a pair that a broad phase loses or makes up.
template <class S>
int count_wrong(table<S> const& cases) {
  int wrong = 0;
  space_type space;
  constexpr std::size_t most = 16;
  for (std::size_t first = 0; first < cases.size(); first += most) {
    std::size_t const n = std::min(most, cases.size() - first);
    auto const mesh = collide::upload(space, cases.mesh(first, n));
    auto const spheres = collide::upload(space, cases.balls(first, n));
    collide::buffer<std::uint8_t> hits_there;
    std::vector<std::uint8_t> hits(n * n);
    space.for_each(hits.size(), judge<S>{mesh.view(), spheres.view(), hits_there.reserve(space.resource(), n * n)});
    space.copy_to_host(hits.data(), hits_there.data(), hits.size());
    std::vector<collide::pair> pairs;
    for (collide::id s = 0; s < n; ++s) {
      if (hits[s * n + s] != cases.hit[first + s]) {
        std::printf("row %zu: %d\n", first + s, hits[s * n + s]);
        ++wrong;
      }
      for (collide::id t = 0; t < n; ++t)
        if (hits[s * n + t] != 0) pairs.push_back({s, t});
    }
    if (detected<S, collide::all_pairs, space_type>(mesh.view(), spheres.view()) != pairs)
      std::printf("rows from %zu: all_pairs\n", first), ++wrong;
    if (detected<S, collide::bucket, bucket_space>(mesh.view(), spheres.view()) != pairs)
      std::printf("rows from %zu: bucket\n", first), ++wrong;
  }
  return wrong;
}

template <class S>
int judge_file(std::string const& path) {
  table<S> const cases(path);
  int const wrong = count_wrong(cases);
  std::printf("%s as %s: %zu cases, %d wrong\n", path.c_str(), sizeof(S) == 4 ? "float" : "double", cases.size(),
              wrong);
  return wrong;
}

int judge_files(int argc, char** argv) {
  int wrong = 0;
  for (int i = 1; i + 1 < argc; i += 2) {
    if (std::strcmp(argv[i], "float") == 0) wrong += judge_file<float>(argv[i + 1]);
    wrong += judge_file<double>(argv[i + 1]);
  }
  return wrong;
}

int main(int argc, char** argv) {
#if defined(__CUDACC__)
  if (collide::cuda_device_count() == 0) {
    std::puts("skipped: no CUDA device");
    return 77;
  }
#endif
  int wrong = judge_files(argc, argv);
  std::puts("with subnormal numbers flushed to zero:");
  tests::flush_to_zero const flushes;
  wrong += judge_files(argc, argv);
  return argc < 3 || wrong != 0;
}
