"""Ranks that are processes with a GPU each, and send by NCCL, write what one process writes, byte by byte."""

import shutil
import subprocess
import sys

import programs
from programs import ProgramTest

SPACE = ("--space", "cuda_shared")


def gpus():
    """How many there are."""
    if shutil.which("nvidia-smi") is None:
        return 0
    listed = subprocess.run(["nvidia-smi", "-L"], capture_output=True, text=True)
    return sum(line.startswith("GPU ") for line in listed.stdout.splitlines()) if listed.returncode == 0 else 0


GPUS = gpus()
RANKS = [n for n in (2, 3, 4, 8) if n <= GPUS]


class NcclTest(ProgramTest):
    def succeed_on(self, n, *args):
        """Runs a program that must succeed on so many processes."""
        done = self.run_on_mpi(n, *args, ranks="nccl")
        self.assertEqual((done.returncode, done.stderr.decode()), (0, ""), (n, args))


class Film:
    """A test of the scene that a class is named after."""

    def check(self, folder):
        film = {path.name: path.read_bytes() for path in self.path("film").iterdir()}
        self.assertEqual(sorted(path.name for path in self.path(folder).iterdir()), sorted(film), folder)
        for name, content in film.items():
            self.assertTrue(self.read(f"{folder}/{name}") == content, (folder, name))

    def test_film(self):
        scene = type(self).__name__.lower()
        args = (scene, *SPACE, "--particles", 1000, "--seconds", 0.6, "--frames", 3, "--output")
        self.succeed(*args, "film")
        self.assertGreater(len(self.read("film/particles-00002.vtp")), 3000)
        for n in RANKS:
            self.succeed_on(n, *args, f"nccl-{n}")
            self.check(f"nccl-{n}")
        self.succeed(*args, "threads", "--ranks", f"threads:{RANKS[-1]}")
        self.check("threads")


class Snow(Film, NcclTest):
    pass


class Marbles(Film, NcclTest):
    pass


class Mud(Film, NcclTest):
    pass


class Dust(Film, NcclTest):
    pass


class Drum(Film, NcclTest):
    pass


class Conveyor(Film, NcclTest):
    pass


class Detect(NcclTest):
    FILES = ("pairs.csv", "contacts.csv", "hits.ply")

    def test_pairs(self):
        self.succeed("generate", "--spheres", 20000, "--triangles", 20000, "mesh.obj", "spheres.csv")
        args = ("detect", "mesh.obj", "spheres.csv", "--radius", 30, *SPACE, "--output", "pairs.csv", "--contacts", "contacts.csv",
                "--ply", "hits.ply")
        self.succeed(*args)
        alone = [self.read(name) for name in self.FILES]
        self.assertGreater(len(alone[0]), 1000)
        for n in RANKS:
            for name in self.FILES:
                self.path(name).unlink()
            self.succeed_on(n, *args)
            self.assertTrue([self.read(name) for name in self.FILES] == alone, n)

    def test_more_ranks_than_gpus(self):
        done = self.run_on_mpi(GPUS + 1, "dust", *SPACE, "--particles", 50, "--seconds", 0.1, ranks="nccl")
        self.assertNotEqual(done.returncode, 0)
        self.assertIn(f"ranks 0 and {GPUS} have the same GPU", done.stderr.decode())


if __name__ == "__main__":
    if GPUS < 2 or shutil.which("mpirun") is None:
        print("skipped: NCCL wants mpirun and two GPUs")
        sys.exit(0)
    programs.main()
