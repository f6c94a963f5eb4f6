"""Meshes, and what their queries find."""

import functools
import math
import os
import re
import warnings
from typing import Any, Iterable, Iterator, Literal, NamedTuple, get_args, overload

import numpy

from ._arrays import CUDA, arrays_of, device_of, library_of, module_for, of_list, stream_of, table
from ._errors import choice, real, refuse, whole

Array = Any  #: an array of numpy, torch, cupy, jax or warp, or anything with __dlpack__
Precision = Literal["exact", "double", "single"]
Order = Literal["unspecified", "canonical"]
Poses = Any  #: (bodies, 7) numbers of numpy or in lists: of each a position, and a unit quaternion w, x, y, z
PRECISIONS, ORDERS = get_args(Precision), get_args(Order)


class _field:  # noqa: N801: it is used like property
    """A property that shows a field of records, which has so many integers and numbers of the mesh's type before it: a
    column of numbers, or ``count`` of them, or of integers if that is 0. Its documentation is a line of its class'."""

    def __init__(self, integers, numbers=0, count=0):
        self.integers, self.numbers, self.count = integers, numbers, count

    def __set_name__(self, owner, name):
        found = re.search(rf"^ *{name}  +(.*(?:\n {{11,}}.*)*)", owner.__doc__ or "", re.MULTILINE)
        self.__doc__ = re.sub(r"\s+", " ", found[1]) if found else None  # Python -OO has none

    def __get__(self, of, owner=None):
        if of is None:
            return self
        word = 2 if of._is_wide else 1
        begin = self.integers + self.numbers * word
        if self.count == 0:
            return of._library.field(of.records, begin, None, "int32")
        begin += begin % word
        end = begin + self.count * word if self.count > 1 else None
        return of._library.field(of.records, begin, end, "float64" if of._is_wide else "float32")


class _Records:
    def __init__(self, library, records, wide, size):
        self.records = records  #: the memory of all: (..., words) int32, where a row is one result
        self._library, self._is_wide, self._size = library, wide, size

    def __len__(self) -> int:
        return self._size

    def __repr__(self):
        return f"<collide.{type(self).__name__}: {len(self)}>"


class Pairs(_Records):
    """Colliding pairs of a sphere and a triangle, each exactly once. ``sphere, triangle = pairs`` works, too.

    sphere         (n,) int32: numbers of the spheres
    triangle       (n,) int32: numbers of the triangles; -1 where a sphere has none (``closest``, ``first``)
    total          how many collide; more than len() where there was no room for all
    """

    def __init__(self, library, records, wide, size, total):
        super().__init__(library, records, wide, size)
        self.total = total

    @property
    def complete(self) -> bool:
        """Whether there was room for all of them."""
        return len(self) == self.total

    sphere: Array = _field(0)
    triangle: Array = _field(1)

    def __iter__(self) -> Iterator[Array]:
        return iter((self.sphere, self.triangle))

    def __repr__(self):
        return f"<collide.{type(self).__name__}: {len(self)} of {self.total}>"


class Contacts(Pairs):
    """Colliding pairs with their contacts: where and how each sphere touches each triangle.

    point          (n, 3): the point of the triangle that is closest to the centre
    normal         (n, 3): unit vector from the triangle to the centre; a normal of the triangle if the centre is on it
    distance       (n,): from the centre to the triangle; infinite where a sphere has none (``closest``)
    depth          (n,): radius - distance, how deep the triangle is in the sphere
    feature        (n,) int32: where on the triangle the point is: 0 face, 1 edge, 2 vertex
    feature_index  (n,) int32: edge 0 = ab, 1 = bc, 2 = ca; vertex 0 = a, 1 = b, 2 = c; face 0
    """

    point: Array = _field(2, 0, 3)
    normal: Array = _field(2, 3, 3)
    distance: Array = _field(2, 6, 1)
    depth: Array = _field(2, 7, 1)
    feature: Array = _field(2, 8)
    feature_index: Array = _field(3, 8)


class Impacts(Contacts):
    """Pairs that touch while the sphere moves, with the contact at the time of impact.

    time           (n,): when it first touches, 0 at the beginning of the displacement to 1 at its end; infinite where a
                   sphere touches nothing (``first``)
    """

    time: Array = _field(4, 8, 1)


