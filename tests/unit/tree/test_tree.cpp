/// Trees of boxes: each triangle is in it once, in boxes that contain it; what goes through it leaves out nothing.
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <doctest/doctest.h>

#include <collide/bvh.cuh>

#include "counted_new.hpp"
#include "execution/lockstep.hpp"
#include "hard_meshes.hpp"

using namespace collide::detail;
using collide::host, collide::id, collide::bvh_tuning;

namespace {

using in_lockstep = tests::lockstep<64, false>;

/// A tree of a mesh, made in a space.
template <class S, class Space>
struct tree {
  Space space{2};
  tree_policy::index<S> index;
  tree_ref<S> ref{};

  explicit tree(collide::mesh_view<S> const& mesh) {
    index.build(space, tree_policy(), mesh);
    ref = index.ref();
  }
  /// That of a mesh that has deformed.
  tree(collide::mesh_view<S> const& before, collide::mesh_view<S> const& mesh) {
    index.build(space, tree_policy(), before);
    index.refit(space, tree_policy(), mesh);
    ref = index.ref();
  }
};

/// All triangles below a node whose boxes are all in `around`, the boxes of each, and what is wrong.
template <class S>
struct walk {
  tree_ref<S> const& ref;
  std::vector<id> triangles;  ///< those that are whole, and the first pieces of others
  std::vector<std::vector<aabb<float>>> boxes = std::vector<std::vector<aabb<float>>>(ref.mesh.size());
  int levels = 0;
  bool boxes_fit = true, parents_fit = true;

  void visit(std::uint32_t number, std::uint32_t parent, std::uint32_t slot, aabb<float> const& around, int level) {
    tree_node const& node = ref.nodes[number];
    levels = std::max(levels, level + 1);
    parents_fit = parents_fit && node.parent == parent && node.slot == slot;
    for (std::uint32_t k = 0; k < 8; ++k) {
      if ((node.there >> k & 1) == 0) continue;
      aabb<float> box;
      for (int i = 0; i < 3; ++i) {
        box.lower[i] = node.lower[i][k], box.upper[i] = node.upper[i][k];
        if (!box.is_empty())
          boxes_fit = boxes_fit && box.lower[i] >= around.lower[i] && box.upper[i] <= around.upper[i];
      }
      std::uint32_t const child = node.child[k];
      if ((child & tree_node::leaf) == 0) {
        visit(child, number, k, box, level + 1);
        continue;
      }
      if ((node.continues >> k & 1) == 0) triangles.push_back(child & ~tree_node::leaf);
      boxes[child & ~tree_node::leaf].push_back(box);
    }
  }

