/// \file
/// The peers that there may be, each in a file of its own.
#pragma once

#include <vector>

namespace peers {

void add_embree(std::vector<int> const& threads);
void add_cgal(std::vector<int> const& threads);
void add_bullet(std::vector<int> const& threads);
void add_fcl(std::vector<int> const& threads);

}  // namespace peers
