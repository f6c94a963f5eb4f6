"""mutate.py names | table [FILE] | precompile FOLDER | judge NAME --rows FOLDER | guarded PROGRAM [--digest FILE]: the guards
of `exact`, one by one.

Every mutation takes a guard out of the library, or loosens it; a small program, compiled with that, must then find
something wrong, or fail; and nothing with the library as it is. The rows that it judges are those of tests/data, those
of hunted_*.csv, which were looked for because no others show the guards that they name, and cases next to contact: see
make_rows.cpp. `precompile` compiles ../standard.hpp for all compilers, into the folder of the rows. `names` prints each mutation and the
program that judges it, `table` the lists of all mutations and of guards that no row shows, or writes them to a file.
`guarded` prints the files on which the verdicts of a program depend, and writes their digest into its line of a file; the
one beside this script, `judged`, is of the files that all mutations were last seen to be found in.
"""
import argparse
import hashlib
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
LIBRARY = pathlib.Path("collide")
SKIPPED = 77

COMPILERS = {
    "plain": "g++ -O1",
    "fast": "g++ -O2 -ffast-math",
    "checked": "g++ -O1 -fsanitize=address",
    "clang-fast": "clang++ -O2 -ffast-math",
}

# The regions of Ericson are right as they are; the weights are kept in their limits for what they might be. This guard
# has a name of its own.
NO_REGIONS = [("regions", """    v = select(inside, v_there, v);
    w = select(inside, w_there, w);
    weight_sum = select(inside, weight_sum_there, weight_sum);
""", "")]

