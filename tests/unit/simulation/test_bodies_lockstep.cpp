/// Bodies that move, on the host and as blocks of threads go: the same bits. Compiled with all optimisation, as what
/// g++ vectorises must round as everything else does.
#include "compositions.hpp"
#include "simulation/bodies.hpp"

using collide::host;
using collide::karabassi;
using collide::karabassi_swept;
using tests::lockstep;

TEST_CASE("bodies: the same bits on every run, however many lanes") {
  tests::check_same_bits<karabassi<>>(host(1), host(2));
  tests::check_same_bits<karabassi<>>(host(1), lockstep<256, true>());
  tests::check_same_bits<karabassi_swept<>>(host(1), lockstep<256, true>());
}

TEST_CASE("bodies: what they get of particles is what these lose, in the same bits however many lanes") {
  tests::check_reaction(host(1), host(2));
  tests::check_reaction(host(1), lockstep<256, true>());
}
