/// Pairs of spheres on the host.
#include "execution/lockstep.hpp"
#include "neighbours/sphere_pairs.hpp"

using collide::host;
using in_lockstep = tests::lockstep<64, false>;

TEST_CASE_TEMPLATE("sphere pairs: all that touch, as the oracle has them", S, float, double) {
  tests::check_sphere_pairs<host, S>(host(2));
  tests::check_sphere_pairs<in_lockstep, S>(in_lockstep(1));
}

TEST_CASE_TEMPLATE("sphere pairs: within some units in the last place of touching", S, float, double) {
  std::mt19937 engine(5);
  std::uniform_real_distribution<S> uniform(-1, 1);
  std::size_t wrong = 0, touching = 0;
  constexpr std::size_t n = 20000;
  for (std::size_t i = 0; i < n; ++i) {
    bool const vanishes = i % 4 == 3;  // squares do
    int const power = vanishes ? (sizeof(S) == 4 ? -125 : -520) : -20;
    S const scale = std::ldexp(S(1), power + int(engine() % 40) - 10), away = i % 2 == 0 ? S(0) : 64 * scale;
    auto const any = [&] { return scale * uniform(engine); };
    collide::sphere<S> const a{{away + any(), any(), any()}, std::abs(any())};
    collide::sphere<S> b{{away + any(), any(), any()}, 0};
    collide::vec3<double> const d = a.centre.template cast<double>() - b.centre.template cast<double>();
    double const left = std::hypot(d.x(), d.y(), d.z()) - double(a.radius);
    if (left < 0) continue;
    b.radius = S(left);
    for (int k = int(engine() % 5) - 2; k != 0; k += k < 0 ? 1 : -1)
      b.radius = std::nextafter(b.radius, k < 0 ? S(0) : S(1e30));
    auto const plain = [](collide::sphere<S> const& s) {
      return oracle::sphere{{double(s.centre.x()), double(s.centre.y()), double(s.centre.z())}, double(s.radius)};
    };
    bool const expected = oracle::touch(plain(a), plain(b));
    touching += expected ? 1 : 0;
    wrong += collide::detail::spheres_touch(a, b) != expected || collide::detail::spheres_touch(b, a) != expected;
  }
  CHECK(wrong == 0);
  CHECK(touching > n / 10);
  CHECK(touching < n / 2);
}

TEST_CASE("sphere pairs: nothing is allocated once there is room") {
  tests::counting_resource memory(std::pmr::new_delete_resource());
  tests::check_sphere_pairs_allocate_once(host(2, &memory), memory);
  tests::check_sphere_pairs_allocate_once(in_lockstep(1, &memory), memory);
}

TEST_CASE("sphere pairs: a set that fits in no list at once is found in two passes") {
  std::vector<float> const one_place(3 * 100, 1.0f);
  collide::sphere_pairs<> finder;
  auto const all = collide::spheres_xyz(one_place.data(), 100, 1.0f);
  CHECK(finder.query(all, collide::pairs()).to_host().size() == 100 * 99 / 2);
  collide::pair room[10];
  collide::pairs few(room, 10, collide::order::canonical);
  finder.query(all, few);
  CHECK(few.total() == 100 * 99 / 2);
  CHECK(few.size() == 10);
  CHECK(room[9].triangle == 10);
}