# name: (what goes without the guard, program, compiler, [(text of the guard, what takes its place)]). The guard stands
# behind the comment `// guard: name` of one header. Names in its text stand for whatever is called so there now, names in
# what takes its place for the same: a header is renamed, moved and formatted without a change here.
MUTATIONS = {
    "error": ("the error of a length, 32 units: 3 instead", "stages", "plain",
              [("error = 32 * ieee_traits<T>::unit_roundoff", "error = 3 * ieee_traits<T>::unit_roundoff")]),
    "error-of-hit": ("that error in hits", "stages", "plain", [("t.radius - error", "t.radius")]),
    "error-of-miss": ("that error in misses", "stages", "plain", [("t.radius + error", "t.radius")]),
    "inner": ("a radius below its error gives no hit", "stages", "plain",
              [("(radius_low > 0) & ", "")]),
    "least": ("a direction that the triangle reaches to both sides of separates nothing", "stages", "plain",
              [("(least > 0) & ", "")]),
    "shortest": ("squared lengths that have lost digits to underflow", "stages", "plain",
                 [("(gg >= bounds::shortest) & ", "")]),
    "v-from-below": ("v >= 0, whatever the region", "stages", "plain",
                     [*NO_REGIONS, ("v = saturate(mul_rn(v, inverse))", "v = mul_rn(v, inverse) < 1 ? mul_rn(v, inverse) : 1")]),
    "v-from-above": ("v <= 1, whatever the region", "stages", "plain",
                     [*NO_REGIONS, ("v = saturate(mul_rn(v, inverse))", "v = mul_rn(v, inverse) > 0 ? mul_rn(v, inverse) : 0")]),
    "w-from-below": ("w >= 0, whatever the region", "stages", "plain",
                     [*NO_REGIONS, ("limited = saturate(mul_rn(w, inverse))", "limited = mul_rn(w, inverse)")]),
    "v-and-w": ("v + w <= 1, whatever the region", "stages", "plain",
                [*NO_REGIONS, ("select(limited < remainder, limited, remainder)", "limited")]),
    "smallest": ("sizes below which squares underflow", "stages", "plain",
                 [("size >= bounds::smallest && ", "")]),
    "largest": ("sizes above which products overflow", "stages", "fast",
                [("size >= bounds::smallest && size <= bounds::largest", "size >= bounds::smallest")]),
    "floor-of-float": ("sizes at which flushed subnormal numbers show, float", "stages", "plain",
                       [("T(0x1p-60) : T(0x1p-900)", "T(0x1p-126) : T(0x1p-900)")]),
    "floor-of-double": ("the same, double", "stages", "plain",
                        [("T(0x1p-60) : T(0x1p-900)", "T(0x1p-60) : T(0x1p-1022)")]),
    "scaling": ("scaling to a size that squares bear", "stages", "plain",
                [("  p = scaled(p, inverse_power_of_two(size));\n", "")]),
    "box": ("the box test where subnormal numbers are flushed", "stages", "plain",
            [("max(l.radius, ieee_traits<S>::min_sum_under_ftz)", "l.radius")]),
    "size-in-float": ("no filter in float at the wrong size", "stages", "plain",
                      [("  if (!rescale_to_filter_range<S>(l, size)) return {verdict::uncertain, stage::single_filter};\n",
                        "  rescale_to_filter_range<S>(l, size);\n")]),
    "size-in-double": ("no filter in double at the wrong size", "stages", "plain",
                       [("  if (rescale_to_filter_range<double>(l, size)) {", "  rescale_to_filter_range<double>(l, size);\n  {")]),
    "bad-radius": ("radii that are negative or NaN", "stages", "plain",
                   [("!is_valid_radius(s.radius) || ", "")]),
    "bad-centre": ("centres that are not finite", "stages", "plain", [("!is_valid_radius(s.radius) || !is_finite(s.centre)", "!is_valid_radius(s.radius)")]),
    "bad-corner": ("corners that are not finite", "stages", "plain", [(" || !is_finite(t)", "")]),
    "infinite-radius": ("an infinite radius reaches all", "stages", "plain",
                        [("  if (is_infinite(s.radius)) return {true, stage::exact_integers};\n", "")]),
    "finite": ("finite numbers are known by their bits", "stages", "clang-fast",
               [("return (to_bits(x) & ieee_traits<T>::exponent_mask) != ieee_traits<T>::exponent_mask", "return x - x == 0")]),
    "finite-corner": ("finite corners are known by their bits", "stages", "clang-fast",
                      [("return max(max(largest_bits(t.a), largest_bits(t.b)), largest_bits(t.c)) < ieee_traits<T>::exponent_mask",
                        "return (t.a[0] + t.a[1] + t.a[2] + t.b[0] + t.b[1] + t.b[2] + t.c[0] + t.c[1] + t.c[2]) * 0 == 0")]),
    "valid-radius": ("valid radii are known by their bits", "stages", "fast",
                     [("return u <= ieee_traits<T>::exponent_mask || u == ieee_traits<T>::sign_mask",
                       "return r >= 0 || u == ieee_traits<T>::sign_mask")]),
    "difference": ("a difference is one number only if 62 bits suffice", "stages", "plain",
                   [("high.length() + shift > 61", "high.length() + shift > 65")]),
    "carry": ("the carry from digit to digit", "stages", "plain",
              [("digits_[i] + carry", "digits_[i]")]),
    "window-carry": ("the carry from window to window", "stages", "plain",
                     [("begin_ += window_digits) {", "begin_ += window_digits) { carry = 0;")]),
    "product-carry": ("the carry within a product", "stages", "plain",
                      [("carry = (carry >> 32) + (first >> 32)", "carry = (first >> 32)")]),
    "product-room": ('memory for a product of six', 'stages', 'checked',
        [('product[2 * Product::most_factors + 1]', 'product[2 * Product::most_factors - 1]')]),
    "spare": ("digits for the sign of the sum: 32 bits fewer", "stages", "plain",
              [("carry_bits = 24", "carry_bits = -8")]),
    "sign": ("the signs of factors", "stages", "plain",
             [("negative = negative != (f.mantissa < 0)", "")]),
    "twice": ('weights of 2', 'stages', 'plain',
        [(' + magnitude_exponent', '')]),
    "subnormal": ("the exponent of subnormal numbers", "stages", "plain",
                  [("max(biased, 1) -", "biased -")]),
    "hidden-bit": ("the leading bit of subnormal numbers", "stages", "plain",
                   [("biased == 0 ? fraction : fraction", "fraction")]),
    "first-digit": ("products that begin below the window", "stages", "plain",
                    [("first + words < 0", "first < 0")]),
    "last-digit": ("bits that a shift moves into one more digit", "stages", "plain",
                   [("i <= words; ++i", "i < words; ++i")]),
    "window": ("digits outside of the window", "stages", "checked",
               [("first + i >= 0 && first + i < window_digits", "first + i >= 0")]),
    "widened": ("subnormal floats that the hardware takes for zero", "stages", "plain",
                [("  if (magnitude >> f::mantissa_bits != 0) return", "  return")]),
    "touching": ("touching counts", "stages", "plain",
                 [("excess(projection, false).value >= 0", "excess(projection, false).value > 0")]),
    "over-face": ("a degenerate triangle has no face", "stages", "plain",
                  [("if (side_of_edge(i) <= 0) return false", "if (side_of_edge(i) < 0) return false")]),
    "edge-begin": ("the projection is not before the edge", "stages", "plain",
                   [("along(projection - 3, projection - 3, -1) > 0 && ", "")]),
    "edge-end": ("the projection is not beyond the edge", "stages", "plain",
                 [(" && along(projection - 3, (projection + 1) % 3, 1) > 0", "")]),
    "fixed-shift": ("numbers that two words have no room for", "stages", "plain",
                    [("most_length = 126", "most_length = 128")]),
    "fixed-far": ("shifts by more than two words", "stages", "plain",
                  [("fits_ = fits_ && shift + d.length()", "fits_ = fits_ && (shift & 127) + d.length()")]),
    "fixed-unit": ("the radius is an integer, too", "stages", "plain",
                   [("    lower_exponent(s.radius);\n", "")]),
    "fixed-corner": ("edges and face are for corners out of reach", "stages", "plain",
                     [("      if (!diagonal[0].positive()) return true;\n", "")]),
    "fixed-edge": ("the projection is inside the edge", "stages", "plain", [("off_diagonal[0].negative() && ", "")]),
    "fixed-face": ("the projection is inside the face", "stages", "plain",
                   [("      if (!weight.positive()) return false;\n", "")]),
    "fixed-degenerate": ("a degenerate triangle has no face", "stages", "plain",
                         [("if (!weight.positive())", "if (weight.negative())")]),
    "fixed-touching-corner": ("touching a corner counts", "stages", "plain",
                              [("if (!diagonal[0].positive())", "if (diagonal[0].negative())")]),
    "fixed-touching-edge": ("touching an edge counts", "stages", "plain",
                            [("!(diagonal[0] * diagonal[1] - off_diagonal[0] * off_diagonal[0]).positive()",
                              "(diagonal[0] * diagonal[1] - off_diagonal[0] * off_diagonal[0]).negative()")]),
    "fixed-touching-face": ("touching the face counts", "stages", "plain",
                            [("!determinant.positive()", "determinant.negative()")]),
    "fixed-carry": ("the carry of a sum", "stages", "plain", [("+ y[i] + carry", "+ y[i]")]),
    "fixed-borrow": ("the borrow of a difference", "stages", "plain", [(" - borrow;", ";")]),
    "fixed-product-carry": ("the carry within a product", "stages", "plain",
                            [("product[i + k] + carry", "product[i + k]")]),
    "fixed-product-top": ("the carry that is the product's highest word", "stages", "plain",
                          [("    product[i + m] = carry;\n", "")]),
    "fixed-sign": ("the sign of the first factor", "stages", "plain",
                   [("  subtract_words(product.word + N, y.word, M, x.negative());\n", "")]),
    "fixed-second-sign": ("the sign of the second factor", "stages", "plain",
                          [("  subtract_words(product.word + M, x.word, N, y.negative());\n", "")]),
    "slack": ("the rounding of a bounding sphere", "stages", "plain",
              [("1 + 32 * S(ieee_traits<float>::unit_roundoff)", "1")]),
    "ball-underflow": ("squares in its radius that underflow", "stages", "plain",
                       [(" + 2 * sqrt_rn(std::numeric_limits<S>::min());", ";")]),
    "lifted-slack": ("the rounding of squares that cancel", "stages", "plain",
                     [("lifted_slack = 32 * ieee_traits<S>::unit_roundoff", "lifted_slack = 0 * ieee_traits<S>::unit_roundoff")]),
    "lifted-overflow": ("squares of a bounding sphere that overflow", "stages", "plain",
                        [("    if (is_finite(centre + square) && centre + square <= max_lifted_square<S>) return;\n", "    return;\n")]),
    "lifted-sphere": ("squares of a sphere that overflow", "stages", "plain",
                      [("      if (is_finite(centre + square) && centre + square <= max_lifted_square<S> && is_valid_radius(radius[k])) continue;\n",
                        "      continue;\n")]),
    "room": ("pairs that find no room on the list", "scenes", "checked",
             [("if (slot < capacity()) ", "")]),
    "listed": ("a list that lacks pairs is not used", "scenes", "checked",
               [("bool const all_were_stored = total <= deferred.capacity();", "bool const all_were_stored = true;")]),
    "first-step": ("what was certain is not reported again", "scenes", "plain",
                   [("        if (filter<NarrowPhase>(t, shape) != verdict::uncertain) continue;\n", "")]),
    "left-empty": ("the list is empty for the next query", "scenes", "plain",
                   [("      deferred.count->total = deferred.count->ready = 0;\n", "")]),
    "near-depth": ("depths of which doubles have too few digits", "contacts", "plain",
                   [(" && (!exact_depth || depth >= enough || depth <= -enough)", "")]),
    "double-input": ("doubles in, doubles out: twice the digits, or exact", "contacts", "plain",
                     [("sizeof(S) == sizeof(float) ? digits::of_float : digits::of_double", "digits::of_float")]),
    "compensated-depth": ("depths that even twice the digits are too few for", "contacts", "plain",
                          [("exact_depth ? min(away, mul_rn(depth < 0 ? -depth : depth, scale)) : away", "away")]),
    "compensated-length": ("distances that even twice the digits are too few for", "contacts", "plain",
                           [("  if (!(mul_rn(mul_rn(least, least), nearest.sine_squared) >= 0x1p-84)) return false;\n", "")]),
    "compensated-doubt": ("projections of which doubles do not know whether they are there", "contacts", "plain",
                          [("!nearest.certain && ", "false && ")]),
    "compensated-nearest": ("projections that doubles take for farther by mistake", "contacts", "plain",
                            [("error = 0x1p-43, ", "error = 0, ")]),
    "compensated-scale": ("lengths that under- or overflow", "contacts", "plain",
                          [("  if (!(scale >= 0x1p-1000 && scale <= 0x1p850)) return false;\n", "")]),
    "depth-of-a-tie": ("a centre on the triangle and a radius of 0", "contacts", "plain",
                       [("    if (above.value == 0) return {distance, 0};\n", "")]),
    "equally-deep": ("of projections that are equally deep the closest", "contacts", "plain",
                     [("there.depth > there.distance ? there.distance < to_nearest.distance : there.depth", "there.depth")]),
    "near-feet": ("projections that doubles take for farther by mistake", "contacts", "plain",
                  [("sqrt_rn(around) + 0x1p-40", "sqrt_rn(around)"), ("mul_rn(mul_rn(reach, reach), 1 + 0x1p-40)", "mul_rn(reach, reach)")]),
    "power-below": ('powers of two beyond the range, below', 'contacts', 'plain',
        [('  for (; n < -1000; n += 1000) x *= 0x1p-1000;\n', '')]),
    "bounds": ('the error of the bounds of a distance', 'nearest', 'plain',
        [('mul_rn(64 * u, size)', 'mul_rn(0 * u, size)')]),
    "bounds-certain": ('a region is certain only if rounding does not matter', 'nearest', 'plain',
        [('certain = inside ? surely : certain;', 'certain = true;')]),
    "bounds-smallest": ('sizes at which flushed subnormal numbers show', 'nearest', 'plain',
        [('size >= smallest && ', '')]),
    "bounds-least": ('a direction that the triangle reaches to both sides of separates nothing', 'nearest', 'plain',
        [('!(along > 0) || ', '')]),
    "nearest-tie": ('of equally near triangles the lowest number', 'nearest', 'plain',
        [('order < 0 || (order == 0 && number < number_)', 'order < 0')]),
    "nearest-certain": ('features that are one are known for certain', 'nearest', 'plain',
        [('certain_ && found.certain && is_same_foot', 'is_same_foot')]),
    "nearest-projection": ('features that doubles are not sure of', 'nearest', 'plain',
        [('certain_ ? foot_ : closest_foot(t, p)', 'foot_')]),
    "nearest-reach": ('the largest distance is kept exactly', 'nearest', 'plain',
        [('number_ == no_id || !is_within_reach()', 'number_ == no_id')]),
    "nearest-fit": ('numbers that two words have no room for', 'nearest', 'plain',
        [('most_bits = 124', 'most_bits = 999')]),
    "nearest-face": ('the projection is inside the face', 'nearest', 'plain',
        [('weight[0].positive() && ', '')]),
    "nearest-edge-begin": ('the projection is not before the edge', 'nearest', 'plain',
        [('before.positive() && ', '')]),
    "nearest-edge-end": ('the projection is not beyond the edge', 'nearest', 'plain',
        [('after.positive() && ', '')]),
    "nearest-edge-side": ("the projection is not beyond the edge's line", 'nearest', 'plain',
        [(' && !weight[2].positive()', '')]),
    "nearest-rough": ('the error of rough quotients', 'nearest', 'plain',
        [('mul_rn(right, 0x1p-48)', '0')]),
    "four-fold": ('weights of 4', 'nearest', 'plain',
        [('magnitude / 2;', 'magnitude > 1 ? 1 : 0;')]),
    "ray-moved": ('a ray through an edge or a corner is moved', 'nearest', 'plain',
        [('  return a.y() != b.y() ? (b.y() < a.y() ? 1 : -1) : sign_of(b.x() - a.x());\n', '  return 0;\n')]),
    "ray-moved-twice": ('along an edge, it is moved beside it', 'nearest', 'plain',
        [(' : sign_of(b.x() - a.x());', ' : 0;')]),
    "ray-sides": ('the error of sides in a ray by itself', 'nearest', 'plain',
        [('mul_rn(16 * u, area)', '0')]),
    "ray-along": ('the error of the height above its beginning', 'nearest', 'plain',
        [('mul_rn(128 * u, mul_rn(area, size))', '0')]),
    "lane-sides": ('the same in lanes', 'nearest', 'plain', [('= 16 * u * area', '= 0')]),
    "lane-along": ('the error of the height in lanes', 'nearest', 'plain',
        [('128 * u * area * from_bits<S>(along)', '0')]),
    "ray-side": ('the error of a side', 'nearest', 'plain',
        [('mul_rn(sum, 8 * ieee_traits<double>::unit_roundoff)', '0')]),
    "ray-height": ('the error of a height', 'nearest', 'plain',
        [('mul_rn(sum, 32 * ieee_traits<double>::unit_roundoff)', '0')]),
    "ray-surface": ('a point on the surface is inside, also where the ray does not cross it', 'nearest', 'plain',
        [(' || (on_line && intersects_exact(t, sphere<S>{point_, 0}).hit)', '')]),
    "measured-edge": ('edges for which twice the digits are too few', 'nearest', 'plain',
        [('    if (!(by.high >= limit && square.high >= mul_rn(limit, by.high))) return false;\n', '')]),
    "measured-face": ('the same, faces', 'nearest', 'plain',
        [('(is_on || mul_rn(height.high, height.high) >= limit)', 'true')]),
    "measured-level": ('a point on a face across an axis', 'nearest', 'plain',
        [(' && t.c[k] == point[k])', ')')]),
    "pair-axis": ('an axis along which a triangle is seen as one', 'triangles', 'plain',
        [('while (turn_ == 0 && ++axis_ < 3)', 'while (false)')]),
    "pair-same": ('triangles of the same corners overlap', 'triangles', 'plain',
        [('if (shared == 3) return true;', '')]),
    "pair-shared-edge": ('an edge that two triangles share is not where they meet', 'triangles', 'plain',
        [('if (p_at != 3 && q_at != 3) return false;', '')]),
    "pair-shared-corner": ('an edge from a corner that they share has to be in the plane', 'triangles', 'plain',
        [('return in_plane && begins_inside', 'return begins_inside')]),
    "pair-begins": ('and has to begin in the triangle, as seen from both edges', 'triangles', 'plain',
        [(' && side_of_edge(next(next(k)), to) >= 0', '')]),
    "pair-plane": ('an edge in the plane', 'triangles', 'plain',
        [('if (in_plane) return meets_in_plane(p, q);', '')]),
    "pair-one-side": ('an edge on one side of the plane', 'triangles', 'plain',
        [('if (h[i] * h[next(i)] > 0) return false;', '')]),
    "pair-through": ('an edge that goes through the plane beside the triangle', 'triangles', 'plain',
        [('!(left && right)', 'true')]),
    "pair-along-edge": ('a line along an edge of the triangle, between it and a segment', 'triangles', 'plain',
        [('if (side_of_edge(k, p) < 0 && side_of_edge(k, q) < 0) return false;', '')]),
    "pair-along-segment": ('a line along the segment', 'triangles', 'plain',
        [('!left && !right', 'true')]),
}

