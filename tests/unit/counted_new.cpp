#include "counted_new.hpp"

#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <new>

// Not in a file that allocates: where the compiler sees through them it warns of memory that is not from new.

namespace {

std::atomic<std::size_t> news{0};

void* allocate(std::size_t bytes, std::size_t alignment) {
  ++news;
  std::size_t const whole = (bytes + alignment) / alignment * alignment;  // never 0
  if (void* const p = std::aligned_alloc(alignment, whole)) return p;
  throw std::bad_alloc();
}

}  // namespace

std::size_t tests::counted_news() { return news.load(); }

void* operator new(std::size_t bytes) { return allocate(bytes, alignof(std::max_align_t)); }
void* operator new(std::size_t bytes, std::align_val_t alignment) {
  return allocate(bytes, static_cast<std::size_t>(alignment));
}
void operator delete(void* p) noexcept { std::free(p); }
void operator delete(void* p, std::size_t) noexcept { std::free(p); }
void operator delete(void* p, std::align_val_t) noexcept { std::free(p); }
void operator delete(void* p, std::size_t, std::align_val_t) noexcept { std::free(p); }
