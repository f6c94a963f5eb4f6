/// The few smallest of many numbers.
#include <algorithm>
#include <random>
#include <vector>

#include <doctest/doctest.h>

#include <collide/simulation/detail/neighbours/particle_order.hpp>

TEST_CASE("first neighbours: the smallest, each once and in order, whatever the order in which they come") {
  std::mt19937 random(1);
  for (std::size_t n = 0; n < 12; ++n) {
    for (int round = 0; round < 50; ++round) {
      std::vector<collide::id> numbers(n);
      for (auto& number : numbers) number = static_cast<collide::id>(random() % 8);
      collide::detail::first_neighbours<4> first;
      for (auto const number : numbers) first.add(number, 10 * number);
      std::sort(numbers.begin(), numbers.end());
      numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
      CHECK(first.complete == (numbers.size() <= 4));
      REQUIRE(first.size == std::min<std::size_t>(numbers.size(), 4));
      for (std::uint32_t k = 0; k < first.size; ++k) {
        CHECK(first.numbers[k] == numbers[k]);
        CHECK(first.places[k] == 10 * numbers[k]);
      }
    }
  }
}