# The same without a mutation: nothing may be wrong.
SOUND = {f"none.{program}.{compiler}": (None, program, compiler, [])
         for program, compiler in sorted({m[1:3] for m in MUTATIONS.values()})}
SOUND["none.regions"] = (None, "stages", "plain", NO_REGIONS)

# (file, the text of the guard, with any names, why no row goes wrong without it)
UNSEEN = [
    ('exact/detail/predicates/exact_ray.hpp', 'size >= smallest && size <= 0x1p140', 'numbers that are flushed to zero decide wrongly only where they are among a few others as small: test_ray_parity.cpp has such, and fails without it'),
    ('narrow/detail/measure_nearest.hpp', 'scale >= 0x1p-1000 && scale <= 0x1p850', 'differences that overflow become NaN, which the tests that follow refuse; those that are scaled up stay exact'),
    ('narrow/detail/distance_bounds.hpp', ' && size <= most)', 'products that overflow are infinite or NaN: no comparison holds that would separate, and the upper bound is infinite'),
    ("exact/detail/predicates/exact.hpp", "if (square.value == 0) return {0, -4000};",
     "a distance of 0 has no exponent; the depth, which then is infinite or too large, is limited by the radius, and that is right"),
    ("exact/detail/predicates/fixed_width.hpp", "static constexpr int most_bits = 126;",
     "no more bits than products have room for; no row has a number from 2^126 to 2^127"),
    ("exact/detail/geometry/lifted_bounds.hpp", "lifted_radius_slack = 32 * S(ieee_traits<float>::unit_roundoff)",
     "is for narrow phases that compute in float; of real contacts the other slack takes care"),
    ("exact/detail/geometry/lifted_bounds.hpp", "32 * std::numeric_limits<S>::min()", "the bounding radius has room for squares that underflow already"),
    ("exact/detail/geometry/bounding_sphere.hpp", "if (!is_finite(far_squared)) return {m.x()",
     "the root of infinity is infinity, but a NaN with -ffast-math in kernels that read the bounding sphere from memory; "
     "`verdicts` saw it until the host came to do without bounding spheres"),
    ("exact/detail/predicates/filter.hpp", " | !has_radius",
     "below 0 `radius_low > 0` fails, and with NaN every comparison; -ffinite-math-only promises neither, but g++ and clang++ do so"),
    ("exact/detail/predicates/filter.hpp", "bad = !sound",
     "weights are limited by selection, so a NaN becomes 0, and no comparison holds that follows; the same compilers"),
    ("exact/detail/predicates/filter.hpp", " && size <= std::numeric_limits<T>::max()",
     "an infinite coordinate makes `weight_sum` infinite or NaN, an infinite radius `radius_low` NaN; the same compilers"),
    ("exact/detail/predicates/filter.hpp", "weight_sum > std::numeric_limits<T>::min()",
     "dividing by 0 gives NaN or limited weights, and so no result of the filter; the same compilers, and the limits of `__fdividef`"),
    ("exact/detail/numeric/float_bits.hpp", "max(r, 1)", "a subnormal power of two is as good where it is not flushed to zero"),
    ("narrow/detail/contact.hpp", "distance >= enough && (!exact_depth",
     "no row of floats has a distance so small and a depth so large that doubles lack the digits"),
    ("narrow/detail/contact_compensated.hpp", "if (sine_squared < 0x1p-80)",
     "a triangle that thin and a centre that near its edges would have to be below 2^-25 of the size at once"),
    ("exact/detail/predicates/exact.hpp", "for (; n > 1000; n -= 1000)", "no row has so large a power: a number beyond the range would follow"),
    ("exact/detail/numeric/rounding.hpp", "T volatile const kept = x",
     "C0 needs it where a compiler may reassociate; g++ 12 and clang++ 14 do not here, with -ffast-math"),
    ("broad/detail/grid/plan.hpp", "g.reach * (1 + 4 * S(ieee_traits<float>::unit_roundoff))", "is for single precision; `exact` needs lo - c <= r only"),
    ("broad/detail/grid/plan.hpp", " + 64 * ieee_traits<S>::unit_roundoff * far",
     "rounding is monotone, so lo - r <= c implies fl(lo - r) <= c; is for compilers that reassociate"),
]


