"""Runs the programs and knows the truth: what the tests of the programs share. Only Python's standard library."""

import json
import os
import pty
import shutil
import struct
import subprocess
import tempfile
import unittest
from fractions import Fraction
from pathlib import Path

PROGRAMS = Path(os.environ.get("COLLIDE_PROGRAMS", Path(__file__).parents[2] / "build" / "examples"))

# for ranks of MPI that share a machine, perhaps a container, as whoever runs the tests
MPI = {**os.environ, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
       "OMPI_MCA_rmaps_base_oversubscribe": "1", "OMPI_MCA_mpi_yield_when_idle": "1", "OMPI_MCA_plm": "isolated",
       "OMPI_MCA_btl": "self,vader", "OMPI_MCA_btl_vader_single_copy_mechanism": "none",
       "PRTE_MCA_rmaps_default_mapping_policy": ":oversubscribe", "OMP_NUM_THREADS": "1"}


class ProgramTest(unittest.TestCase):
    """A test in an empty folder of its own, in which programs run and files are named without a path."""

    def setUp(self):
        self.folder = Path(tempfile.mkdtemp(prefix="collide-"))
        self.addCleanup(shutil.rmtree, self.folder)

    def path(self, name):
        return self.folder / name

    def write(self, name, content):
        self.path(name).write_bytes(content if isinstance(content, bytes) else content.encode())

    def read(self, name):
        return self.path(name).read_bytes()

    def files(self):
        return sorted(p.name for p in self.folder.iterdir())

    def run_program(self, name, *args, **options):
        return subprocess.run([PROGRAMS / name, *map(str, args)], cwd=self.folder, capture_output=True,
                              stdin=subprocess.DEVNULL, timeout=300, **options)

    def run_on_mpi(self, n, name, *args, ranks="mpi"):
        return subprocess.run(["mpirun", "-np", str(n), PROGRAMS / name, *map(str, args), "--ranks", ranks],
                              cwd=self.folder, capture_output=True, stdin=subprocess.DEVNULL, timeout=300, env=MPI)

    def succeed(self, name, *args, **options):
        """Runs a program that must succeed and has nothing to complain of; returns its standard output."""
        done = self.run_program(name, *args, **options)
        self.assertEqual((done.returncode, done.stderr), (0, b""), args)
        return done.stdout.decode()

    def succeed_saying(self, lines, name, *args, **options):
        """Runs a program that must succeed and say these lines on standard error; returns its standard output."""
        done = self.run_program(name, *args, **options)
        self.assertEqual((done.returncode, done.stderr.decode()), (0, "".join(f"{name}: {line}\n" for line in lines)), args)
        return done.stdout.decode()

    def fail_with(self, status, words, name, *args, **options):
        """Runs a program that must fail with this status, one line that has all of the words, and no new file."""
        before = self.files()
        done = self.run_program(name, *args, **options)
        message = done.stderr.decode()
        self.assertEqual(done.returncode, status, (args, message))
        self.assertRegex(message, r"\A" + name + r": [^\n]+\n\Z", args)
        for word in words:
            self.assertIn(word, message, args)
        self.assertEqual(self.files(), before, args)
        return message

    def on_a_terminal(self, name, *args, patience):
        """Runs a program with a terminal as standard error; returns what a person of such patience would see fly by.

        What takes long depends on the machine, so the tests say for how many seconds of work a bar is not worth it.
        """
        terminal, slave = pty.openpty()
        process = subprocess.Popen([PROGRAMS / name, *map(str, args)], cwd=self.folder,
                                   env={**os.environ, "COLLIDE_PATIENCE": str(patience)}, stdout=subprocess.DEVNULL, stderr=slave)
        os.close(slave)
        seen = b""
        try:
            while part := os.read(terminal, 4096):
                seen += part
        except OSError:
            pass  # how Linux says that the other side is closed
        os.close(terminal)
        self.assertEqual(process.wait(), 0)
        return seen.decode()

    def detect(self, *args, **options):
        """The pairs that `detect` writes, as they stand in the file."""
        self.succeed("detect", *args, "--output", "pairs.csv", **options)
        return self.pairs("pairs.csv")

    def pairs(self, name):
        header, *lines = self.read(name).decode().splitlines()
        self.assertEqual(header, "sphere,triangle")
        return [tuple(map(int, line.split(","))) for line in lines]

    def report(self, *args):
        self.succeed("detect", *args, "--report", "report.json")
        return json.loads(self.read("report.json"))

    def scene(self, vertices, triangles, spheres, radii=None):
        """Writes mesh.obj and spheres.csv."""
        lines = ["v %r %r %r" % tuple(v) for v in vertices] + ["f %d %d %d" % tuple(i + 1 for i in t) for t in triangles]
        self.write("mesh.obj", "\n".join(lines) + "\n")
        rows = ["x,y,z" + (",r" if radii else "")]
        for i, centre in enumerate(spheres):
            rows.append(",".join(repr(x) for x in [*centre, *([radii[i]] if radii else [])]))
        self.write("spheres.csv", "\n".join(rows) + "\n")