class Nearest(_Records):
    """The nearest triangle of each point; of `Mesh.k_nearest` the k nearest, with the shape (n, k) in place of (n,).

    triangle       (n,) int32: numbers of the triangles; -1 where none is in reach
    distance       (n,): from the point to the triangle; infinite where none is in reach
    point          (n, 3): the nearest point of the triangle; NaN where none is in reach
    barycentric    (n, 3): weights of the triangle's corners that give the nearest point; not negative, with the sum 1
    feature        (n,) int32: where on the triangle the nearest point is: 0 face, 1 edge, 2 vertex
    feature_index  (n,) int32: edge 0 = ab, 1 = bc, 2 = ca; vertex 0 = a, 1 = b, 2 = c; face 0
    """

    triangle: Array = _field(0, 7)
    distance: Array = _field(0, 6, 1)
    point: Array = _field(0, 0, 3)
    barycentric: Array = _field(0, 3, 3)
    feature: Array = _field(1, 7)
    feature_index: Array = _field(2, 7)


class SignedDistance(Nearest):
    """The nearest triangle of each point, with a distance that is negative inside of a closed mesh and 0 on it.

    gradient       (n, 3): the gradient of the distance, a unit vector: from the surface to a point outside, from a point
                   inside to the surface. On the surface the normal (b - a) x (c - a) of the triangle
    """

    gradient: Array = _field(3, 7, 3)


class Winding(_Records):
    """How often a mesh winds around each point.

    value          (n,): 1 inside of a closed mesh whose normals point outwards, 0 outside; where closed parts overlap their
                   sum, so that above 1/2 is in their union. NaN of a point that is not finite
    error          (n,): how far the value may be from that of real arithmetic, at most
    """

    value: Array = _field(0, 0, 1)
    error: Array = _field(0, 1, 1)


class Seams(NamedTuple):
    """What `Mesh.validate_closed` has found, as arrays of numpy: rows of a triangle and its edge, 0 = ab, 1 = bc, 2 = ca."""

    message: str  #: a sentence on each problem; empty if there is none
    is_closed: bool  #: every edge has an even number of triangles: there is an inside
    is_oriented: bool  #: all normals point to one side
    open_edges: Array  #: (k, 2) int32: edges of one triangle only
    crowded_edges: Array  #: (k, 2): of three triangles or more
    flipped_edges: Array  #: (k, 2): of two triangles whose normals disagree
    duplicate_faces: Array  #: (k, 2): triangles that are there twice; the edge is 0


class Surface(NamedTuple):
    """What `Mesh.validate_surface` has found, as arrays of numpy: rows of two triangles."""

    message: str  #: a sentence on each problem; empty if there is none
    hanging_nodes: Array  #: (k, 2) int32: a corner of one lies in an edge of the other
    cracks: Array  #: (k, 2): a corner of each lie next to each other
    overlaps: Array  #: (k, 2): the two lie on each other in one plane


class Csr(NamedTuple):
    """Rows of triangles: those of sphere i are ``triangle[offsets[i]:offsets[i + 1]]``."""

    offsets: Array  #: (n + 1,) int64
    triangle: Array  #: (total,) int32


