/// make_cases FOLDER: writes near_f32.csv and near_f64.csv, cases next to contact with the oracle's verdicts. Is not
/// built with the flags that are under test.
#include <fstream>
#include <stdexcept>
#include <string>

#include "narrow_phase/near_contact.hpp"

namespace {

template <class S>
void write(std::string const& path) {
  std::ofstream file(path);
  file << "hit,ax,ay,az,bx,by,bz,cx,cy,cz,px,py,pz,R\n";
  for (auto const& cases :
       {tests::near_contact<S>(61, 500), tests::ties<S>(62, 700), tests::mixed_exponents<S>(63, 300)})
    for (auto const& c : cases) file << tests::describe(c) << '\n';
  if (!file.flush()) throw std::runtime_error(path + ": cannot write it");
}

}  // namespace

int main(int, char** argv) {
  std::string const folder = argv[1];
  write<float>(folder + "/near_f32.csv");
  write<double>(folder + "/near_f64.csv");
}
