/// \file
/// Bullet: triangles of its BVH in a sphere's box.
#include <btBulletCollisionCommon.h>

#include "peer.hpp"
#include "peers.hpp"

namespace {

using peers::pair_list;

struct near_sphere : btTriangleCallback {
  collide::mesh_view<float> mesh;
  collide::sphere<float> sphere;
  collide::id number;
  pair_list* to;

  void processTriangle(btVector3*, int, int triangle) override {
    auto const t = static_cast<collide::id>(triangle);
    if (peers::touch(mesh[t], sphere)) to->push_back({number, t});
  }
};

class bullet {
 public:
  bullet(peers::scene const& from, int threads)
      : from_{from},
        threads_{threads},
        corners_(from.corners.begin(), from.corners.end()),
        vertices_(from.vertices.begin(), from.vertices.end()),
        triangles_(static_cast<int>(from.triangles()), corners_.data(), 3 * sizeof(int),
                   static_cast<int>(from.vertices.size() / 3), vertices_.data(), 3 * sizeof(btScalar)),
        shape_(&triangles_, true) {}

  pair_list query() const {
    auto const spheres = from_.view();
    return peers::in_parts(spheres.size(), threads_, [&](std::size_t first, std::size_t last, pair_list& to) {
      near_sphere callback;
      callback.mesh = from_.mesh();
      callback.to = &to;
      for (std::size_t i = first; i < last; ++i) {
        callback.sphere = {spheres.centre(i), spheres.radius(i)};
        callback.number = static_cast<collide::id>(i);
        btVector3 const centre(callback.sphere.centre.x(), callback.sphere.centre.y(), callback.sphere.centre.z());
        btVector3 const reach(callback.sphere.radius, callback.sphere.radius, callback.sphere.radius);
        shape_.processAllTriangles(&callback, centre - reach, centre + reach);
      }
    });
  }

 private:
  peers::scene const& from_;
  int threads_;
  std::vector<int> corners_;
  std::vector<btScalar> vertices_;
  btTriangleIndexVertexArray triangles_;
  btBvhTriangleMeshShape shape_;
};

}  // namespace

void peers::add_bullet(std::vector<int> const& threads) {
  benchmark::AddCustomContext("Bullet", std::to_string(btGetVersion()));
  add<bullet>("Bullet, BVH of a mesh", threads);
}
