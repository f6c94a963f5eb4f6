"""The scenes of the gallery as their users see them, run small: what they write, and whether it can be true."""

import json
import math
import os
import re
import shutil
import struct
import subprocess
import time
import unittest
from xml.etree import ElementTree

import programs
from programs import ProgramTest

SCENES = ("snow", "marbles", "mud", "dust", "drum", "conveyor", "silo", "penetration")
KINDS = {"Float32": "f", "UInt8": "B", "UInt32": "I"}


def read_vtp(content):
    """The arrays of a file: section -> name -> rows, each a tuple, or a number."""
    header, data = content.split(b'<AppendedData encoding="raw">\n_', 1)
    root = ElementTree.fromstring(header + b"<AppendedData/></VTKFile>")
    assert root.attrib == {"type": "PolyData", "version": "1.0", "byte_order": "LittleEndian", "header_type": "UInt64"}
    piece = root.find("PolyData/Piece")
    found, end = {"counts": {k: int(v) for k, v in piece.attrib.items()}}, 0
    for section in piece:
        rows = found[section.tag] = {}
        for array in section:
            offset, width, kind = int(array.get("offset")), int(array.get("NumberOfComponents")), KINDS[array.get("type")]
            assert offset == end
            size, = struct.unpack_from("<Q", data, offset)
            values = struct.unpack_from("<%d%s" % (size // struct.calcsize(kind), kind), data, offset + 8)
            end = offset + 8 + size
            rows[array.get("Name")] = list(values) if width == 1 else list(zip(*[iter(values)] * width))
    assert data[end:] == b"\n</AppendedData>\n</VTKFile>\n"
    return found


class SceneTest(ProgramTest):
    def shoot(self, scene, *args, output="film"):
        """Runs a scene; returns what it prints."""
        return self.succeed(scene, "--threads", 1, "--output", output, *args)

    def frames(self, output="film"):
        """(time, points, arrays) of each frame, each of which must be sound."""
        film = self.read(f"{output}/film.pvd").decode()
        listed = re.findall(r'<DataSet timestep="([^"]*)" file="(.*?)"/>', film)
        moved = re.findall(r'<DataSet timestep="([^"]*)" part="1" file="(.*?)"/>', film)
        names = [name for _, name in listed]
        self.assertEqual(sorted(p.name for p in self.path(output).iterdir()),
                         ["film.pvd", *[name for _, name in moved], "mesh.vtp", *names])
        if moved:
            self.assertEqual([time for time, _ in moved], [time for time, _ in listed])
        times = [float(time) for time, _ in listed]
        self.assertEqual(times, sorted(set(times)))
        frames = []
        for time, name in zip(times, names):
            file = read_vtp(self.read(f"{output}/{name}"))
            points, arrays = file["Points"]["position"], file["PointData"]
            n = len(points)
            self.assertEqual(file["counts"], {"NumberOfPoints": n, "NumberOfVerts": 1 if n else 0})
            self.assertEqual(file["Verts"], {"connectivity": list(range(n)), "offsets": [n] if n else []})
            self.assertEqual({name: len(values) for name, values in arrays.items()}, dict.fromkeys(arrays, n))
            self.assertLessEqual({"radius", "velocity"}, set(arrays))
            for rows in (points, arrays["velocity"]):
                self.assertTrue(all(math.isfinite(x) for row in rows for x in row))
            frames.append((time, points, arrays))
        return frames

    def mesh(self, output="film", name="mesh"):
        file = read_vtp(self.read(f"{output}/{name}.vtp"))
        points, corners, ends = file["Points"]["position"], file["Polys"]["connectivity"], file["Polys"]["offsets"]
        self.assertEqual(file["counts"], {"NumberOfPoints": len(points), "NumberOfPolys": len(ends)})
        self.assertEqual(ends, list(range(3, len(corners) + 1, 3)))
        self.assertTrue(corners and max(corners) < len(points))
        return points


class Snow(SceneTest):
    def test_it_falls_and_sticks(self):
        self.shoot("snow", "--particles", 300, "--seconds", 2.5, "--frames", 5)
        self.mesh()
        frames = self.frames()
        self.assertEqual(len(frames), 5)
        self.assertEqual([len(points) for _, points, _ in frames][-1], 300)
        for _, points, arrays in frames:
            for (x, y, z) in points:
                self.assertGreater(z, 0.1 * math.sin(4 * x + 1) * math.cos(3 * y) - 0.1)  # the ground
                self.assertTrue(abs(x) <= 0.7 and abs(y) <= 0.7)
        _, points, arrays = frames[-1]
        stuck = [p for p, sticks in zip(points, arrays["stuck"]) if sticks]
        self.assertGreater(len(stuck), 150)
        self.assertTrue(any(z > 0.9 for _, _, z in stuck), "none on the statue")
        self.assertTrue(all(v == (0, 0, 0) for v, sticks in zip(arrays["velocity"], arrays["stuck"]) if sticks))


class Marbles(SceneTest):
    def test_they_roll_into_the_bowl_and_stay(self):
        self.shoot("marbles", "--particles", 40, "--seconds", 6, "--frames", 12)
        bowl = lambda d2: d2 * (1.2 + 1.5 * d2)
        turning = []
        for _, points, arrays in self.frames():
            for (x, y, z) in points:
                self.assertTrue(x * x + y * y < 0.6 ** 2 and z > bowl(x * x + y * y), (x, y, z))
            turning += [x * v - y * u for (x, y, z), (u, v, _) in zip(points, arrays["velocity"]) if z < 0.25]
        self.assertEqual(len(points), 40)
        self.assertGreater(len([1 for _, _, z in points if z < 0.25]), 15)  # in the bowl
        self.assertGreater(sum(turning) / len(turning), 0.01)  # they circle, the way that the gutter winds
        self.assertTrue(any(math.hypot(*w) > 1 for w in arrays["angular_velocity"]))


class Mud(SceneTest):
    def test_it_sticks_and_slides(self):
        self.shoot("mud", "--particles", 600, "--seconds", 2.5, "--frames", 10)
        frames = self.frames()
        _, thrown, arrays = frames[4]
        self.assertEqual(len(thrown), 600)
        _, points, arrays = frames[-1]
        self.assertTrue(all(abs(y) <= 0.7 and z > -0.014 for _, y, z in points))
        high = [sticks for (_, _, z), sticks in zip(points, arrays["stuck"]) if z > 0.5]
        self.assertTrue(20 < sum(high) < 600, sum(high))
        slid = [before[2] - after[2] for before, after in zip(thrown, points)]
        self.assertGreater(sum(drop > 0.1 for drop in slid), 60)


class Dust(SceneTest):
    def test_it_goes_with_the_wind_around_the_boulders(self):
        self.shoot("dust", "--particles", 3000, "--seconds", 3, "--frames", 4)
        rocks = [(-0.8, -0.5, 0.7), (0.5, 0.9, 0.5), (1.4, -0.6, 0.35)]
        for time, points, arrays in self.frames():
            for p in points:
                self.assertTrue(p[2] > 0 and -3.1 < p[0] < 3, p)
                for x, y, radius in rocks:
                    self.assertGreater(math.dist(p, (x, y, 0)), 0.99 * radius)  # of flat triangles
            mean = [sum(v[k] for v in arrays["velocity"]) / len(points) for k in range(3)]
            self.assertTrue(1.8 < mean[0] < 2.8 and abs(mean[1]) < 0.3 and abs(mean[2]) < 0.3, mean)
        self.assertTrue(1000 < len(points) < 3000)  # those that the wind has carried away are gone
        self.assertGreater(max(p[2] for p in points), 0.5)


class Drum(SceneTest):
    def test_it_turns_and_carries_grains_up(self):
        self.shoot("drum", "--particles", 600, "--seconds", 4, "--frames", 4)
        start = self.mesh()
        for i, (time, points, arrays) in enumerate(self.frames()):
            now = self.mesh(name=f"mesh-{i:05}")
            turn = 1.6 * time
            for (x, y, z), (u, v, w) in zip(start[:700], now):  # of the drum
                self.assertAlmostEqual(u, x * math.cos(turn) + z * math.sin(turn), delta=1e-4)
                self.assertAlmostEqual(v, y, delta=1e-6)
                self.assertAlmostEqual(w, z * math.cos(turn) - x * math.sin(turn), delta=1e-4)
            self.assertEqual(start[-25:], now[-25:])  # the floor rests
            self.assertNotEqual(start[-40:-25], now[-40:-25])
            for (x, y, z) in points:
                self.assertLess(math.hypot(x, z), 0.3)
                self.assertLessEqual(abs(y), 0.1)
        self.assertEqual(len(points), 600)
        self.assertGreater(max(z for _, _, z in points), 0)  # what a lifter has taken along
        self.assertLess(sum(x for x, _, _ in points) / len(points), -0.05)


class Conveyor(SceneTest):
    def test_belts_carry_grains_to_the_table(self):
        self.shoot("conveyor", "--particles", 200, "--seconds", 6, "--frames", 6)
        frames = self.frames()
        on_belt = [v for _, points, arrays in frames for (x, y, z), v in zip(points, arrays["velocity"])
                   if -0.4 < x < 0.1 and abs(y) < 0.1]
        self.assertGreater(len(on_belt), 20)
        self.assertAlmostEqual(sorted(math.hypot(*v) for v in on_belt)[len(on_belt) // 2], 0.7, delta=0.1)
        _, points, arrays = frames[-1]
        there = [((x - 0.32, y - 1.15), v) for (x, y, z), v in zip(points, arrays["velocity"]) if math.hypot(x - 0.32, y - 1.15) < 0.42]
        self.assertGreater(len(there), 50)
        turning = sorted((x * v[1] - y * v[0]) / (x * x + y * y) for (x, y), v in there)
        self.assertAlmostEqual(turning[len(turning) // 2], 1, delta=0.1)  # with the table


class Silo(SceneTest):
    def test_grains_stay_until_the_gate_opens_and_then_flow_out(self):
        self.shoot("silo", "--particles", 400, "--seconds", 2.4, "--frames", 8)
        low = 0.014578 - 0.07
        inside = []
        for _, points, _ in self.frames():
            for (x, y, z) in points:
                if z > low:
                    self.assertLess(math.hypot(x, y), min(0.1, 0.03 + z - low))
            inside.append(sum(z > low for _, _, z in points))
        self.assertEqual(inside[3], 400)  # after 1.2 s all have come, and the gate is shut until 1.4 s
        self.assertEqual(sorted(inside[3:], reverse=True), inside[3:])
        self.assertLess(inside[-1], 40)


class Penetration(SceneTest):
    def test_the_ball_comes_to_where_the_benchmark_begins_and_is_stopped(self):
        self.shoot("penetration", "--particles", 400, "--seconds", 0.15, "--frames", 12)
        frames = self.frames()
        balls = [[(p[2], v[2]) for p, v, r, m in zip(points, arrays["velocity"], arrays["radius"], arrays["material"]) if r > 0.005 and m == 1]
                 for _, points, arrays in frames]
        self.assertEqual([len(ball) for ball in balls], [1] * 12)
        for (time, points, arrays), [(z, v)] in zip(frames[:8], balls):  # of which the eighth is after 0.1 s
            left = 0.1 - time
            self.assertAlmostEqual(z, 0.06 + 5 * left - 9.81 / 2 * left * left, delta=1e-3)
            self.assertAlmostEqual(v, -5 + 9.81 * left, delta=1e-2)
            for (x, y, z), r in zip(points, arrays["radius"]):  # grains are in the box; the ball will crush so thin a layer
                self.assertTrue(abs(x) < 0.05 and abs(y) < 0.03 and (r > 0.005 or z > -0.0902431), (x, y, z))
        self.assertEqual(len(frames[7][1]), 401)
        [(z, v)] = balls[-1]
        self.assertTrue(-0.0902 + 0.008 < z < 0.06 and abs(v) < 4, (z, v))


class AllScenes(SceneTest):
    small = ("--particles", 150, "--seconds", 0.5, "--frames", 3)
    long = ("--particles", 150, "--seconds", 1.5, "--frames", 6)

    def of(self, scene, args):
        """The arguments for a scene: that of the shortest steps is shorter."""
        return (*args[:3], args[3] / 10, *args[4:]) if scene == "penetration" else args

    def check_film(self, scene, output):
        names = sorted(p.name for p in self.path(scene).iterdir())
        self.assertEqual(sorted(p.name for p in self.path(output).iterdir()), names)
        for name in names:
            self.assertEqual(self.read(f"{scene}/{name}"), self.read(f"{output}/{name}"), (output, name))


class Threads(AllScenes):
    def test_the_same_bits(self):
        for scene in SCENES:
            small = self.of(scene, self.small)
            self.shoot(scene, *small, output=scene)
            self.succeed(scene, *small, "--threads", 2, "--output", scene + "-2")
            for file in ("film.pvd", "mesh.vtp", "particles-00002.vtp"):
                self.assertEqual(self.read(f"{scene}/{file}"), self.read(f"{scene}-2/{file}"), (scene, file))


class Pauses(AllScenes):
    def test_going_on_from_a_checkpoint_in_another_process(self):
        """For each scene, saved while particles still come, and after: the pictures are those of a film without a pause."""
        for scene in SCENES:
            long = self.of(scene, self.long)
            self.shoot(scene, *long, output=scene)
            self.shoot(scene, *long, "--until", 2, "--save", "state", output=scene + "-1")
            self.shoot(scene, *long, "--until", 5, "--load", "state", "--save", "state", output=scene + "-2")
            self.shoot(scene, *long, "--load", "state", output=scene + "-3")
            seen = []
            for part in "123":
                names = sorted(p.name for p in self.path(f"{scene}-{part}").glob("particles-*"))
                for name in names:
                    self.assertEqual(self.read(f"{scene}/{name}"), self.read(f"{scene}-{part}/{name}"), (scene, part, name))
                seen += names
            self.assertEqual(seen, [f"particles-{i:05}.vtp" for i in range(6)])


class Ranks(AllScenes):
    def test_ranks(self):
        """For each scene: on any number of ranks the film of one, also with a pause and on another number then."""
        numbers = (2, 3, 7) if "COLLIDE_LONG_TESTS" in os.environ else (7,)
        for scene in SCENES:
            long = self.of(scene, self.long)
            self.shoot(scene, *long, output=scene)
            for n in numbers:
                self.shoot(scene, *long, "--ranks", f"threads:{n}", output=f"{scene}-{n}")
                self.check_film(scene, f"{scene}-{n}")
            self.shoot(scene, *long, "--ranks", "threads:2", "--until", 3, "--save", "state", output=scene + "-first")
            self.shoot(scene, *long, "--ranks", "threads:3", "--load", "state", output=scene + "-rest")
            for i in range(6):
                part = "first" if i < 3 else "rest"
                name = f"particles-{i:05}.vtp"
                self.assertEqual(self.read(f"{scene}/{name}"), self.read(f"{scene}-{part}/{name}"), (scene, name))
        for wrong in ("threads", "threads:0", "many"):
            self.fail_with(2, ["--ranks"], "dust", *self.small, "--ranks", wrong)
        self.fail_with(1, ["dust-7"], "dust", *self.small, "--ranks", "threads:2", "--output", "dust-7")

    def test_mpi(self):
        self.shoot("snow", *self.small, output="snow")
        if shutil.which("mpirun") is None or b"without MPI" in self.run_on_mpi(1, "snow", *self.small).stderr:
            self.skipTest("no MPI")
        done = self.run_on_mpi(3, "snow", *self.small, "--output", "snow-mpi")
        self.assertEqual((done.returncode, done.stderr), (0, b""))
        self.check_film("snow", "snow-mpi")


class Checkpoints(AllScenes):
    def test_a_process_that_is_killed_leaves_a_checkpoint(self):
        args = ("--particles", 200, "--seconds", 5, "--frames")
        self.shoot("snow", *args, 1)
        killed = subprocess.Popen([programs.PROGRAMS / "snow", *map(str, args), "3000", "--threads", "1", "--save", "state"],
                                  cwd=self.folder, stdout=subprocess.DEVNULL)
        while not self.path("state").exists():
            self.assertIsNone(killed.poll())
            time.sleep(0.001)
        killed.kill()
        killed.wait()
        self.shoot("snow", *args, 1, "--load", "state", output="rest")
        self.assertEqual(self.read("film/particles-00000.vtp"), self.read("rest/particles-00000.vtp"))

    def test_bad_checkpoints(self):
        self.succeed("dust", *self.small, "--save", "state")
        good = self.read("state")
        self.assertEqual(self.files(), ["state"])
        self.write("damaged", good[:-20] + b"?" + good[-19:])
        self.write("cut", good[:-1])
        self.write("longer", good + b"\n")
        for name, words in (("damaged", ["checksum"]), ("cut", ["checksum", "ends"]), ("longer", ["longer"]), ("none", ["none"]),
                            ("state", ["state", "over"])):
            self.fail_with(1, words, "dust", *self.small, "--load", name)
        self.fail_with(1, ["effects"], "snow", *self.small, "--load", "state")
        self.fail_with(1, ["no/state"], "dust", *self.small, "--save", "no/state")
        self.fail_with(2, ["--save", "--report"], "dust", *self.small, "--save", "same", "--report", "same")
        self.fail_with(2, ["--save", "film"], "dust", *self.small, "--save", "film/state", "--output", "film")

    def test_what_it_says(self):
        for scene in SCENES:
            said = self.succeed(scene, "--particles", 50, "--seconds", 0.1, "--threads", 1, "--report", "report.json")
            report = json.loads(self.read("report.json"))
            self.assertRegex(said, rf"\A{scene}: 50 particles, {report['steps']} steps of [^\n]* host [^\n]*\n\Z")
            self.assertEqual(list(report), ["scene", "particles", "triangles", "steps", "dt", "ms_per_step", "bytes_per_particle",
                                            "space", "threads", "ranks", "device", "version"])
            self.assertEqual((report["scene"], report["particles"], report["threads"]), (scene, 50, 1))
            self.assertAlmostEqual(report["steps"] * report["dt"], 0.1, delta=report["dt"])
            self.assertGreater(report["ms_per_step"], 0)
        self.assertEqual(self.files(), ["report.json"])

    def test_progress(self):
        args = ("--particles", 200, "--seconds", 1)
        self.shoot("snow", *args)
        seen = self.on_a_terminal("snow", *args, "--threads", 1, "--output", "watched", patience=0)
        self.assertRegex(seen, r"snow \[#*\.*\] +\d+ %, \d+:\d\d left")
        self.assertTrue(seen.endswith("\r\x1b[K"), seen[-80:])
        self.assertEqual(self.frames("watched"), self.frames())

    def test_more_frames_than_steps(self):
        self.shoot("dust", "--particles", 10, "--seconds", 0.01, "--frames", 100)
        self.assertEqual(len(self.frames()), 5)

    def test_frames_before_the_first_particle(self):
        self.shoot("snow", "--particles", 2, "--seconds", 0.5, "--frames", 10)
        self.assertEqual([len(points) for _, points, _ in self.frames()][::9], [0, 2])
        kinds = {re.search(rb'Name="velocity" NumberOfComponents="(\d)"', self.read(f"film/particles-{i:05}.vtp"))[1] for i in range(10)}
        self.assertEqual(kinds, {b"3"})

    def test_cuda(self):
        for scene in SCENES:
            done = self.run_program(scene, *self.of(scene, self.small), "--space", "cuda_shared")
            if done.returncode != 0:  # no CUDA here: it says so
                self.assertRegex(done.stderr.decode(), rf"\A{scene}: --space[^\n]*CUDA[^\n]*\n\Z")
                self.assertEqual(done.returncode, 1)

    def test_bad_usage(self):
        for args in (["--nonsense"], ["--particles", 0], ["--particles", "many"], ["--particles", -5], ["--seconds", 0], ["--seconds", "nan"],
                     ["--seconds", "inf"], ["--seconds", -1], ["--seconds", "1e9"], ["--frames", 0], ["--frames", 1.5], ["--space", "moon"],
                     ["--threads", -1], ["--output"]):
            with self.subTest(args=args):
                self.fail_with(2, [args[0]], "snow", *args)
        self.fail_with(2, ["extra"], "mud", "extra")
        for report in ("film/film.pvd", "film/../film/particles-00000.vtp", "film"):
            self.fail_with(2, ["--report", report], "dust", *self.small, "--output", "film", "--report", report)

    def test_bad_places(self):
        self.write("file", "")
        self.path("full").mkdir()
        self.write("full/mine", "kept")
        for args in (["--output", "full"], ["--output", "file"], ["--output", "file/film"], ["--output", "/proc/film"],
                     ["--report", "no/report.json"], ["--report", "full"]):
            with self.subTest(args=args):
                self.fail_with(1, [args[1]], "dust", *self.small, *args)
        self.assertEqual(self.read("full/mine"), b"kept")

    def test_a_folder_that_is_there(self):
        self.path("film").mkdir()
        self.shoot("dust", *self.small)
        self.assertEqual(len(self.frames()), 3)


if __name__ == "__main__":
    programs.main()
