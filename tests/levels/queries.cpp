/// \file
/// Times queries on the host. Prints a line for each scene: its name, seconds, hash of the results.
#include <collide/bucket.cuh>
#include <collide/bvh.cuh>
#include <collide/detectors/sphere_pairs.cuh>
#include <collide/karabassi_swept.hpp>
#include <collide/sinks/nearest.hpp>

#include "../../bench/scene.hpp"
#include "io/scenes.hpp"
#include "timings.hpp"

namespace {

template <class S>
bench::scene<S> scene_of(char const* name, std::size_t spheres, std::size_t triangles) {
  return bench::scene<S>(io::find_scene(name)->make(spheres, triangles, 0));
}

template <class Broad, class S, class Sink>
void query(std::string const& name, bench::scene<S> const& scene, Sink sink) {
  collide::detector<Broad, collide::karabassi<>, collide::host, S> detector(collide::host(1));
  detector.build(scene.mesh());
  timed(
      name, [&] { detector.query(scene.spheres(), sink); }, [&] { return sink.to_host(); });
}

template <class Broad, class S>
void build(std::string const& name, bench::scene<S> const& scene) {
  collide::detector<Broad, collide::karabassi<>, collide::host, S> detector(collide::host(1));
  collide::pairs found(collide::order::canonical);
  timed(
      name, [&] { detector.build(scene.mesh()); }, [&] { return detector.query(scene.spheres(), found).to_host(); });
}

}  // namespace

int main() {
  using collide::bucket;
  using collide::bvh;
  auto const study = scene_of<float>("study", 400000, io::study_triangles);
  query<bucket>("study/bucket/pairs", study, collide::pairs());
  query<bucket>("study/bucket/pairs_double", scene_of<double>("study", 200000, io::study_triangles), collide::pairs());
  query<bvh>("study/bvh/pairs", study, collide::pairs());
  build<bucket>("study/bucket/build", study);
  build<bvh>("study/bvh/build", scene_of<float>("study", 100, 20000));
  query<bucket>("few/bucket/pairs", scene_of<float>("few", 20000, 1000), collide::pairs());
  query<bucket>("hits/bucket/pairs", scene_of<float>("hits", 2000, io::study_triangles), collide::pairs());
  query<bucket>("radii_100/bucket/pairs", scene_of<float>("radii_100", 50000, io::study_triangles), collide::pairs());
  query<bucket>("grains/bucket/contacts", scene_of<float>("grains", 30000, 30000), collide::contacts());
  query<bvh>("tube_1000/bvh/pairs", scene_of<float>("tube_1000", 20000, 20000), collide::pairs());
  query<bucket>("giants_10/bucket/pairs", scene_of<float>("giants_10", 100000, 50000), collide::pairs());
  {
    collide::detector<bvh, collide::karabassi<>, collide::host> tree(collide::host(1));
    tree.build(study.mesh());
    collide::nearest sink;
    auto const places = collide::points(study.centres.data(), 20000);
    timed(
        "study/bvh/nearest", [&] { tree.query(places, sink); },
        [&] {
          std::vector<float> distances;
          for (auto const& found : sink.to_host()) distances.push_back(found.distance);
          return distances;
        });
  }
  {
    collide::detector<bucket, collide::karabassi_swept<>, collide::host> detector(collide::host(1));
    detector.build(study.mesh());
    std::vector<float> displacements(study.centres.size());
    for (std::size_t i = 0; i < displacements.size(); ++i) displacements[i] = static_cast<float>(i % 7) - 3.f;
    auto const moving =
        collide::with_displacements(collide::spheres_xyz(study.centres.data(), 100000, 3.f), displacements.data());
    collide::pairs sink;
    timed(
        "study/bucket/swept", [&] { detector.query(moving, sink); }, [&] { return sink.to_host(); });
  }
  {
    collide::sphere_pairs<collide::host> finder(collide::host(1));
    collide::pairs sink;
    auto const soup = scene_of<float>("crowd", 3000, 1000);
    timed(
        "clustered/sphere_pairs/pairs", [&] { finder.query(soup.spheres(), sink); }, [&] { return sink.to_host(); });
  }
}
