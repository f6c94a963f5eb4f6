#include "checks.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include <doctest/doctest.h>

namespace tests {
namespace {

oracle::point operator-(oracle::point const& p, oracle::point const& q) { return {p.x - q.x, p.y - q.y, p.z - q.z}; }
double dot(oracle::point const& p, oracle::point const& q) { return p.x * q.x + p.y * q.y + p.z * q.z; }
double size(oracle::point const& p) { return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}); }

template <class S>
oracle::point exact(collide::vec3<S> const& v) {
  return {v.x(), v.y(), v.z()};
}

std::vector<oracle::id_pair> ids(std::vector<collide::pair> const& pairs) {
  std::vector<oracle::id_pair> copy;
  for (auto p : pairs) copy.push_back({p.sphere, p.triangle});
  return copy;
}

template <class S>
std::vector<collide::pair> pairs_of(std::vector<collide::contact<S>> const& contacts) {
  std::vector<collide::pair> pairs;
  for (auto const& c : contacts) pairs.push_back({c.sphere, c.triangle});
  return pairs;
}

template <class S>
void sort(std::vector<collide::contact<S>>& contacts) {
  std::sort(contacts.begin(), contacts.end(), [](auto const& a, auto const& b) {
    return collide::pair{a.sphere, a.triangle} < collide::pair{b.sphere, b.triangle};
  });
}

/// The pairs of a csr, sphere after sphere.
std::vector<collide::pair> pairs_of(rows const& found) {
  std::vector<collide::pair> pairs;
  for (std::size_t i = 0; i + 1 < found.offsets.size(); ++i) {
    for (std::uint64_t k = found.offsets[i]; k < found.offsets[i + 1]; ++k) {
      REQUIRE(k < found.triangles.stored.size());
      pairs.push_back({static_cast<collide::id>(i), found.triangles.stored[k]});
    }
  }
  return pairs;
}

template <class T>
bool same_bits(T const& a, T const& b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

/// The first pair that one list has and the other has not, for the message.
std::string difference(std::vector<oracle::id_pair> const& wanted, std::vector<oracle::id_pair> const& among) {
  for (auto p : wanted)
    if (!std::binary_search(among.begin(), among.end(), p))
      return "sphere " + std::to_string(p.sphere) + ", triangle " + std::to_string(p.triangle);
  return "";
}

/// Per sphere the contact with the closest triangle, of equally close ones that with the smallest number.
template <class S>
std::vector<collide::contact<S>> closest_of(std::vector<collide::contact<S>> const& contacts, std::size_t spheres) {
  collide::contact<S> none;
  std::memset(static_cast<void*>(&none), 0xff, sizeof none);
  none.distance = std::numeric_limits<S>::infinity();
  std::vector<collide::contact<S>> best(spheres, none);
  for (auto const& c : contacts)  // in canonical order
    if (auto& b = best[c.sphere]; b.triangle == collide::no_id || c.distance < b.distance) b = c;
  return best;
}

/// The closed feature as a (degenerate) triangle.
template <class S>
oracle::triangle feature_of(collide::contact<S> const& c, oracle::triangle const& t) {
  oracle::point const corners[3] = {t.a, t.b, t.c};
  auto const& from = corners[c.feature_index % 3];
  if (c.feature == collide::feature::face) return t;
  return {from, from, c.feature == collide::feature::edge ? corners[(c.feature_index + 1) % 3] : from};
}

template <class S>
unsigned feature_bit(collide::contact<S> const& c) {
  if (c.feature == collide::feature::face) return oracle::face;
  return (c.feature == collide::feature::edge ? oracle::edge_ab : oracle::vertex_a) << c.feature_index;
}

/// True if `x` is at most 4 units in the last place (of S) off; a number beyond the range of S must have become
/// infinite.
template <class S>
bool within_4_ulp(S x, double exact) {
  S const size = static_cast<S>(std::abs(exact));
  if (std::isinf(size)) return x == std::copysign(size, static_cast<S>(exact));
  S const next = std::nextafter(size, std::numeric_limits<S>::infinity());
  double const unit = std::isinf(next) ? double(size) - std::nextafter(size, S(0)) : double(next) - size;
  return std::abs(x - exact) <= 4 * unit;
}

}  // namespace

template <class S>
bool same(collide::contact<S> const& a, collide::contact<S> const& b) {
  return a.sphere == b.sphere && a.triangle == b.triangle && same_bits(a.point, b.point) &&
         same_bits(a.normal, b.normal) && same_bits(a.distance, b.distance) && same_bits(a.depth, b.depth) &&
         a.feature == b.feature && a.feature_index == b.feature_index;
}

