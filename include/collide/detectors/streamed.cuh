/// \file
/// Queries of spheres in host memory, also of more than fit into the memory of the space: they are streamed in chunks.
#pragma once

#include <algorithm>
#include <cstddef>

#include <collide/detector.hpp>
#include <collide/detectors/detail/chunk_streamer.cuh>

namespace collide {

/// Hands spheres in host memory to a detector, a chunk at a time.
///
/// In the CUDA spaces a chunk is copied to the device while those before it are queried: copies are put on a stream of
/// their own, one after the other, and together take as long as the whole, if a query does not take longer than a copy
/// from pinned memory (`cuda_pinned_memory`). A copy from pageable memory blocks the host: it takes longer, and does
/// not overlap with queries. On the host nothing is copied.
///
/// Memory of the space: three chunks in the layout of the spheres, where there are so many; 38 MB for packed floats
/// and chunks of the usual size. It is kept between queries. One object is for one thread at a time.
template <class Detector>
class streamed {
  static_assert(detail::is_detector<Detector>,
                "collide: what spheres are streamed to is a detector, such as detector<bucket>");

 public:
  /// `sphere_view`, or `moving_sphere_view` if the detector's narrow phase judges spheres that move.
  using spheres_type = typename Detector::spheres_type;

  /// `detector` must outlive this. `chunk`: how many spheres go at a time, so many that a copy takes longer than what
  /// a query costs whatever its size, some 0.1 ms. Throws `error` if that is 0.
  explicit streamed(Detector& detector, std::size_t chunk = std::size_t{1} << 20)
      : detector_{&detector}, chunk_{chunk} {
    if (chunk == 0) throw error("collide: streamed: chunk is 0");
  }

  /// For each chunk, in order: queries it with the sink, and calls f(first, sink). What the sink then holds is about
  /// that chunk alone: sphere i there is sphere `first` + i of all. Without spheres nothing is called.
  ///
  /// `spheres` are in host memory, in any layout. What lies between them is copied too, so layouts without gaps are the
  /// fastest. Their memory may change when this returns. What the sink or f throws is passed on; everything can be used
  /// again afterwards.
  template <class Sink, class F>
  void query(spheres_type const& spheres, Sink&& sink, F&& f) {
    if (spheres.size() == 0) return;
    chunks_.for_each_chunk(detector_->space(), spheres, std::min(chunk_, spheres.size()),
                           [&](spheres_type const& chunk, std::size_t first) {
                             detector_->query(chunk, sink);
                             f(static_cast<id>(first), sink);
                           });
  }

 private:
  Detector* detector_;
  std::size_t chunk_;
  detail::chunk_streamer<typename Detector::execution_space, spheres_type> chunks_;
};

}  // namespace collide
