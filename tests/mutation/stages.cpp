/// stages ROWS: how many rows some stage of the filter gets wrong, subnormal numbers as they are or flushed to zero.
#include <cstdio>

#if defined(__SSE__)
#include <xmmintrin.h>
#endif

#include "rows.hpp"
#include "stages.hpp"

template <class S>
int count_wrong(std::vector<tests::row<S>> const& rows) {
  int wrong = 0;
  for (auto const& r : rows) wrong += tests::some_stage_is_wrong(r.triangle(), r.sphere(), r.hit()) ? 1 : 0;
  return wrong;
}

int main(int, char** argv) {
  auto const floats = tests::read_rows<float>(argv[1]);
  auto const doubles = tests::read_rows<double>(argv[1]);
  int wrong = count_wrong(floats) + count_wrong(doubles);
#if defined(__SSE__)
  _mm_setcsr(_mm_getcsr() | 0x8040);
  wrong += count_wrong(floats) + count_wrong(doubles);
#endif
  std::printf("%d wrong\n", wrong);
  return wrong != 0;
}