template <class S>
bool same(std::vector<collide::contact<S>> const& a, std::vector<collide::contact<S>> const& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](auto const& x, auto const& y) { return same(x, y); });
}

template <class S>
void check_contact(collide::contact<S> const& c, oracle::triangle const& t, oracle::sphere const& s, bool strict) {
  CAPTURE(c.sphere);
  CAPTURE(c.triangle);
  auto const nearest = oracle::closest(t, s.centre);
  CHECK(within_4_ulp(c.distance, nearest.distance));
  CHECK(within_4_ulp(c.depth, oracle::depth(t, s)));

  // The point is rounded to S; its way from the centre has the errors of double.
  double const unit = std::numeric_limits<S>::epsilon(), noise = 0x1p-48;
  double const seen = std::max({size(t.a - s.centre), size(t.b - s.centre), size(t.c - s.centre)});
  auto const point = exact<S>(c.point), normal = exact<S>(c.normal);
  double const place =
      2 * unit * size(point) + noise * (size(s.centre) + seen) + 2 * std::numeric_limits<S>::denorm_min();
  REQUIRE(std::isfinite(size(point)));
  CHECK(oracle::closest(t, point).distance <= place);
  CHECK(std::abs(oracle::closest({point, point, point}, s.centre).distance - nearest.distance) <= place);

  CHECK(std::abs(std::sqrt(dot(normal, normal)) - 1) <= 4 * unit);
  if (nearest.distance > std::numeric_limits<double>::min())
    CHECK(std::abs(dot(normal, nearest.offset) / nearest.distance + 1) <= 8 * unit);
  // (several feet may be nearer than the smallest number, and then each may count as the closest)
  if (nearest.distance == 0 && nearest.features == oracle::face && c.feature == collide::feature::face)
    for (auto const& edge : {t.b - t.a, t.c - t.b, t.a - t.c}) {
      double const length = size(edge);
      if (std::isfinite(length)) CHECK(std::abs(dot(normal, edge)) <= (8 * unit + 0x1p-30) * length);
    }

  CHECK(c.feature_index < (c.feature == collide::feature::face ? 1 : 3));
  if (strict)
    CHECK((nearest.features & feature_bit(c)) != 0);
  else
    CHECK(oracle::closest(feature_of(c, t), s.centre).distance <= nearest.distance + noise * seen);
}

template <class S>
void check_plain_contact(collide::contact<S> const& c, oracle::triangle const& t, oracle::sphere const& s,
                         double roundoff) {
  CAPTURE(c.sphere);
  CAPTURE(c.triangle);
  auto const nearest = oracle::closest(t, s.centre);
  double const seen = std::max({size(t.a - s.centre), size(t.b - s.centre), size(t.c - s.centre)});
  double const unit = std::numeric_limits<S>::epsilon(), tiny = 2 * std::numeric_limits<S>::denorm_min();
  double const most = std::numeric_limits<S>::max(), error = 0x1p11 * roundoff * seen;
  auto const close = [&](S x, double exact, double scale) {
    if (std::abs(exact) + error > most) return true;  // as far as numbers of S reach
    return std::abs(x - exact) <= error + 4 * unit * scale + tiny;
  };
  CHECK(close(c.distance, nearest.distance, nearest.distance));
  CHECK(close(c.depth, oracle::depth(t, s), s.radius + nearest.distance));
  auto const point = exact<S>(c.point), normal = exact<S>(c.normal);
  REQUIRE(std::isfinite(size(point)));
  if (seen < most / 4) {
    CHECK(oracle::closest(t, point).distance <= error + 2 * unit * (size(point) + size(s.centre)) + tiny);
  }
  CHECK(std::abs(std::sqrt(dot(normal, normal)) - 1) <= 8 * std::max(unit, 2 * roundoff));
  // where neither the distance nor the face is next to nothing, so that both have a direction
  double const shortest = std::min({size(t.b - t.a), size(t.c - t.b), size(t.a - t.c)});
  if (nearest.distance > seen / 16 && shortest > seen / 16 && c.feature != collide::feature::face) {
    CHECK(std::abs(dot(normal, nearest.offset) / nearest.distance + 1) <= 0x1p-10);
  }
}

template <class S>
std::vector<collide::pair> check_pairs(subject<S>& detector, oracle::expectation const& expected) {
  auto const pairs = detector.pairs(collide::order::canonical);
  auto const found = ids(pairs);
  bool const once_and_ordered =
      std::is_sorted(found.begin(), found.end()) && std::adjacent_find(found.begin(), found.end()) == found.end();
  CHECK(once_and_ordered);
  auto const& must = detector.exact() ? expected.exact : expected.certain;
  auto const& may = detector.exact() ? expected.exact : expected.possible;
  CHECK_MESSAGE(std::includes(found.begin(), found.end(), must.begin(), must.end()),
                "missed: " << difference(must, found));
  CHECK_MESSAGE(std::includes(may.begin(), may.end(), found.begin(), found.end()),
                "false hit: " << difference(found, may));
  return pairs;
}

