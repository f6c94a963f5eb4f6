/// Shared by the harnesses of the verdicts. An input is the bytes of the numbers of one case: three corners, the
/// centre, the displacement of a ball that moves, and the radius; as many as `Count`. They are floats if that is what
/// its length says, doubles if it is twice as long, and nothing else is looked at.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <random>

#include <collide/core/contact.hpp>

#include "../oracle/exact.hpp"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

namespace fuzz {

/// The numbers of a case.
template <class S, std::size_t Count>
struct numbers {
  static constexpr std::size_t count = Count;
  std::array<S, Count> x;

  static numbers from(std::uint8_t const* data) {
    numbers n;
    std::memcpy(n.x.data(), data, sizeof n.x);
    return n;
  }

  collide::vec3<S> point(std::size_t i) const { return {x[3 * i], x[3 * i + 1], x[3 * i + 2]}; }
  collide::triangle<S> shape() const { return {point(0), point(1), point(2)}; }
  collide::sphere<S> ball() const { return {point(3), radius()}; }
  collide::moving_sphere<S> moving() const { return {ball(), point(4)}; }
  S radius() const { return x[Count - 1]; }

  oracle::point exact_point(std::size_t i) const { return {x[3 * i], x[3 * i + 1], x[3 * i + 2]}; }
  oracle::triangle exact_shape() const { return {exact_point(0), exact_point(1), exact_point(2)}; }
  oracle::sphere exact_ball() const { return {exact_point(3), radius()}; }

  /// No place or length is NaN or infinite, and the radius is not below 0.
  bool plain() const {
    return std::all_of(x.begin(), x.end(), [](S number) { return std::isfinite(number); }) && radius() >= 0;
  }

  /// Ends the program unless the property holds; says of which case.
  void require(bool holds, char const* property) const {
    if (holds) return;
    std::fprintf(stderr, "\nthis does not hold: %s\nof (%s):", property, sizeof(S) == 4 ? "float" : "double");
    for (S const number : x) std::fprintf(stderr, " %a", static_cast<double>(number));
    std::fprintf(stderr, "\n");
    std::abort();
  }

  bool finite_point(std::size_t i) const {
    return std::isfinite(x[3 * i]) && std::isfinite(x[3 * i + 1]) && std::isfinite(x[3 * i + 2]);
  }

  /// Checks that bad values are treated as the README says, by a verdict.
  void check_bad_values(bool hit) const {
    bool places = true;
    for (std::size_t i = 0; i < Count / 3; ++i) places = places && finite_point(i);
    require(!hit || (places && radius() >= 0), "bad values never collide");
    require(hit || !places || radius() != std::numeric_limits<S>::infinity(), "an infinite radius reaches all");
  }

  /// The contact of a pair that collides is a place, a direction and a feature that there is.
  void check_contact(collide::contact<S> const& c) const {
    double const length = c.normal.template cast<double>().norm();
    require(c.point.allFinite(), "the point of contact is finite");
    require(std::abs(length - 1) <= 4 * double(std::numeric_limits<S>::epsilon()), "the normal is a unit vector");
    require(c.distance >= 0, "a distance is not below 0");
    bool const face = c.feature == collide::feature::face;
    require(face || c.feature == collide::feature::edge || c.feature == collide::feature::vertex,
            "there is such a feature");
    require(c.feature_index < (face ? 1 : 3), "the triangle has that many of them");
  }

  /// The same case as seen by one who names the corners in another order, and the axes, and looks from the other side.
  /// `how` chooses one of 6 * 48.
  numbers turned(std::uint32_t how) const {
    auto const draw = [&](std::uint32_t n) {
      std::uint32_t const drawn = how % n;
      how /= n;
      return drawn;
    };
    std::size_t corner[3] = {0, 1, 2}, axis[3] = {0, 1, 2};
    for (auto* order : {corner, axis}) {
      std::swap(order[2], order[draw(3)]);
      std::swap(order[1], order[draw(2)]);
    }
    S const sign[3] = {S(draw(2) ? -1 : 1), S(draw(2) ? -1 : 1), S(draw(2) ? -1 : 1)};
    numbers t = *this;
    for (std::size_t p = 0; p < Count / 3; ++p) {
      for (std::size_t k = 0; k < 3; ++k) t.x[3 * p + k] = sign[k] * x[3 * (p < 3 ? corner[p] : p) + axis[k]];
    }
    return t;
  }

  /// A number that is the same for the same input: what an input is asked besides the verdict.
  std::uint32_t hash() const {
    std::uint64_t h = 14695981039346656037u;  // FNV-1a
    for (S const number : x) {
      std::uint64_t bits = 0;
      std::memcpy(&bits, &number, sizeof number);
      h = (h ^ bits) * 1099511628211u;
      h ^= h >> 29;
    }
    return static_cast<std::uint32_t>(h >> 32);
  }
};

/// Changes a case as what goes wrong asks for: numbers that are equal, or next to it, of all magnitudes, or bad.
template <class S, std::size_t Count>
class mutation {
 public:
  explicit mutation(unsigned seed) : random_(seed) {}

  void apply(numbers<S, Count>& n) {
    for (std::size_t times = 1 + draw(3); times > 0; --times) once(n.x);
  }

 private:
  using limits = std::numeric_limits<S>;

