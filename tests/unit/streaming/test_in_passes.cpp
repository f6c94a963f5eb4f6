/// Meshes larger than one build: in passes, on the host, and divided among ranks.
#include <Eigen/Core>

#include <collide/automatic.cuh>
#include <collide/ranks/thread_ranks.hpp>

#include "compositions.hpp"
#include "streaming/in_passes.hpp"

namespace {

/// A space that copies as a GPU does, and cannot sort.
class remote_space : public tests::lockstep<64, true> {
 public:
  using tests::lockstep<64, true>::lockstep;
  static constexpr bool host_accessible = false;
};

using floats = collide::detector<collide::bucket>;

/// The error that f throws.
template <class F>
std::string thrown(F const& f) {
  try {
    f();
  } catch (std::exception const& e) {
    return e.what();
  }
  return "nothing";
}

bool contains(std::string const& text, char const* part) { return text.find(part) != std::string::npos; }

/// A sink that has had enough.
struct reluctant {
  template <class Space, class Query>
  void run(Space&, Query const&) {
    throw std::runtime_error("enough");
  }
};

tests::moving_scene<float> made_of(int triangles, int spheres) {
  tests::motion m;
  m.size = 5;
  m.triangles = triangles;
  m.spheres = spheres;
  return tests::random_motion<float>(11, m);
}

}  // namespace

TEST_CASE("in passes: sinks hold what they hold after one detector, on the host") {
  tests::check_passes<collide::bucket, float>(collide::host(1));
  tests::check_passes<collide::bucket, double>(collide::host(2));
  tests::check_passes<collide::all_pairs, float, collide::host, collide::single_precision>(collide::host(1));
  tests::check_passes<collide::all_pairs, double, collide::host, collide::double_precision>(collide::host(1));
}

TEST_CASE("in passes: sinks hold what they hold after one detector, with CUDA's algorithms, and copies of the parts") {
  tests::check_passes<collide::bucket, float>(tests::lockstep<64, true>(1));
  tests::check_passes<collide::bucket, float>(remote_space(1), false);
  tests::check_passes<collide::bucket, double>(remote_space(1), false);
}

TEST_CASE("in passes: visits, and the first pairs where memory ends") {
  auto const made = made_of(200, 200);
  floats whole;
  whole.build(made.mesh());
  auto const expected = whole.query(made.spheres(), collide::pairs(collide::order::canonical)).to_host();
  REQUIRE(expected.size() > 20);
  collide::in_passes<floats> passes;
  for (std::size_t const most : {std::size_t{200}, std::size_t{30}}) {
    passes.build(made.mesh(), most);
    std::vector<collide::pair> few(9);
    collide::pairs kept(few.data(), few.size(), collide::order::canonical);
    CHECK(passes.query(made.spheres(), kept).total() == expected.size());
    CHECK(std::equal(few.begin(), few.end(), expected.begin()));
    std::atomic<std::size_t> seen{0}, wrong{0};
    passes.query(made.spheres(), collide::visit([&](collide::hit<collide::karabassi<>, float> const& h) {
                   ++seen;
                   auto const c = h.contact();
                   auto const alone =
                       collide::karabassi<>::contact_of(made.mesh()[h.triangle], made.spheres()[h.sphere]);
                   wrong += c.triangle != h.triangle || c.sphere != h.sphere || c.depth != alone.depth;
                 }));
    CHECK(seen == expected.size());
    CHECK(wrong == 0);
  }
}

