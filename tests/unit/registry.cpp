#include <algorithm>

#include "type_erased_detector.hpp"

namespace tests {

template <class S>
std::vector<composition<S>> compositions(std::string const& precision) {
  std::vector<composition<S>> chosen;
  for (auto const& c : registry<S>()) {
#if defined(COLLIDE_TESTS_CUDA)
    // the plain host is there to be compared with
    if (c.space.find("lockstep") == 0 || (c.space == "host" && c.broad != "all_pairs")) continue;
#endif
    if (precision.empty() || c.precision == precision) chosen.push_back(c);
  }
  std::sort(chosen.begin(), chosen.end(), [](auto const& a, auto const& b) {
    return std::make_pair(a.space != "host", a.name()) < std::make_pair(b.space != "host", b.name());
  });
  return chosen;
}

template std::vector<composition<float>> compositions(std::string const&);
template std::vector<composition<double>> compositions(std::string const&);

}  // namespace tests
