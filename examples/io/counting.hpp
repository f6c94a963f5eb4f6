/// \file
/// How much memory is taken.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory_resource>

namespace io {

/// Counts what goes through it to another resource.
class counting_resource final : public std::pmr::memory_resource {
 public:
  explicit counting_resource(std::pmr::memory_resource* upstream) : upstream_{upstream} {}

  std::size_t allocations = 0;  ///< how many there were
  std::size_t in_use = 0;       ///< bytes
  std::size_t peak = 0;         ///< the most bytes in use since it was last set to `in_use`

  /// Counts bytes that were taken elsewhere.
  void add(std::size_t bytes) { peak = std::max(peak, in_use += bytes); }

 private:
  void* do_allocate(std::size_t bytes, std::size_t alignment) override {
    void* const p = upstream_->allocate(bytes, alignment);
    ++allocations;
    add(bytes);
    return p;
  }
  void do_deallocate(void* p, std::size_t bytes, std::size_t alignment) override {
    in_use -= bytes;
    upstream_->deallocate(p, bytes, alignment);
  }
  bool do_is_equal(std::pmr::memory_resource const& other) const noexcept override { return this == &other; }

  std::pmr::memory_resource* upstream_;
};

}  // namespace io