TEST_CASE("in passes: parts of meshes of any layout") {
  auto const made = made_of(60, 100);
  std::vector<collide::id> records, columns(180);
  for (collide::id i = 0; i < 60; ++i) {
    records.insert(records.end(), {9999, 3 * i, 9999, 3 * i + 1, 9999, 3 * i + 2, 9999});
    for (collide::id k = 0; k < 3; ++k) columns[60 * k + i] = 3 * i + k;
  }
  auto const vertices = collide::points(made.corners.data(), 180);
  std::vector<collide::mesh_view<float>> const layouts{
      made.mesh(), collide::triangle_soup(vertices), collide::indexed_mesh(vertices, static_cast<int*>(nullptr), 0),
      collide::mesh_view<float>(vertices, records.data() + 1, 60, 7, 2),
      collide::mesh_view<float>(vertices, columns.data(), 60, 1, 60)};
  floats whole;
  collide::in_passes<floats> passes;
  collide::in_passes<collide::detector<collide::bucket, collide::karabassi<>, remote_space>> copied(remote_space(1));
  for (auto const& mesh : layouts) {
    for (std::size_t i = 0; i < mesh.size(); ++i) CHECK(mesh.subview(i, 1)[0].b == made.mesh()[i].b);
    whole.build(mesh);
    passes.build(mesh, 13);
    copied.build(mesh, 13);
    auto const expected = whole.query(made.spheres(), collide::closest<float>()).to_host();
    CHECK(tests::equal_bytes(passes.query(made.spheres(), collide::closest<float>()).to_host(), expected));
    CHECK(tests::equal_bytes(copied.query(made.spheres(), collide::closest<float>()).to_host(), expected));
  }
}

TEST_CASE("in passes: a mesh of more triangles than a build takes is refused, and found in passes") {
  auto const made = made_of(300, 200);
  collide::bucket options;
  options.max_triangles = 100;
  floats small(collide::host(1), options), whole(collide::host(1));
  std::string const refused = "collide: bucket: 300 triangles are more than 100, the most of one build";
  CHECK(contains(thrown([&] { small.build(made.mesh()); }), refused.c_str()));
  CHECK(contains(thrown([&] { small.query(made.spheres(), collide::count()); }), "call build"));
  small.build(made.mesh().subview(0, 100));
  whole.build(made.mesh());
  collide::in_passes<floats> passes(collide::host(1), options);
  passes.build(made.mesh(), 100);
  CHECK(passes.passes() == 3);
  tests::check_same_sinks(passes, whole, made.spheres());
  passes.build(made.mesh(), 101);  // 100 each all the same
  CHECK(passes.passes() == 3);
  tests::check_same_sinks(passes, whole, made.spheres());
  passes.build(made.mesh(), 150);
  CHECK(contains(thrown([&] { passes.query(made.spheres(), collide::count()); }), "150 triangles are more than 100"));
  CHECK(contains(thrown([&] { passes.build(made.mesh(), 300); }), refused.c_str()));
  CHECK(contains(thrown([&] { passes.query(made.spheres(), collide::count()); }), "call build before"));
  options.max_triangles = std::numeric_limits<std::size_t>::max();  // a grid has no more all the same
  CHECK_NOTHROW(collide::detail::check_triangles(536870911, options.max_triangles));
  CHECK(contains(thrown([&] { collide::detail::check_triangles(536870912, options.max_triangles); }), "536870911"));
}

TEST_CASE("in passes: automatic makes no grid that cannot be, and passes are as large as a build takes") {
  auto const made = made_of(2000, 20);
  collide::automatic options;
  options.grid.max_triangles = 100;
  using detector = collide::detector<collide::automatic>;
  detector whole(collide::host(1)), limited(collide::host(1), options);
  whole.build(made.mesh());
  limited.build(made.mesh());
  auto const all = whole.query(made.spheres(), collide::count()).total();
  for (int i = 0; i < 100; ++i) CHECK(limited.query(made.spheres(), collide::count()).total() == all);
  limited.build(made.mesh(), 0.1f);
  CHECK(limited.query(made.spheres(), collide::count()).total() == all);
  collide::in_passes<detector> passes(collide::host(1), options);
  passes.build(made.mesh());
  CHECK(passes.passes() == 20);
  CHECK(passes.query(made.spheres(), collide::count()).total() == all);
  collide::in_passes<floats> buckets(collide::host(1), options.grid);
  buckets.build(made.mesh());
  CHECK(buckets.passes() == 20);
  CHECK(buckets.query(made.spheres().subview(0, 0), collide::count()).total() == 0);
}

