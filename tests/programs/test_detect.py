"""detect as its users see it."""

import base64
import json
import math
import os
import random
import re
import resource
import shutil
import signal
import stat
import struct
import subprocess
import time
import unittest
from fractions import Fraction
from pathlib import Path

import programs
from programs import ProgramTest, nearest, read_ply, true_pairs

DATA = Path(__file__).parents[1] / "data"
TRIANGLE = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
ONE_SPHERE = "x,y,z\n0.2,0.2,0.1\n"
CUBE = ([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)],
        [(0, 2, 1), (0, 3, 2), (4, 5, 6), (4, 6, 7), (0, 1, 5), (0, 5, 4), (1, 2, 6), (1, 6, 5), (2, 3, 7), (2, 7, 6),
         (3, 0, 4), (3, 4, 7)])
COMPOSITIONS = [("--broad", b, "--precision", p) for b in ("all_pairs", "bucket", "bvh") for p in ("exact", "single", "double")]


def random_scene(seed, spread):
    """Triangles of many shapes and spheres around them, as floats of few digits."""
    rng = random.Random(seed)
    number = lambda half: round(rng.uniform(-half, half) * 64) / 64
    vertices, triangles = [], []
    for _ in range(40):
        centre, size = [number(4) for _ in range(3)], rng.choice([0, 0.25, 1, 8])
        triangles.append([len(vertices) + k for k in range(3)])
        vertices += [[c + number(size) for c in centre] for _ in range(3)]
    spheres = [[number(6) for _ in range(3)] for _ in range(60)]
    radii = [round(rng.uniform(0.5, 3) * rng.choice([1, spread]) * 64) / 64 for _ in spheres]
    return vertices, triangles, spheres, radii


class Answers(ProgramTest):
    def test_passes(self):
        self.scene(*random_scene(5, 3))
        def written(*args):
            self.succeed("detect", "mesh.obj", "spheres.csv", "--output", "pairs.csv", *args)
            self.succeed("detect", "mesh.obj", "spheres.csv", "--contacts", "contacts.csv", *args)
            return self.read("pairs.csv"), self.read("contacts.csv")
        for args in ((), ("--broad", "all_pairs"), ("--scalar", "double"), ("--ranks", "threads:2")):
            whole = written(*args)
            for n in (1, 7, 39, 40, 1000):  # there are 40 triangles
                self.assertEqual(written(*args, "--triangles-per-pass", n), whole, (args, n))
        report = self.report("mesh.obj", "spheres.csv", "--triangles-per-pass", 9, "--repeat", 2)
        self.assertEqual((report["pairs"], report["cell_width"]), (len(whole[0].splitlines()) - 1, 0))

    def test_the_cube(self):
        spheres = [(0, 0, 0), (3, 3, 3), (.5, .5, .5), (1.3, 0, .5)]
        self.scene(*CUBE, spheres)
        truth = true_pairs(*CUBE, spheres, [.4] * 4)
        self.assertEqual({s for s, _ in truth}, {0, 3})
        for composition in COMPOSITIONS:
            self.assertEqual(self.detect("mesh.obj", "spheres.csv", "--radius", .4, *composition), truth, composition)

    def test_the_octahedron(self):
        vertices = [(0, 0, 78), (45, 45, 0), (-45, 45, 0), (-45, -45, 0), (45, -45, 0), (0, 0, -78)]
        faces = [(0, 1, 2), (0, 2, 3), (0, 3, 4), (0, 4, 1), (5, 2, 1), (5, 3, 2), (5, 4, 3), (5, 1, 4)]
        self.scene(vertices, faces, [(0, 0, -90), (0, 0, 100)])
        for composition in COMPOSITIONS:
            found = self.detect("mesh.obj", "spheres.csv", "--radius", 20, *composition)
            self.assertEqual(found, [(0, 4), (0, 5), (0, 6), (0, 7)], composition)

    def test_random_scenes(self):
        for seed in range(4):
            vertices, triangles, spheres, radii = random_scene(seed, spread=1 + 3 * seed)
            truth = true_pairs(vertices, triangles, spheres, radii)
            self.assertGreater(len(truth), 50)
            self.scene(vertices, triangles, spheres, radii)
            for composition in COMPOSITIONS:
                for more in ([], ["--cell-width", 0.5], ["--scalar", "double"], ["--threads", 1]):
                    with self.subTest(seed=seed, options=[*composition, *more]):
                        self.assertEqual(self.detect("mesh.obj", "spheres.csv", *composition, *more), truth)

    def test_one_radius_for_all(self):
        vertices, triangles, spheres, _ = random_scene(9, 1)
        self.scene(vertices, triangles, spheres)
        for radius in (0, 0.75, 4):
            truth = true_pairs(vertices, triangles, spheres, [radius] * len(spheres))
            for composition in COMPOSITIONS:
                found = self.detect("mesh.obj", "spheres.csv", "--radius", radius, *composition)
                self.assertEqual(found, truth, (radius, composition))

    def test_touching_is_colliding(self):
        self.write("mesh.obj", TRIANGLE)
        self.write("spheres.csv", "x,y,z\n.25,.25,.5\n-.5,0,0\n.25,.25,.5000001\n.25,.25,0\n")
        for composition in COMPOSITIONS:
            found = self.detect("mesh.obj", "spheres.csv", "--radius", ".5", *composition)
            self.assertEqual(found, [(0, 0), (1, 0), (3, 0)])
            self.assertEqual(self.detect("mesh.obj", "spheres.csv", "--radius", "-0", *composition), [(3, 0)])

    def test_the_form_of_the_study(self):
        self.scene(*CUBE, [(0, 0, 0), (3, 3, 3)])
        found = self.detect("mesh.obj", "spheres.csv", "--radius", .4)
        self.assertNotEqual(found, [])
        self.succeed("detect", "mesh.obj", "spheres.csv", .4, "study.csv")
        self.assertEqual(self.pairs("study.csv"), found)
        self.assertEqual(self.read("study.csv"), self.read("pairs.csv"))

    def test_broad_phases_write_the_same_files(self):
        self.succeed("generate", "--spheres", 3000, "--triangles", 5000, "mesh.obj", "spheres.csv")
        outputs = set()
        for i, options in enumerate((["--broad", "all_pairs"], ["--broad", "bucket"], ["--broad", "bvh"], ["--cell-width", 12], ["--threads", 1])):
            self.succeed("detect", "mesh.obj", "spheres.csv", "--radius", 30, *options, "--output", f"p{i}", "--contacts", f"c{i}",
                         "--ply", f"h{i}")
            outputs.add((self.read(f"p{i}"), self.read(f"c{i}"), self.read(f"h{i}")))
        self.assertEqual(len(outputs), 1)
        self.assertGreater(len(self.pairs("p0")), 1000)

    def test_the_scalar_decides(self):
        # the plane x = 1 + 2^-30 is at distance 2^-30 from the sphere in double, and at distance 0 in float
        self.write("mesh.obj", "v 1.000000000931322574615478515625 0 0\nv 1.000000000931322574615478515625 1 0\n"
                               "v 1.000000000931322574615478515625 0 1\nf 1 2 3\n")
        self.write("spheres.csv", "x,y,z\n1,.25,.25\n")
        call = ["mesh.obj", "spheres.csv", "--radius", 0]
        self.assertEqual(self.detect(*call, "--scalar", "float"), [(0, 0)])
        self.assertEqual(self.detect(*call, "--scalar", "double"), [])
        self.assertEqual(self.detect(*call), [])
        self.assertEqual(self.detect(*call, "--precision", "double"), [])
        self.assertEqual(self.detect(*call, "--precision", "double", "--scalar", "float"), [(0, 0)])


