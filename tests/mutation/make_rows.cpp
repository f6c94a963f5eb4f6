/// make_rows FOLDER FILE...: writes the rows of the mutation check: those of files with the columns of tests/data, and
/// cases next to contact. The rows of names that end in f32.csv are rows of floats, and all are rows of doubles. The
/// verdicts, distances and depths are the oracle's.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <stdexcept>
#include <string>

#include "../oracle/scene.hpp"
#include "narrow_phase/near_contact.hpp"
#include "rows.hpp"

namespace {

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
  floats.close();
  doubles.close();
}
