"""The tutorial: make_notebook.py makes tutorial.ipynb of it."""

# %% [markdown]
# # A point cloud against a part, and a drum of grains
#
# A scanner has measured a part. Where does it deviate from its drawing, and has it too much there, or too little? The
# part is made with trimesh, and drawn with pyvista.

# %%
import numpy
import pyvista
import trimesh

import collide

profile = [(0.3, -0.5), (1, -0.5), (1, -0.3), (0.55, -0.25), (0.55, 0.3), (0.8, 0.4), (0.8, 0.5), (0.3, 0.5)]
part = trimesh.creation.revolve([*profile, profile[0]], sections=128)
mesh = collide.Mesh(part.vertices, part.faces.astype(numpy.int32))  # float64, as trimesh has it
print(mesh, "closed" if part.is_watertight else "open")

# %% [markdown]
# As it was made the part is oval, and its flange has a dent. The scanner has measured 150,000 points of it.

# %%
vertices, faces = part.vertices, part.faces
for _ in range(3):
    vertices, faces = trimesh.remesh.subdivide(vertices, faces)
angle = numpy.arctan2(vertices[:, 1], vertices[:, 0])
vertices[:, :2] *= 1 + 0.012 * numpy.cos(2 * angle)[:, None]
vertices[:, 2] -= 0.03 * numpy.exp(-numpy.sum((vertices - (0.75, -0.45, -0.3)) ** 2, axis=1) / 0.03)
points, _ = trimesh.sample.sample_surface(trimesh.Trimesh(vertices, faces), 150_000, seed=1)
points = points + numpy.random.default_rng(1).normal(0, 0.001, points.shape)

# %% [markdown]
# `signed_distance` is how far each point is from the drawing, negative inside of it.

# %%
deviation = mesh.signed_distance(points).distance
print(f"it deviates by {deviation.min():+.3f} to {deviation.max():+.3f}; {(deviation < 0).mean():.0%} are inside")

plotter = pyvista.Plotter(off_screen=True, window_size=(900, 560))
bar = dict(title="deviation", n_labels=5, fmt="%+.2f", vertical=True, color="white", position_x=0.86, height=0.7)
plotter.set_background("#303030")
plotter.add_points(points, scalars=deviation, cmap="RdBu_r", clim=(-0.02, 0.02), point_size=5, scalar_bar_args=bar)
plotter.camera_position = [(2.5, -2.8, 2), (0, 0, -0.1), (0, 0, 1)]
show(plotter)

# %% [markdown]
# A ring with lifters is a drum, which turns around its axis with grains in it. It is one body of the mesh; `box_walls`
# close its ends. This list of effects is not in the package: it is compiled when it is first used.

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
sim = collide.Simulation(drum, effects, bodies=[collide.Body(0, len(drum), rate=1.5)])

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