template <class S>
findings<S> check_sinks(subject<S>& detector, scene<S> const& made, oracle::expectation const& expected) {
  findings<S> found;
  found.pairs = check_pairs(detector, expected);

  auto unordered = detector.pairs(collide::order::unspecified);
  std::sort(unordered.begin(), unordered.end());
  CHECK((unordered == found.pairs));
  CHECK(detector.count() == found.pairs.size());

  std::vector<std::uint8_t> flags(made.spheres.size(), 0);
  for (auto p : found.pairs) flags[p.sphere] = 1;
  CHECK((detector.any() == flags));

  found.contacts = detector.contacts(collide::order::canonical);
  CHECK((pairs_of(found.contacts) == found.pairs));
  auto unordered_contacts = detector.contacts(collide::order::unspecified);
  sort(unordered_contacts);
  CHECK(same(unordered_contacts, found.contacts));
  auto visited = detector.visit();
  sort(visited);
  CHECK(same(visited, found.contacts));

  for (auto const asked : {collide::order::canonical, collide::order::unspecified}) {
    auto const rows = detector.csr(asked);
    CHECK(rows.offsets.size() == made.spheres.size() + 1);
    CHECK(rows.offsets.front() == 0);
    CHECK(rows.offsets.back() == rows.triangles.stored.size());
    auto listed = pairs_of(rows);
    if (asked == collide::order::unspecified) std::sort(listed.begin(), listed.end());
    CHECK((listed == found.pairs));
  }

  found.closest = detector.closest();
  CHECK(same(found.closest, closest_of(found.contacts, made.spheres.size())));
  return found;
}

template <class S>
std::vector<oracle::id_pair> check_all(scene<S> const& made, conditions const& how) {
  auto const expected = made.expect(how.band);
  for (char const* precision : precisions) {
    findings<S> first;
    for (auto const& c : compositions<S>(precision)) {
      CAPTURE(c.name());
      auto const detector = c.make(how.policy);
      detector->build(made.mesh, how.mesh);
      detector->place(made.spheres, how.spheres);
      auto const found = check_sinks(*detector, made, expected);
      if (first.closest.empty()) {
        first = found;
        CHECK((found.pairs == c.narrow_phase(made)));
        std::size_t const stride = 1 + found.contacts.size() / 2000;  // the exact answers take microseconds each
        for (std::size_t i = 0; i < found.contacts.size(); i += stride) {
          auto const& contact = found.contacts[i];
          auto const& shape = made.mesh[contact.triangle];
          auto const& ball = made.spheres[contact.sphere];
          if (precision == std::string("exact")) {
            check_contact(contact, shape, ball, how.band == 0);
          } else {
            check_plain_contact(contact, shape, ball, precision == std::string("single") ? 0x1p-24 : 0x1p-53);
          }
        }
      }
      CHECK((found.pairs == first.pairs));
      CHECK(same(found.contacts, first.contacts));  // and so the closest, which follow from the contacts
    }
  }
  return expected.possible;
}

template bool same(collide::contact<float> const&, collide::contact<float> const&);
template bool same(std::vector<collide::contact<float>> const&, std::vector<collide::contact<float>> const&);
template void check_contact(collide::contact<float> const&, oracle::triangle const&, oracle::sphere const&, bool);
template void check_plain_contact(collide::contact<float> const&, oracle::triangle const&, oracle::sphere const&,
                                  double);
template std::vector<collide::pair> check_pairs(subject<float>&, oracle::expectation const&);
template findings<float> check_sinks(subject<float>&, scene<float> const&, oracle::expectation const&);
template std::vector<oracle::id_pair> check_all(scene<float> const&, conditions const&);
template bool same(collide::contact<double> const&, collide::contact<double> const&);
template bool same(std::vector<collide::contact<double>> const&, std::vector<collide::contact<double>> const&);
template void check_contact(collide::contact<double> const&, oracle::triangle const&, oracle::sphere const&, bool);
template void check_plain_contact(collide::contact<double> const&, oracle::triangle const&, oracle::sphere const&,
                                  double);
template std::vector<collide::pair> check_pairs(subject<double>&, oracle::expectation const&);
template findings<double> check_sinks(subject<double>&, scene<double> const&, oracle::expectation const&);
template std::vector<oracle::id_pair> check_all(scene<double> const&, conditions const&);

}  // namespace tests
