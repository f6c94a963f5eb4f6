/// \file
/// From plain arrays, as C code and simulations have them: separate x, y, z, a radius for each sphere, a soup of
/// triangles. The pairs go to an array of the caller's.

#include <cstdio>
#include <cstdlib>

#include <collide/all_pairs.cuh>

int main() {
  double const soup[] = {0, 0, 0, 4, 0, 0, 0, 4, 0,   // a triangle, corner by corner
                         0, 0, 1, 4, 0, 1, 0, 4, 1};  // and one above it
  double const x[] = {1, 1, 9}, y[] = {1, 1, 9}, z[] = {0.25, 0.5, 0}, r[] = {0.25, 0.5, 5};
  collide::pair found[2];

  collide::detector<collide::all_pairs, collide::karabassi<collide::double_precision>, collide::host, double> detector;
  detector.build(collide::triangle_soup(soup, 2));
  auto const spheres = collide::spheres_soa(x, y, z, 3, r);

  // Too small an array is no error: total() says how large it has to be.
  collide::pairs hits(found, 2, collide::order::canonical);
  detector.query(spheres, hits);
  std::printf("room for 2, %llu found\n", static_cast<unsigned long long>(hits.total()));

  auto const enough = static_cast<std::size_t>(hits.total());
  auto* const all = static_cast<collide::pair*>(std::malloc(enough * sizeof(collide::pair)));
  if (all == nullptr) return 1;
  detector.query(spheres, collide::pairs(all, enough, collide::order::canonical));
  for (std::size_t i = 0; i < enough; ++i) std::printf("%u %u\n", all[i].sphere, all[i].triangle);
  std::free(all);
}
