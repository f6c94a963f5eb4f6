/// make_rows FOLDER FILE...: writes the rows of the mutation check: those of files with the columns of tests/data, and
/// cases next to contact; four triangles each, of which it is hard to tell which is nearest to a point, or on which
/// side of them that is; and pairs of triangles, which meet or do not. The rows of names that end in f32.csv are rows
/// of floats, and all are rows of doubles. The verdicts, distances and depths are the oracle's.
#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "../oracle/scene.hpp"
#include "narrow_phase/near_contact.hpp"
#include "rows.hpp"
#include "scenes.hpp"

namespace {

using tests::operator+;

template <class S>
class writer {
 public:
  explicit writer(std::string const& folder) : file_(tests::path_of<S>(folder), std::ios::binary) {}

  void add(oracle::triangle const& t, oracle::sphere const& s) {
    double const numbers[] = {t.a.x, t.a.y, t.a.z,      t.b.x,      t.b.y,      t.b.z,   t.c.x,
                              t.c.y, t.c.z, s.centre.x, s.centre.y, s.centre.z, s.radius};
    tests::row<S> r{};
    std::transform(std::begin(numbers), std::end(numbers), r.numbers.begin(),
                   [](double x) { return static_cast<S>(x); });
    r.hit = oracle::hit(t, s) ? S(1) : S(0);
    if (s.radius >= 0 &&
        std::all_of(std::begin(numbers), std::end(numbers), [](double x) { return std::isfinite(x); })) {
      r.distance = oracle::closest(t, s.centre).distance;
      r.depth = oracle::depth(t, s);
    }
    file_.write(reinterpret_cast<char const*>(&r), sizeof r);
  }

  void close() {
    if (!file_.flush()) throw std::runtime_error("cannot write the rows");
  }

 private:
  std::ofstream file_;
};

/// Calls f for the cases next to contact.
template <class S, class F>
void each_near_contact(F const& f) {
  for (auto const& cases :
       {tests::near_contact<S>(61, 500), tests::ties<S>(62, 700), tests::mixed_exponents<S>(63, 300)})
    for (auto const& c : cases) f(c);
}

/// Writes rows of four triangles.
template <class S>
class nearest_writer {
 public:
  using triangles = std::array<oracle::triangle, 4>;

  nearest_writer(std::string const& folder, unsigned seed)
      : file_(tests::path_of_nearest<S>(folder), std::ios::binary), roll_(seed) {}

  void add_all() {
    for (int i = 0; i < 800; ++i) add(lattice(), lattice_point(), false);
    for (int i = 0; i < 800; ++i) add(tetrahedron([&] { return lattice_point(); }), lattice_point(), true);
    for (double const offset : {0.0, 100.0}) {
      for (int i = 0; i < 800; ++i) {
        auto const mesh = tetrahedron([&] {
          return rounded(oracle::point{offset, offset, offset} + roll_.in_cube(1));
        });
        add(mesh, at_surface(mesh), true);
      }
    }
    for (int i = 0; i < 800; ++i) add(mirrored(), {0, 0, 0}, false);
    // last, since their integers are so long that they take most of the time
    for (int i = 0; i < 100; ++i) {
      int const kind = i % 3, exponent = kind == 0 ? std::numeric_limits<S>::min_exponent - 18
                                                   : std::numeric_limits<S>::max_exponent - 2;
      auto const place = [&] { return any_point(exponent, kind == 2); };
      add({{{place(), place(), place()},
            {place(), place(), place()},
            {place(), place(), place()},
            {place(), place(), place()}}},
          place(), false);
    }
    if (!file_.flush()) throw std::runtime_error("cannot write the rows");
  }

 private:
  std::ofstream file_;
  tests::dice roll_;

  static oracle::point rounded(oracle::point const& p) {
    return {static_cast<S>(p.x), static_cast<S>(p.y), static_cast<S>(p.z)};
  }

  void add(triangles const& mesh, oracle::point const& p, bool closed) {
    tests::nearest_row<S> r{};
    std::size_t n = 0;
    auto const append = [&](oracle::point const& q) {
      for (double const x : {q.x, q.y, q.z}) r.numbers[n++] = static_cast<S>(x);
    };
    for (auto const& t : mesh) append(t.a), append(t.b), append(t.c);
    append(p);
    for (int i = 1; i < 4; ++i)
      if (oracle::compare_distances(mesh[std::size_t(i)], mesh[std::size_t(r.nearest)], p) < 0) r.nearest = i;
    auto const exact = oracle::closest(mesh[std::size_t(r.nearest)], p);
    r.distance = exact.distance;
    r.features = exact.features;
    bool const is_in = closed && oracle::inside({mesh.begin(), mesh.end()}, p);
    r.side = !closed ? r.none : (is_in ? r.inside : r.outside);
    file_.write(reinterpret_cast<char const*>(&r), sizeof r);
  }

