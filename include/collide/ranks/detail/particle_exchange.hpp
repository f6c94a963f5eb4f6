/// \file
/// How particles go from rank to rank, and what ranks tell each other of them.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

#include <collide/ranks/detail/bisection.hpp>
#include <collide/ranks/detail/device_exchange_buffer.hpp>
#include <collide/ranks/detail/part_of_simulation.hpp>
#include <collide/ranks/detail/send_plan.hpp>
#if defined(__CUDACC__)
#include <collide/cuda.cuh>
#endif

namespace collide::detail {

/// A stream beside that of a space, for copies that travel while the space works. Only CUDA spaces have streams: others
/// do all in their own order.
template <class Space, class = void>
class side_stream {
 public:
  void begin(Space const&) {}
  void end(Space const&) const {}
  Space const& of(Space const& space) const { return space; }
};

#if defined(__CUDACC__)

template <class Space>
class side_stream<Space, std::enable_if_t<std::is_base_of<cuda_space, Space>::value>> {
 public:
  /// Has what is put on the side stream from now on begin after the work that the space has.
  void begin(Space const& space) {
    if (!side_) make(space);
    side_->after(space.mark());
  }
  /// Has what the space gets from now on begin after the work of the side stream.
  void end(Space const& space) const {
    if (side_) space.after(side_->mark());
  }
  /// A space that puts its work on the side stream, or the space itself where there is none yet.
  cuda_space const& of(Space const& space) const {
    if (side_) return *side_;
    return space;
  }

 private:
  /// Kernels that copy, as NCCL's do, go before blocks of a large kernel that has begun.
  void make(Space const& space) {
    int least = 0, greatest = 0;
    cuda_check(cudaDeviceGetStreamPriorityRange(&least, &greatest), "cudaDeviceGetStreamPriorityRange");
    cudaStream_t made = nullptr;
    cuda_check(cudaStreamCreateWithPriority(&made, cudaStreamNonBlocking, greatest), "cudaStreamCreateWithPriority");
    stream_.reset(made);
    side_ = std::make_unique<cuda_space>(made, space.resource());
  }

  struct destroy {
    void operator()(cudaStream_t stream) const { cudaStreamDestroy(stream); }
  };
  std::unique_ptr<std::remove_pointer_t<cudaStream_t>, destroy> stream_;
  std::unique_ptr<cuda_space> side_;
};

#endif

/// Each rank has the particles of its subdomain, and copies of those outside that may meet them, until one has moved
/// too far. All ranks call all members. Particles stay in memory of their spaces, but when subdomains are cut.
template <class Part>
class particle_exchange {
  using S = typename Part::S;
  using all_row = particle_row<S, typename Part::all_columns>;
  using seen_row = particle_row<S, typename Part::seen_columns>;
  using space_type = typename Part::space_type;

 public:
  void clear() { is_divided_ = false; }

  /// Brings particles to the ranks in whose subdomains they are, and finds out which copies go where.
  template <class Ranks>
  void exchange(Ranks const& ranks, Part& part) {
    divide(ranks, part);
    typename Part::contact_rows contacts;
    move(ranks, part, contacts);
    together(ranks, [&] {
      part.find_copied(lookup_, ranks.rank(), ranks.size(), copied_);
      sent_.counts = copied_.counts();
      sent_.resize(part.space());
      received_.clear(ranks.size());
    });
    ranks.exchange_counts(sent_.counts.data(), received_.counts.data());
    together(ranks, [&] {
      device_exchange<Ranks, space_type>(ranks, part.space()).expect(received_);
      part.expect_copies(received_.size(), sent_.size());
      part.set_contacts(contacts);
      pack(ranks, part, [] {});
    });
  }

  /// Makes ready what others must know in this step. What meanwhile() puts on the part's stream runs while that
  /// travels.
  template <class Ranks, class Meanwhile>
  void pack(Ranks const& ranks, Part& part, Meanwhile const& meanwhile) {
    side_.begin(part.space());
    part.pack_seen(side_.of(part.space()), copied_, sent_.data());
    meanwhile();
    by(ranks, part).stage(sent_);
  }