  /// True if some box of a triangle has each of some points of it, and what is around each that narrow phases may take
  /// for it.
  bool has_all_of(id t) const {
    auto const whole = triangle_aabb_of(ref.mesh[t]);
    auto const& corners = ref.mesh[t];
    auto const origin = tree_origin(ref.mesh);
    using wide = long double;
    for (int i = 0; i <= 12; ++i) {
      for (int j = 0; i + j <= 12; ++j) {
        bool found = false;
        for (auto const& box : boxes[t]) {
          bool inside = true;
          for (int k = 0; k < 3; ++k) {
            wide const x = (wide(corners.a[k]) * i + wide(corners.b[k]) * j + wide(corners.c[k]) * (12 - i - j)) / 12;
            wide const local = x - wide(origin[k]), room = wide(whole.padding) * 15 / 16;
            inside = inside && wide(box.lower[k]) <= local - room && wide(box.upper[k]) >= local + room;
          }
          found = found || inside;
        }
        if (!found) return false;
      }
    }
    return true;
  }
};

/// The same triangles, each somewhere else, but some.
template <class S>
tests::hard_mesh<S> moved(tests::hard_mesh<S> mesh) {
  std::mt19937 engine(3);
  std::uniform_real_distribution<double> uniform(-0.5, 0.5);
  S const extent = mesh.extent();
  for (std::size_t i = 0; i < mesh.corners.size(); i += 9) {
    for (std::size_t k = 0; k < 3; ++k) {
      S const by = i % 4 == 0 ? 0 : extent * static_cast<S>(uniform(engine));
      for (std::size_t c = 0; c < 9; c += 3) mesh.corners[i + c + k] += by;
    }
  }
  return mesh;
}

template <class S, class Space>
void check_tree(tests::hard_mesh<S> const& made, tree<S, Space> const& t) {
  CAPTURE(made.name);
  CAPTURE(Space::name());
  std::vector<id> finite;
  for (id i = 0; i < made.size(); ++i) {
    if (is_finite(made.view()[i])) finite.push_back(i);
  }
  if (t.ref.nodes == nullptr) {
    CHECK(finite.empty());
    return;
  }
  walk<S> seen{t.ref, {}};
  constexpr float far = std::numeric_limits<float>::infinity();
  seen.visit(0, 0, 0, {{-far, -far, -far}, {far, far, far}}, 0);
  CHECK(seen.boxes_fit);
  CHECK(seen.parents_fit);
  CHECK(std::all_of(finite.begin(), finite.end(), [&](id i) { return seen.has_all_of(i); }));
  bool const is_cut = std::any_of(finite.begin(), finite.end(), [&](id i) { return seen.boxes[i].size() > 1; });
  if (made.name == "needles") CHECK(is_cut == bvh_tuning<Space>::divides_by_area);
  if (made.name == "a soup" || made.name == "giants") CHECK(!is_cut);
  CHECK(seen.levels <= max_tree_levels);
  std::sort(seen.triangles.begin(), seen.triangles.end());
  std::vector<id> found;  // what is not finite may be there too
  std::copy_if(seen.triangles.begin(), seen.triangles.end(), std::back_inserter(found),
               [&](id i) { return is_finite(made.view()[i]); });
  CHECK(found == finite);
  CHECK(std::adjacent_find(seen.triangles.begin(), seen.triangles.end()) == seen.triangles.end());

  S const extent = made.extent();
  for (std::size_t i = 0; i < 200 && !finite.empty(); ++i) {
    auto const draw = [n = std::uint32_t(i) * 7919u](int k) {
      return S(((n + std::uint32_t(k)) * 2654435761u) >> 8) / S(0x800000) - 1;
    };
    collide::vec3<S> const centre = i % 2 == 0 ? collide::vec3<S>(extent * draw(0), extent * draw(1), extent * draw(2))
                                               : made.view()[finite[i % finite.size()]].b;
    collide::sphere<S> const s{centre, extent * (1 + draw(3)) / (i % 4 == 0 ? 2 : 100)};
    std::vector<id> all, one_by_one;
    t.ref.for_each_candidate(s, [&](id k) { all.push_back(k); });
    auto at = t.ref.begin(s);
    for (id k; t.ref.next(s, at, k);) one_by_one.push_back(k);
    CHECK(at.at_end());
    CHECK(one_by_one == all);
    std::sort(all.begin(), all.end());
    CHECK(std::adjacent_find(all.begin(), all.end()) == all.end());
    std::size_t missing = 0;
    for (id const k : finite) {
      if (collide::karabassi<>::intersects(made.view()[k], s))
        missing += !std::binary_search(all.begin(), all.end(), k);
    }
    CHECK(missing == 0);
  }
}

}  // namespace

TEST_CASE_TEMPLATE("tree: each finite triangle is in it once, in boxes that contain it, and no hit is left out", S,
                   float, double) {
  for (auto const& made : tests::hard_meshes<S>(700)) {
    check_tree(made, tree<S, host>(made.view()));
    check_tree(made, tree<S, in_lockstep>(made.view()));
  }
}

TEST_CASE_TEMPLATE("tree: of a mesh that deforms it has all triangles where they are now", S, float, double) {
  for (auto const& made : tests::hard_meshes<S>(300)) {
    auto const before = moved(made);
    check_tree(made, tree<S, host>(before.view(), made.view()));
    check_tree(made, tree<S, in_lockstep>(before.view(), made.view()));
  }
}