# ---- the truth, in exact arithmetic

def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def minus(a, b):
    return [x - y for x, y in zip(a, b)]


def squared_distance_to_segment(p, a, b):
    ab, ap = minus(b, a), minus(p, a)
    length = dot(ab, ab)
    t = min(max(dot(ap, ab) / length, Fraction(0)), Fraction(1)) if length else Fraction(0)
    d = [x - t * y for x, y in zip(ap, ab)]
    return dot(d, d)


def squared_distance(p, triangle):
    """From a point to a triangle, all of whose coordinates are fractions: the nearest of the three edges, or the plane if the
    point projects into the triangle."""
    a, b, c = triangle
    best = min(squared_distance_to_segment(p, *edge) for edge in ((a, b), (b, c), (c, a)))
    u, v, w = minus(b, a), minus(c, a), minus(p, a)
    uu, uv, vv, uw, vw = dot(u, u), dot(u, v), dot(v, v), dot(u, w), dot(v, w)
    area = uu * vv - uv * uv
    if area:
        s, t = (vv * uw - uv * vw) / area, (uu * vw - uv * uw) / area
        if s >= 0 and t >= 0 and s + t <= 1:
            d = [x - s * y - t * z for x, y, z in zip(w, u, v)]
            best = min(best, dot(d, d))
    return best


def true_pairs(vertices, triangles, spheres, radii):
    """All colliding pairs in canonical order; numbers are taken as they are."""
    exact = [[Fraction(x) for x in v] for v in vertices]
    corners = [[exact[i] for i in t] for t in triangles]
    found = []
    for s, centre in enumerate(spheres):
        p, r = [Fraction(x) for x in centre], Fraction(radii[s])
        found += [(s, t) for t, triangle in enumerate(corners) if r >= 0 and squared_distance(p, triangle) <= r * r]
    return found


def nearest(text, kind):
    """A decimal number correctly rounded (to nearest, ties to even) to 'f'loat or 'd'ouble."""
    if kind == "d":
        return float(text)
    if text.startswith("-"):
        return -nearest(text[1:], kind)
    exact = Fraction(text)
    bits = struct.unpack("i", struct.pack("f", float(text)))[0]  # right, or the next one
    around = [b for b in (bits - 1, bits, bits + 1) if 0 <= b <= 0x7f7fffff]
    value = lambda b: struct.unpack("f", struct.pack("i", b))[0]
    return value(min(around, key=lambda b: (abs(Fraction(value(b)) - exact), b % 2)))


def read_ply(content):
    """The vertices (x, y, z, colour) and faces (corners, colour) of a binary PLY file."""
    header, body = content.split(b"end_header\n", 1)
    words = [line.split() for line in header.decode().splitlines()]
    assert words[0] == ["ply"] and words[1] == ["format", "binary_little_endian", "1.0"]
    counts = {w[1]: int(w[2]) for w in words if w[0] == "element"}
    kind = next(w[1] for w in words if w[0] == "property")[0]
    vertex, face = struct.Struct("<3%s3B" % kind), struct.Struct("<B3i3B")
    assert len(body) == counts["vertex"] * vertex.size + counts["face"] * face.size
    end = counts["vertex"] * vertex.size
    vertices = [(v[:3], v[3:]) for v in vertex.iter_unpack(body[:end])]
    faces = [(f[1:4], f[4:]) for f in face.iter_unpack(body[end:]) if f[0] == 3]
    assert len(faces) == counts["face"]
    return vertices, faces


def main():
    unittest.main(verbosity=2)
