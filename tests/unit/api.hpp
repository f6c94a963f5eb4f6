/// The interface as a user meets it, checked alike in all spaces; instantiated by test_api.cpp and test_api_cuda.cpp.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <new>
#include <type_traits>
#include <vector>

#include <doctest/doctest.h>

#include <collide/all_pairs.cuh>
#include <collide/bucket.cuh>
#include <collide/checks/validate.hpp>
#include <collide/core/memory.hpp>
#include <collide/karabassi_swept.hpp>
#include <collide/spaces/upload.hpp>

#include "type_erased_detector.hpp"

namespace tests {

/// A quadrilateral of two triangles in the plane z = 0, and four spheres of which 0, 1 and 3 touch it.
struct small_scene {
  std::vector<float> vertices{0, 0, 0, 2, 0, 0, 2, 2, 0, 0, 2, 0};
  std::vector<int> corners{0, 1, 2, 0, 2, 3};
  std::vector<float> xyz{1.5f, 0.5f, 0.25f, 1, 1, -0.5f, 5, 5, 5, 0, 2, 0};
  std::vector<float> radii{0.5f, 0.5f, 0.5f, 0.125f};

  collide::mesh_view<float> mesh() const { return collide::indexed_mesh(vertices.data(), 4, corners.data(), 2); }
  collide::sphere_view<float> spheres() const { return collide::spheres_xyz(xyz.data(), 4, radii.data()); }
  std::vector<collide::pair> hits() const { return {{0, 0}, {1, 0}, {1, 1}, {3, 1}}; }
};

/// Fails on demand.
class failing_resource final : public std::pmr::memory_resource {
 public:
  explicit failing_resource(std::pmr::memory_resource* upstream) : upstream_{upstream} {}
  bool fails = false;

 private:
  void* do_allocate(std::size_t bytes, std::size_t alignment) override {
    if (fails) throw std::bad_alloc();
    return upstream_->allocate(bytes, alignment);
  }
  void do_deallocate(void* p, std::size_t bytes, std::size_t alignment) override {
    upstream_->deallocate(p, bytes, alignment);
  }
  bool do_is_equal(std::pmr::memory_resource const& other) const noexcept override { return this == &other; }

  std::pmr::memory_resource* upstream_;
};

/// Host memory that is full of ones at first.
class dirty_resource final : public std::pmr::memory_resource {
 private:
  void* do_allocate(std::size_t bytes, std::size_t alignment) override {
    return std::memset(std::pmr::new_delete_resource()->allocate(bytes, alignment), 0xff, bytes);
  }
  void do_deallocate(void* p, std::size_t bytes, std::size_t alignment) override {
    std::pmr::new_delete_resource()->deallocate(p, bytes, alignment);
  }
  bool do_is_equal(std::pmr::memory_resource const& other) const noexcept override { return this == &other; }
};

/// A pointer in the style of Thrust's: an object.
template <class T>
class fancy_pointer {
 public:
  using difference_type = std::ptrdiff_t;
  explicit fancy_pointer(T* p = nullptr) : p_{p} {}
  T* get() const { return p_; }

 private:
  T* p_;
};

template <class T>
class fancy_allocator {
 public:
  using value_type = T;
  using pointer = fancy_pointer<T>;

  explicit fancy_allocator(counting_resource* from) : from_{from} {}
  template <class U>
  explicit fancy_allocator(fancy_allocator<U> const& other) : from_{other.from()} {}

  pointer allocate(std::size_t n) { return pointer(static_cast<T*>(from_->allocate(n * sizeof(T), 256))); }
  void deallocate(pointer p, std::size_t n) { from_->deallocate(p.get(), n * sizeof(T), 256); }
  counting_resource* from() const { return from_; }

 private:
  counting_resource* from_;
};

/// A sink whose handle wants to know when a pass has ended.
struct ending_sink {
  struct output {
    std::uint64_t* stored;
    std::uint64_t* ended;
    std::uint64_t* stored_then;

    COLLIDE_HD std::uint64_t allocate(std::uint64_t) const { return 0; }
    template <class Hit>
    COLLIDE_HD void store(std::uint64_t, Hit const&) const {
      collide::detail::fetch_add(stored, std::uint64_t{1});
    }
    COLLIDE_HD void end_pass() const {
      collide::detail::fetch_add(ended, std::uint64_t{1});
      *stored_then = collide::detail::fetch_add(stored, std::uint64_t{0});
    }
  };
  collide::buffer<std::uint64_t> memory;
  std::array<std::uint64_t, 3> numbers{};

