/// \file
/// Other libraries at the study's job, on the host: every pair of a sphere and a triangle that touch, build included.
/// peers_bench [SCENE [PART]] [OPTION OF GOOGLE BENCHMARK...]
///
/// SCENE is a name that `generate --help` lists, the study's if none is given; PART divides the number of its spheres,
/// where it would take some library minutes (--benchmark_filter leaves libraries out). With one thread and with all;
/// OMP_NUM_THREADS says how many that are. CMake found out which libraries there are.
#include <cstdio>

#include "peer.hpp"
#include "peers.hpp"
#include "program.hpp"

namespace {

/// This library, with the precision that is the default.
class ours {
 public:
  ours(peers::scene const& from, int threads) : from_{from}, detector_{collide::host(threads)} {
    detector_.build(from.mesh());
  }
  collide::pairs query() { return detector_.query(from_.view(), collide::pairs()); }

 private:
  peers::scene const& from_;
  collide::detector<collide::bucket> detector_;
};

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  std::vector<int> threads{1};
  if (int const all = collide::host().threads(); all > 1) threads.push_back(all);
  if (argc > 1) peers::scene::kind = io::find_scene(argv[1]);
  if (argc > 2) peers::scene::part = bench::count_of(argv[2], 1);
  if (argc > 3 || peers::scene::kind == nullptr || peers::scene::part == 0) {
    std::fputs("usage: peers_bench [SCENE [PART, at least 1]] [OPTION OF GOOGLE BENCHMARK...]\n", stderr);
    return 2;
  }
  peers::add<ours>("collide, bucket x host", threads);
#if defined(COLLIDE_HAVE_EMBREE)
  peers::add_embree(threads);
#endif
#if defined(COLLIDE_HAVE_CGAL)
  peers::add_cgal(threads);
#endif
#if defined(COLLIDE_HAVE_BULLET)
  peers::add_bullet(threads);
#endif
#if defined(COLLIDE_HAVE_FCL)
  peers::add_fcl(threads);
#endif
  return bench::run();
}