  oracle::point lattice_point() {
    return {double(roll_.integer(-2, 2)), double(roll_.integer(-2, 2)), double(roll_.integer(-2, 2))};
  }
  triangles lattice() {
    triangles mesh;
    for (auto& t : mesh) t = {lattice_point(), lattice_point(), lattice_point()};
    return mesh;
  }

  template <class Corner>
  triangles tetrahedron(Corner const& corner) {
    oracle::point const a = corner(), b = corner(), c = corner(), d = corner();
    return {{{a, c, b}, {a, b, d}, {a, d, c}, {b, c, d}}};
  }

  oracle::point any_point(int exponent, bool mixed) {
    auto const number = [&] {
      int const e = mixed ? roll_.integer(-exponent, exponent) : exponent;
      return static_cast<double>(static_cast<S>(std::ldexp(roll_.uniform(-2, 2), e)));
    };
    return {number(), number(), number()};
  }

  /// On a face, an edge or a corner, and up to two units in the last place away.
  oracle::point at_surface(triangles const& mesh) {
    auto const& t = mesh[std::size_t(roll_.integer(0, 3))];
    double w[3] = {roll_.uniform(0, 1), roll_.uniform(0, 1), roll_.uniform(0.1, 1)};
    for (int k = roll_.integer(0, 2); k > 0; --k) w[k - 1] = 0;
    double const sum = w[0] + w[1] + w[2];
    auto const mix = [&](double a, double b, double c) {
      S x = static_cast<S>((w[0] * a + w[1] * b + w[2] * c) / sum);
      int const steps = roll_.integer(-2, 2);
      for (int k = 0; k < std::abs(steps); ++k) x = std::nextafter(x, static_cast<S>(1000 * steps));
      return static_cast<double>(x);
    };
    return {mix(t.a.x, t.b.x, t.c.x), mix(t.a.y, t.b.y, t.c.y), mix(t.a.z, t.b.z, t.c.z)};
  }

  /// A triangle and its images in mirrors through the origin, one of them with a coordinate that is next to its own.
  triangles mirrored() {
    std::array<oracle::point, 3> v;
    for (auto& p : v) p = rounded(oracle::point{1, 1, 1} + roll_.in_cube(0.9));
    triangles mesh;
    for (auto& t : mesh) {
      for (auto& p : v) p = {p.y, p.z, -p.x};
      std::rotate(v.begin(), v.begin() + 1, v.end());
      t = {v[0], v[1], v[2]};
    }
    double& x = mesh[std::size_t(roll_.integer(0, 3))].a.x;
    x = std::nextafter(static_cast<S>(x), static_cast<S>(roll_.integer(0, 1) ? 9 : -9));
    return mesh;
  }
};

/// Two triangles with corners on a small lattice, many of them in one plane or with corners in common.
void write_pairs(std::string const& folder) {
  std::ofstream file(tests::path_of_pairs(folder), std::ios::binary);
  tests::dice roll(66);
  for (int i = 0; i < 6000; ++i) {
    int const depth = i % 3 == 0 ? 0 : 1, width = 1 + i % 2;
    auto const point = [&]() -> oracle::point {
      return {double(roll.integer(-width, width)), double(roll.integer(-width, width)),
              double(roll.integer(-depth, depth))};
    };
    oracle::triangle const t[] = {{point(), point(), point()}, {point(), point(), point()}};
    tests::pair_row r{};
    std::size_t n = 0;
    for (auto const& own : t)
      for (auto const& q : {own.a, own.b, own.c})
        for (double const x : {q.x, q.y, q.z}) r.numbers[n++] = x;
    r.meet = oracle::meet(t[0], t[1]) ? 1 : 0;
    file.write(reinterpret_cast<char const*>(&r), sizeof r);
  }
  if (!file.flush()) throw std::runtime_error("cannot write the rows");
}

}  // namespace

int main(int argc, char** argv) {
  writer<float> floats(argv[1]);
  writer<double> doubles(argv[1]);
  auto const add_both = [&](auto const& c) { floats.add(c.shape, c.ball), doubles.add(c.shape, c.ball); };
  auto const add_double = [&](auto const& c) { doubles.add(c.shape, c.ball); };
  for (int i = 2; i < argc; ++i) {
    std::string const path = argv[i];
    bool const single = path.size() > 7 && path.compare(path.size() - 7, 7, "f32.csv") == 0;
    for (auto const& c : oracle::read_hard_cases(path, single)) {
      if (oracle::hit(c.shape, c.ball) != c.hit) throw std::runtime_error(path + ": wrong: " + std::to_string(c.id));
      single ? add_both(c) : add_double(c);
    }
  }
  each_near_contact<float>(add_both);
  each_near_contact<double>(add_double);
  write_pairs(argv[1]);
  nearest_writer<float>(argv[1], 64).add_all();
  nearest_writer<double>(argv[1], 65).add_all();
  floats.close();
  doubles.close();
}