class Points(ProgramTest):
    """The nearest triangles of points, and the side of the surface that they are on."""

    def ask(self, *options):
        """The rows of the table that it writes, as text."""
        self.succeed("detect", "mesh.obj", "spheres.csv", *options, "--output", "found.csv")
        header, *rows = self.read("found.csv").decode().splitlines()
        return header, [row.split(",") for row in rows]

    def cube_and_points(self):
        rng = random.Random(46)
        points = [[rng.randrange(-8, 17) / 8 for _ in range(3)] for _ in range(300)]  # many on faces, edges and corners
        self.scene(*CUBE, points)
        return points

    def test_the_cube(self):
        points = self.cube_and_points()
        header, rows = self.ask("--nearest")
        self.assertEqual(header, "point,triangle,x,y,z,distance")
        self.assertEqual([int(row[0]) for row in rows], list(range(300)))
        _, signed = self.ask("--signed-distance")
        header, inside = self.ask("--inside")
        self.assertEqual(header, "point,inside")
        for point, row, with_sign, (number, flag) in zip(points, rows, signed, inside):
            clamped = [min(max(x, 0), 1) for x in point]
            outside = math.dist(point, clamped)
            depth = min(min(x, 1 - x) for x in point)
            distance = max(outside, depth)
            self.assertEqual(float(row[5]), distance)
            self.assertEqual(float(with_sign[5]), -distance if depth > 0 else distance)
            self.assertEqual((number, flag), (row[0], str(int(depth >= 0))))
            self.assertAlmostEqual(math.dist(point, [float(x) for x in row[2:5]]), distance, places=12)
            plane = {triangle: axis for triangle, axis in zip(range(12), (2, 2, 2, 2, 1, 1, 0, 0, 1, 1, 0, 0))}[int(row[1])]
            self.assertIn(float(row[2 + plane]), (0, 1))

    def test_all_ways_write_the_same(self):
        for question in ("--nearest", "--signed-distance", "--inside"):
            if question == "--nearest":
                self.scene(*random_scene(7, 3)[:3])
            else:
                self.cube_and_points()
            found = self.ask(question)
            for options in (["--broad", "all_pairs"], ["--ranks", "threads:3"], ["--threads", 1]):
                self.assertEqual(self.ask(question, *options), found)

    def test_radii_count(self):
        self.write("mesh.obj", TRIANGLE)
        self.write("spheres.csv", "x,y,z,r\n.25,.25,2,.5\n.25,.25,-1,3\n")
        self.assertEqual([row[5] for row in self.ask("--nearest")[1]], ["1.5", "-2"])

    def test_usage(self):
        self.cube_and_points()
        for words, args in ((["--nearest", "one thing"], ["--nearest", "--inside"]), (["--broad", "bucket"], ["--nearest", "--broad", "bucket"]),
                            (["--contacts"], ["--inside", "--contacts", "c.csv"]), (["--ply"], ["--nearest", "--ply", "p.ply"]),
                            (["--triangles-per-pass"], ["--nearest", "--triangles-per-pass", 3])):
            done = self.run_program("detect", "mesh.obj", "spheres.csv", *args)
            self.assertEqual(done.returncode, 2)
            for word in words:
                self.assertIn(word, done.stderr.decode())

    def test_points_next_to_the_surface(self):
        rng = random.Random(3)
        number = lambda: rng.choice([-1, 0, 0.25, 0.5, 1, 2, 1 - 2.0**-53, 2.0**-70, round(rng.uniform(-1, 2), 3)])
        points = [[number() for _ in range(3)] for _ in range(300)]
        self.scene(*CUBE, points)
        corners = [[[Fraction(x) for x in CUBE[0][i]] for i in t] for t in CUBE[1]]
        for point, row, signed in zip(points, self.ask("--nearest")[1], self.ask("--signed-distance")[1]):
            squares = [programs.squared_distance([Fraction(x) for x in point], t) for t in corners]
            least, distance = min(squares), float(row[5])
            self.assertEqual(int(row[1]), squares.index(least), point)
            below, above = (Fraction(math.nextafter(distance, to)) for to in (0, 9))
            self.assertTrue(below**2 <= least <= above**2, point)
            self.assertEqual(float(signed[5]), -distance if all(0 <= x <= 1 for x in point) else distance, point)

    def test_a_mesh_with_a_hole(self):
        points = self.cube_and_points()
        self.scene(CUBE[0], CUBE[1][:-1], points)
        for asked in ("--inside", "--signed-distance"):
            done = self.run_program("detect", "mesh.obj", "spheres.csv", asked)
            self.assertEqual(done.returncode, 0)
            self.assertRegex(done.stderr.decode(),
                             r"\Adetect: the mesh is not closed, so sides mean little: 3 open edge\(s\)[^\n]*\n\Z")
        self.succeed("detect", "mesh.obj", "spheres.csv", "--nearest")

    def test_a_mesh_that_cuts_itself(self):
        corners, faces = CUBE
        moved = [[x + 0.5 for x in corner] for corner in corners]
        second = [[i + len(corners) for i in face] for face in faces]
        self.scene(corners + moved, faces + second, [[0.25, 0.25, 0.25], [0.75, 0.75, 0.75]])
        done = self.run_program("detect", "mesh.obj", "spheres.csv", "--inside")
        self.assertRegex(done.stderr.decode(), r"\Adetect: the mesh cuts or touches itself, and what is inside twice "
                                               r"counts as outside: \d+ pair\(s\) of triangles, [^\n]*\n\Z")
        self.succeed("detect", "mesh.obj", "spheres.csv", "--nearest")


class ObjTest(ProgramTest):
    """The plate 0 <= x <= 4, 0 <= y <= 4, and where the triangles of a mesh are."""

    def triangles(self, obj, *remarks):
        """The corners of each triangle of the mesh, from the picture; there must be these remarks about the mesh."""
        self.write("mesh.obj", obj)
        self.write("spheres.csv", "x,y,z\n1000,1000,1000\n")
        self.succeed_saying([f"mesh.obj:{remark}" for remark in remarks], "detect", "mesh.obj", "spheres.csv", "--radius", 1, "--ply", "hits.ply")
        vertices, faces = read_ply(self.read("hits.ply"))
        return [tuple(tuple(int(x) for x in vertices[i][0][:2]) for i in corners) for corners, _ in faces]

    square = "v 0 0 0\nv 4 0 0\nv 4 4 0\nv 0 4 0\n"
    two = [((0, 0), (4, 0), (4, 4)), ((0, 0), (4, 4), (0, 4))]


class ObjForms(ObjTest):
    def test_faces_of_every_form(self):
        for faces in ("f 1 2 3\nf 1 3 4\n", "f -4 -3 -2\nf -4 -2 -1\n", "f 1/1 2/2 3/3\nf 1/1 3/1 4/1", "f 1//1 2//1 3//1\nf 1//1 3//1 4//1\n",
                      "f 1/1/1 2/1/1 3/1/1\nf -4/-1/-1 -2/-1/-1 -1/-1/-1\n", "f\t1  2\t 3 \nf 1 3 4 # a comment\n",
                      "f 1 2 3\r\nf 1 3 4\r\n", "f 1 2 \\\n3\nf 1 3 4", "  f 1 2 3\n\n\n# f 1 2 4\nf 1 3 4"):
            for extra in ("", "vt 0 0\nvt 1 0\nvt 1 1\nvn 0 0 1\n"):
                with self.subTest(faces=faces):
                    self.assertEqual(self.triangles(self.square + extra + faces), self.two)

    def test_vertices_of_every_form(self):
        for v in ("v 0 0 0 1\nv 4 0 0 1\nv 4 4 0 1\nv 0 4 0 1\n", "v 0 0 0 .5 .5 .5\nv 4 0 0 1 0 0\nv 4 4 0 0 0 0\nv 0 4 0 0 0 1\n",
                  "v +0 -0 0.\nv 4e0 .0 0\nv 40E-1 +4.0 0e9\nv 0 4.00 0 # last\n", "\ufeffv 0 0 0\r\nv 4 0 0\r\nv 4 4 0\r\nv 0 4 0\r\n",
                  "# C:\\models\\\nv 0 0 0\nv 4 0 0\nv 4 4 0\nv 0 4 0\n"):
            with self.subTest(vertices=v):
                self.assertEqual(self.triangles(v + "f 1 2 3\nf 1 3 4\n"), self.two)

    def test_objects_groups_and_materials_in_the_order_of_the_file(self):
        obj = ("mtllib none.mtl\no first\nv 0 0 0\nv 4 0 0\nv 4 4 0\ng a b\nusemtl red\ns 1\nf 1 2 3\ns off\no second\nv 0 4 0\n"
               "g\nusemtl blue\nl 1 2\np 1\nf 1 3 4\ng a\nf -3 -2 -1\nf 1 2 4\n")
        self.assertEqual(self.triangles(obj), self.two + [((4, 0), (4, 4), (0, 4)), ((0, 0), (4, 0), (0, 4))])

    def test_faces_before_their_vertices(self):
        self.assertEqual(self.triangles("f 1 2 3\nf 1 3 4\n" + self.square), self.two)

    def area(self, triangle):
        (ax, ay), (bx, by), (cx, cy) = triangle
        return ((bx - ax) * (cy - ay) - (by - ay) * (cx - ax)) / 2

    def test_polygons(self):
        shapes = {
            "square": [(0, 0), (4, 0), (4, 4), (0, 4)],
            "arrow, quadrangle": [(0, 0), (8, 0), (2, 2), (0, 8)],
            "arrow, other start": [(8, 0), (2, 2), (0, 8), (0, 0)],
            "narrow arrow": [(-1, 0), (0, 8), (1, 0), (0, 12)],
            "narrow arrow, other start": [(0, 8), (1, 0), (0, 12), (-1, 0)],
            "pentagon": [(0, 0), (4, 0), (6, 3), (2, 6), (-2, 3)],
            "far from the origin": [(100, 100), (104, 100), (106, 103), (102, 106), (98, 103)],
            "corners in line": [(0, 0), (2, 0), (4, 0), (4, 4), (2, 4), (0, 4)],
            "L": [(0, 0), (6, 0), (6, 2), (2, 2), (2, 6), (0, 6)],
            "L far away": [(90, 90), (96, 90), (96, 92), (92, 92), (92, 96), (90, 96)],
            "comb": [(0, 0), (9, 0), (9, 9), (7, 9), (7, 2), (5, 2), (5, 9), (3, 9), (3, 2), (1, 2), (1, 9), (0, 9)],
            "star": [(0, 9), (-2, 3), (-9, 3), (-4, -1), (-6, -8), (0, -4), (6, -8), (4, -1), (9, 3), (2, 3)],
            "300 corners": [(round(1e6 * math.cos(i * math.pi / 150)), round(1e6 * math.sin(i * math.pi / 150))) for i in range(300)],
        }
        for name, corners in shapes.items():
            whole = sum(x * v - u * y for (x, y), (u, v) in zip(corners, corners[1:] + corners[:1])) / 2
            for shape in (corners, corners[::-1]):
                sign = 1 if (shape is corners) == (whole > 0) else -1
                obj = "".join("v %d %d 7\n" % c for c in shape) + "f " + " ".join(str(i + 1) for i in range(len(shape)))
                found = self.triangles(obj)
                with self.subTest(shape=name):
                    # none is turned over and they add up: they tile the polygon
                    self.assertEqual(len(found), len(corners) - 2)
                    self.assertTrue(all(sign * self.area(t) >= 0 for t in found), found)
                    self.assertEqual(sum(abs(self.area(t)) for t in found), abs(whole))

    def test_a_polygon_that_crosses_itself_all_over_takes_no_cubic_time(self):
        rng = random.Random(1)
        n = 20000  # took six minutes
        obj = "".join(f"v {rng.randrange(1000)} {rng.randrange(1000)} 7\n" for _ in range(n))
        begin = time.monotonic()
        found = self.triangles(obj + "f " + " ".join(str(i + 1) for i in range(n)))
        self.assertEqual(len(found), n - 2)
        self.assertLess(time.monotonic() - begin, 60)

    def test_quadrangles_are_cut_along_the_shorter_diagonal(self):
        a, b, c, d = (0, 0), (4, 0), (6, 2), (2, 2)  # from b to d it is shorter
        for corners, cut in (((a, b, c, d), [(a, b, d), (b, c, d)]), ((b, c, d, a), [(b, c, d), (b, d, a)])):
            obj = "".join("v %d %d 0\n" % corner for corner in corners) + "f 1 2 3 4\n"
            self.assertEqual(self.triangles(obj), cut)
        self.assertEqual(self.triangles(self.square + "f 1 2 3 4\n"), [((0, 0), (4, 0), (0, 4)), ((4, 0), (4, 4), (0, 4))])

    def test_degenerate_polygons_keep_their_triangles(self):
        self.assertEqual(len(self.triangles("v 1 1 0\nf 1 1 1 1 1 1\n")), 4)
        self.assertEqual(len(self.triangles("v 0 0 0\nv 1 1 0\nv 2 2 0\nv 3 3 0\nv 4 4 0\nf 1 2 3 4 5\nf 1 2 3 4\n")), 5)
        self.assertEqual(len(self.triangles("v 0 0 0\nv 4 4 0\nv 4 0 0\nv 0 4 0\nv 2 9 0\nf 1 2 3 4 5\n")), 3)

    def test_ids_count_over_polygons(self):
        self.write("mesh.obj", self.square + "v 9 9 9\nv 10 9 9\nv 9 10 9\nf 1 2 3 4\nf 5 6 7\n")
        self.write("spheres.csv", "x,y,z\n9,9,9\n2,2,0\n")
        self.assertEqual(self.detect("mesh.obj", "spheres.csv", "--radius", 1), [(0, 2), (1, 0), (1, 1)])


