"""The tutorial: make_notebook.py makes tutorial.ipynb of it, docs/tutorials/8-python.md has its code."""

# %% [markdown]
# # A point cloud against a part, and a drum of grains
#
# A scanner has measured points on and around a part. Which of them are closer to the surface than its tolerance, and
# where? The part is read with trimesh, and drawn with pyvista.

# %%
import numpy
import pyvista
import trimesh

import collide

part = trimesh.creation.annulus(r_min=0.6, r_max=1, height=0.5, sections=96)
mesh = collide.Mesh(part.vertices, part.faces.astype(numpy.int32))  # float64, as trimesh has it
print(mesh)

# %% [markdown]
# The scan: 200,000 points near the part. `any` tells for each whether it is within the tolerance of the surface, exactly.

# %%
random = numpy.random.default_rng(1)
on_part, _ = trimesh.sample.sample_surface(part, 200_000, seed=1)
scan = on_part + random.normal(0, 0.02, on_part.shape)
good = mesh.any(scan, 0.03)
print(f"{good.sum()} of {len(scan)} points are within 0.03 of the part")

# %% [markdown]
# `contacts` says where: the closest point of the part, and how far it is.

# %%
contacts = mesh.contacts(scan, 0.03, closest=True)
print(f"the mean distance of those is {contacts.distance[good].mean():.4f}")

plotter = pyvista.Plotter(off_screen=True, window_size=(700, 450))
plotter.add_mesh(pyvista.wrap(part), color="lightgray")
plotter.add_points(scan[~good][:20_000], color="crimson", point_size=2)
show(plotter)

# %% [markdown]
# The same part as a drum, which turns around its axis with grains in it. It is one body of the mesh; `box_walls` close
# its ends. This list of effects is not in the package: it is compiled when it is first used.

# %%
wall = trimesh.creation.annulus(r_min=0.9, r_max=1, height=0.4, sections=64)
for k in range(8):  # lifters
    lifter = trimesh.creation.box((0.15, 0.04, 0.4), trimesh.transformations.translation_matrix((0.85, 0, 0)))
    wall += lifter.apply_transform(trimesh.transformations.rotation_matrix(k * numpy.pi / 4, (0, 0, 1)))
drum = collide.Mesh(wall.vertices.astype(numpy.float32), wall.faces.astype(numpy.int32))
effects = [
    collide.gravity(0, -9.81, 0),
    collide.sphere_contact(stiffness=2000, damping=1, friction=0.4, tangential_damping=1, density=2500),
    collide.bounce(0.3),
    collide.friction(0.5),
    collide.box_walls((-9, -9, -0.2), (9, 9, 0.2)),
    collide.moving_bodies(),
]
sim = collide.Simulation(drum, effects, bodies=[collide.Kernel(0, len(drum), rate=1.5)])

# %%
radius = 0.03
x, y, z = numpy.meshgrid(*(numpy.arange(-a, a, 2.1 * radius) for a in (0.5, 0.5, 0.14)))
grains = numpy.stack([x, y, z], -1).reshape(-1, 3).astype(numpy.float32)
sim.set(grains, radius)
dt = sim.largest_time_step()
sim.steps(int(3 / dt), dt)
print(f"{len(sim)} grains, {sim.time:.2f} s in steps of {dt:.1e} s; "
      f"{(numpy.linalg.norm(sim['position'][:, :2], axis=1) < 1).sum()} are in the drum")

# %%
plotter = pyvista.Plotter(off_screen=True, window_size=(700, 450))
turned = wall.copy().apply_transform(trimesh.transformations.rotation_matrix(1.5 * sim.time, (0, 0, 1)))
plotter.add_mesh(pyvista.wrap(turned), color="lightgray", opacity=0.4)
sphere = pyvista.Sphere(radius=radius, theta_resolution=12, phi_resolution=12)
cloud = pyvista.PolyData(sim["position"].copy())
cloud["height before"] = grains[:, 1]
plotter.add_mesh(cloud.glyph(geom=sphere, scale=False, orient=False), scalars="height before", show_scalar_bar=False)
plotter.camera_position = "xy"
show(plotter)