TOKEN = re.compile(r"\s+|0x[\da-f.]+(?:p[+-]?\d+)?|\d[\w.]*|std::\w+(?:::\w+)*|[A-Za-z_]\w*|.", re.DOTALL)
LANGUAGE = set("bool char const constexpr continue double false float for if inline int long return short signed sizeof static true unsigned void volatile".split())


def tokens(text):
    """The text's tokens, and whether each is a name."""
    for token in TOKEN.findall(text):
        if not token.isspace():
            yield token, re.match(r"[A-Za-z_]", token) and not token.startswith("std::") and token not in LANGUAGE


def pattern_of(text):
    """A regular expression for the text with any names, and the group of each name."""
    groups, parts = {}, []
    for token, is_name in tokens(text):
        if not is_name:
            parts.append(re.escape(token))
        elif token in groups:
            parts.append(rf"(?P={groups[token]})\b")
        else:
            groups[token] = f"n{len(groups)}"
            parts.append(rf"\b(?P<{groups[token]}>[A-Za-z_]\w*)\b")
    return r"\s*".join(parts), groups


def headers():
    return {p.relative_to(ROOT / "include" / LIBRARY).as_posix(): p.read_text() for p in sorted((ROOT / "include" / LIBRARY).rglob("*.hpp"))}


