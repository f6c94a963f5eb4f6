/// \file
/// Embree: a point query over its BVH of triangles.
#include <map>
#include <string>

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#include <embree4/rtcore_config.h>
#else
#include <embree3/rtcore.h>
#include <embree3/rtcore_config.h>
#endif

#include "peer.hpp"
#include "peers.hpp"

namespace {

using peers::pair_list;

/// The data of a callback of the query for one sphere.
struct asked {
  collide::mesh_view<float> mesh;
  collide::sphere<float> sphere;
  collide::id number;
  pair_list* to;
};

bool found(RTCPointQueryFunctionArguments* arguments) {
  auto const& a = *static_cast<asked const*>(arguments->userPtr);
  if (peers::touch(a.mesh[arguments->primID], a.sphere)) a.to->push_back({a.number, arguments->primID});
  return false;  // the radius of the query stays
}

/// Embree's device with so many threads. It is made once, as a user would, and not part of the build.
RTCDevice device_of(int threads) {
  static std::map<int, RTCDevice> made;
  auto const found = made.find(threads);
  if (found != made.end()) return found->second;
  return made.emplace(threads, rtcNewDevice(("threads=" + std::to_string(threads)).c_str())).first->second;
}

template <RTCBuildQuality Quality>
class embree {
 public:
  embree(peers::scene const& from, int threads) : from_{from}, threads_{threads}, device_{device_of(threads)} {
    scene_ = rtcNewScene(device_);
    RTCGeometry const mesh = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    void* const vertices = rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                   3 * sizeof(float), from.vertices.size() / 3);
    std::copy(from.vertices.begin(), from.vertices.end(), static_cast<float*>(vertices));
    void* const corners = rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                  3 * sizeof(unsigned), from.triangles());
    std::copy(from.corners.begin(), from.corners.end(), static_cast<unsigned*>(corners));
    rtcSetGeometryBuildQuality(mesh, Quality);
    rtcCommitGeometry(mesh);
    rtcAttachGeometry(scene_, mesh);
    rtcReleaseGeometry(mesh);
    rtcSetSceneBuildQuality(scene_, Quality);
    rtcCommitScene(scene_);
  }
  embree(embree const&) = delete;
  embree& operator=(embree const&) = delete;
  ~embree() { rtcReleaseScene(scene_); }

  pair_list query() const {
    auto const mesh = from_.mesh();
    auto const spheres = from_.view();
    return peers::in_parts(spheres.size(), threads_, [&](std::size_t first, std::size_t last, pair_list& to) {
      RTCPointQueryContext context;
      rtcInitPointQueryContext(&context);
      for (std::size_t i = first; i < last; ++i) {
        asked a{mesh, {spheres.centre(i), spheres.radius(i)}, static_cast<collide::id>(i), &to};
        RTCPointQuery query{a.sphere.centre.x(), a.sphere.centre.y(), a.sphere.centre.z(), 0, a.sphere.radius};
        rtcPointQuery(scene_, &query, &context, found, &a);
      }
    });
  }

 private:
  peers::scene const& from_;
  int threads_;
  RTCDevice device_;
  RTCScene scene_;
};

}  // namespace

void peers::add_embree(std::vector<int> const& threads) {
  benchmark::AddCustomContext("Embree", RTC_VERSION_STRING);
  for (int const t : threads) device_of(t);
  add<embree<RTC_BUILD_QUALITY_LOW>>("Embree, fast build", threads);
  add<embree<RTC_BUILD_QUALITY_MEDIUM>>("Embree, medium build", threads);
  add<embree<RTC_BUILD_QUALITY_HIGH>>("Embree, high build", threads);
}