class OtherFormats(ProgramTest):
    """Files that Assimp reads, where the program is built with it: the same triangles in the same order as in OBJ."""

    SPHERES = [(0, 0, 0), (3, 3, 3), (.5, .5, .5), (1.25, 0, .5), (2.25, 2, 2)]

    def setUp(self):
        super().setUp()
        self.scene(*CUBE, self.SPHERES)
        self.write("mesh.stl", "solid a\nendsolid a\n")
        done = self.run_program("detect", "mesh.stl", "spheres.csv", 1)
        if b"built without Assimp" in done.stderr:
            self.skipTest("detect was built without Assimp")

    def pairs(self, name, content):
        self.write(name, content)
        said = [f"{name}: coordinates are floats, as Assimp reads them"] if name.endswith((".gltf", ".glb")) else []
        self.succeed_saying(said, "detect", name, "spheres.csv", .4, "out.csv")
        return self.read("out.csv")

    def test_the_cube_in_each_format(self):
        vertices, triangles = CUBE
        self.succeed("detect", "mesh.obj", "spheres.csv", .4, "truth.csv")
        truth = self.read("truth.csv")
        self.assertGreater(len(truth.splitlines()), 5)
        numbers = lambda rows: "".join(" ".join(map(str, row)) + "\n" for row in rows)
        faces = numbers((3, *t) for t in triangles)
        self.assertEqual(self.pairs("cube.off", f"OFF\n8 12 0\n{numbers(vertices)}{faces}"), truth)
        self.assertEqual(self.pairs("cube.PLY", "ply\nformat ascii 1.0\nelement vertex 8\n" + "".join(f"property float {x}\n" for x in "xyz") +
                                    f"element face 12\nproperty list uchar int vertex_indices\nend_header\n{numbers(vertices)}{faces}"), truth)
        soup = b"".join(struct.pack("<12fH", 0, 0, 0, *(x for i in t for x in vertices[i]), 0) for t in triangles)
        self.assertEqual(self.pairs("cube.stl", bytes(80) + struct.pack("<I", 12) + soup), truth)

    def gltf(self, node):
        data = struct.pack("<36H", *(i for t in CUBE[1] for i in t)) + struct.pack("<24f", *(x for v in CUBE[0] for x in v))
        return json.dumps({
            "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0, **node}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 1}, "indices": 0}]}],
            "buffers": [{"byteLength": len(data), "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode()}],
            "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 72}, {"buffer": 0, "byteOffset": 72, "byteLength": 96}],
            "accessors": [{"bufferView": 0, "componentType": 5123, "count": 36, "type": "SCALAR"},
                          {"bufferView": 1, "componentType": 5126, "count": 8, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 1]}]})

    def test_a_scene_is_placed_as_its_nodes_say(self):
        self.succeed("detect", "mesh.obj", "spheres.csv", .4, "truth.csv")
        self.assertEqual(self.pairs("cube.gltf", self.gltf({})), self.read("truth.csv"))
        self.write("mesh.obj", "".join("v %g %g %g\n" % tuple(2 * x for x in v) for v in CUBE[0]) +
                   "".join("f %d %d %d\n" % tuple(i + 1 for i in t) for t in CUBE[1]))
        self.succeed("detect", "mesh.obj", "spheres.csv", .4, "truth.csv")
        self.assertEqual(self.pairs("cube.gltf", self.gltf({"scale": [2, 2, 2]})), self.read("truth.csv"))

    def test_what_is_no_mesh_is_named(self):
        self.write("mesh.off", "nonsense\n")
        self.fail_with(1, ["mesh.off: "], "detect", "mesh.off", "spheres.csv", 1, "out.csv")
        self.fail_with(1, ["mesh.off: ", "--strict"], "detect", "mesh.off", "spheres.csv", 1, "out.csv", "--strict")


class RealExporters(ObjTest):
    """Files of other programs that are not quite OBJ: each is read as it was meant, and a line says so."""

    def left_out(self, line, count):
        return f"{line}: a face of fewer than three corners is left out (the first of {count})"

    def no_continuation(self, line, count=1):
        return f"{line}: the backslash at the end does not continue this line, as the next begins with a keyword (the first of {count})"

    def refused_if_strict(self, obj, line, words):
        self.write("mesh.obj", obj)
        self.write("spheres.csv", "x,y,z\n0,0,0\n")
        self.fail_with(1, [f"mesh.obj:{line}: ", *words], "detect", "mesh.obj", "spheres.csv", 1, "out.csv", "--strict")

    def test_faces_of_fewer_than_three_corners(self):
        a, b = "f 1 2 3\n", "f 1 3 4\n"
        for few in ("f 1 2\n", "f 1\n", "f\n", "f \\\n2\n", "f -1/-1 -2\r\n", "f 1//1 # 2 3\n", " f\t2 3 \n", "f 9 8\n"):
            with self.subTest(face=few):
                self.assertEqual(self.triangles(self.square + a + few + b, self.left_out(6, 1)), self.two)
                self.assertEqual(self.triangles(few + self.square + few + a + few + b + few.rstrip("\n"), self.left_out(1, 4)), self.two)
                self.refused_if_strict(self.square + a + few + b, 6, ["three corners"])
        for bad in ("f 1 2x\n", "f 1.5\n", "f 1 nan\n"):  # are no corners, however few
            self.write("mesh.obj", self.square + a + bad)
            self.fail_with(1, ["mesh.obj:6: "], "detect", "mesh.obj", "spheres.csv", 1, "out.csv")
        self.write("mesh.obj", self.square + "f 1 2\n")
        self.fail_with(1, ["mesh.obj: no faces"], "detect", "mesh.obj", "spheres.csv", 1, "out.csv")

    def test_a_well_known_mesh(self):
        # 124,990 faces, of which 201 have two corners or one; the sphere tells the number of the last
        faces = ["f 1 2 3"] * 124_990
        for i in range(201):
            faces[100 + 617 * i] = "f 1 2" if i % 3 else "f 2"
        faces[-1] = "f 4 5 6"
        self.write("mesh.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 9 0 0\nv 9 1 0\nv 9 0 1\n" + "\n".join(faces) + "\n")
        self.write("spheres.csv", "x,y,z\n9,0,0\n")
        text = self.succeed_saying([f"mesh.obj:{self.left_out(107, 201)}"], "detect", "mesh.obj", "spheres.csv", 0.5, "pairs.csv")
        self.assertIn(" 124789 triangles\n", text)
        self.assertEqual(self.pairs("pairs.csv"), [(0, 124_788)])

    def test_names_that_end_in_a_backslash(self):
        for name in ("mtllib C:\\stuff\\", "o a\\", "g a b\\", "g \\ ", "usemtl a \\", "s off\\ ", "usemap D:\\maps\\\t", "maplib \\\\server\\maps\\\\",
                     "shadow_obj ..\\", "trace_obj ..\\", "call ..\\", "csh dir\\", "lod 1\\", "mg off\\", "bevel off\\", "c_interp off\\", "d_interp off\\",
                     "vt 0 0\\", "vn 0 0 1 \\", "vp 0\\", "l 1 2\\", "p 1\\"):
            for end in ("\n", "\r\n"):
                with self.subTest(name=name, end=end):
                    vertices, faces = self.square.replace("\n", end), f"f 1 2 3{end}{name}{end}f 1 3 4{end}"
                    self.assertEqual(self.triangles(vertices + faces, self.no_continuation(6)), self.two)
                    self.assertEqual(self.triangles(f"{name}{end}{vertices}{faces}", self.no_continuation(1, 2)), self.two)
                    # nothing that matters goes on in a blank line, a comment or the end of the file
                    for after in (f"{end}", f" \t{end}", f"# f 1 2 3{end}", f"  # \\{end}", f"\\{end}{end}"):
                        self.assertEqual(self.triangles(f"{name}{end}{after}{vertices}f 1 2 3{end}{name}{end}{after}f 1 3 4{end}{name}"), self.two)
                    self.refused_if_strict(vertices + faces, 6, ["backslash"])

    def test_lines_that_go_on(self):
        for faces in ("f 1 2 \\\n3\nf 1 3 4", "f 1 2\\\n3\nf 1 3 4", "f 1 2 \\  \n  3\nf 1 3 4", "f 1 2 \\\r\n3\r\nf 1 3 4\r\n", "f 1 \\\n2 \\\n3\nf 1 3 4 \\",
                      "f \\\n1 2 3\nf \\ # now\n1 3 4", "\\\nf 1 2 3\n \\ \n\\\nf 1 3 4\n", "f 1 2 3 \\\n\nf 1 3 4\\\n# the end", "f\\\n1 2 3\nf 1 3 4",
                      "g a \\\nb c\nf 1 2 3\ng \\\n a\\\nb\nf 1 3 4\n", "vn 0 0 \\\n1\nf 1 2 3\nl 1 \\\n2\nf 1 3 4\n", "# a \\\nf 1 2 3\n#\\\nf 1 3 4"):
            with self.subTest(faces=faces):
                self.assertEqual(self.triangles(self.square + faces), self.two)
        self.assertEqual(self.triangles("v 0 0 \\\n0\nv \\\n4 0 0\nv 4 4\\\n 0\nv 0 4 0\\\n\nf 1 2 3\nf 1 3 4"), self.two)

    def test_what_cannot_go_on_is_refused(self):
        self.write("spheres.csv", ONE_SPHERE)
        for lines in ("f 1 2 3 \\\nf 1 3 4\n", "f 1 2 3\\\ng a\nf 1 3 4\n", "f 1 2 \\\n# three\n3\n", "v 1 2 3 \\\nf 1 2 3\n", "v 1 2 3\\\nv 1 2 3\n",
                      "f 1 2 \\\\\n3\n", "banana\\\nf 1 2 3\n"):
            with self.subTest(lines=lines):
                self.write("mesh.obj", self.square + lines)
                message = self.fail_with(1, ["mesh.obj:"], "detect", "mesh.obj", "spheres.csv", 1, "out.csv")
                self.assertRegex(message, "mesh.obj:[567]: ")

    def test_what_is_no_number_is_refused_even_where_no_face_needs_it(self):
        self.write("spheres.csv", ONE_SPHERE)
        for number in ("nan", "-nan", "inf", "3.1+e2", "3.1e", "3,1", "-1.IND"):
            self.write("mesh.obj", TRIANGLE + f"v 0 {number} 0\n")
            self.fail_with(1, ["mesh.obj:5: ", f"'{number}'"], "detect", "mesh.obj", "spheres.csv", 1, "out.csv")


class CsvForms(ProgramTest):
    def spheres(self, csv, *options):
        """The spheres that touch a triangle around the origin."""
        self.write("mesh.obj", "v -1 -1 0\nv 1 -1 0\nv 0 1 0\nf 1 2 3\n")
        self.write("spheres.csv", csv)
        return [s for s, _ in self.detect("mesh.obj", "spheres.csv", *options)]

    def test_every_form(self):
        forms = {
            "plain": "x,y,z\n0,0,0\n5,5,5\n0,0,.5\n",
            "no final newline": "x,y,z\n0,0,0\n5,5,5\n0,0,.5",
            "CRLF": "x,y,z\r\n0,0,0\r\n5,5,5\r\n0,0,.5\r\n",
            "CRLF, no final newline": "x,y,z\r\n0,0,0\r\n5,5,5\r\n0,0,.5",
            "any order": "z,y,x\n0,0,0\n5,5,5\n.5,0,0\n",
            "other columns": "id,x,name,y,z,t\n1,0,a,0,0,nan\n2,5,b c,5,5,\n3,0,,0,.5,-1\n",
            "quotes": '"x","y","z","note"\n0,0,0,"a, b"\n"5","5","5","say ""hi"", twice"\n0,0,".5",""\n',
            "blanks": " x , y ,\tz \n 0 , 0 , 0 \n 5,5,5\n0,0,\t.5\t\n",
            "byte order mark": "\ufeffx,y,z\n0,0,0\n5,5,5\n0,0,.5\n",
            "blank lines": "\nx,y,z\n0,0,0\n\n5,5,5\n  \n0,0,.5\n\n\n",
            "NumPy's header": "# x,y,z\n0.000e+00,0.000e+00,0.000e+00\n5e0,5e0,5e0\n0,0,5.0e-01\n",
            "numbers of every form": "x,y,z\n-0,+0,0.\n5.0,+5e0,.5E1\n0e5,-0.0,5e-1\n",
            "too small to tell from 0": "x,y,z\n1e-400,-1e-5000,1e-46\n5,5,5\n0,0,.5\n",
            "a byte that is no text elsewhere": "x,y,z,\u00e9\n0,0,0,\u00fc\n5,5,5,\n0,0,.5,\n",
        }
        for name, csv in forms.items():
            with self.subTest(form=name):
                self.assertEqual(self.spheres(csv, "--radius", 1), [0, 2])

    def test_radii(self):
        csv = "r,x,y,z\n.25,0,0,.5\n.5,0,0,.5\n0,0,0,0\n-0,0,0,0\n9,5,5,5\n"
        self.assertEqual(self.spheres(csv), [1, 2, 3, 4])
        self.assertEqual(self.spheres(csv, "--radius", 1), [1, 2, 3, 4])  # the file knows better
        self.assertIn("column r", self.succeed("detect", "mesh.obj", "spheres.csv", "--radius", 1))

    def test_no_spheres(self):
        for csv in ("x,y,z\n", "x,y,z", "x,y,z\r\n\r\n"):
            self.assertEqual(self.spheres(csv, "--radius", 1), [])
            self.assertEqual(self.read("pairs.csv"), b"sphere,triangle\n")

        self.assertEqual(self.spheres("x,y,z,r\n"), [])

    def test_from_a_pipe(self):
        self.write("mesh.obj", TRIANGLE)
        out = subprocess.run([programs.PROGRAMS / "detect", "mesh.obj", "/dev/stdin", "1", "/dev/stdout"], cwd=self.folder,
                             input=b"x,y,z\n0,0,0\n", capture_output=True)
        self.assertEqual((out.returncode, out.stdout, out.stderr), (0, b"sphere,triangle\n0,0\n", b""))


class Rounding(ProgramTest):
    """Numbers reach the scalar type in one correct rounding: coordinates and radii are seen in the picture."""

    numbers = [
        "1.000000059604644775390625",  # halfway between two floats: to even, down
        "1.0000000596046447753906250000000000000000000001",  # a hair above it: up; a double cannot tell
        "1.0000000596046447753906249999999999999999999999",
        "1.000000178813934326171875",  # halfway, to even, up
        "0.1", "0.3", "16777217", "16777219", "123456789.123456789", "3.14159265358979323846264338327950288",
        "2.2250738585072011e-308", "4.9e-324", "1e-45", "7.0064923216240853546186479164495e-46", "7.0064923216240853546186479164496e-46",
        "1.17549435082228750797e-38", "340282346638528859811704183484516925440",
        "9007199254740993", "9007199254740992.9999999999", "179769313486231570e21", "8.5e-10",
        "0.000000000000000000000000000000000000011754942807573642918",
    ]

    def test_coordinates(self):
        for scalar, kind in (("float", "f"), ("double", "d")):
            for text in self.numbers:
                with self.subTest(scalar=scalar, number=text):
                    expected = nearest(text, kind)
                    self.write("mesh.obj", f"v {text} 0 0\nv {text} 0 0\nv {text} 0 0\nf 1 2 3\n")
                    self.write("spheres.csv", f"x,y,z\n{text},0,0\n")
                    self.succeed("detect", "mesh.obj", "spheres.csv", "--radius", 0, "--scalar", scalar, "--precision", "double",
                                 "--ply", "hits.ply", "--output", "pairs.csv")
                    self.assertEqual(self.pairs("pairs.csv"), [(0, 0)])
                    vertices, _ = read_ply(self.read("hits.ply"))
                    self.assertEqual([v[0][0] for v in vertices], [expected] * 9)  # 3 corners and an octahedron of radius 0

    def test_radii(self):
        self.write("mesh.obj", "v 0 0 0\nv 0 0 0\nv 0 0 0\nf 1 2 3\n")
        self.write("with.csv", "x,y,z,r\n" + "".join(f"0,0,0,{text}\n" for text in self.numbers))
        self.write("without.csv", "x,y,z\n0,0,0\n")
        for scalar, kind in (("float", "f"), ("double", "d")):
            expected = [nearest(text, kind) for text in self.numbers]
            self.succeed("detect", "mesh.obj", "with.csv", "--scalar", scalar, "--ply", "hits.ply")
            vertices, _ = read_ply(self.read("hits.ply"))
            self.assertEqual([v[0][0] for v in vertices[3::6]], expected)
            for text, value in list(zip(self.numbers, expected))[:4]:
                self.succeed("detect", "mesh.obj", "without.csv", "--radius", text, "--scalar", scalar, "--ply", "hits.ply")
                vertices, _ = read_ply(self.read("hits.ply"))
                self.assertEqual(vertices[3][0][0], value)

    def test_contacts_read_back_the_same(self):
        self.write("mesh.obj", "v 0.1 0 0\nv 0.1 0 0\nv 0.1 0 0\nf 1 2 3\n")
        self.write("spheres.csv", "x,y,z\n0.1,0,0.5\n")
        for scalar, text in (("float", "0.1"), ("double", "0.1")):
            self.succeed("detect", "mesh.obj", "spheres.csv", "1", "--scalar", scalar, "--contacts", "c.csv")
            row = self.read("c.csv").decode().splitlines()[1].split(",")
            self.assertEqual(row[2], text)  # the shortest number that reads back the same


class Scalar(ProgramTest):
    """Which scalar type is taken, and what is said of the numbers that had to be rounded to it."""

    @staticmethod
    def roundings(numbers, kind):
        """How many of the texts had to be rounded to 'f'loat or 'd'ouble, and by how much at most."""
        moved = [abs(Fraction(text) - Fraction(nearest(text, kind))) for text in numbers]
        return sum(m > 0 for m in moved), max(moved, default=0)

    def check(self, text, numbers, scalar, chosen=False, coarse=False):
        """That the last line of `text` says what is true of the numbers."""
        pattern = r"(\w+) of (\d+) numbers had to be rounded to (\w+)(?:, by at most (\S+?))?(, more than a thousandth of a radius)?" \
                  r"(?:; float (?:would move one by (\S+)|(cannot hold one)))?"
        found = re.fullmatch(pattern, text.splitlines()[-1])
        self.assertTrue(found, text)
        count, most = self.roundings(numbers, scalar[0])
        self.assertEqual(found.groups()[:3], (str(count) if count else "none", str(len(numbers)), scalar))
        self.assertEqual(found[4] is not None, count > 0)
        if count:
            bound = Fraction(float(found[4]))  # six digits of it
            self.assertGreaterEqual(bound * (1 + Fraction(1, 10**5)), most)
            self.assertLessEqual(bound, max(Fraction(abs(float(n))) for n in numbers) / 2**53 if scalar == "double" else most * (1 + Fraction(1, 10**5)))
        self.assertEqual(found[5] is not None, coarse, text)
        self.assertEqual(found[6] is not None or found[7] is not None, chosen, text)
        if found[6]:
            self.assertAlmostEqual(float(found[6]) / float(self.roundings(numbers, "f")[1]), 1, 5)

    def test_surveyed_coordinates(self):
        mesh, csv = DATA / "survey.obj", DATA / "survey.csv"
        words = [line.split() for line in mesh.read_text().splitlines()]
        rows = [line.split(",") for line in csv.read_text().splitlines()[1:]]
        vertices = [w[1:] for w in words if w[0] == "v"]
        triangles = [tuple(int(i) - 1 for i in w[1:]) for w in words if w[0] == "f"]
        truth = true_pairs(vertices, triangles, rows, ["0.02"] * len(rows))
        self.assertEqual(len(truth), 11)
        numbers = [x for row in vertices + rows for x in row] + ["0.02"]
        call = [mesh, csv, "--radius", "0.02", "--output", "pairs.csv"]
        for options, scalar, chosen in ((), "double", True), (("--precision", "double"), "double", False), (("--scalar", "double"), "double", False), \
                                       (("--precision", "single"), "double", True), (("--broad", "all_pairs"), "double", True):
            with self.subTest(options=options):
                text = self.succeed("detect", *call, *options)
                self.assertEqual(self.pairs("pairs.csv"), truth)
                self.check(text, numbers, scalar, chosen)
        text = self.succeed("detect", *call, "--scalar", "float")
        self.assertNotEqual(self.pairs("pairs.csv"), truth)
        self.check(text, numbers, "float", coarse=True)

    def test_when_float_is_too_coarse(self):
        near = "16777217"  # is moved by 1
        for place in ("mesh", "centre", "unused vertex", "radii"):
            for radius, scalar in (("1001", "float"), ("999", "double")):
                vertices = ["0", near if place == "mesh" else "1"]
                self.write("mesh.obj", f"v 0 0 0\nv {vertices[1]} 0 0\nv 0 1 0\nf 1 2 3\n" + (f"v 0 {near} 0\n" if place == "unused vertex" else ""))
                numbers = ["0"] * 7 + [vertices[1], "1"] + (["0", near, "0"] if place == "unused vertex" else []) + ["0", near if place == "centre" else "5", "0"]
                if place == "radii":
                    self.write("spheres.csv", f"x,y,z,r\n0,5,0,{radius}\n0,5,0,{near}\n")
                    numbers += ["0", "5", "0", radius, near]
                    call = ["mesh.obj", "spheres.csv"]
                else:
                    self.write("spheres.csv", f"x,y,z\n0,{near if place == 'centre' else 5},0\n")
                    numbers.append(radius)
                    call = ["mesh.obj", "spheres.csv", "--radius", radius]
                with self.subTest(place=place, radius=radius):
                    self.assertEqual(self.report(*call)["scalar"], scalar)
                    self.check(self.succeed("detect", *call), numbers, scalar, chosen=scalar == "double")
                    self.check(self.succeed("detect", *call, "--scalar", "float"), numbers, "float", coarse=scalar == "double")
        self.write("spheres.csv", "x,y,z,r\n")  # no spheres, to which nothing can matter
        self.write("mesh.obj", f"v 0 0 0\nv {near} 0 0\nv 0 1 0\nf 1 2 3\n")
        self.assertEqual(self.report("mesh.obj", "spheres.csv")["scalar"], "float")

    def test_the_radius_of_the_command_line(self):
        self.write("mesh.obj", TRIANGLE)
        self.write("spheres.csv", "x,y,z\n0,0,1e-40\n")
        for radius, scalar in (("0.1", "float"), ("1e-40", "float"), ("1e-44", "double"), ("1e39", "double"), ("inf", "float"), ("0", "double")):
            text = self.succeed("detect", "mesh.obj", "spheres.csv", "--radius", radius)
            self.assertIn(f" of 13 numbers had to be rounded to {scalar}", text, radius)

    def test_numbers_of_every_form(self):
        forms = [*Rounding.numbers, "0", "-0", "+0.0", "0e9", "0.000000000000000000000000000", "1", "-1", "+1", "0.5", "0.50", "5e-1", "5E-001", ".5", "1.", "1e3", "1e+3", "12e3",
                 "1e22", "1e23", "123456789012345", "1234567890123456", "9007199254740993", "0.1e1", "10e-1", "0.1e20", "1e-400", "0.0000005e5", "0.0000005e6", "0.0625", "0.06250000001",
                 "0.000030517578125", "0.00003051757812500000000000000000000000000000000000001", "1.000000000000000000e+00", "1.250000000000000000e-01", "1.100000023841857910e+00",
                 "1.10000002384185791015625", "1.10000002384185791015626", "4503599627370496.5", "4503599627370497.25", "0.333251953125", "33.3251953125e-2", "1e-22", "1e-23", "1e15"]
        self.write("mesh.obj", TRIANGLE)
        for text in forms:
            self.write("spheres.csv", f"x,y,z\n0,0,{text}\n")
            numbers = ["0", "0", "0", "1", "0", "0", "0", "1", "0", "0", "0", text, "1"]
            for scalar in ("float", "double"):
                with self.subTest(number=text, scalar=scalar):
                    if scalar == "float" and abs(float(text)) > 3.5e38:
                        continue
                    said = self.succeed("detect", "mesh.obj", "spheres.csv", 1, "--scalar", scalar)
                    count, most = self.roundings(numbers, scalar[0])
                    self.assertRegex(said, f"\n{count or 'none'} of 13 numbers had to be rounded to {scalar}")
                    if count:
                        bound = Fraction(float(re.search("by at most ([^,;\n]+)", said)[1]))
                        self.assertLessEqual(most, bound * (1 + Fraction(1, 10**5)))

    def test_it_is_said_where_standard_output_has_something_else(self):
        self.write("mesh.obj", TRIANGLE)
        self.write("spheres.csv", "x,y,z\n0.25,0.25,0.1\n")
        said = "1 of 13 numbers had to be rounded to float, by at most 1.49012e-09"
        self.assertTrue(self.succeed("detect", "mesh.obj", "spheres.csv", 1).endswith(f"\n{said}\n"))
        self.assertEqual(self.succeed_saying([said], "detect", "mesh.obj", "spheres.csv", 1, "/dev/stdout"), "sphere,triangle\n0,0\n")
        self.write("spheres.csv", "x,y,z\n0.25,0.25,0.125\n")
        self.assertTrue(self.succeed("detect", "mesh.obj", "spheres.csv", 1).endswith("\nnone of 13 numbers had to be rounded to float\n"))
        self.assertEqual(self.succeed("detect", "mesh.obj", "spheres.csv", 1, "/dev/stdout"), "sphere,triangle\n0,0\n")

    def test_a_float_read_by_choice_is_rounded_once(self):
        for text in Rounding.numbers:
            if float(text) < 1e30:
                self.write("mesh.obj", f"v {text} 0 0\nv {text} 0 0\nv {text} 0 0\nf 1 2 3\n")
                self.write("spheres.csv", f"x,y,z\n{text},0,0\n")
                self.succeed("detect", "mesh.obj", "spheres.csv", "--radius", "1e30", "--ply", "hits.ply")
                vertices, _ = read_ply(self.read("hits.ply"))
                self.assertEqual([v[0][0] for v in vertices[:3]], [nearest(text, "f")] * 3)

    def test_from_pipes(self):
        for mesh, csv in ((DATA / "survey.obj", "/dev/stdin"), ("/dev/stdin", DATA / "survey.csv")):
            content = (DATA / ("survey.csv" if csv == "/dev/stdin" else "survey.obj")).read_bytes()
            done = subprocess.run([programs.PROGRAMS / "detect", mesh, csv, "0.02"], input=content, capture_output=True)
            self.assertTrue(done.stdout.startswith(b"11 colliding pairs"), done)


class BadMesh(ProgramTest):
    def test_bad_lines_are_named(self):
        good = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
        for line in ("f 1 2 3x", "f 1 2 4", "f 1 2 0", "f 0/1/1 1/1/1 2/1/1", "f 1 2 -4", "f 1 2 99999999999", "f 1 2 4294967297",
                     "f 1.5 2 3", "f 1/2/3/4 2 3", "f a b c", "f 1,2,3", "f /1 2 3", "v", "v 1", "v 1 2", "v 1 2 x", "v 1,2,3", "v 1 2 nan",
                     "v inf 0 0", "v 0 -infinity 0", "v 1e999 0 0", "v 0x10 0 0", "v +-1 0 0", "v -+1 0 0", "v 1e 0 0", "v 1.2.3 0 0",
                     "v 1 2 3 x", "banana", "x,y,z", "vx 1 2 3", "v\0 0 0 0", "f 1 2 3\r4", "\x7fELF"):
            with self.subTest(line=line):
                self.write("mesh.obj", good + "# five\n" + line + "\nf 1 2 3\n")
                self.write("spheres.csv", ONE_SPHERE)
                self.fail_with(1, ["mesh.obj:6: "], "detect", "mesh.obj", "spheres.csv", 1, "out.csv")

    def test_an_index_out_of_range_is_named(self):
        self.write("spheres.csv", ONE_SPHERE)
        for index in (0, 4, -4):
            self.write("mesh.obj", f"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 {index}\n")
            self.fail_with(1, ["mesh.obj:4: ", f"vertex {index} "], "detect", "mesh.obj", "spheres.csv", 1, "out.csv")

    def test_the_line_is_right_after_continued_and_foreign_line_ends(self):
        self.write("spheres.csv", ONE_SPHERE)
        for text, line in (("v 0 0 0\r\nv 1 \\\r\n0 0\r\nbad\r\n", 4), ("v 0 0 \\\nx\n", 1), ("\n\n\nv 0 0\n", 4),
                           ("v 0 0 0\nf 1 1 2\n# then\nv 0 0 0 0 x", 4), ("v 0 0 0\nf 1 1 9\nv 0 0 0\n", 2)):
            self.write("mesh.obj", text)
            self.fail_with(1, [f"mesh.obj:{line}: "], "detect", "mesh.obj", "spheres.csv", 1, "out.csv")

    def test_no_mesh(self):
        self.write("spheres.csv", ONE_SPHERE)
        self.write("empty.obj", "")
        self.write("comments.obj", "# nothing\n\n")
        self.write("points.obj", "v 0 0 0\n")
        for mesh in ("missing.obj", "empty.obj", "comments.obj", "points.obj", ".", "spheres.csv", "no/such/folder.obj"):
            self.fail_with(1, [mesh + ":"], "detect", mesh, "spheres.csv", 1, "out.csv")

    def test_what_a_message_quotes_is_short_and_plain(self):
        self.write("spheres.csv", ONE_SPHERE)
        self.write("mesh.obj", b"\x1b[31m" + b"x" * 100000 + b"\n")
        message = self.fail_with(1, ["mesh.obj:1"], "detect", "mesh.obj", "spheres.csv", 1)
        self.assertLess(len(message), 200)
        self.assertNotIn("\x1b", message)


class BadSpheres(ProgramTest):
    def test_bad_rows_are_named(self):
        self.write("mesh.obj", TRIANGLE)
        for row in ("1,2", "1", "1,2,3,4,5", "1,2,,1", ",,,", "1,2,x,1", "1 2,3,4,1", "1;2;3;4", "nan,0,0,1", "0,NaN,0,1", "0,0,inf,1", "0,-inf,0,1",
                    "0,0,0,nan", "0,0,0,inf", "0,0,0,-1", "0,0,0,-1e-30", "1e999,0,0,1", '"1,0,0,1', '"1"2,0,0,1', "0x1,0,0,1", "1e,0,0,1",
                    "--1,0,0,1", "+-1,0,0,1", "x,y,z,r", "1,2,3,4,", "1,2,3,\0"):
            with self.subTest(row=row):
                self.write("spheres.csv", "x,y,z,r\n0,0,0,1\n\n" + row + "\n0,0,0,1\n")
                self.fail_with(1, ["spheres.csv:4: "], "detect", "mesh.obj", "spheres.csv", "--output", "out.csv")
                self.write("spheres.csv", "x,y,z,r\r\n0,0,0,1\r\n" + row)
                self.fail_with(1, ["spheres.csv:3: "], "detect", "mesh.obj", "spheres.csv", "--output", "out.csv")

    def test_a_number_that_is_too_large_for_float_only(self):
        self.write("mesh.obj", TRIANGLE)
        self.write("spheres.csv", "x,y,z\n1e39,0,0\n")
        self.fail_with(1, ["spheres.csv:2: "], "detect", "mesh.obj", "spheres.csv", 1, "out.csv", "--scalar", "float")
        self.assertEqual(self.detect("mesh.obj", "spheres.csv", "--radius", 1, "--precision", "double"), [])
        self.write("far.obj", "v 0 0 0\nv 1e39 0 0\nv 0 1 0\nf 1 2 3\n")
        self.fail_with(1, ["far.obj:2: "], "detect", "far.obj", "spheres.csv", 1, "out.csv", "--scalar", "float")
        self.assertEqual(self.detect("far.obj", "spheres.csv", "--radius", 1), [(0, 0)])
        text = self.succeed("detect", "mesh.obj", "spheres.csv", 1)
        self.assertRegex(text, r"^0 colliding pairs.*\n(.*\n)*1 of 13 numbers had to be rounded to double, by at most 1.\d+e\+23, more than a thousandth of a radius; float cannot hold one\n$")

    def test_bad_headers(self):
        self.write("mesh.obj", TRIANGLE)
        for header, column in (("x,y", "z"), ("a,b,c", "x"), ("1,2,3", "x"), ("x y z", "x"), ("X,Y,Z", "x"), ("x;y;z", "x"), ("x,x,y,z", "x"),
                               ('"x,y,z', "quotation")):
            self.write("spheres.csv", header + "\n1,2,3\n")
            self.fail_with(1, ["spheres.csv:1: ", column], "detect", "mesh.obj", "spheres.csv", 1, "out.csv")

    def test_no_spheres(self):
        self.write("mesh.obj", TRIANGLE)
        self.write("empty.csv", "")
        self.write("blank.csv", "\n \n")
        for spheres in ("missing.csv", "empty.csv", "blank.csv", ".", "mesh.obj"):
            self.fail_with(1, [spheres + ":"], "detect", "mesh.obj", spheres, 1, "out.csv")


class BadUsage(ProgramTest):
    def test_usage(self):
        self.write("mesh.obj", TRIANGLE)
        self.write("spheres.csv", ONE_SPHERE)
        files = ["mesh.obj", "spheres.csv"]
        for words, args in ((["mesh"], []), (["spheres"], ["mesh.obj"]), (["--radius"], files), (["--nonsense"], [*files, 1, "--nonsense"]),
                            (["-q"], [*files, 1, "-q"]), (["five"], [*files, 1, "o", "five"]), (["--radius", "-1"], [*files, "--radius", -1]),
                            (["--radius", "-1"], [*files, -1, "out.csv"]), (["--radius"], [*files, "--radius", "nan"]),
                            (["--radius"], [*files, "--radius", "-nan"]), (["--radius"], [*files, "--radius", "-inf"]),
                            (["--radius", "1x"], [*files, "--radius", "1x"]), (["--radius"], [*files, "--radius", ""]), (["--radius"], [*files, "--radius"]),
                            (["--radius"], [*files, "--radius", 1, "--radius", 2]), (["--broad"], [*files, 1, "--broad", "tree"]),
                            (["--broad"], [*files, 1, "--broad"]), (["--space"], [*files, 1, "--space", "moon"]),
                            (["--precision"], [*files, 1, "--precision", "half"]), (["--scalar"], [*files, 1, "--scalar", "int"]),
                            (["--threads"], [*files, 1, "--threads", -1]), (["--threads"], [*files, 1, "--threads", "two"]),
                            (["--threads"], [*files, 1, "--threads", "1.5"]), (["--repeat"], [*files, 1, "--repeat", 0]),
                            (["--repeat"], [*files, 1, "--repeat", "x"]), (["--cell-width"], [*files, 1, "--cell-width", -2]),
                            (["--cell-width"], [*files, 1, "--cell-width", "nan"]), (["--cell-width"], [*files, 1, "--cell-width", "inf"]),
                            (["--cell-width"], [*files, 1, "--cell-width", "wide"]), (["--output", "mesh.obj"], [*files, 1, "./mesh.obj"]),
                            (["--triangles-per-pass"], [*files, 1, "--triangles-per-pass", 0]),
                            (["--triangles-per-pass"], [*files, 1, "--triangles-per-pass", "-1"]),
                            (["--triangles-per-pass"], [*files, 1, "--triangles-per-pass", "1.5"]),
                            (["--triangles-per-pass", "host"], [*files, 1, "--triangles-per-pass", 7, "--space", "cuda"]),
                            (["--report", "--output"], [*files, 1, "new", "--report", "new"]), (["--ply"], [*files, 1, "--ply", "spheres.csv"])):
            with self.subTest(args=args):
                self.fail_with(2, words, "detect", *args)
        self.assertEqual(self.read("mesh.obj").decode(), TRIANGLE)

    def test_cuda_that_is_not_there(self):
        self.write("mesh.obj", TRIANGLE)
        self.write("spheres.csv", ONE_SPHERE)
        for space in ("cuda", "cuda_shared"):
            done = self.run_program("detect", "mesh.obj", "spheres.csv", 1, "--space", space)
            if done.returncode == 0:
                self.skipTest("there is a CUDA device")
            self.fail_with(1, ["--space", "CUDA"], "detect", "mesh.obj", "spheres.csv", 1, "--space", space)

    def test_help_and_version(self):
        text = self.succeed("detect", "--help")
        for option in ("--radius", "--broad", "--space", "--precision", "--threads", "--cell-width", "--output", "--contacts", "--ply", "--report",
                       "--repeat", "--strict", "--triangles-per-pass", "--scalar", "all_pairs", "bucket", "host", "cuda_shared", "exact", "single", "double"):
            self.assertIn(option, text)
        self.assertRegex(self.succeed("detect", "--version"), r"^detect .*\d+\.\d+\.\d+\n$")


class Outputs(ProgramTest):
    def setUp(self):
        super().setUp()
        self.scene(*CUBE, [(0, 0, 0), (3, 3, 3), (.5, .5, .5), (1.3, 0, .5)])
        self.call = ["mesh.obj", "spheres.csv", "--radius", ".4"]

    def test_contacts(self):
        self.succeed("detect", *self.call, "--contacts", "c.csv", "--output", "p.csv")
        header, *rows = [line.split(",") for line in self.read("c.csv").decode().splitlines()]
        self.assertEqual(header, "sphere,triangle,x,y,z,nx,ny,nz,depth,feature,index".split(","))
        self.assertEqual([(int(r[0]), int(r[1])) for r in rows], self.pairs("p.csv"))
        for row in rows:
            values = dict(zip(header, row))
            self.assertIn(values["feature"], ("face", "edge", "vertex"))
            if row[0] == "3":
                self.assertAlmostEqual(float(values["x"]), 1)
                self.assertAlmostEqual(float(values["z"]), .5)
                self.assertAlmostEqual(float(values["nx"]), 1)
                self.assertAlmostEqual(float(values["depth"]), .1, 6)

    def test_picture(self):
        self.succeed("detect", *self.call, "--ply", "h.ply", "--output", "p.csv")
        found = self.pairs("p.csv")
        vertices, faces = read_ply(self.read("h.ply"))
        self.assertEqual((len(vertices), len(faces)), (8 + 2 * 6, 12 + 2 * 8))
        colours = [colour for _, colour in faces]
        hit = {t for _, t in found}
        self.assertNotEqual(len(hit), 12)
        self.assertEqual([c == (214, 39, 40) for c in colours[:12]], [t in hit for t in range(12)])
        self.assertEqual(set(colours[12:]), {(31, 119, 180)})
        for centre, corners in ((0, vertices[8:14]), (1.3, vertices[14:20])):
            self.assertAlmostEqual(sum(v[0][0] for v in corners) / 6, centre, 6)
            self.assertAlmostEqual(max(v[0][2] for v in corners) - min(v[0][2] for v in corners), .8, 6)

    def test_a_full_disk(self):
        for option in ("--output", "--contacts", "--ply", "--report"):
            self.fail_with(1, ["/dev/full", "space"], "detect", *self.call, option, "/dev/full")
        # the others do not appear either, and what was there stays
        self.write("pairs.csv", "old")
        self.fail_with(1, ["/dev/full"], "detect", *self.call, "--output", "pairs.csv", "--contacts", "c.csv", "--report", "/dev/full")
        self.assertEqual(self.read("pairs.csv"), b"old")
        done = self.run_program("detect", *self.call)
        self.assertEqual(done.returncode, 0)
        with open("/dev/full", "wb") as full:
            done = subprocess.run([programs.PROGRAMS / "detect", *self.call], cwd=self.folder, stdout=full, stderr=subprocess.PIPE)
        self.assertEqual((done.returncode, done.stderr.count(b"\n")), (1, 1))

    def test_a_file_that_may_not_grow(self):
        def limit():
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (20, 20))
        options = {"preexec_fn": limit, "restore_signals": False}
        self.write("pairs.csv", "old")
        self.fail_with(1, ["pairs.csv"], "detect", *self.call, "--output", "pairs.csv", **options)
        self.assertEqual(self.read("pairs.csv"), b"old")

    def test_places_that_cannot_be_written(self):
        os.mkdir(self.path("folder"))
        for path in ("no/such/folder/x.csv", "folder", "mesh.obj/x.csv"):
            self.fail_with(1, [path], "detect", *self.call, "--output", path)

    def test_replacing_keeps_links_and_permissions(self):
        self.write("target.csv", "old")
        os.chmod(self.path("target.csv"), 0o640)
        os.symlink("target.csv", self.path("link.csv"))
        self.succeed("detect", *self.call, "--output", "link.csv")
        self.assertTrue(os.path.islink(self.path("link.csv")))
        self.assertNotEqual(self.pairs("target.csv"), [])
        self.assertEqual(stat.S_IMODE(os.stat(self.path("target.csv")).st_mode), 0o640)
        self.assertEqual(self.files(), ["link.csv", "mesh.obj", "spheres.csv", "target.csv"])

    def test_new_files_obey_the_umask(self):
        self.succeed("detect", *self.call, "--output", "new.csv", preexec_fn=lambda: os.umask(0o027))
        self.assertEqual(stat.S_IMODE(os.stat(self.path("new.csv")).st_mode), 0o640)

    def test_standard_output(self):
        self.succeed("detect", *self.call, "--output", "p.csv")
        done = self.run_program("detect", *self.call, "--output", "/dev/stdout")
        self.assertEqual((done.returncode, done.stdout), (0, self.read("p.csv")))
        with open(self.path("redirected"), "wb") as out:
            subprocess.run([programs.PROGRAMS / "detect", *self.call, "--output", "/dev/stdout"], cwd=self.folder, stdout=out, stderr=subprocess.DEVNULL,
                           check=True)
        self.assertEqual(self.read("redirected"), self.read("p.csv"))

    def test_summary(self):
        text = self.succeed("detect", *self.call)
        self.assertIn(f"{len(self.detect(*self.call))} colliding pairs of 4 spheres and 12 triangles", text)


