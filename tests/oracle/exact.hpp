/// The truth that the tests compare with: sphere against triangle in exact rational arithmetic on the floating-point
/// numbers as they are. Shares no code, and no type, with the library.
#pragma once

#include <vector>

namespace oracle {

struct point {
  double x, y, z;
};

struct triangle {
  point a, b, c;
};

struct sphere {
  point centre;
  double radius;
};

/// The features of a triangle, as bits: a closest point lies on several where the triangle is a segment or a point.
enum feature_bits : unsigned {
  face = 1,
  edge_ab = 2,
  edge_bc = 4,
  edge_ca = 8,
  vertex_a = 16,
  vertex_b = 32,
  vertex_c = 64
};

/// Is min over x in conv(a, b, c) of |x - centre|^2 <= radius^2? The triangle may be a segment or a point; touching
/// counts. A NaN or infinite coordinate, a NaN or a negative radius: no. An infinite radius: yes. -0 is 0. Floats
/// convert to double without loss, so this is exact for both.
bool hit(triangle const& t, sphere const& s);

/// The same for a ball whose centre moves along the vector `move`: is min over x and t in [0, 1] of
/// |x - centre - t * move|^2 <= radius^2? A NaN or an infinity in `move`: no.
bool hit(triangle const& t, sphere const& s, point const& move);

/// The same with t in [0, time].
bool hit_by(triangle const& t, sphere const& s, point const& move, double time);

/// The same with t in [0, time): false if the first contact is at `time` or later. Exact except for contacts that are
/// earlier by less than 2^-300 * time.
bool hit_before(triangle const& t, sphere const& s, point const& move, double time);

/// The first time of contact, rounded up to a double, of a ball that touches the triangle on its way.
double impact_time(triangle const& t, sphere const& s, point const& move);

/// How a finite point lies to a finite triangle: exact, then rounded once to double.
struct closest_point {
  double distance;
  point on_triangle;
  point offset;       ///< on_triangle - p, without its cancellation
  unsigned features;  ///< feature_bits that contain the closest point in their relative interior
};
closest_point closest(triangle const& t, point const& p);

/// radius - distance, rounded once to double: no cancellation, whatever the depth.
double depth(triangle const& t, sphere const& s);

/// The distance of the triangle from the way from p to p + move, rounded once to double.
double distance(triangle const& t, point const& p, point const& move);

/// -1, 0 or 1: is p nearer to s than to t, as near, or farther? Exact.
int compare_distances(triangle const& s, triangle const& t, point const& p);

/// Do two spheres with their surfaces have a point in common? |a - b|^2 <= (r + s)^2 in integers; what is not finite
/// as for `hit`.
bool touch(sphere const& a, sphere const& b);

/// Is p in the closed mesh, or on its surface? Exact: triangles that a ray crosses, in a direction that meets no edge.
bool inside(std::vector<triangle> const& mesh, point const& p);

/// Have two triangles a point in common that is not of the hull of the corners that they share by equal coordinates? Or
/// do they share three? In rational numbers: one is cut off at the sides of the other. False if one has no area, or is
/// not finite.
bool meet(triangle const& s, triangle const& t);

}  // namespace oracle