  /// Sends it. All ranks come out of it.
  template <class Ranks>
  void send(Ranks const& ranks, Part& part) {
    by(ranks, part).send(sent_, received_);
  }
  /// True if what is sent may be on its way until `receive`.
  template <class Ranks>
  bool is_under_way(Ranks const& ranks, Part& part) const {
    return by(ranks, part).is_under_way();
  }
  template <class Ranks>
  void receive(Ranks const& ranks, Part& part) const {
    by(ranks, part).end();
  }

  /// If something has gone wrong: what the part does from now on comes after what is sent.
  void abandon(Part& part) const { side_.end(part.space()); }

  template <class Ranks>
  void unpack(Ranks const& ranks, Part& part) {
    by(ranks, part).unstage(received_);
    part.unpack_seen(side_.of(part.space()), received_.data());
    side_.end(part.space());
  }

 private:
  /// How messages go, on the stream beside that of the part.
  template <class Ranks>
  auto by(Ranks const& ranks, Part& part) const {
    auto const& side = side_.of(part.space());
    return device_exchange<Ranks, std::decay_t<decltype(side)>>(ranks, side);
  }

  /// Cuts subdomains if there are none, or one has many more particles than it should.
  template <class Ranks>
  void divide(Ranks const& ranks, Part& part) {
    std::uint64_t mine = 0, largest = 0, sum = 0;
    together(ranks, [&] { mine = part.count_somewhere(); });
    ranks.reduce(&mine, &largest, 1, reduction::max);
    ranks.reduce(&mine, &sum, 1, reduction::sum);
    std::uint64_t const fair = sum / static_cast<std::uint64_t>(ranks.size());
    if (is_divided_ && largest <= fair + fair / 4 + 16) return;
    std::vector<S> there;
    together(ranks, [&] { there = part.centres_somewhere(); });
    bricks_.build(ranks, there);
    together(ranks, [&] { lookup_ = bricks_.lookup(part.space(), subdomain_memory_); });
    is_divided_ = true;
  }

  /// Brings particles to where they are to be, and finds what contacts of those that are then here remember. What this
  /// takes is not kept.
  template <class Ranks>
  void move(Ranks const& ranks, Part& part, [[maybe_unused]] typename Part::contact_rows& contacts) {
    send_plan leaving;
    device_exchange_buffer<all_row> going, coming;
    [[maybe_unused]] std::vector<std::pair<id, int>> ranks_of;
    together(ranks, [&] {
      part.find_leaving(lookup_, ranks.rank(), ranks.size(), leaving);
      part.pack_all(leaving, going);
      if constexpr (Part::remembers_pairs || Part::remembers_surfaces) {
        contacts = part.contacts();
        ranks_of = part.new_ranks(leaving);
      }
    });
    deliver(ranks, part.space(), going, coming);
    auto const rank_of = [&](id number) {
      auto const found = std::lower_bound(ranks_of.begin(), ranks_of.end(), std::pair<id, int>(number, 0));
      return found != ranks_of.end() && found->first == number ? found->second : ranks.rank();
    };
    if constexpr (Part::remembers_pairs) deliver_rows(ranks, contacts.pairs, rank_of);
    if constexpr (Part::remembers_surfaces) deliver_rows(ranks, contacts.surfaces, rank_of);
    together(ranks, [&] { part.replace(leaving, coming); });
  }

  side_stream<space_type> side_;
  bisection bricks_;
  buffer<subdomain> subdomain_memory_;
  subdomain_lookup lookup_{};
  bool is_divided_ = false;
  send_plan copied_;  ///< this rank's particles of which others have copies
  device_exchange_buffer<seen_row> sent_, received_;
};

}  // namespace collide::detail