TEST_CASE("in passes: wrong calls, sinks that throw and memory that ends are errors, and it can be used again") {
  auto const made = made_of(60, 50);
  using remote = collide::detector<collide::bucket, collide::karabassi<>, remote_space>;
  collide::in_passes<floats> passes;
  auto const count = [&](auto& in) { return in.query(made.spheres(), collide::count()).total(); };
  CHECK(passes.passes() == 0);
  CHECK(contains(thrown([&] { count(passes); }), "in_passes: query needs a mesh"));
  passes.build(made.mesh(), 20);
  auto const all = count(passes);
  CHECK(all > 0);
  CHECK_THROWS_WITH(passes.query(made.spheres(), reluctant()), "enough");
  CHECK(count(passes) == all);
  CHECK(contains(thrown([&] { passes.build(made.mesh(), 0); }), "in_passes: there are 0 triangles per pass"));
  CHECK(contains(thrown([&] { count(passes); }), "in_passes: query needs a mesh"));
  std::size_t failures = 0;
  for (std::size_t most = 0;; ++most) {
    tests::short_memory memory;
    memory.left = most;
    collide::in_passes<remote> parts(remote_space(1, &memory));
    auto const work = [&] {
      parts.build(made.mesh(), 20);
      return parts.query(made.spheres(), collide::contacts<float>()).total();
    };
    bool failed = false;
    try {
      work();
    } catch (std::bad_alloc const&) {
      failed = true;
    }
    memory.left = std::numeric_limits<std::size_t>::max();
    CHECK(work() == all);
    if (!failed) break;
    ++failures;
  }
  CHECK(failures > 5);
}

TEST_CASE("in passes: memory is that of a part") {
  tests::motion m;
  m.triangles = 40000;
  m.spheres = 100;
  m.triangle = 0.1;
  auto const made = tests::random_motion<float>(12, m);
  auto const peak = [&](std::size_t most) {
    tests::counting_resource memory(std::pmr::new_delete_resource());
    collide::in_passes<floats> passes(collide::host(1, &memory));
    passes.build(made.mesh(), most);
    std::size_t after[3];  // one grid of the whole gets lists in the third query
    for (auto& peak : after) {
      passes.query(made.spheres(), collide::count());
      peak = memory.peak;
    }
    if (passes.passes() > 1) CHECK(after[2] == after[0]);
    return static_cast<double>(after[2]);
  };
  double const whole = peak(40000);
  CHECK(peak(10000) < 0.35 * whole);
  CHECK(peak(4000) < 0.2 * whole);
}

TEST_CASE("in passes: a divided mesh goes beyond what a build takes, and a rank with too much says so on all") {
  auto const made = made_of(300, 200);
  collide::bucket options;
  options.max_triangles = 120;  // of rank 0
  floats whole(collide::host(1));
  whole.build(made.mesh());
  auto const all = whole.query(made.spheres(), collide::count()).total();
  for (int const n : {2, 4}) {  // of 150 and of 75 triangles
    std::vector<std::string> said(static_cast<std::size_t>(n));
    try {
      collide::thread_ranks::run(n, [&](collide::thread_ranks const& ranks) {
        using distributed = collide::distributed<floats, collide::thread_ranks>;
        distributed detector(ranks, collide::host(1), ranks.rank() == 0 ? options : collide::bucket());
        auto const triangles = tests::part_of(300, tests::split::first, ranks.rank(), n),
                   spheres = tests::part_of(200, tests::split::evenly, ranks.rank(), n);
        auto& mine = said[static_cast<std::size_t>(ranks.rank())];
        mine = thrown([&] {
                 detector.build(made.mesh().subview(triangles.first, triangles.size), collide::divided);
                 auto const found =
                     detector.query(made.spheres().subview(spheres.first, spheres.size), collide::count());
                 mine = detector.total(found) == all ? "found" : "missed";
               }) +
               mine;
      });
    } catch (collide::error const&) {
    }
    for (auto const& what : said) {
      CAPTURE(what);
      CHECK((n == 4 ? what == "nothingfound" : contains(what, "more than 120, the most of one build")));
    }
  }
}
