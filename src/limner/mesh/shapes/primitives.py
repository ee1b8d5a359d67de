"""Triangle meshes of simple shapes, for renderers that know triangles only (FoCG 12.1, 11.1): the list of all.

Everything is counter-clockwise seen from outside, with exact normals and texture coordinates; +y is up. A vertex is shared by
all triangles around it; only its normal or texture coordinate is split, where the surface has an edge or the texture a seam. A mesh
without its normals is faceted: ``dataclasses.replace(mesh, normals=None, normal_triangles=None)``.

    spheres      uv_sphere, sphere, icosphere, superquadric
    platonic     tetrahedron, cube (and box), octahedron, dodecahedron, icosahedron
    revolution   disk, cylinder, cone, torus, capsule, revolution
    sheets       quad, plane, plane_disk, bilinear_patch, heightfield
    extrusion    extrusion of outlines with holes
    tube         tube along a line of points
    teapot       teapot
"""

from __future__ import annotations

from .extrusion import extrusion
from .platonic import box, cube, dodecahedron, icosahedron, octahedron, tetrahedron
from .revolution import capsule, cone, cylinder, disk, revolution, torus
from .sheets import bilinear_patch, heightfield, plane, plane_disk, quad
from .spheres import icosphere, sphere, superquadric, uv_sphere
from .teapot import teapot
from .tube import tube

__all__ = [
    "bilinear_patch", "box", "capsule", "cone", "cube", "cylinder", "disk", "dodecahedron", "extrusion", "heightfield", "icosahedron",
    "icosphere", "octahedron", "plane", "plane_disk", "quad", "revolution", "sphere", "superquadric", "teapot", "tetrahedron", "torus",
    "tube", "uv_sphere",
]  # fmt: skip