TEST_CASE("tree: refit of a detector allocates nothing, finds what a new build does, and needs a mesh of that size") {
  for (auto const& made : tests::hard_meshes<float>(300)) {
    CAPTURE(made.name);
    auto const before = moved(made);
    collide::sphere_view<float> const spheres(collide::points(made.corners.data(), made.size(), 9), nullptr, 0,
                                              made.extent() / 50);
    collide::detector<collide::bvh> built, refitted;
    CHECK_THROWS_AS(refitted.refit(made.view()), collide::error);
    built.build(made.view());
    refitted.build(before.view());
    bool const stays = made.name != "of the largest numbers" &&  // their boxes are infinite
                       std::all_of(made.corners.begin(), made.corners.end(), [](float x) { return std::isfinite(x); });
    std::size_t const news = tests::counted_news();
    refitted.refit(made.view());
    if (stays) CHECK(tests::counted_news() == news);
    collide::pairs expected(collide::order::canonical), found(collide::order::canonical);
    built.query(spheres, expected);
    refitted.query(spheres, found);
    CHECK(found.to_host() == expected.to_host());
    CHECK_THROWS_AS(refitted.refit(made.view().subview(0, made.size() - 1)), collide::error);
    refitted.query(spheres, found);  // what was refused has done no harm
    CHECK(found.to_host() == expected.to_host());
  }
}

TEST_CASE("tree: where more levels are above than a cursor keeps, it finds out again what is left") {
  // each triangle half as large and half as far as the one before: as deep a tree as there is
  std::vector<float> corners;
  for (int i = 0; i < 4000; ++i) {
    float const x = std::ldexp(1.0f, -(i % 120)) * (1 + 1e-3f * static_cast<float>(i / 120));
    corners.insert(corners.end(), {x, 0, 0, x, x / 8, 0, x, 0, x / 8});
  }
  auto const check = [&](auto const& t, int more_levels_than, int most_levels) {
    walk<float> seen{t.ref, {}};
    constexpr float far = std::numeric_limits<float>::infinity();
    seen.visit(0, 0, 0, {{-far, -far, -far}, {far, far, far}}, 0);
    CHECK(seen.levels > more_levels_than);
    CHECK(seen.levels <= most_levels);
    std::vector<id> all;
    t.ref.for_each_candidate({{0, 0, 0}, 10}, [&](id k) { all.push_back(k); });
    CHECK(all.size() == 4000);
    std::sort(all.begin(), all.end());
    CHECK(std::unique(all.begin(), all.end()) == all.end());
  };
  auto const mesh = collide::triangle_soup(corners.data(), 4000);
  check(tree<float, host>(mesh), 7, max_tree_levels);
  check(tree<float, in_lockstep>(mesh), 5, 32);  // as many as on a device
}

TEST_CASE("tree: near triangles come first, and most others never") {
  auto const made = tests::hard_meshes<float>(5000)[3];
  auto const check = [&](auto const& t) {
    std::size_t looked_at = 0, wrong = 0;
    auto const mesh = made.view();
    for (std::size_t i = 0; i < 200; ++i) {
      collide::vec3<float> const p = mesh[i].a + collide::vec3<float>(0.01f, -0.02f, 0.03f);
      auto const squared = [&](id k) { return (mesh[k].a - p).squaredNorm(); };  // any number will do that is not below
      auto const to_box = [&](id k) {
        auto const box = aabb_of(mesh[k]);
        float sum = 0;
        for (int c = 0; c < 3; ++c) {
          float const gap = std::max({box.lower[c] - p[c], p[c] - box.upper[c], 0.0f});
          sum += gap * gap;
        }
        return sum;
      };
      float best = std::numeric_limits<float>::infinity(), least = best;
      t.ref.for_each_nearer(p, best, [&](id k) {
        ++looked_at;
        return best = std::min(best, squared(k));
      });
      for (id k = 0; k < mesh.size(); ++k) {
        if (to_box(k) <= best) least = std::min(least, squared(k));
      }
      wrong += best != least;
    }
    CHECK(wrong == 0);
    CHECK(looked_at < 200 * 300);
  };
  check(tree<float, host>(made.view()));
  check(tree<float, in_lockstep>(made.view()));
}

TEST_CASE("tree: nothing is near a place that is none, or within less than no distance") {
  auto const made = tests::hard_meshes<double>(100)[3];
  tree<double, host> const t(made.view());
  auto const count = [&](collide::vec3<double> const& p, double bound) {
    int n = 0;
    t.ref.for_each_nearer(p, bound, [&](id) {
      ++n;
      return bound;
    });
    return n;
  };
  CHECK(count({0, 0, 0}, std::numeric_limits<double>::infinity()) == 100);
  CHECK(count({0, 0, 0}, -1) == 0);
  CHECK(count({0, 0, 0}, std::nan("")) == 0);
  CHECK(count({0, std::nan(""), 0}, 1) == 0);
  CHECK(count({0, std::numeric_limits<double>::infinity(), 0}, 1) == 0);
}
