"""A ball falls into grains, from shortly before it meets them on: Yade.

yade -n -x yade_penetration.py BED STEPS CURVE.csv
Writes time, height and velocity of the ball, and how long that took."""
import math
import sys
from yade import utils

path, steps, out = sys.argv[-3], int(sys.argv[-2]), sys.argv[-1]
start = 0.0206  # the ball is above the bed until then
solids = [O.materials.append(FrictMat(young=e, poisson=0.2, frictionAngle=math.atan(0.3), density=rho))
          for e, rho in ((1e9, 2500), (210e9, 7200))]
for line in open(path):
    try:
        r, x, y, z = map(float, line.split())
    except ValueError:
        continue
    if r < 0.005:
        O.bodies.append(utils.sphere((x, y, z), r, material=solids[0]))
ball = O.bodies.append(utils.sphere((0, 0, 0.06 - 5 * start - 4.905 * start**2), 0.01, material=solids[1]))
O.bodies[ball].state.vel = (0, 0, -5 - 9.81 * start)
for axis, at, sense in ((0, -0.05, 1), (0, 0.05, -1), (1, -0.03, 1), (1, 0.03, -1), (2, -0.0902431, 1)):
    O.bodies.append(utils.wall(at, axis, sense, material=solids[1]))
pairs = lambda both, mixed, steel: MatchMaker(matches=((0, 0, both), (0, 1, mixed), (1, 1, steel)))
physics = Ip2_FrictMat_FrictMat_MindlinPhys(
    frictAngle=pairs(math.atan(0.3), math.atan(0.2), math.atan(0.5)), en=pairs(0.5, 0.4, 0.6))
curve = open(out, "w")


def write():
    state = O.bodies[ball].state
    curve.write("%.10g,%.10g,%.10g,%.6g\n" % (start + O.time, state.pos[2], state.vel[2], O.realtime))
    curve.flush()


O.engines = [
    ForceResetter(),
    InsertionSortCollider([Bo1_Sphere_Aabb(), Bo1_Wall_Aabb()], verletDist=2e-4),
    InteractionLoop([Ig2_Sphere_Sphere_ScGeom(), Ig2_Wall_Sphere_ScGeom()], [physics],
                    [Law2_ScGeom_MindlinPhys_Mindlin()]),
    PyRunner(command="write()", iterPeriod=200),
    NewtonIntegrator(damping=0, gravity=(0, 0, -9.81)),
]
O.dt = 5e-7
O.run(steps, True)
