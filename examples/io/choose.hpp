/// \file
/// From names on the command line to types.
#pragma once

#include <string>

namespace io {

/// A type under the name that the command line has for it.
template <class T>
struct named {
  char const* name;
  using type = T;
};

/// Calls f with the one of `choices` whose name it is.
template <class F, class... Choices>
void choose(std::string const& name, F const& f, Choices const&... choices) {
  (void)((name == choices.name && (f(choices), true)) || ...);
}

}  // namespace io
