"""Gradients for PyTorch: distances and nearest points that know what they depend on.

    import collide.autograd

    distance = collide.autograd.signed_distance(points, vertices, triangles)
    distance.square().sum().backward()                  # points.grad, vertices.grad

Which triangle is nearest, and on which side a point is, are constants: gradients are those of the distance to that
triangle, which is what the distance has almost everywhere. Where a gradient does not exist, as on the medial axis, it is
that of the triangle which `Mesh.nearest` finds. `signed_distance` has no second derivatives.
"""

from typing import Any

import torch
from torch.autograd.function import once_differentiable

from ._mesh import Mesh

Tensor = Any  #: of torch


class _SignedDistance(torch.autograd.Function):
    @staticmethod
    def forward(ctx, points, vertices, triangles, mesh):
        found = mesh.signed_distance(points.detach())
        corners = triangles.long()[found.triangle.clamp(min=0).long()]
        ctx.save_for_backward(found.gradient.clone(), found.barycentric.clone(), corners)
        ctx.vertices = len(vertices)
        return found.distance.clone()

    @staticmethod
    @once_differentiable
    def backward(ctx, of_distance):
        gradient, weights, corners = ctx.saved_tensors
        of_points = of_distance[:, None] * gradient
        of_vertices = None
        if ctx.needs_input_grad[1]:
            parts = -weights[:, :, None] * of_points[:, None, :]
            of_vertices = torch.zeros(ctx.vertices, 3, dtype=parts.dtype, device=parts.device)
            of_vertices.index_add_(0, corners.reshape(-1), parts.reshape(-1, 3))
        return of_points, of_vertices, None, None


def signed_distance(points: Tensor, vertices: Tensor, triangles: Tensor, mesh: Mesh | None = None) -> Tensor:
    """(n,): how far each point is from a closed mesh, negative inside, as `Mesh.signed_distance` finds it, with gradients
    to points and vertices.

    points     (n, 3), finite
    vertices   (m, 3) of the same dtype and device
    triangles  (k, 3) integers
    mesh       a `Mesh` of these vertices and triangles, kept for many calls: call its `update` when vertices change.
               None: one is made.

    Errors are those of `Mesh` and its queries. O(n log k), and without ``mesh`` O(k log k).
    """
    return _SignedDistance.apply(points, vertices, triangles, _mesh(vertices, triangles, mesh))


def nearest(points: Tensor, vertices: Tensor, triangles: Tensor, mesh: Mesh | None = None) -> tuple[Tensor, Tensor]:
    """The nearest point of the mesh to each point, (n, 3), and the distance between the two, (n,), with gradients to
    points and vertices. Computed from the triangle, edge or corner that `Mesh.nearest` finds, by torch, so that there are
    second derivatives too. Arguments and errors as for `signed_distance`; the mesh need not be closed, nor empty. On the
    surface the distance has the gradient 0.
    """
    found = _mesh(vertices, triangles, mesh).nearest(points.detach())
    corners = vertices[triangles.long()[found.triangle.long()]]
    rows = torch.arange(len(points), device=points.device)
    begin = found.feature_index.long() % 3  # of a face any
    a, b = corners[rows, begin], corners[rows, (begin + 1) % 3]
    normal = torch.cross(b - a, corners[rows, (begin + 2) % 3] - a, dim=1)
    on_face = points - normal * _ratio(((points - a) * normal).sum(1), (normal * normal).sum(1))
    on_edge = a + (b - a) * _ratio(((points - a) * (b - a)).sum(1), ((b - a) * (b - a)).sum(1))
    kind = found.feature[:, None]
    point = torch.where(kind == 0, on_face, torch.where(kind == 1, on_edge, a))
    squared = ((points - point) ** 2).sum(1)
    apart = squared > 0
    return point, torch.where(apart, torch.where(apart, squared, torch.ones_like(squared)).sqrt(), torch.zeros_like(squared))


def _ratio(above, below):
    """A quotient as a column; 0 where it would be one by 0, as in a triangle without area."""
    return (torch.where(below > 0, above, torch.zeros_like(above)) / torch.where(below > 0, below, torch.ones_like(below)))[:, None]


def _mesh(vertices, triangles, mesh):
    return mesh if mesh is not None else Mesh(vertices.detach(), triangles)
