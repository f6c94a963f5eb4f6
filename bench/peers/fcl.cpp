/// \file
/// FCL: a sphere against a BVH model of oriented boxes, which is the fastest of its models here. With boxes along the
/// axes fcl::collide copies the model for every sphere.
#include <fcl/config.h>
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/math/bv/OBB.h>
#include <fcl/narrowphase/collision.h>

#include "peer.hpp"
#include "peers.hpp"

namespace {

using peers::pair_list;

class fcl_model {
 public:
  fcl_model(peers::scene const& from, int threads)
      : from_{from}, threads_{threads}, mesh_{std::make_shared<fcl::BVHModel<fcl::OBBd>>()} {
    std::vector<fcl::Vector3d> points;
    std::vector<fcl::Triangle> triangles;
    for (std::size_t i = 0; i < from.vertices.size(); i += 3) {
      points.emplace_back(from.vertices[i], from.vertices[i + 1], from.vertices[i + 2]);
    }
    for (std::size_t i = 0; i < from.corners.size(); i += 3) {
      triangles.emplace_back(from.corners[i], from.corners[i + 1], from.corners[i + 2]);
    }
    mesh_->beginModel(static_cast<int>(triangles.size()), static_cast<int>(points.size()));
    mesh_->addSubModel(points, triangles);
    mesh_->endModel();
  }

  pair_list query() const {
    auto const spheres = from_.view();
    return peers::in_parts(spheres.size(), threads_, [&](std::size_t first, std::size_t last, pair_list& to) {
      fcl::CollisionRequestd request;
      request.num_max_contacts = from_.triangles();
      request.enable_contact = false;
      fcl::Transform3d at = fcl::Transform3d::Identity();
      for (std::size_t i = first; i < last; ++i) {
        fcl::Sphered const sphere(static_cast<double>(spheres.radius(i)));
        at.translation() = spheres.centre(i).cast<double>();
        fcl::CollisionResultd result;
        fcl::collide(mesh_.get(), fcl::Transform3d::Identity(), &sphere, at, request, result);
        for (std::size_t k = 0; k < result.numContacts(); ++k) {
          to.push_back({static_cast<collide::id>(i), static_cast<collide::id>(result.getContact(k).b1)});
        }
      }
    });
  }

 private:
  peers::scene const& from_;
  int threads_;
  std::shared_ptr<fcl::BVHModel<fcl::OBBd>> mesh_;
};

}  // namespace

void peers::add_fcl(std::vector<int> const& threads) {
  benchmark::AddCustomContext("FCL", FCL_VERSION);
  add<fcl_model>("FCL, BVH of OBB", threads);
}