class Ranks(ProgramTest):
    """Several ranks write what one process writes, byte by byte."""
    OUTPUTS = ("--output", "pairs.csv", "--contacts", "contacts.csv", "--ply", "hits.ply")

    def written(self, *args):
        self.succeed("detect", "mesh.obj", "spheres.csv", *args, *self.OUTPUTS)
        return [self.read(name) for name in ("pairs.csv", "contacts.csv", "hits.ply")]

    def on_mpi(self, n, *args):
        return self.run_on_mpi(n, "detect", *args)

    def test_threads(self):
        vertices, triangles, spheres, radii = random_scene(3, 1)
        for given, args in ((radii, ()), (None, ("--radius", 1.5))):
            self.scene(vertices, triangles, spheres, given)
            alone = self.written(*args)
            for n in (1, 2, 3, 7, 100):  # the last have no spheres
                self.assertEqual(self.written(*args, "--ranks", f"threads:{n}"), alone, n)
        report = self.report("mesh.obj", "spheres.csv", "--radius", 1, "--ranks", "threads:3")
        self.assertEqual((report["ranks"], report["spheres"]), (3, 60))

    def test_a_single_sphere_and_no_newline(self):
        self.write("mesh.obj", TRIANGLE)
        self.write("spheres.csv", ONE_SPHERE.rstrip())
        self.assertEqual(self.written("--radius", 1, "--ranks", "threads:4"), self.written("--radius", 1))

    def test_the_scalar_is_one_for_all(self):
        self.write("mesh.obj", TRIANGLE)
        self.write("spheres.csv", "x,y,z\n" + "0.5,0.5,0.5\n" * 20 + "1000000.03,0,0\n")  # of the last rank
        for ranks in ((), ("--ranks", "threads:3")):
            out = self.succeed("detect", "mesh.obj", "spheres.csv", "--radius", 1, *ranks)
            self.assertIn("; float would move one by", out)

    def test_mistakes_are_told_once_with_the_line_of_the_file(self):
        self.write("mesh.obj", TRIANGLE)
        self.write("spheres.csv", "x,y,z\n" + "0.5,0.5,0.5\n" * 20 + "1,x,0\n")
        self.fail_with(1, ["spheres.csv:22:", "'x'"], "detect", "mesh.obj", "spheres.csv", "--radius", 1, "--ranks", "threads:3")
        self.fail_with(1, ["missing.csv"], "detect", "mesh.obj", "missing.csv", "--radius", 1, "--ranks", "threads:3")
        self.write("spheres.csv", ONE_SPHERE)
        self.fail_with(1, ["no/such"], "detect", "mesh.obj", "spheres.csv", "--radius", 1, "--ranks", "threads:3",
                       "--output", "no/such/folder.csv")
        for wrong in ("threads", "threads:", "threads:0", "threads:x", "threads:1e9", "many"):
            self.fail_with(2, ["--ranks"], "detect", "mesh.obj", "spheres.csv", "--radius", 1, "--ranks", wrong)

    def test_mpi(self):
        self.scene(*random_scene(4, 2))
        alone = self.written()
        if shutil.which("mpirun") is None or b"without MPI" in self.on_mpi(1, "mesh.obj", "spheres.csv").stderr:
            self.skipTest("no MPI")
        for n in (1, 3):
            done = self.on_mpi(n, "mesh.obj", "spheres.csv", *self.OUTPUTS)
            self.assertEqual((done.returncode, done.stderr), (0, b""))
            self.assertEqual([self.read(name) for name in ("pairs.csv", "contacts.csv", "hits.ply")], alone, n)
        self.write("spheres.csv", "x,y,z,r\n" + "0.5,0.5,0.5,1\n" * 20 + "1,x,0,1\n")
        done = self.on_mpi(3, "mesh.obj", "spheres.csv", "--output", "other.csv")
        self.assertNotEqual(done.returncode, 0)
        self.assertIn(b"detect: spheres.csv:22:", done.stderr)
        self.assertFalse(self.path("other.csv").exists())


