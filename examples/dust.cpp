/// \file
/// Dust is blown over a plain, around boulders. The particles do not know of each other.

#include <collide/effects/absorb.hpp>
#include <collide/effects/bounce.hpp>
#include <collide/effects/gravity.hpp>
#include <collide/effects/wind.hpp>

#include "io/film_program.hpp"
#include "io/scenes/surfaces.hpp"

namespace {

using namespace collide;

/// Half a ball on the ground.
struct boulder {
  double x, y, radius;
};

constexpr int boulders = 3;

/// Wind along x that flows around the boulders: the potential flow past a ball, for each.
struct breeze {
  double speed;
  boulder rocks[boulders];

  template <class S>
  COLLIDE_HD vec3<S> operator()(vec3<S> const& x) const {
    vec3<S> v(S(speed), S(0), S(0));
    for (boulder const& rock : rocks) {
      vec3<S> const from(x.x() - S(rock.x), x.y() - S(rock.y), x.z());
      S const a = S(rock.radius), square = from.squaredNorm(), r2 = square > a * a ? square : a * a;
      S const strength = S(speed) * a * a * a / (2 * r2 * std::sqrt(r2));
      v -= from * (3 * strength * from.x() / r2);
      v.x() += strength;
    }
    return v;
  }
};

/// Dust rises in plumes from a line across the wind.
struct plumes {
  double speed;

  template <class S>
  COLLIDE_HD void operator()(std::uint64_t number, vec3<S>& x, vec3<S>& v) const {
    io::spot const at(number);
    double const plume = static_cast<double>(number % 14) - 6.5;
    x = {S(-3), S(0.28 * plume + 0.04 * at.anyhow[0]), S(0.16 + 0.14 * at.evenly[0])};
    v = {S(speed), S(0.04 * at.anyhow[0]), S(0.15 + 0.15 * at.anyhow[1])};
  }
};

template <class Space>
using dust =
    simulation<detector<bucket, karabassi<>, Space>, emit_from<plumes>, gravity, wind<breeze>, bounce, absorbing_box>;

constexpr double speed = 2.5;
constexpr boulder rocks[boulders] = {{-0.8, -0.5, 0.7}, {0.5, 0.9, 0.5}, {1.4, -0.6, 0.35}};

constexpr auto make = [](auto space, io::film const& film) {
  return dust<decltype(space)>(space, emit_from<plumes>{film.rate(), {speed}}, gravity{0, 0, -0.3},
                               wind<breeze>{3, 0, {speed, {rocks[0], rocks[1], rocks[2]}}}, bounce{0.1},
                               absorbing_box{{3, -10, -1}, {10, 10, 10}});
};

/// The plain and the boulders.
io::scene stage() {
  io::scene s;
  s.radius = 0.006;
  io::add_surface(s, 24, 16, false, [](double across, double along) {
    return io::point{6.4 * across - 3.2, 4.4 * along - 2.2, 0};
  });
  for (auto const& rock : rocks) {
    io::add_surface(s, 64, 16, false, [&](double across, double along) {
      double const u = 2 * 3.14159265358979 * across, v = 3.14159265358979 / 2 * along;
      double const d = rock.radius * std::cos(v);
      return io::point{rock.x + d * std::cos(u), rock.y + d * std::sin(u), rock.radius * std::sin(v)};
    });
  }
  return s;
}

}  // namespace

int main(int argc, char** argv) {
  return io::film_program(argc, argv, {"dust", "Dust is blown around boulders.", stage(), 0.002, 100'000, 4}, make);
}