  template <class Space, class Query>
  void run(Space& space, Query const& query) {
    std::uint64_t* const to = memory.reserve(space.resource(), 3);
    space.fill(to, 0, 3 * sizeof *to);
    query(output{to, to + 1, to + 2});
    space.copy_to_host(numbers.data(), to, 3);
  }
};

/// A pass ends once, after its last hit, also where there is nothing to collide and where verdicts are put off.
template <class NarrowPhase, class Broad, class Space>
void check_end_of_pass(Space space) {
  using numbers = std::array<std::uint64_t, 3>;
  small_scene scene;
  auto const mesh = collide::upload(space, scene.mesh());
  collide::detector<Broad, NarrowPhase, Space> detector(space);
  ending_sink sink;
  auto const query = [&] { return detector.query(collide::upload(space, scene.spheres()).view(), sink).numbers; };
  detector.build({});
  CHECK((query() == numbers{0, 1, 0}));
  detector.build(mesh.view());
  for (int k = 0; k < 3; ++k) CHECK((query() == numbers{4, 1, 4}));
  CHECK((detector.query(collide::sphere_view<float>(), sink).numbers == numbers{0, 1, 0}));
  scene.radii[0] = 0.25f;  // just touches, as no quick test can tell
  CHECK((query() == numbers{4, 1, 4}));
  scene.radii = {0, 0, 0, 0};
  CHECK((query() == numbers{1, 1, 1}));  // on a corner
}

/// Every way to hand over and to read a sink.
template <class Broad, class Space>
void check_sink_interface(Space space) {
  small_scene const scene;
  auto const mesh = collide::upload(space, scene.mesh());
  auto const spheres = collide::upload(space, scene.spheres());
  collide::detector<Broad, collide::karabassi<>, Space> detector(space);

  CHECK_THROWS_AS(detector.query(spheres.view(), collide::count()), collide::error);  // nothing is built yet
  detector.build({});
  CHECK(detector.query(spheres.view(), collide::count()).total() == 0);
  CHECK(detector.detect(mesh.view(), spheres.view(), collide::count()).total() == 4);

  collide::pairs kept(collide::order::canonical);
  auto& same = detector.query(spheres.view(), kept);
  static_assert(std::is_same<decltype(detector.query(spheres.view(), kept)), collide::pairs&>::value,
                "an lvalue stays one");
  static_assert(std::is_same<decltype(detector.query(spheres.view(), collide::pairs())), collide::pairs>::value,
                "an rvalue moves");
  static_assert(std::is_same<decltype(kept.total()), std::uint64_t>::value, "totals have 64 bits");
  CHECK(&same == &kept);
  CHECK((kept.to_host() == scene.hits()));
  CHECK(kept.size() == 4);
  std::vector<collide::pair> read(kept.size());
  space.copy_to_host(read.data(), kept.data(), kept.size());
  CHECK((read == scene.hits()));
  read.clear();
  for (auto hit : detector.query(spheres.view(), collide::pairs(collide::order::canonical)).to_host())
    read.push_back(hit);
  CHECK((read == scene.hits()));
  auto const [sphere, triangle] = kept.to_host()[3];
  CHECK(sphere == 3);
  CHECK(triangle == 1);
  auto const moved = std::move(kept);  // the memory moves with the sink
  CHECK((moved.to_host() == scene.hits()));
  CHECK((detector.query(spheres.view(), collide::pairs(collide::order::canonical)).to_host() == scene.hits()));

  CHECK((detector.query(spheres.view(), collide::any_hit()).to_host() == std::vector<std::uint8_t>{1, 1, 0, 1}));
  collide::buffer<std::uint8_t> flags;
  auto* const to = flags.reserve(detector.space().resource(), 5);
  std::uint8_t host_flags[5] = {9, 9, 9, 9, 9};
  space.copy_from_host(to, host_flags, 5);
  auto const own = detector.query(spheres.view(), collide::any_hit(to));
  CHECK(own.data() == to);
  CHECK(own.size() == 4);
  space.copy_to_host(host_flags, to, 5);
  CHECK((std::vector<int>(host_flags, host_flags + 5) == std::vector<int>{1, 1, 0, 1, 9}));

  auto const closest = detector.query(spheres.view(), collide::closest<>()).to_host();
  REQUIRE(closest.size() == 4);
  CHECK(closest[0].triangle == 0);
  CHECK(closest[0].distance == 0.25f);
  CHECK(closest[1].triangle == 0);  // both touch, on the diagonal
  CHECK(closest[2].triangle == collide::no_id);
  CHECK(closest[2].distance == std::numeric_limits<float>::infinity());

  auto const contacts = detector.query(spheres.view(), collide::contacts<>(collide::order::canonical)).to_host();
  REQUIRE(contacts.size() == 4);
  CHECK(contacts[0].point == collide::vec3<float>(1.5f, 0.5f, 0));
  CHECK(contacts[0].normal == collide::vec3<float>(0, 0, 1));
  CHECK(contacts[0].depth == 0.25f);
  CHECK(contacts[0].feature == collide::feature::face);
  CHECK(contacts[1].normal == collide::vec3<float>(0, 0, -1));
  CHECK(contacts[1].feature == collide::feature::edge);  // ca of triangle 0, ab of triangle 1
  CHECK(contacts[1].feature_index == 2);
  CHECK(contacts[2].feature_index == 0);
  CHECK(contacts[3].feature == collide::feature::vertex);
  CHECK(contacts[3].feature_index == 2);
  CHECK(contacts[3].depth == 0.125f);

  auto const one_each = detector.query(spheres.view(), collide::closest_contact<>()).to_host();
  REQUIRE(one_each.size() == 4);
  CHECK(std::memcmp(&one_each[0], &contacts[0], sizeof contacts[0]) == 0);
  CHECK(std::memcmp(&one_each[1], &contacts[1], sizeof contacts[1]) == 0);
  CHECK(std::memcmp(&one_each[3], &contacts[3], sizeof contacts[3]) == 0);
  CHECK(one_each[2].sphere == collide::no_id);
  CHECK(one_each[2].triangle == collide::no_id);
  CHECK(one_each[2].distance == std::numeric_limits<float>::infinity());
  CHECK(std::isnan(one_each[2].depth));
  CHECK(std::isnan(one_each[2].point.x()));
  CHECK(std::isnan(one_each[2].normal.z()));

  check_end_of_pass<collide::karabassi<>, Broad>(space);
  check_end_of_pass<collide::karabassi<collide::double_precision>, Broad>(space);

  auto const none = detector.query(spheres.view(), collide::pairs(nullptr, 0));
  CHECK(none.total() == 4);
  CHECK(none.size() == 0);
  CHECK_FALSE(none.complete());
}

/// `baseline` finds what is well away from contact, and makes mistakes far from the origin, as it is there to show.
template <class Broad, class Space>
void check_baseline(Space space) {
  random_scene random;
  random.seed = 71;
  random.triangles = 500;
  random.spheres = 1000;
  auto const ids_of = [&](scene<float> const& made) {
    auto const mesh =
        collide::upload(space, collide::indexed_mesh(made.mesh.vertices.data(), made.mesh.vertices.size() / 3,
                                                     made.mesh.corners.data(), made.mesh.size()));
    auto const spheres = collide::upload(
        space, collide::spheres_xyz(made.spheres.centres.data(), made.spheres.size(), made.spheres.radii.data()));
    collide::detector<Broad, collide::karabassi<collide::baseline>, Space> detector(space);
    std::vector<oracle::id_pair> found;
    for (auto p : detector.detect(mesh.view(), spheres.view(), collide::pairs(collide::order::canonical)).to_host())
      found.push_back({p.sphere, p.triangle});
    return found;
  };
  auto const all = random.make<float>();
  scene<float> made{all.mesh, {}};
  for (std::size_t i = 0; i < all.spheres.size(); ++i) {
    scene<float> one{all.mesh, {}};
    one.spheres.add(all.spheres[i].centre, all.spheres[i].radius);
    auto const expected = one.expect(1e-3);
    if (expected.certain == expected.possible) made.spheres.add(all.spheres[i].centre, all.spheres[i].radius);
  }
  auto const expected = made.expect(1e-3);
  CHECK(expected.exact.size() > 500);
  CHECK((expected.certain == expected.possible));
  CHECK((ids_of(made) == expected.exact));

  random.offset = {1e6, 1e6, 1e6};
  auto const far = random.make<float>();
  CHECK((ids_of(far) != far.expect(0).exact));
}

/// Every layout survives an upload, and nothing is lost on the way.
template <class Space>
void check_uploads(Space space) {
  small_scene const scene;
  std::vector<float> x, y, z, xyzr, soup;
  for (std::size_t i = 0; i < 4; ++i) {
    x.push_back(scene.xyz[3 * i]);
    y.push_back(scene.xyz[3 * i + 1]);
    z.push_back(scene.xyz[3 * i + 2]);
    for (float value : {x[i], y[i], z[i], scene.radii[i]}) xyzr.push_back(value);
  }
  for (int corner : scene.corners) {
    float const* const vertex = scene.vertices.data() + 3 * corner;
    soup.insert(soup.end(), vertex, vertex + 3);
  }

  collide::detector<collide::bucket, collide::karabassi<>, Space> detector(space);
  auto const hits = [&](collide::mesh_view<float> mesh, collide::sphere_view<float> spheres) {
    auto const m = collide::upload(space, mesh);
    auto const s = collide::upload(space, spheres);
    return detector.detect(m.view(), s.view(), collide::pairs(collide::order::canonical)).to_host();
  };
  for (auto const& mesh : {scene.mesh(), collide::triangle_soup(soup.data(), 2)}) {
    for (auto const& spheres :
         {scene.spheres(), collide::spheres_soa(x.data(), y.data(), z.data(), 4, scene.radii.data()),
          collide::spheres_xyzr(xyzr.data(), 4)})
      CHECK((hits(mesh, spheres) == scene.hits()));
    CHECK((hits(mesh, collide::spheres_xyz(scene.xyz.data(), 4, 0.5f)).size() == 4));
    CHECK((hits(mesh, collide::spheres_soa(x.data(), y.data(), z.data(), 4, 20)).size() == 8));
  }
}

/// `validate` counts what is wrong and names the first.
template <class Space>
void check_validate(Space space) {
  float const nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
  using collide::problem;
  small_scene scene;
  auto const mesh_report = [&] { return collide::validate(collide::upload(space, scene.mesh()).view(), space); };
  auto const sphere_report = [&] { return collide::validate(collide::upload(space, scene.spheres()).view(), space); };
  CHECK(mesh_report().ok());
  CHECK(mesh_report().message() == "");
  CHECK(sphere_report().ok());

  scene.corners = {0, 1, 1, 0, 2, 3};
  auto report = mesh_report();
  CHECK(report.ok());  // a segment is legal
  CHECK(report.count(problem::triangle_degenerate) == 1);
  CHECK(report.first(problem::triangle_degenerate) == 0);
  CHECK(report.first(problem::triangle_not_finite) == collide::no_id);
  scene.corners = {0, 1, 2, 0, 2, -1};
  report = mesh_report();
  CHECK_FALSE(report.ok());
  CHECK(report.count(problem::corner_out_of_range) == 1);
  CHECK(report.first(problem::corner_out_of_range) == 1);
  CHECK(report.message().find("number 1") != std::string::npos);
  scene.corners = {0, 1, 2, 0, 2, 3};
  scene.vertices[10] = nan;
  report = mesh_report();
  CHECK_FALSE(report.ok());
  CHECK(report.count(problem::triangle_not_finite) == 1);
  CHECK(report.first(problem::triangle_not_finite) == 1);

  scene.radii = {infinity, -0.0f, 0, 1};
  CHECK(sphere_report().ok());
  CHECK(sphere_report().count(problem::radius_infinite) == 1);
  scene.radii = {1, nan, -1, -infinity};
  scene.xyz[4] = -infinity;
  scene.xyz[9] = nan;
  report = sphere_report();
  CHECK_FALSE(report.ok());
  CHECK(report.count(problem::radius_nan) == 1);
  CHECK(report.first(problem::radius_nan) == 1);
  CHECK(report.count(problem::radius_negative) == 2);
  CHECK(report.first(problem::radius_negative) == 2);
  CHECK(report.count(problem::radius_infinite) == 0);
  CHECK(report.count(problem::centre_not_finite) == 2);
  CHECK(report.first(problem::centre_not_finite) == 1);

  scene.radii = {-infinity, 1, 1, 1};  // never collides, so this is not the legal infinite radius
  CHECK_FALSE(sphere_report().ok());
}

/// Memory comes from the caller's resource or allocator only; a failure is passed on and leaves the detector usable.
template <class Space, class MakeSpace>
void check_memory(MakeSpace make, std::pmr::memory_resource* upstream) {
  small_scene const scene;
  Space const plain = make(nullptr);
  auto const mesh = collide::upload(plain, scene.mesh());
  auto const spheres = collide::upload(plain, scene.spheres());

  counting_resource counting(upstream);
  {
    collide::allocator_resource<fancy_allocator<float>> adapted{fancy_allocator<float>(&counting)};
    collide::detector<collide::bucket, collide::karabassi<>, Space> detector(make(&adapted));
    CHECK((detector.detect(mesh.view(), spheres.view(), collide::pairs(collide::order::canonical)).to_host() ==
           scene.hits()));
    CHECK(counting.in_use > 0);
  }
  CHECK(counting.in_use == 0);

  failing_resource failing(upstream);
  collide::detector<collide::bucket, collide::karabassi<>, Space> detector(make(&failing));
  failing.fails = true;
  CHECK_THROWS_AS(detector.build(mesh.view()), std::bad_alloc);
  failing.fails = false;
  detector.build(mesh.view());
  failing.fails = true;
  CHECK_THROWS_AS(detector.query(spheres.view(), collide::pairs()), std::bad_alloc);
  failing.fails = false;
  CHECK((detector.query(spheres.view(), collide::pairs(collide::order::canonical)).to_host() == scene.hits()));
}

/// `n` spheres, of which every `apart`-th may touch one of two large triangles; those that do not are not even in the
/// grid. Those of some turns are far away, as the first ones are, others in part, and the last group is not whole
/// unless `n` is a multiple of 4.
template <class NarrowPhase, class Space>
void check_crowd(std::size_t n, std::size_t apart) {
  Space space;
  std::vector<float> const corners{0, 0, 0, 2000, 0, 0, 0, 2000, 0, 0, 0, 50, 2000, 0, 50, 0, 2000, 50};
  std::vector<float> centres(3 * n);
  std::vector<std::uint64_t> expected;
  for (std::size_t i = 0; i < n; ++i) {
    float const x = static_cast<float>(i % 967) + 10, y = static_cast<float>(i / 967 % 967) + 10;
    bool const away = i % 7 == 3 || i / 5000 % 5 == 0 || i % apart != 0;
    collide::id const triangle = i % 3 == 0 ? 1 : 0;
    centres[3 * i] = x, centres[3 * i + 1] = y, centres[3 * i + 2] = (triangle == 1 ? 50.5f : 0.5f) + (away ? 100 : 0);
    if (!away) expected.push_back(std::uint64_t{i} << 32 | triangle);
  }
  auto const mesh = collide::upload(space, collide::triangle_soup(corners.data(), 2));
  auto const spheres = collide::upload(space, collide::spheres_xyz(centres.data(), n, 1.0f));
  collide::detector<collide::bucket, NarrowPhase, Space> detector(space);
  detector.build(mesh.view(), 1.0f);
  std::vector<collide::pair> found;
  if constexpr (!std::is_same_v<NarrowPhase, collide::karabassi_swept<>>) {
    found = detector.query(spheres.view(), collide::pairs(collide::order::canonical)).to_host();
  } else {
    std::vector<float> const still(3 * n);
    collide::buffer<float> memory;
    float* const ways = memory.reserve(space.resource(), still.size());
    space.copy_from_host(ways, still.data(), still.size());
    auto const moving = collide::with_displacements(spheres.view(), static_cast<float const*>(ways));
    found = detector.query(moving, collide::pairs(collide::order::canonical)).to_host();
  }
  REQUIRE(found.size() == expected.size());
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    wrong += (std::uint64_t{found[i].sphere} << 32 | found[i].triangle) != expected[i];
  }
  CHECK(wrong == 0);
}

}  // namespace tests