class Report(ProgramTest):
    def test_report(self):
        self.scene(*CUBE, [(0, 0, 0), (3, 3, 3)])
        for composition in COMPOSITIONS:
            for repeat in (1, 4):
                report = self.report("mesh.obj", "spheres.csv", .4, "--repeat", repeat, "--threads", 1, *composition)
                for key in ("build_ms", "query_ms", "total_ms"):
                    times = report[key]
                    self.assertEqual(set(times), {"min", "median", "max"})
                    self.assertTrue(0 <= times["min"] <= times["median"] <= times["max"], times)
                    self.assertEqual(times["min"] == times["max"], repeat == 1)
                self.assertGreaterEqual(report["total_ms"]["min"], report["query_ms"]["min"])
                self.assertEqual([report[k] for k in ("space", "broad", "precision", "threads", "triangles", "spheres", "repeat")],
                                 ["host", composition[1], composition[3], 1, 12, 2, repeat])
                self.assertEqual(report["scalar"], "double" if composition[3] == "double" else "float")
                self.assertEqual(report["cell_width"] > 0, composition[1] == "bucket")
                self.assertNotEqual(report["device"], "")
                self.assertEqual(report["pairs"], len(self.detect("mesh.obj", "spheres.csv", .4)))

    def test_pairs_do_not_depend_on_what_is_written(self):
        self.succeed("generate", "--spheres", 2000, "--triangles", 2000, "mesh.obj", "spheres.csv")
        counts = {self.report("mesh.obj", "spheres.csv", 30, *options)["pairs"]
                  for options in ([], ["out.csv"], ["--contacts", "c.csv"], ["--ply", "h.ply"], ["--repeat", 3], ["out.csv", "--repeat", 3])}
        self.assertEqual(counts, {len(self.pairs("out.csv"))})

    def test_a_fixed_cell_width(self):
        self.succeed("generate", "--spheres", 100, "--triangles", 5000, "mesh.obj", "spheres.csv")
        self.assertAlmostEqual(self.report("mesh.obj", "spheres.csv", 3, "--cell-width", 12)["cell_width"], 12, 4)

    def test_memory_grows_with_the_scene(self):
        peaks = []
        for n in (1000, 100000):
            self.succeed("generate", "--spheres", n, "--triangles", 2000, "mesh.obj", "spheres.csv")
            peaks.append(self.report("mesh.obj", "spheres.csv", 3)["peak_bytes"])
        self.assertGreaterEqual(peaks[1] - peaks[0], 12 * 99000)
        self.assertLess(peaks[1], 100 * 2 ** 20)

    def test_default_threads(self):
        self.scene(*CUBE, [(0, 0, 0)])
        self.assertIn(self.report("mesh.obj", "spheres.csv", 1)["threads"], (1, len(os.sched_getaffinity(0))))


