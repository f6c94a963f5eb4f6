/// Any text as a CSV file of cases: it is read or refused, what is read makes sense, and reads the same once written.
#include <cstring>

#include "examples/io/cases.hpp"
#include "text.hpp"

namespace {

using fuzz::require;

/// Equal, or both NaN.
template <class S>
bool same_numbers(std::vector<S> const& a, std::vector<S> const& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](S x, S y) { return x == y || (std::isnan(x) && std::isnan(y)); });
}

template <class S>
std::string written(io::case_data<S> const& cases) {
  std::string text = "id,family,ax,ay,az,bx,by,bz,cx,cy,cz,px,py,pz,R,dx,dy,dz";
  text += cases.has_hits ? ",hit\n" : "\n";
  for (std::size_t i = 0; i < cases.size(); ++i) {
    text += cases.ids[i] + ',';
    auto const add = [&](std::vector<S> const& numbers, std::size_t count) {
      for (std::size_t k = 0; k < count; ++k) text += ',' + fuzz::written(numbers[count * i + k]);
    };
    add(cases.corners, 9);
    add(cases.spheres, 4);
    add(cases.displacements, 3);
    if (cases.has_hits) text += cases.hits[i] == 1 ? ",1" : ",0";
    text += '\n';
  }
  return text;
}

template <class S>
void check(io::case_data<S> const& cases) {
  auto const n = cases.size();
  require(cases.families.size() == n && cases.corners.size() == 9 * n && cases.spheres.size() == 4 * n &&
              cases.displacements.size() == 3 * n && cases.hits.size() == (cases.has_hits ? n : 0),
          "as many of everything");
  require(cases.swept <= n && cases.tally.numbers == 13 * n + 3 * cases.swept, "counts are of what there is");
  for (auto const& id : cases.ids) require(!id.empty() && id.find(',') == id.npos, "an id is a field");
  for (auto const hit : cases.hits) require(hit <= 1, "a hit is 0 or 1");

  auto const same = io::read_cases<S>("again", written(cases));
  require(same.ids == cases.ids && same.hits == cases.hits && same.tally.rounded == 0 &&
              same_numbers(same.corners, cases.corners) && same_numbers(same.spheres, cases.spheres) &&
              same_numbers(same.displacements, cases.displacements),
          "what is written reads the same");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(std::uint8_t const* data, std::size_t size) {
  auto const text = fuzz::text(data, size);
  auto const floats = fuzz::read_or_refuse([&] { return io::read_cases<float>("input", text); });
  auto const doubles = fuzz::read_or_refuse([&] { return io::read_cases<double>("input", text); });
  if (floats) check(*floats);
  if (doubles) check(*doubles);
  require(!floats || doubles, "doubles hold what floats hold");
  if (!floats) return 0;
  fuzz::check_rounding(floats->corners, doubles->corners, floats->tally);
  fuzz::check_rounding(floats->spheres, doubles->spheres, floats->tally);
  fuzz::check_rounding(floats->displacements, doubles->displacements, floats->tally);
  return 0;
}