def place_of(guard, texts):
    """The header with the guard of this name, and where the comment ends that names it."""
    found = [(file, comment.end()) for file, text in texts.items()
             for comment in re.finditer(r"// guard: ([\w, -]+)\n", text) if guard in comment[1].split(", ")]
    if len(found) != 1:
        raise SystemExit(f"{len(found)} headers have the comment `// guard: {guard}`")
    return found[0]


def mutated(name):
    """The file that a mutation changes, and its new text."""
    texts = headers()
    file = text = None
    for edit in (SOUND | MUTATIONS)[name][-1]:
        guard, old, new = edit if len(edit) == 3 else (name, *edit)
        file, begin = place_of(guard, texts)
        text = texts[file]
        pattern, groups = pattern_of(old)
        found = re.compile(pattern).search(text, begin, begin + len(old) + 400)
        if not found:
            raise SystemExit(f"{name}: this does not stand behind `guard: {guard}` in {file}, by any names: {old}")
        written = "".join(found[groups[t]] if t in groups else t for t in TOKEN.findall(new))
        texts[file] = text = f"{text[:found.start()]} {written} {text[found.end():]}"
    return file, text


def included(sources):
    """The files of the repository, and those that they include, and so on."""
    found, left = set(), list(sources)
    while left:
        file = left.pop()
        if file not in found:
            found.add(file)
            for name in re.findall(r'#include [<"]([^>"]+)', file.read_text()):
                folders = (file.parent, ROOT / "include", ROOT / "tests" / "unit", ROOT / "tests" / "mutation", ROOT / "examples")
                left += [path.resolve() for folder in folders if (path := folder / name).is_file()][:1]
    return found