class Progress(ProgramTest):
    def test_long_work_shows_a_bar_and_finds_the_same(self):
        self.succeed("generate", "--spheres", 6000, "mesh.obj", "spheres.csv")
        call = ["mesh.obj", "spheres.csv", "--radius", 30, "--threads", 1, "--broad", "all_pairs"]
        expected = self.detect(*call)
        seen = self.on_a_terminal("detect", *call, "--output", "watched.csv", "--repeat", 15, patience=0.02)
        self.assertRegex(seen, r"detecting \[#*\.*\] +\d+ %, \d+:\d\d left")
        self.assertTrue(seen.endswith("\r\x1b[K"), seen[-80:])  # it goes away
        self.assertEqual(self.pairs("watched.csv"), expected)

    def test_short_work_shows_none(self):
        self.scene(*CUBE, [(0, 0, 0)])
        self.assertEqual(self.on_a_terminal("detect", "mesh.obj", "spheres.csv", 1, "out.csv", patience=1e3), "")

    def test_queries_in_parts(self):
        self.succeed("generate", "--scene", "radii", "--spheres", 60000, "mesh.obj", "spheres.csv")
        expected = self.detect("mesh.obj", "spheres.csv", "--broad", "bucket")
        seen = self.on_a_terminal("detect", "mesh.obj", "spheres.csv", "--threads", 1, "--broad", "all_pairs", "--output", "parts.csv", patience=0.02)
        self.assertRegex(seen, r"detecting .* left")
        self.assertEqual(self.pairs("parts.csv"), expected)


if __name__ == "__main__":
    programs.main()
