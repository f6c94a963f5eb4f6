"""generate as its users see it, and what detect finds in the scenes."""

import hashlib
import math
import unittest
from collections import Counter

import programs
from programs import ProgramTest


class GenerateTest(ProgramTest):
    def mesh(self, name="mesh.obj"):
        """The vertices and the triangles of a file."""
        lines = [line.split() for line in self.read(name).decode().splitlines()]
        self.assertEqual({line[0] for line in lines}, {"v", "f"})
        vertices = [tuple(map(float, line[1:])) for line in lines if line[0] == "v"]
        return vertices, [tuple(int(i) - 1 for i in line[1:]) for line in lines if line[0] == "f"]

    def spheres(self, name="spheres.csv", header="x,y,z"):
        first, *rows = self.read(name).decode().splitlines()
        self.assertEqual(first, header)
        return [tuple(map(float, row.split(","))) for row in rows]

    def generate(self, *args):
        self.succeed("generate", *args, "--mesh", "mesh.obj", "--spheres-file", "spheres.csv")


class Study(GenerateTest):
    def test_the_mesh(self):
        self.generate("--spheres", 0)
        vertices, triangles = self.mesh()
        self.assertEqual((len(vertices), len(triangles)), (192 * 164, 62976))
        for number, (x, y, z) in enumerate(vertices):
            u, v = math.tau * (number // 164) / 192, math.tau * (number % 164) / 164
            r = 120 * (1 + 0.12 * math.sin(5 * u) * math.cos(3 * v))
            d = 300 + r * math.cos(v)
            for seen, expected in ((x, d * math.cos(u)), (y, d * math.sin(u)), (z, r * math.sin(v))):
                self.assertAlmostEqual(seen, expected, delta=5e-5)
        # closed: each edge has two triangles, which run through it in opposite directions; and it is a torus
        edges = Counter((t[k], t[(k + 1) % 3]) for t in triangles for k in range(3))
        self.assertEqual(set(edges.values()), {1})
        self.assertTrue(all((b, a) in edges for a, b in edges))
        self.assertEqual(len(vertices) - len(edges) // 2 + len(triangles), 0)

    def test_the_spheres_are_the_same_everywhere(self):
        self.succeed("generate")
        content = self.read("spheres.csv")
        self.assertEqual(content.count(b"\n"), 1703244 + 1)
        self.assertEqual(hashlib.sha256(content).hexdigest(), "0f73cfd2adcce892b94d864704ea7efbaf8d3ba4219120f8c6f2868f1b023a03")
        spheres = self.spheres()
        for axis in range(3):
            values = [s[axis] for s in spheres]
            self.assertTrue(-592.2001 <= min(values) < -592 and 592 < max(values) <= 592.2001)
            self.assertAlmostEqual(sum(values) / len(values), 0, delta=1.5)
        report = self.report("mesh.obj", "spheres.csv", 3)
        self.assertTrue(39300 <= report["pairs"] <= 39600, report["pairs"])

    def test_number_seed_offset_and_radius(self):
        self.generate("--spheres", 100)
        spheres, (vertices, triangles) = self.spheres(), self.mesh()
        self.generate("--spheres", 250)
        self.assertEqual(len(self.spheres()), 250)
        self.assertEqual(self.spheres()[:100], spheres)
        self.generate("--spheres", 100, "--seed", 5)
        self.assertEqual(len(set(self.spheres()) & set(spheres)), 0)
        for offset, by in ((["1000"], (1000,) * 3), (["1024", "-2048", "0.5"], (1024, -2048, .5)), (["1,2,3"], (1, 2, 3))):
            self.generate("--spheres", 100, "--offset", *offset)
            for moved, still in zip(self.spheres() + self.mesh()[0], spheres + vertices):
                for k in range(3):
                    self.assertAlmostEqual(moved[k], still[k] + by[k], delta=3e-4)
            self.assertEqual(self.mesh()[1], triangles)
        self.succeed("generate", "--offset", "1", "2", "3", "-n", 3, "moved.obj", "moved.csv")  # numbers are no file names
        self.assertEqual(len(self.spheres("moved.csv")), 3)
        self.assertIn("--radius 7", self.succeed("generate", "--spheres", 1, "--radius", 7))

    def test_orders(self):
        def generated(*options):
            self.generate("--scene", "radii", "--spheres", 300, "--triangles", 600, *options)
            vertices, triangles = self.mesh()
            return vertices, [tuple(vertices[i] for i in t) for t in triangles], self.spheres(header="x,y,z,r")

        vertices, triangles, spheres = generated()
        for order in ("shuffled", "along_x", "halves"):
            ordered = generated("--triangle-order", order)
            self.assertEqual((ordered[0], sorted(ordered[1]), ordered[2]), (vertices, sorted(triangles), spheres))
            self.assertNotEqual(ordered[1], triangles)
            self.assertEqual(generated("--triangle-order", order), ordered)
            if order == "along_x":
                self.assertEqual([t[0][0] for t in ordered[1]], sorted(t[0][0] for t in triangles))
            if order == "halves":
                self.assertEqual(ordered[1], triangles[::2] + triangles[1::2])
            ordered = generated("--vertex-order", order)
            self.assertEqual((sorted(ordered[0]), ordered[1:]), (sorted(vertices), (triangles, spheres)))
            self.assertNotEqual(ordered[0], vertices)
            ordered = generated("--sphere-order", order)
            self.assertEqual((ordered[:2], sorted(ordered[2])), ((vertices, triangles), sorted(spheres)))
            self.assertNotEqual(ordered[2], spheres)
        self.fail_with(2, ["--triangle-order", "shuffled"], "generate", "--triangle-order", "sorted")

    def test_scalar(self):
        self.generate("--spheres", 50, "--scalar", "double")
        doubles = self.spheres()
        self.generate("--spheres", 50)
        self.assertNotEqual(doubles, self.spheres())
        self.assertEqual([[programs.nearest(repr(x), "f") for x in s] for s in doubles],
                         [[programs.nearest(repr(x), "f") for x in s] for s in self.spheres()])


# Scenes that libraries are compared on (issue 32 and docs/performance.md), and some that are hard or small.
MEASURED = ("study", "few", "hits", "many_hits", "radii_1000", "radii_100", "many_triangles", "drum", "camera", "grains", "soup", "crowd", "sparse")
OTHERS = ("radii", "ball", "terrain", "slivers", "long_slivers", "giant", "clusters", "pile", "cube", "octahedron")

NEEDLES = ("tube_10", "tube_1000", "shaft_100", "shaft_1000", "cage_30", "cage_100", "truss_100", "truss_300", "needles_100", "needles_1000",
           "giants_1", "giants_10")


class Scenes(GenerateTest):
    def test_every_scene_runs(self):
        found = {}
        for scene in MEASURED + OTHERS + NEEDLES:
            summary = self.succeed("generate", "--scene", scene, "--spheres", 2000, "--triangles", 600, "mesh.obj", "spheres.csv")
            vertices, triangles = self.mesh()
            self.assertTrue(all(0 <= i < len(vertices) for t in triangles for i in t))
            if scene not in ("cube", "octahedron"):
                self.assertTrue(400 <= len(triangles) <= 800, (scene, len(triangles)))
                self.assertIn("2000 spheres", summary)
            radius = [] if "with radii" in summary else ["--radius", summary.split("--radius ")[1].strip()]
            self.assertEqual(radius == [], scene.startswith("radii"))
            pairs = self.detect("mesh.obj", "spheres.csv", *radius)
            self.assertEqual(self.detect("mesh.obj", "spheres.csv", *radius, "--broad", "all_pairs"), pairs, scene)
            self.assertEqual(self.detect("mesh.obj", "spheres.csv", *radius, "--broad", "bvh"), pairs, scene)
            found[scene] = len(pairs)
        self.assertEqual(found["octahedron"], 4)
        self.assertEqual([scene for scene, pairs in found.items() if pairs == 0], [])

    def test_the_measured_scenes_are_the_same_everywhere(self):
        digest = hashlib.sha256()
        for scene in MEASURED:
            self.generate("--scene", scene, "--spheres", 2000, "--triangles", 600)
            for file in ("mesh.obj", "spheres.csv"):
                digest.update(self.read(file))
        self.assertEqual(digest.hexdigest(), "ba8de7b5ad6119fab5e1064323678d91e05277bcb68ffafc93da94e840c082b3")

    def test_a_scene_has_its_own_numbers(self):
        self.generate("--scene", "few")
        self.assertEqual((len(self.spheres()), len(self.mesh()[1])), (1000, 1008))
        self.generate("--scene", "few", "--triangles", 4000)
        self.assertEqual((len(self.spheres()), len(self.mesh()[1])), (1000, 4032))
        self.generate("--scene", "soup", "--spheres", 10)
        self.assertEqual((len(self.spheres()), len(self.mesh()[1])), (10, 200000))

    def test_drum(self):
        self.generate("--scene", "drum", "--spheres", 3000, "--triangles", 2000)
        vertices, triangles = self.mesh()
        spheres = self.spheres()
        self.assertEqual((len(spheres), len(triangles)), (3000, 1896))
        wall = max(math.hypot(x, z) for x, _, z in vertices)
        gaps = [min(wall - math.hypot(x, z), wall / 2 - abs(y)) for x, y, z in spheres]
        self.assertTrue(0.96 < min(gaps) and sum(gap < 1 for gap in gaps) > 450)
        self.assertLess(max(z for _, _, z in spheres), 1)

    def test_camera(self):
        self.generate("--scene", "camera", "--spheres", 3000)
        vertices, triangles = self.mesh()
        self.assertEqual((len(vertices), len(triangles)), (15020, 30000))
        near = [p for p in self.spheres() if p[2] > 0]
        self.assertTrue(850 < len(near) < 1150)

    def test_radii(self):
        self.generate("--scene", "radii", "--spheres", 2000)
        radii = [s[3] for s in self.spheres(header="x,y,z,r")]
        self.assertTrue(.03 <= min(radii) < .04 and 25 < max(radii) <= 30)

    def test_giant(self):
        self.generate("--scene", "giant", "--triangles", 100, "--spheres", 10)
        vertices, triangles = self.mesh()
        sizes = sorted(math.dist(vertices[a], vertices[b]) for a, b, _ in triangles)
        self.assertGreater(sizes[-1], 1e5 * sizes[-2])
        self.assertEqual(len(triangles), 100)


class Usage(GenerateTest):
    def test_bad_usage(self):
        for args in (["--nonsense"], ["--scene", "moon"], ["--spheres", -1], ["--spheres", "many"], ["--spheres", "1.5"], ["--spheres", "5000000000"],
                     ["--offset", "x"], ["--offset", "1,2"], ["--offset", "1,2,3,4"], ["--offset", "nan"], ["--offset", ""], ["--radius", -1],
                     ["--radius", "nan"], ["--seed", "x"], ["--scalar", "int"], ["--offset"]):
            with self.subTest(args=args):
                self.fail_with(2, [args[0]], "generate", *args)
        self.fail_with(2, ["third"], "generate", "a.obj", "b.csv", "third")

    def test_bad_places(self):
        for args in (["/dev/full", "x.csv"], ["x.obj", "/dev/full"], ["no/folder.obj", "x.csv"], ["x.obj", "no/folder.csv"]):
            self.fail_with(1, [next(a for a in args if "/" in a)], "generate", "--spheres", 10, *args)

    def test_standard_output(self):
        self.assertEqual(self.succeed("generate", "--scene", "cube", "mesh.obj", "/dev/stdout").splitlines()[0], "x,y,z")

    def test_help_and_version(self):
        text = self.succeed("generate", "--help")
        for word in ("--scene", "--spheres", "--triangles", "--offset", "--seed", "--radius", "study", "clusters"):
            self.assertIn(word, text)
        self.assertRegex(self.succeed("generate", "--version"), r"^generate .*\d+\.\d+\.\d+\n$")


if __name__ == "__main__":
    programs.main()
