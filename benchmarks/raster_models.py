"""The models of the raster benchmark: the vertices, triangles and texels that all its renderers get."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from raster_job import ELEVATION_DEGREES, N_VIEWS, YFOV_DEGREES, Job, Model


def models_of(paths: Sequence[Path], dense: int) -> Iterator[tuple[str, Model]]:
    for path in paths:
        model = _load(path)
        yield path.stem, model
    if dense:
        while len(model.triangles) < dense:
            model = _split(model)
        yield f"{path.stem}-dense", model


def _load(path: Path) -> Model:
    """The first mesh of a file, in the world, with the texture of its colour."""
    import limner
    from limner.linear import transform
    from limner.mesh.mesh import Mesh
    from limner.mesh.normals import vertex_normals

    shapes = limner.load(str(path)).shapes()
    found = next(((placed, shape, shape.geometry) for placed, shape in shapes if isinstance(shape.geometry, Mesh)), None)
    if found is None:
        raise SystemExit(f"{path} holds no mesh")
    placed, shape, mesh = found
    if mesh.normals is None:
        mesh = replace(mesh, normals=vertex_normals(mesh.positions, mesh.triangles))
    normals = np.asarray(mesh.normals)
    uvs = np.zeros((len(mesh.positions), 2), np.float32) if mesh.uvs is None else mesh.uvs
    indices = [mesh.triangles if given is None else given for given in (mesh.triangles, mesh.normal_triangles, mesh.uv_triangles)]
    corners, triangles = np.unique(np.stack(indices, axis=-1).reshape(-1, 3), axis=0, return_inverse=True)
    texture = getattr(shape.materials[0], "base_color_texture", getattr(shape.materials[0], "texture", None))
    return Model(
        transform.transform_points(placed.world_from_object, mesh.positions[corners[:, 0]]).astype(np.float32),
        transform.transform_normals(placed.world_from_object, normals[corners[:, 1]]).astype(np.float32),
        uvs[corners[:, 2]],
        triangles.reshape(-1, 3).astype(np.int32),
        np.zeros((0, 0, 4), np.uint8) if texture is None else np.array(texture.texels.pixels),
    )


def _split(model: Model) -> Model:
    """Every triangle in four, at the middles of its edges; each edge is split once for both its sides.

    >>> corners, uvs = np.eye(3, dtype=np.float32), np.zeros((3, 2), np.float32)
    >>> model = Model(corners, corners, uvs, np.array([[0, 1, 2]], np.int32), np.zeros((0, 0, 4), np.uint8))
    >>> [len(_split(_split(model)).positions), len(_split(_split(model)).triangles)]
    [15, 16]
    """
    ends = np.sort(model.triangles[:, [[0, 1], [1, 2], [2, 0]]].astype(np.int64), axis=2)
    n = len(model.positions)
    keys, middle = np.unique(ends[..., 0] * n + ends[..., 1], return_inverse=True)
    a, b = keys // n, keys % n
    positions, normals, uvs = (np.concatenate([x, (x[a] + x[b]) / 2.0]).astype(np.float32) for x in model[:3])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-20)
    (i, j, k), (ij, jk, ki) = model.triangles.T, (n + middle.reshape(-1, 3)).T
    parts = [(i, ij, ki), (ij, j, jk), (ki, jk, k), (ij, jk, ki)]
    # Side by side, as the triangle itself was: neighbours in the mesh stay neighbours in memory.
    triangles = np.stack([np.stack(part, axis=-1) for part in parts], axis=1).reshape(-1, 3).astype(np.int32)
    return Model(positions, normals, uvs, triangles, model.texels)


def write_model(folder: Path, model: Model) -> None:
    """What `serve` and f3d read."""
    from limner.image.png import png_bytes

    folder.mkdir()
    np.savez(folder / "model.npz", **model._asdict())
    texels = model.texels[::-1] if model.texels.size else np.full((1, 1, 4), 255, np.uint8)
    (folder / "texture.png").write_bytes(png_bytes(np.ascontiguousarray(texels)))


def job_of(folder: Path, model: Model, width: int, height: int, samples: int, threads: int) -> Job:
    """Look from a circle at the sphere around the model, from so near that it just fills the shorter side."""
    low, high = model.positions.min(axis=0).astype(np.float64), model.positions.max(axis=0).astype(np.float64)
    target = (low + high) / 2.0
    radius = float(np.linalg.norm(model.positions - target, axis=1).max())
    tangent = math.tan(math.radians(YFOV_DEGREES) / 2.0) * min(1.0, width / height)
    distance = radius / math.sin(math.atan(tangent))
    elevation = math.radians(ELEVATION_DEGREES)
    eyes = []
    for view in range(N_VIEWS):
        azimuth = math.radians(30.0) + 2.0 * math.pi * view / N_VIEWS
        outwards = (math.sin(azimuth) * math.cos(elevation), math.sin(elevation), math.cos(azimuth) * math.cos(elevation))
        x, y, z = (target + distance * np.array(outwards)).tolist()
        eyes.append((x, y, z))
    x, y, z = target.tolist()
    return Job("limner", str(folder), width, height, samples, threads, eyes, (x, y, z), distance - 1.01 * radius, distance + 1.01 * radius)