class Mesh:
    """A triangle mesh, and the queries that spheres may ask of it. Where its vertices lie, it runs.

    vertices   (n, 3) float32 or float64, of warp also (n,) vec3 or vec3d, in any unit of length. They are read where they
               are, not copied: keep them as they are while the mesh is used, or call `update` when they have changed.
               Here and in queries short lists (fewer than 1,000 numbers) are taken on the host, too; as float64.
    triangles  (m, 3) integers of 32 or 64 bits, of any strides: numbers of vertices, from 0. They are copied. None: rows
               3 i, 3 i + 1, 3 i + 2 of vertices are triangle i.
    bodies     parts that move as a whole, (first triangle, how many) of each, at most 64: queries take ``poses=`` of them
    validate   refuse triangles of vertices that are not there. O(m); on a GPU it waits for the result. Without it such
               a corner is the last vertex.
    threads    on the host: how many at most, and no more than there are cores. 0: as many as that where it pays.

    Raises TypeError for another dtype, ValueError for another shape, device, or triangles of vertices that are not
    there. The first query of a kind (at rest, moving, and each precision) prepares what depends on the mesh, O(m).

    Other Python threads run while a call works; two meshes may be used by two threads at once, calls to one mesh wait
    for each other. A call from within another one to the same mesh, as from a signal's handler, is an `Error`. In a forked
    process calls on the host use one thread; calls on a GPU are an `Error`, and so is a mesh that another thread was using
    at the fork. Ctrl-C ends a call on the host within a second, except for a sort of 10^8 pairs. Pickle and copy.deepcopy copy
    the arrays. On a GPU work is put on the current stream of the library that the centres are of, and a call waits only as
    far as it must read a number back: `any` does not, after a first call, if
    there is one radius or there are at most 262,144 triangles.
    """

    def __init__(self, vertices: Array, triangles: Array | None = None, *, bodies: Iterable[tuple[int, int]] = (),
                 validate: bool = True, threads: int = 0) -> None:
        vertices, triangles = of_list(vertices, "vertices", "float64"), of_list(triangles, "triangles", "int64")
        self._device = device_of(vertices, "vertices")
        self._library = library_of(vertices, self._device)
        module = module_for(self._device, "vertices")
        self._is_wide = _is_wide(vertices)
        self._dtype = "float64" if self._is_wide else "float32"
        self._threads = how_many_threads(threads)
        make = module.MeshDouble if self._is_wide else module.MeshFloat
        self._bodies = _parts(bodies)
        self._mesh = make(self._threads, self._device[1], self._bodies)
        self._mesh.take(stream_of(self._library, self._device), vertices, triangles, bool(validate))
        self._vertices, self._version, self._is_known_closed = vertices, 0, False

    @classmethod
    def of(cls, mesh: Any, **options: Any) -> "Mesh":
        """The mesh of an object of trimesh, meshio, PyVista (PolyData) or Open3D, with the options of `Mesh`: of its
        vertices, as they are, and its triangles. Raises ValueError where it has other faces or cells than triangles."""
        return cls(*arrays_of(mesh), **options)

    from_trimesh = of  #: the same

    def __reduce__(self):
        stream = stream_of(self._library, self._device)
        triangles = self._mesh.triangles(stream, self._library.is_numpy)
        if triangles is not None:
            triangles = self._library.array(triangles, stream)
        return functools.partial(Mesh, bodies=self._bodies, threads=self._threads), (self._vertices, triangles)

    def __len__(self) -> int:
        """How many triangles there are."""
        return len(self._mesh)

    def __repr__(self):
        place = "host" if self._device[0] != CUDA else f"GPU {self._device[1]}"
        return f"<collide.Mesh: {len(self)} triangles, {'float64' if self._is_wide else 'float32'}, {place}>"

    def update(self, vertices: Array, triangles: Array | None = None, *, validate: bool = True) -> None:
        """The mesh has moved: takes other vertices, or the same array with other contents, and triangles if they have
        changed, too, which are copied and checked as by the constructor. What depends on them is prepared again by the
        next query, and by simulations in their next steps; without triangles nothing is allocated. Raises as the
        constructor does; the mesh is then as it was."""
        vertices = of_list(vertices, "vertices", self._dtype)
        triangles = of_list(triangles, "triangles", "int64")
        stream = stream_of(library_of(vertices, self._device), self._device)
        self._mesh.take(stream, vertices, triangles, bool(validate))
        self._vertices, self._version = vertices, self._version + 1
        self._is_known_closed = self._is_known_closed and triangles is None

    @property
    def is_closed(self) -> bool:
        """Whether every edge has an even number of triangles, so that there is an inside; see `validate_closed`."""
        return self.validate_closed().is_closed

    def validate_closed(self) -> Seams:
        """Whether a mesh of the host is the boundary of a solid, and where it is not: `Seams`. Vertices of equal
        coordinates are one. O(m log m), on one thread. Raises `Error` on a GPU."""
        message, is_closed, is_oriented, parts = self._mesh.check(self._stream(), "closed", 0)
        return Seams(message, is_closed, is_oriented, *parts)

    def validate_surface(self, tolerance: float) -> Surface:
        """Where the triangles of a surface, on the host, do not share whole edges: `Surface`. Points no farther apart
        than the tolerance, a length, are one. Raises `Error` for a negative one, and on a GPU."""
        message, parts = self._mesh.check(self._stream(), "surface", real("tolerance", tolerance))
        return Surface(message, *parts)

    def self_intersections(self) -> Array:
        """(k, 2) int32 of numpy, sorted: pairs of triangles that cut through each other, touch where they share no corner
        or edge, or overlap. Exact. Where a closed mesh cuts itself, `contains` takes what is inside twice for outside:
        `winding_number` above 1/2 is the union. O(m log m + pairs). Raises `Error` on a GPU."""
        return self._mesh.check(self._stream(), "intersections", 0)

    def count(self, centres: Array, radius: float | Array, *, displacements: Array | None = None,
              precision: Precision = "exact", poses: Poses | None = None) -> int:
        """How many pairs of a sphere and a triangle touch. Arguments as for `query`."""
        return self._query(int, "count", centres, radius, displacements, precision, poses=poses)

    def any(self, centres: Array, radius: float | Array, *, displacements: Array | None = None,
            precision: Precision = "exact", poses: Poses | None = None, out: Array | None = None) -> Array:
        """(n,) bool: whether each sphere touches anything. Arguments as for `query`.

        out  (n,) uint8 or bool: where flags go. On a GPU such a call allocates nothing and does not
             wait, once a first one has been made, with one radius or up to 262,144 triangles: it can be captured in
             a CUDA graph.
        """
        return self._query(bool, "any", centres, radius, displacements, precision, poses=poses, out=out)

    @overload
    def query(self, centres: Array, radius: float | Array, *, displacements: Array | None = None,
              precision: Precision = "exact", order: Order = "unspecified", output: Literal["pairs"] = "pairs",
              capacity: int | None = None, poses: Poses | None = None, out: Array | None = None) -> Pairs: ...

    @overload
    def query(self, centres: Array, radius: float | Array, *, displacements: Array | None = None,
              precision: Precision = "exact", order: Order = "unspecified", output: Literal["csr"],
              poses: Poses | None = None) -> Csr: ...

    def query(self, centres: Array, radius: float | Array, *, displacements: Array | None = None,
              precision: Precision = "exact", order: Order = "unspecified", output: Literal["pairs", "csr"] = "pairs",
              capacity: int | None = None, poses: Poses | None = None, out: Array | None = None) -> Pairs | Csr:
        """All pairs of a sphere and a triangle that touch, each exactly once.

        centres        (n, 3), of the dtype of the vertices and on the same device
        radius         a number for all, or (n,) of the same dtype. A sphere whose radius is negative or NaN is empty.
        displacements  (n, 3): spheres move by so much along straight lines, and a pair touches if it does at any time.
                       None: they rest.
        precision      'exact': as with real arithmetic on the numbers as given. 'double', 'single': rounded, and so
                       wrong for pairs within a few units in the last place of contact.
        order          'canonical': by sphere, then by triangle; costs a sort. 'unspecified': any.
        output         'csr': offsets and triangles, a row for each sphere
        capacity       room for so many results at most; ``total`` tells how many there are all the same
        poses          (bodies, 7): where the mesh's bodies are, of one without them the whole mesh. Spheres are taken to the
                       frame of each, and rounded there.
        out            (capacity, 2) int32, packed: where results go, in place of memory of their own

        Returns `Pairs`, or `Csr`. Results own their memory. Raises TypeError or ValueError for arguments that do not
        fit, `Error` if the library or CUDA fails, MemoryError without memory. O(n + candidates).
        """
        if choice("output", output, ("pairs", "csr")) == "csr":
            refuse(capacity is not None, "capacity", "rows have no capacity: take output='pairs'")
            refuse(out is not None, "out", "rows are not written to an array: take output='pairs'")
        kind = Csr if output == "csr" else Pairs
        return self._query(kind, output, centres, radius, displacements, precision, order, capacity, poses, out)

    def contacts(self, centres: Array, radius: float | Array, *, closest: bool = False,
                 displacements: Array | None = None, precision: Precision = "exact", order: Order = "unspecified",
                 capacity: int | None = None, poses: Poses | None = None, out: Array | None = None) -> Contacts:
        """The contact of every pair that touches: closest point, normal, distance, depth, feature. With displacements,
        at the time of impact.

        closest  one row for each sphere, of the triangle closest to its centre (of equally close ones the first). Of a
                 sphere that touches nothing ``triangle`` is -1, ``distance`` infinite, and the other numbers NaN.
        out      (capacity, 12) int32, of float64 (capacity, 20): what ``records`` is

        Other arguments, errors and costs as for `query`.
        """
        refuse(closest and out is not None, "out", "of the closest contacts is not taken")
        refuse(closest and capacity is not None, "capacity", "there is a contact for each sphere")
        what = "closest" if closest else "contacts"
        return self._query(Contacts, what, centres, radius, displacements, precision, order, capacity, poses, out)

    def impacts(self, centres: Array, displacements: Array, radius: float | Array, *, first: bool = False,
                order: Order = "unspecified", capacity: int | None = None, poses: Poses | None = None,
                out: Array | None = None) -> Impacts:
        """Moving spheres: every pair that touches on the way from ``centres`` to ``centres + displacements``, with the
        time of impact and the contact then.

        first  one row for each sphere, of the triangle that it hits first (of equal times the one of the smallest
               number). Of a sphere that touches nothing ``triangle`` is -1, ``time`` infinite, and the rest NaN.
        poses  where the mesh's bodies rest meanwhile, as for `query`
        out    (capacity, 13) int32, of float64 (capacity, 22): what ``records`` is

        Other arguments, errors and costs as for `query`.
        """
        refuse(displacements is None, "displacements", "expected an array of shape (n, 3)")
        refuse(first and out is not None, "out", "of the first impacts is not taken")
        refuse(first and capacity is not None, "capacity", "there is an impact for each sphere")
        what = "earliest" if first else "impacts"
        return self._query(Impacts, what, centres, radius, displacements, "exact", order, capacity, poses, out)

    def nearest(self, points: Array, *, max_distance: float = math.inf, poses: Poses | None = None,
                out: Array | None = None) -> Nearest:
        """The nearest triangle of each point, and the nearest point of it.

        points        (n, 3), of the dtype of the vertices and on the same device. One that is not finite has no triangle.
        max_distance  triangles farther away do not count; not negative
        poses         where the mesh's bodies are, as for `query`
        out           (n, 10) int32, of float64 (n, 18), packed: where ``records`` go, in place of memory of their own

        Returns `Nearest`. Which triangle is nearest is as with real arithmetic on the numbers as given, and of equally near
        ones it is the one of the smallest number; distances and points are rounded. Raises TypeError or ValueError for
        arguments that do not fit, `Error` if the library or CUDA fails. It does not wait on a GPU. The first call prepares a
        tree, O(m log m) for m triangles; O(log m) for a point near the mesh.
        """
        return self._search(Nearest, "nearest", points, 1, max_distance, poses, out)

    def k_nearest(self, points: Array, k: int, *, max_distance: float = math.inf, poses: Poses | None = None,
                  out: Array | None = None) -> Nearest:
        """The k nearest triangles of each point, by rising distance: ``distance`` has the shape (n, k), ``point`` (n, k,
        3). Where fewer are in reach, the last ones of a row are none.

        k    1 to 32
        out  (n, k, 10) int32, of float64 (n, k, 18)

        Other arguments, errors and costs as for `nearest`.
        """
        return self._search(Nearest, "k_nearest", points, whole("k", k, 1, 32), max_distance, poses, out)

    def distance(self, points: Array, *, signed: bool = False, max_distance: float = math.inf,
                 poses: Poses | None = None, out: Array | None = None) -> Array:
        """(n,) of the vertices' dtype: the distances of `nearest`, or with ``signed`` of `signed_distance`, without the
        memory of all else that these find.

        out  (n,) of that dtype: where they go

        Other arguments, errors and costs as for `nearest`.
        """
        if signed:
            self._look_for_holes()
        return self._search(float, "sides" if signed else "distance", points, 1, max_distance, poses, out)

    def winding_number(self, points: Array, *, beta: float = 3, out: Array | None = None) -> Winding:
        """How often the mesh winds around each point: `Winding`, whose ``value`` is above 1/2 inside. For meshes with
        holes, triangle soups, and closed parts that overlap, of which `contains` makes no sense; normals must point
        outwards. Barill et al., 2018.

        beta  2 or more: triangles in a sphere are seen as one from farther away than so many of its radii; twice as
              much makes the error a tenth, and takes four times as long
        out   (n, 2) int32, of float64 (n, 4)

        Errors as for `nearest`. O(log m) a point.
        """
        beta = real("beta", beta)
        refuse(not beta >= 2, "beta", "is below 2")
        return self._search(Winding, "winding", points, beta, math.inf, None, out)

    def signed_distance(self, points: Array, *, max_distance: float = math.inf, poses: Poses | None = None,
                        out: Array | None = None) -> SignedDistance:
        """How far each point is from the surface of a closed mesh: ``distance`` is negative inside, 0 on the surface. It
        is what `nearest` finds, with the side that `contains` finds; each says what it needs. Farther away than
        ``max_distance`` it is infinite, with the sign. A mesh of the host that is not closed gives a warning, once.

        out  (n, 13) int32, of float64 (n, 24)

        Other arguments, errors and costs as for `nearest`.
        """
        self._look_for_holes()
        return self._search(SignedDistance, "signed_distance", points, 1, max_distance, poses, out)

    def contains(self, points: Array, *, poses: Poses | None = None, out: Array | None = None) -> Array:
        """(n,) bool: whether each point is inside of a closed mesh or on its surface. Exact, however triangles are
        oriented: a ray from the point along +z crosses the mesh an odd number of times. Where the mesh is not closed
        the answer depends on that ray, and there is a warning, once. A point that is not finite is outside. O(triangles above or below the point).

        points  (n, 3), of the dtype of the vertices and on the same device
        out     (n,) uint8 or bool: where flags go

        Errors as for `nearest`.
        """
        self._look_for_holes()
        return self._search(bool, "contains", points, 1, math.inf, poses, out)

    def _look_for_holes(self):
        """Warns of a mesh that has no inside, once for its triangles."""
        if self._is_known_closed:
            return
        self._is_known_closed = True
        if not self._mesh.seems_closed(self._stream()):
            warnings.warn(
                "collide: the mesh is not closed, so that its inside is a matter of where its holes are: validate_closed() "
                "names them, and winding_number(points).value > 0.5 makes sense of such a mesh",
                stacklevel=3,
            )

    def _stream(self):
        return stream_of(self._library, self._device)

    def _query(self, kind, what, centres, radius, displacements, precision, order="unspecified", capacity=None, poses=None,
               out=None):
        """What spheres touch."""
        choice("precision", precision, PRECISIONS)
        is_sorted = choice("order", order, ORDERS) == "canonical"
        if capacity is not None:
            capacity = whole("capacity", capacity, 0, 2**63 - 1)
        centres, radius = of_list(centres, "centres", self._dtype), of_list(radius, "radius", self._dtype)
        asked = radius, of_list(displacements, "displacements", self._dtype), precision
        return self._ask(self._mesh.query, kind, what, centres, asked, poses, out, is_sorted, capacity)

    def _search(self, kind, what, points, number, max_distance, poses, out):
        """What is near points; ``number`` is k, or beta of winding numbers."""
        points, asked = of_list(points, "points", self._dtype), (number, real("max_distance", max_distance))
        return self._ask(self._mesh.search, kind, what, points, asked, poses, out)

    def _ask(self, function, kind, what, centres, asked, poses, out, is_sorted=False, capacity=None):
        """What a function of the compiled mesh finds, as a ``kind``; bool stands for flags, float for numbers. It works on
        the stream of the library that the centres, or points, are of."""
        library = library_of(centres, self._device)
        stream = stream_of(library, self._device)
        poses = [] if poses is None else table("poses", poses, "bodies", 7).tolist()
        results = is_sorted, capacity, out, library.is_numpy
        found = function(stream, what, library.lent(centres), *asked, poses, results)
        if kind is int:
            return found
        if kind is Csr:
            return Csr(*(library.array(a, stream) for a in found))
        records, size, *total = found
        if out is None:
            records = library.array(records, stream)
        elif size < len(out):
            records = out[:size]
        if kind is float or (kind is bool and out is not None):
            return records
        if kind is bool:
            return library.flags(records)
        return kind(library, records, self._is_wide, size, *total)


def how_many_threads(threads):
    return min(whole("threads", threads), os.cpu_count() or 1)


def _parts(bodies):
    """Bodies as pairs of numbers."""
    try:
        return [(whole("bodies", first), whole("bodies", size)) for first, size in bodies]
    except (TypeError, ValueError):
        raise TypeError("bodies: expected pairs of numbers such as [(0, 12), (12, 24)]") from None


def _is_wide(array):
    if not hasattr(array, "dtype") and device_of(array, "vertices")[0] != CUDA:
        try:
            array = numpy.from_dlpack(array)
        except Exception:  # noqa: BLE001: it is told below what is wrong
            return False
    dtype = getattr(array, "dtype", "")
    return "float64" in str(getattr(dtype, "_wp_scalar_type_", dtype))  # of warp's vectors, such as vec3
