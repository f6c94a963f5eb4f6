#include "detect.hpp"

template detection::findings<float> detection::detect(options const&, scene<float> const&);

void detection::take_device(std::string const& space, int rank) {
  io::choose_space(space, [&](auto wanted) { io::device_of<typename decltype(wanted)::type>::take(rank); });
}

void detection::require_space(std::string const& name) {
  io::choose_space(name, [](auto space) { io::device_of<typename decltype(space)::type>::require(); });
}