  void once(std::array<S, Count>& x) {
    S& number = x[draw(Count)];
    std::size_t const points = Count / 3, to = 3 * draw(points), from = 3 * draw(points);
    switch (draw(12)) {
      case 0:
        number = x[draw(Count)];
        break;
      case 1:
        number = x[draw(Count)] + (draw(2) ? x[draw(Count)] : -x[draw(Count)]);
        break;
      case 2:
        for (std::size_t n = 1 + draw(3), up = draw(2); n > 0; --n) {
          number = std::nextafter(number, up ? limits::infinity() : -limits::infinity());
        }
        break;
      case 3:
        number = -number;
        break;
      case 4:
        number = std::ldexp(number, power());
        break;
      case 5: {
        int const exponent = power();
        for (S& each : x) each = std::ldexp(each, exponent);
        break;
      }
      case 6:
        number = special();
        break;
      case 7:
        number = static_cast<S>(static_cast<int>(draw(17)) - 8) * (draw(2) ? 1 : S(0.5));
        break;
      case 8:
        std::copy_n(&x[from], 3, &x[to]);
        break;
      case 9: {  // on the line through two points
        std::size_t const other = 3 * draw(points);
        S const part = draw(2) ? static_cast<S>(draw(5)) / 2 - S(0.5) : static_cast<S>(unit());
        for (std::size_t k = 0; k < 3; ++k) x[to + k] = x[from + k] + part * (x[other + k] - x[from + k]);
        break;
      }
      case 10:  // far away
        for (std::size_t k = 0; k < 3; ++k) {
          S const by = std::ldexp(static_cast<S>(unit()), static_cast<int>(draw(40)));
          for (std::size_t p = 0; p < 4; ++p) x[3 * p + k] += by;
        }
        break;
      default:
        touch(x);
    }
  }

  /// Makes the radius about the distance of the centre, anywhere on its way, from a place of the triangle.
  void touch(std::array<S, Count>& x) {
    double const time = Count > 13 ? place() : 0, v = place(), w = draw(2) ? place() * (1 - v) : 0;
    double square = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      double const a = x[k], b = x[3 + k], c = x[6 + k], move = Count > 13 ? x[12 + k] : S(0);
      double const d = a + v * (b - a) + w * (c - a) - x[9 + k] - time * move;
      square += d * d;
    }
    double const distance = std::sqrt(square);
    if (distance < static_cast<double>(limits::max())) x[Count - 1] = static_cast<S>(distance);
  }

  S special() {
    S const all[] = {S(0),
                     -S(0),
                     S(1),
                     limits::infinity(),
                     limits::quiet_NaN(),
                     limits::denorm_min(),
                     limits::min(),
                     limits::max(),
                     limits::epsilon(),
                     limits::max() / 2};
    return (draw(2) ? 1 : -1) * all[draw(sizeof all / sizeof *all)];
  }

  int power() {
    int const most = draw(2) ? 4 : (draw(2) ? 30 : limits::max_exponent);
    return static_cast<int>(draw(2 * static_cast<std::size_t>(most) + 1)) - most;
  }

  /// 0, 1, a half or anything between.
  double place() {
    double const places[] = {0, 1, 0.5, unit()};
    return places[draw(4)];
  }

  std::size_t draw(std::size_t n) { return random_() % n; }
  double unit() { return static_cast<double>(random_()) / static_cast<double>(random_.max()); }

  std::minstd_rand random_;
};

/// Makes another input for libFuzzer: changes the numbers, or now and then bits, and keeps the length.
template <std::size_t Count>
std::size_t mutated(std::uint8_t* data, std::size_t size, std::size_t most, unsigned seed) {
  constexpr std::size_t floats = Count * sizeof(float), doubles = Count * sizeof(double);
  if (most < floats) return 0;
  std::size_t const length = size == doubles && most >= doubles ? doubles : floats;
  if (size < length) std::memset(data + size, 0, length - size);
  if (seed % 8 == 0) {
    LLVMFuzzerMutate(data, length, length);
    return length;
  }
  auto const apply = [&](auto scalar) {
    using S = decltype(scalar);
    auto n = numbers<S, Count>::from(data);
    mutation<S, Count>(seed).apply(n);
    std::memcpy(data, n.x.data(), length);
  };
  length == floats ? apply(0.0f) : apply(0.0);
  return length;
}

/// Calls check(numbers) if the input is one.
template <std::size_t Count, class Check>
void run(std::uint8_t const* data, std::size_t size, Check const& check) {
  if (size == Count * sizeof(float)) check(numbers<float, Count>::from(data));
  if (size == Count * sizeof(double)) check(numbers<double, Count>::from(data));
}

/// True if `x` is at most 4 units in the last place of S off; a number beyond the range of S must have become infinite.
template <class S>
bool nearly(S x, double exact) {
  S const size = static_cast<S>(std::abs(exact));
  if (std::isinf(size)) return x == std::copysign(size, static_cast<S>(exact));
  double const next = std::nextafter(size, std::numeric_limits<S>::infinity());
  double const unit = std::isinf(next) ? double(size) - double(std::nextafter(size, S(0))) : next - double(size);
  return std::abs(double(x) - exact) <= 4 * unit;
}

}  // namespace fuzz
