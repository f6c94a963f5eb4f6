/// \file
/// How much memory is taken, at most.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory_resource>

namespace io {

/// Passes everything on to another memory resource and keeps count of the bytes.
class counting_resource final : public std::pmr::memory_resource {
 public:
  explicit counting_resource(std::pmr::memory_resource* upstream) : upstream_{upstream} {}

  /// The most bytes that were taken at one time.
  std::size_t peak() const { return peak_; }

  /// Counts memory that was taken elsewhere.
  void add(std::size_t bytes) { peak_ = std::max(peak_, now_ += bytes); }

 private:
  void* do_allocate(std::size_t bytes, std::size_t alignment) override {
    void* const p = upstream_->allocate(bytes, alignment);
    add(bytes);
    return p;
  }
  void do_deallocate(void* p, std::size_t bytes, std::size_t alignment) override {
    now_ -= bytes;
    upstream_->deallocate(p, bytes, alignment);
  }
  bool do_is_equal(std::pmr::memory_resource const& other) const noexcept override { return this == &other; }

  std::pmr::memory_resource* upstream_;
  std::size_t now_ = 0;
  std::size_t peak_ = 0;
};

}  // namespace io