def guarded(program):
    """The files that a program is compiled from, and those that make the rows that it judges by."""
    tests = ROOT / "tests"
    source = (tests / "flags" if program == "verdicts" else HERE) / f"{program}.cpp"
    oracle = [*tests.glob("oracle/scene.*"), *tests.glob("oracle/exact.*"), *tests.glob("unit/narrow_phase/near_contact.*")]
    return sorted(included([source, HERE / "make_rows.cpp", *oracle])) + sorted([HERE / "mutate.py", *HERE.glob("*.csv"), *tests.glob("data/static_*.csv")])


def digest(program):
    """A number of what is guarded: another one if a file changes in more than its place, comments, includes and format."""
    def essence(file):
        text = file.read_text()
        if file.suffix in (".hpp", ".cuh", ".cpp"):
            text = "".join(re.sub(r"//[^\n]*|#include[^\n]*", "", text).split())
        return hashlib.sha256(text.encode()).hexdigest()
    return hashlib.sha256("".join(sorted(map(essence, guarded(program)))).encode()).hexdigest()


def write_digest(program, file):
    """Puts the program's digest into its line of a file, which begins as `judged`."""
    lines = dict(line.split() for line in (file if file.exists() else HERE / "judged").read_text().splitlines())
    lines[program] = digest(program)
    file.write_text("".join(f"{name} {lines[name]}\n" for name in sorted(lines)))


