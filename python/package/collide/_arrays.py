"""Which library an array is of, on which stream it works, and how results become arrays of it."""

import functools
import importlib
import os

import numpy

from . import _host
from ._errors import refuse, shown

_why_no_cuda = ""
try:
    from . import _cuda  # in the package collide-spheres-cu13 only
except ImportError as reason:
    _cuda = None
    _why_no_cuda = str(reason)

CPU_TYPES = (1, 3)  # of DLPack: memory of the host, and such that a GPU can read, too
CUDA = 2
NO_STREAM = (0, -1)  # what calls on the host are given


def device_of(array, name):
    """(type, number) of the device that an array is on, as DLPack counts them."""
    try:
        kind, number = array.__dlpack_device__()
        return int(getattr(kind, "value", kind)), int(number)  # Open3D's kind is no int
    except Exception:  # noqa: BLE001: whatever it is, it is no array
        if hasattr(array, "__array_interface__"):
            return 1, 0
        raise TypeError(
            f"{name}: expected an array (numpy, torch, cupy, jax, warp: with __dlpack__), got {type(array).__name__}"
        ) from None


MOST_LISTED = 1000  # numbers of a list: a larger one is slow, and better an array


def numbers(name, values, expected="numbers", dtype="float64"):
    """An array of numpy, of numbers as it takes them; its own errors have no name of the argument."""
    try:
        return numpy.asarray(values, dtype)
    except Exception:  # noqa: BLE001
        raise TypeError(f"{name}: expected {expected}, got {shown(values)}") from None


def of_list(values, name, dtype):
    """Lists and tuples as an array of numpy, if they are short; everything else as it is."""
    if not isinstance(values, (list, tuple)):
        return values
    array = numbers(name, values, "an array, or a list of numbers such as numpy takes", dtype)
    refuse(array.size >= MOST_LISTED, name, f"is a list of {array.size} numbers, which is slow: make an array of it, such as numpy's")
    return array


def table(name, values, rows, width):
    """(rows, width) float64 of numbers, or of those of one row for all; ``rows`` is a word where there may be any number."""
    expected, count = f"({rows}, {width})", None if isinstance(rows, str) else rows
    found = numbers(name, values, f"numbers of shape {expected}")
    if found.shape in ((width,), () if width == 1 else (width,)):
        found = numpy.broadcast_to(found, (1 if count is None else count, width))
    if width == 1 and found.ndim == 1:
        found = found[:, None]
    wrong = found.ndim != 2 or found.shape[1] != width or count not in (None, len(found))
    refuse(wrong, name, f"has shape {found.shape}, expected {expected}")
    return found


def arrays_of(mesh):
    """Vertices and triangles of a mesh of another library."""
    if hasattr(mesh, "vertex") and hasattr(mesh, "triangle"):  # Open3D's tensors
        return mesh.vertex.positions, mesh.triangle.indices
    if hasattr(mesh, "vertices"):  # trimesh; Open3D's older class
        triangles = mesh.faces if hasattr(mesh, "faces") else getattr(mesh, "triangles", None)
        if triangles is not None:
            return numpy.asarray(mesh.vertices), numpy.asarray(triangles)
    if hasattr(mesh, "points") and hasattr(mesh, "cells_dict"):  # meshio
        others = sorted(mesh.cells_dict.keys() - {"triangle", "line", "vertex"})
        refuse(others, "mesh", f"has cells that are no triangles: {', '.join(others)}")
        return numpy.asarray(mesh.points), numpy.asarray(mesh.cells_dict.get("triangle", numpy.zeros((0, 3), int)))
    if hasattr(mesh, "points") and hasattr(mesh, "faces"):  # PyVista: each face is how many corners, and these
        faces = numpy.asarray(mesh.faces)
        wrong = len(faces) % 4 != 0 or (faces[::4] != 3).any()
        refuse(wrong, "mesh", "has faces that are no triangles: call its triangulate() first")
        return numpy.asarray(mesh.points), faces.reshape(-1, 4)[:, 1:]
    raise TypeError(f"mesh: expected one of trimesh, meshio, PyVista or Open3D, got {shown(mesh)}")


def module_for(device, name):
    """The compiled module for a device."""
    if device[0] in CPU_TYPES:
        return _host
    refuse(device[0] != CUDA, name, f"is on a device of DLPack's type {device[0]}; there are the host and NVIDIA GPUs")
    refuse(_cuda is None, name, f"is on a GPU, which needs the package collide-spheres-cu13 ({_why_no_cuda})")
    return _cuda


