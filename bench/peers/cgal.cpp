/// \file
/// CGAL: intersections with its AABB tree.
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/version.h>

#include "peer.hpp"
#include "peers.hpp"

namespace {

using peers::pair_list;
using kernel = CGAL::Simple_cartesian<double>;
using triangle_list = std::vector<kernel::Triangle_3>;
using primitive = CGAL::AABB_triangle_primitive<kernel, triangle_list::const_iterator>;
using tree = CGAL::AABB_tree<CGAL::AABB_traits<kernel, primitive>>;

class cgal {
 public:
  cgal(peers::scene const& from, int threads) : from_{from}, threads_{threads} {
    auto const mesh = from.mesh();
    auto const point = [](auto const& p) { return kernel::Point_3(p.x(), p.y(), p.z()); };
    triangles_.reserve(mesh.size());
    for (std::size_t i = 0; i < mesh.size(); ++i) {
      auto const t = mesh[i];
      triangles_.emplace_back(point(t.a), point(t.b), point(t.c));
    }
    tree_.insert(triangles_.cbegin(), triangles_.cend());
    tree_.build();
  }

  pair_list query() const {
    auto const spheres = from_.view();
    return peers::in_parts(spheres.size(), threads_, [&](std::size_t first, std::size_t last, pair_list& to) {
      std::vector<tree::Primitive_id> met;
      for (std::size_t i = first; i < last; ++i) {
        auto const c = spheres.centre(i);
        double const r = spheres.radius(i);
        met.clear();
        tree_.all_intersected_primitives(kernel::Sphere_3({c.x(), c.y(), c.z()}, r * r), std::back_inserter(met));
        for (auto const triangle : met) {
          to.push_back({static_cast<collide::id>(i), static_cast<collide::id>(triangle - triangles_.cbegin())});
        }
      }
    });
  }

 private:
  peers::scene const& from_;
  int threads_;
  triangle_list triangles_;
  tree tree_;
};

}  // namespace

void peers::add_cgal(std::vector<int> const& threads) {
  benchmark::AddCustomContext("CGAL", CGAL_VERSION_STR);
  add<cgal>("CGAL, AABB tree", threads);
}
