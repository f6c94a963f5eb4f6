/// The lists among which a hunt draws.
#pragma once

#include <string>
#include <vector>

#include "check_list.hpp"

namespace tests::pairs {

/// A list that is hunted, without its type.
struct hunted_list {
  std::string name;
  std::string effects;  ///< in their order, as make_lists.py names them
  std::vector<surface> surfaces;
  void (*check)(trial const&);
};

/// All lists of the program.
inline std::vector<hunted_list>& hunted() {
  static std::vector<hunted_list> all;
  return all;
}

/// Adds a list to those that are hunted.
template <class List>
bool hunt(char const* name, char const* effects) {
  hunted().push_back({name, effects, checked_list<List>::surfaces(), &check_list<List>});
  return true;
}

}  // namespace tests::pairs