class _Numpy:
    """Arrays of numpy, and of whatever else is on the host and has no class of its own here."""

    def __init__(self, root="numpy", module=None):
        self.root, self.module, self.is_numpy = root, module, type(self) is _Numpy

    def __reduce__(self):
        return _library, (self.root,)

    def stream(self, device):
        """The stream that the library works on now, and what its arrays' __dlpack__ is given."""
        return NO_STREAM

    def lent(self, array):
        """An array, or a capsule of DLPack that is made sooner than by its __dlpack__."""
        return array

    def array(self, result, stream):
        """A result of a compiled module as an array of this library, without a copy."""
        return result if self.is_numpy else self.module.from_dlpack(result)

    def shown(self, view):
        """An array that shows memory which changes later."""
        return view

    def dtype(self, name):
        """The library's dtype of a name."""
        return name

    def flags(self, result):
        """Bytes 0 and 1 as booleans."""
        return result.view(self.dtype("bool"))

    def field(self, records, first, last, kind):
        """Columns first to last of records, whose last axis are words of int32, as numbers of a kind; the column alone if
        last is None."""
        width = 2 if kind == "float64" else 1
        whole = records.view(self.dtype(kind))
        return whole[..., first // width] if last is None else whole[..., first // width : last // width]


class _Torch(_Numpy):
    def stream(self, device):
        raw = getattr(self.module._C, "_cuda_getCurrentRawStream", None)  # makes no object: as torch's own compiler asks
        return raw(device) if raw else self.module.cuda.current_stream(device).cuda_stream, -1

    def lent(self, array):  # its __dlpack__ is in Python, and takes some microseconds
        is_plain = type(array) is self.module.Tensor and array.is_cuda and array.layout is self.module.strided
        return self.module.utils.dlpack.to_dlpack(array) if is_plain and not array.requires_grad else array

    def array(self, result, stream):  # a capsule is taken as it is, without asking for its device and stream
        return self.module.from_dlpack(result.__dlpack__())

    def dtype(self, name):
        return getattr(self.module, name)


class _Cupy(_Numpy):
    def stream(self, device):
        return self.module.cuda.get_current_stream(device).ptr, -1


class _Ordered:
    """A result on a GPU that the stream of whoever takes it waits for."""

    def __init__(self, result, stream):
        self.result, self.stream_of_result = result, stream

    def __reduce__(self):
        raise TypeError("collide: an array on a GPU for a library that is unknown here is not pickled: take an array of yours")

    def __dlpack_device__(self):
        return self.result.__dlpack_device__()

    def __dlpack__(self, *, stream=None, **others):
        if self.__dlpack_device__()[0] == CUDA and stream != -1:
            _cuda.order(self.__dlpack_device__()[1], self.stream_of_result[0], stream or 1)
        return self.result.__dlpack__(**others)


class _Stranger(_Numpy):
    """Arrays on a GPU of a library that is not known here: results have __dlpack__. It has no stream to work on: its
    arrays have ours wait for them, and its stream ours."""

    def stream(self, device):
        return _cuda.own_stream(device), _cuda.own_stream(device)

    def array(self, result, stream):
        return _Ordered(result, stream)

    def flags(self, result):
        return result

    def field(self, records, first, last, kind):
        raise TypeError("results are arrays of a library that is unknown here: take `records`, rows of 32-bit words")


class _Jax(_Stranger):
    def array(self, result, stream):
        return self.module.dlpack.from_dlpack(_Ordered(result, stream))

    def shown(self, view):  # its arrays never change: a copy
        return self.module.numpy.array(view, copy=True).block_until_ready()

    def flags(self, result):
        return result != 0

    def field(self, records, first, last, kind):  # it has no arrays with gaps
        if kind == "int32":
            return records[..., first]
        words = records[..., first : last if last is not None else first + (2 if kind == "float64" else 1)]
        if kind == "float64":
            words = words.reshape(*words.shape[:-1], -1, 2)
        numbers = self.module.lax.bitcast_convert_type(words, kind)
        return numbers[..., 0] if last is None else numbers


class _Warp(_Numpy):
    def stream(self, device):
        return self.module.get_stream(f"cuda:{device}").cuda_stream or 0, -1  # None is the null stream

    def flags(self, result):
        return result.view(self.module.bool)

    def field(self, records, first, last, kind):
        size = 8 if kind == "float64" else 4
        columns = () if last is None else ((last - first) * 4 // size,)
        part = self.module.array(
            ptr=records.ptr + 4 * first if records.shape[0] else None,
            dtype=getattr(self.module, kind),
            shape=(*records.shape[:-1], *columns),
            strides=(*records.strides[:-1], *(size for _ in columns)),
            device=records.device,
        )
        part.records = records  # whose memory it is
        return part


_forks = []  # as many as lead to this process
os.register_at_fork(after_in_child=lambda: _forks.append(1))


def stream_of(library, device):
    """What a call to a compiled module begins with: on a GPU the stream that the library works on now."""
    if device[0] != CUDA:
        return NO_STREAM
    if _forks:  # libraries have their own errors, and some have none
        _cuda.order(device[1], 0, 0)  # refuses, and says why
    return library.stream(device[1])


_classes = {"numpy": _Numpy, "torch": _Torch, "cupy": _Cupy, "jax": _Jax, "jaxlib": _Jax, "warp": _Warp}


def library_of(array, device):
    """The library that an array is of."""
    root = type(array).__module__.partition(".")[0]
    if root not in _classes:
        root = "numpy" if device[0] in CPU_TYPES else "stranger"
    return _library(root)


@functools.cache
def _library(root):
    module = importlib.import_module(root.replace("jaxlib", "jax")) if root in _classes else None
    return _classes.get(root, _Stranger)(root, module)
