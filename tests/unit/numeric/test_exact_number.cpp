/// Integers of a few words, modulo some primes and against 128 bits.
#include <cstdint>
#include <random>

#include <doctest/doctest.h>

#include <collide/exact/detail/numeric/exact_number.hpp>

namespace {

using collide::detail::int_words;
__extension__ typedef __int128 int128;
using collide::detail::uint128;

/// Words of which many are all ones or all zeros, where carries run far.
template <int N>
int_words<N> random_words(std::mt19937_64& engine) {
  int_words<N> x;
  for (auto& w : x.word) {
    std::uint64_t const any = engine();
    w = any % 4 == 0   ? 0
        : any % 4 == 1 ? ~std::uint64_t{0}
        : any % 4 == 2 ? std::uint64_t{1} << any / 4 % 64
                       : engine();
  }
  return x;
}

int128 as_128(int_words<2> const& x) { return static_cast<int128>(uint128{x.word[1]} << 64 | x.word[0]); }

/// An integer modulo p.
template <int N>
std::uint64_t modulo(int_words<N> const& x, std::uint64_t p) {
  uint128 rest = 0, power = 1;  // of the words so far, and 2^64 to the number of them
  for (std::uint64_t const w : x.word) {
    rest = (rest + power * (w % p)) % p;
    power = power * ((uint128{1} << 64) % p) % p;
  }
  return static_cast<std::uint64_t>(x.negative() ? (rest + p - power) % p : rest);
}

}  // namespace

TEST_CASE("exact number: integers of several words: sums, differences and signs are those of 128 bits") {
  std::mt19937_64 engine(1);
  for (int i = 0; i < 20000; ++i) {
    auto const x = random_words<2>(engine), y = random_words<2>(engine);
    uint128 const a = static_cast<uint128>(as_128(x)), b = static_cast<uint128>(as_128(y));
    CHECK((as_128(x + y) == static_cast<int128>(a + b)));
    CHECK((as_128(x - y) == static_cast<int128>(a - b)));
    CHECK(x.negative() == (as_128(x) < 0));
    CHECK(x.positive() == (as_128(x) > 0));
  }
}

TEST_CASE("exact number: integers of several words: products have all bits, whatever the signs") {
  std::mt19937_64 engine(2);
  for (int i = 0; i < 20000; ++i) {
    auto const a = random_words<1>(engine), b = random_words<1>(engine);
    int128 const wanted = int128{static_cast<std::int64_t>(a.word[0])} * static_cast<std::int64_t>(b.word[0]);
    CHECK((as_128(a * b) == wanted));
    auto const x = random_words<3>(engine);
    auto const y = random_words<2>(engine);
    int_words<5> const product = x * y;
    bool is_right = true;
    for (std::uint64_t const p :
         {std::uint64_t{0xffffffffffffffc5u}, std::uint64_t{0x1fffffffffffffffu}, std::uint64_t{10007}}) {
      auto const expected = static_cast<std::uint64_t>(uint128{modulo(x, p)} * modulo(y, p) % p);
      is_right = is_right && modulo(product, p) == expected;
    }
    CHECK(is_right);
  }
}
