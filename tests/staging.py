"""Small scenes for tests, and pictures of them by both renderers."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from limner._jit import MODE
from limner.image.image import Image
from limner.linear import transform
from limner.mesh.mesh import Mesh
from limner.render import render
from limner.scene.camera import Camera, PerspectiveCamera
from limner.scene.light import AmbientLight, DirectionalLight, Light
from limner.scene.material import Lambert, Material
from limner.scene.node import Node
from limner.scene.scene import Scene
from limner.scene.shape import Geometry, Shape
from limner.scene.texture import Texels, Texture

__all__ = [
    "SLOW_AS_PYTHON",
    "WHITE", "checkers", "flat_picture", "grid", "interior", "lit_from", "place", "point_light_at", "scene_of", "seen_by_both",
    "two_triangles",
]  # fmt: skip

SLOW_AS_PYTHON = pytest.mark.skipif(MODE != "compiled", reason="takes minutes where kernels run as Python")
WHITE = Lambert(color=(1.0, 1.0, 1.0))


def place(geometry: Geometry, *materials: Material, at: Any = (0.0, 0.0, 0.0), matrix: Any = None) -> Node:
    """A node that shows a geometry at a point, or with a matrix."""
    return Node(
        parent_from_node=transform.translate(*at) if matrix is None else matrix,
        shapes=(Shape(geometry, materials or (Lambert(),)),),
    )


def lit_from(towards: Any, light: Light | None = None) -> Node:
    """A light at `towards` that shines to the origin."""
    d = np.asarray(towards, dtype=np.float64)
    up = (0.0, 1.0, 0.0) if abs(d[1]) < 0.9 * np.linalg.norm(d) else (0.0, 0.0, 1.0)
    return Node(parent_from_node=transform.frame_from_gaze(d, -d, up), lights=(light or DirectionalLight(intensity=np.pi),))


def point_light_at(position: Any, light: Light) -> Node:
    """A light that stands at `position`, its axis along -z."""
    return Node(parent_from_node=transform.translate(*position), lights=(light,))


def scene_of(*nodes: Node, camera: Camera | None = None, background: Any = None) -> Scene:
    """A scene; lit by the sun and the sky where no node brings a light."""
    if not any(placed.node.lights for node in nodes for placed in node.walk()):
        nodes = (*nodes, lit_from((0.4, 1.0, 0.6)), Node(lights=(AmbientLight(intensity=0.2),)))
    return Scene(root=Node(children=nodes), camera=camera, background=background)


def flat_picture(height: float = 2.0) -> Camera:
    """A perspective camera at distance 1 from the plane z = 0, `height` of which it sees from bottom to top."""
    return PerspectiveCamera.look_at((0, 0, 1), (0, 0, 0), yfov_degrees=float(np.degrees(2 * np.arctan(height / 2))))


def grid(n: int, size: float, matrix: NDArray[np.float64] | None = None) -> Mesh:
    """A plane y = 0 of n x n vertices, from -size to size along x and z, moved by a matrix."""
    side = np.linspace(-size, size, n)
    x, z = np.meshgrid(side, side)
    points = np.stack([x, np.zeros_like(x), z], axis=-1).reshape(-1, 3)
    if matrix is not None:
        points = transform.transform_points(matrix, points)
    index = np.arange(n * n).reshape(n, n)
    a, b, c, d = index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]
    triangles = np.concatenate([np.stack([a, b, c], -1).reshape(-1, 3), np.stack([a, c, d], -1).reshape(-1, 3)])
    uvs = (np.stack([x, -z], axis=-1) / (2 * size) + 0.5).reshape(-1, 2)
    return Mesh(points.astype(np.float32), triangles.astype(np.int32), uvs=uvs.astype(np.float32))


def two_triangles(*corners: Any) -> Mesh:
    """A quadrilateral without normals or texture coordinates."""
    return Mesh(np.array(corners, dtype=np.float32), np.array([[0, 1, 2], [0, 2, 3]], dtype=np.int32))


def checkers(n: int = 8, alpha: int = 255, **fields: Any) -> Texture:
    """A chessboard of n x n texels, the dark ones with the given alpha."""
    dark = (np.indices((n, n)).sum(axis=0) % 2).astype(bool)
    texels = np.full((n, n, 4), 255, dtype=np.uint8)
    texels[dark] = (200, 40, 30, alpha)
    return Texture(Texels(texels), **fields)


def seen_by_both(scene: Scene, width: int = 96, height: int = 72, **options: Any) -> tuple[Image, Image]:
    """The pictures of the rasteriser and of the ray tracer without what only that one does."""
    options = {"samples": 1, "aovs": ("instance_id", "triangle_id", "depth"), **options}
    raster = render(scene, width=width, height=height, renderer="raster", **options)
    return raster, render(scene, width=width, height=height, renderer="ray", shadows=False, max_depth=0, **options)


def interior(ids: NDArray[np.int32]) -> NDArray[np.bool_]:
    """Pixels whose eight neighbours have the same id."""
    height, width = ids.shape
    padded = np.pad(ids, 1, mode="edge")
    return np.all([padded[1 + j : 1 + j + height, 1 + i : 1 + i + width] == ids for j in (-1, 0, 1) for i in (-1, 0, 1)], axis=0)