def precompile(folder, eigen):
    """Compiles what the library includes of others, for each compiler that is here."""
    for compiler, command in COMPILERS.items():
        command = command.split()
        if not shutil.which(command[0]):
            continue
        header = pathlib.Path(folder) / compiler / "standard.hpp"
        header.parent.mkdir(exist_ok=True)
        shutil.copy(HERE.parent / "standard.hpp", header)
        ending = ".gch" if command[0] == "g++" else ".pch"
        subprocess.run([*command, "-std=c++17", "-w", "-isystem", eigen, "-x", "c++-header", header, "-o", f"{header}{ending}"], check=True)


def judge(name, rows, eigen):
    """The first fault of the verdicts: None if there is none."""
    _, program, compiler, edits = (SOUND | MUTATIONS)[name]
    command = COMPILERS[compiler].split()
    if not shutil.which(command[0]):
        print(f"skipped: no {command[0]}")
        raise SystemExit(SKIPPED)
    with tempfile.TemporaryDirectory() as folder:
        place = pathlib.Path(folder)
        if edits:
            file, text = mutated(name)
            (place / LIBRARY / file).parent.mkdir(parents=True)
            (place / LIBRARY / file).write_text(text)
        source = ROOT / "tests" / ("flags" if program == "verdicts" else "mutation") / f"{program}.cpp"
        standard = pathlib.Path(rows) / compiler / "standard.hpp"
        included = ["-include", standard] if standard.exists() else []
        subprocess.run([*command, "-std=c++17", "-w", *included, f"-I{place}", f"-I{ROOT / 'include'}", "-isystem", eigen, source, "-o",
                        place / "program"], check=True)
        cases = ["float", ROOT / "tests" / "data" / "static_f32.csv"] if program == "verdicts" else [rows]
        result = subprocess.run([place / "program", *cases], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    if result.returncode == 0:
        return None
    broken = re.search(r"ERROR: AddressSanitizer: (\S+)", result.stderr)
    return broken[1] if broken else result.stdout.strip().split("\n")[-1] or f"ends with {result.returncode}"


def tables():
    yield "| mutation | takes away, or loosens | in | seen by |\n|---|---|---|---|\n"
    for name, (what, program, compiler, _) in MUTATIONS.items():
        file, _ = mutated(name)
        yield f"| `{name}` | {what} | `{file}` | `{program}`, `{COMPILERS[compiler]}` |\n"
    yield "\nNo row is known that goes wrong without these:\n\n| guard | in | why |\n|---|---|---|\n"
    for file, guard, why in UNSEEN:
        found = re.search(pattern_of(guard)[0], headers()[file])
        if not found:
            raise SystemExit(f"this does not stand in {file}, by any names: {guard}")
        shown = " ".join(found[0].split()).replace("|", r"\|")  # in a table a bar ends a cell, in code too
        yield f"| `{shown}` | `{file}` | {why} |\n"


def main():
    parser = argparse.ArgumentParser()
    commands = parser.add_subparsers(dest="command", required=True)
    commands.add_parser("names")
    commands.add_parser("table").add_argument("file", nargs="?", type=argparse.FileType("w"), default=sys.stdout)
    precompiled = commands.add_parser("precompile")
    precompiled.add_argument("folder")
    precompiled.add_argument("--eigen", default="/usr/include/eigen3")
    of_program = commands.add_parser("guarded")
    of_program.add_argument("program", choices={m[1] for m in (SOUND | MUTATIONS).values()})
    of_program.add_argument("--digest", type=pathlib.Path)
    one = commands.add_parser("judge")
    one.add_argument("name", choices=SOUND | MUTATIONS)
    one.add_argument("--rows", required=True, help="the folder that make_rows has written to")
    one.add_argument("--eigen", default="/usr/include/eigen3")
    args = parser.parse_args()

    if args.command == "names":
        print("\n".join(f"{name} {m[1]}" for name, m in (SOUND | MUTATIONS).items()))
        return 0
    if args.command == "table":
        args.file.write("# Mutations\n\n" + "".join(tables()))
        return 0
    if args.command == "guarded":
        print("\n".join(map(str, guarded(args.program))))
        if args.digest:
            write_digest(args.program, args.digest)
        return 0
    if args.command == "precompile":
        precompile(args.folder, args.eigen)
        return 0
    said = judge(args.name, args.rows, args.eigen)
    print(f"{args.name}: {said or 'nothing wrong'}")
    return (said is None) != (args.name in SOUND)


if __name__ == "__main__":
    sys.exit(main())
