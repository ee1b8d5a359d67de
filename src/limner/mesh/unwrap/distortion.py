"""What a flattening does to a surface, triangle by triangle, whoever made it.

The map from a triangle to the texture stretches by s1 along one direction and by s2 < s1 across it: the singular values of its Jacobian.
s1/s2 is 1 where angles are kept, s1 s2 is the same everywhere where areas are, and s1 = s2 = const is an isometry up to scale.

**Source**: Hormann, Lévy and Sheffer, *Mesh parameterization: theory and practice*, 2007, chapter 2; the stretch L2 and L∞: Sander, Snyder,
Gortler and Hoppe, *Texture mapping progressive meshes*, 2001.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..._door import Array, Door
from ...errors import SceneError
from ..mesh import Mesh
from .surface import Surface, components

__all__ = ["Distortion", "UnwrapReport", "rim_edges", "unwrap_report", "uv_charts", "uv_distortion"]

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]

_count_layers = Door(
    "limner.mesh.unwrap.distortion_kernel",
    "count_layers",
    (Array(np.float64, 3), Array(np.int64, 2)),
    "the search for overlaps in a texture",
)
_LOOKED_AT = 2048  # texels along a side, at whose centres overlaps are looked for


class Distortion(NamedTuple):
    """Of each triangle of a mesh; NaN where it has no area, infinite where its texture coordinates have none.

    Attributes
    ----------
    stretch : (m, 2) float64
        s1 >= s2 >= 0: texture lengths per unit of length, greatest and least, as parts of what they would be if all areas had one scale.
    conformal : (m,) float64
        s1 / s2 >= 1: what becomes of a small circle, long over short.
    area : (m,) float64
        s1 s2: the scale of areas, 1 in the mean.
    mirrored : (m,) bool
        Whether the triangle lies on its face.
    """

    stretch: Floats
    conformal: Floats
    area: Floats
    mirrored: NDArray[np.bool_]


@dataclass(frozen=True)
class UnwrapReport:
    """A flattening in numbers; means are weighted by areas on the surface.

    Attributes
    ----------
    n_triangles, n_degenerate : int
        Triangles, and those without area, which are left out of all that follows.
    n_charts : int
        Parts of the surface that are in one piece in the texture.
    seam_length : float
        Of the cuts between triangles that are neighbours on the surface; the unit is the square root of the surface's area.
    conformal_mean, conformal_max : float
        Of s1/s2; 1: angles are kept.
    area_mean, area_max : float
        Of the scale of areas or its inverse, whichever is greater; 1: all alike.
    stretch_l2, stretch_max : float
        Sander's L2 and L∞: texels are farther apart than they need be by this factor, as a root mean square and at the worst.
    filled : float
        Part of the unit square that is covered.
    n_flipped : int
        Triangles that lie on their faces while most of their chart does not, or the other way round.
    n_mirrored : int
        Charts that are mirrored.
    n_collapsed : int
        Triangles with an area on the surface and none in the texture.
    overlap : float
        Part of the covered square, of 2048 x 2048 places looked at, that more than one triangle covers.
    """

    n_triangles: int
    n_degenerate: int
    n_charts: int
    seam_length: float
    conformal_mean: float
    conformal_max: float
    area_mean: float
    area_max: float
    stretch_l2: float
    stretch_max: float
    filled: float
    n_flipped: int
    n_mirrored: int
    n_collapsed: int
    overlap: float

    def document(self) -> dict[str, Any]:
        """The fields by name, for JSON: numbers that are not finite become None."""
        return {name: value if np.isfinite(value) else None for name, value in asdict(self).items()}

    def __str__(self) -> str:
        without = f" ({self.n_degenerate} without area)" if self.n_degenerate else ""
        return "\n".join(
            (
                f"triangles     {self.n_triangles}{without}, {self.n_flipped} flipped, {self.n_collapsed} collapsed",
                f"charts        {self.n_charts}, {self.n_mirrored} mirrored",
                f"seams         {self.seam_length:.3f} (in square roots of the area)",
                f"angles        {self.conformal_mean:.4f} in the mean, {self.conformal_max:.3f} at the worst (1: kept)",
                f"areas         {self.area_mean:.4f} in the mean, {self.area_max:.3f} at the worst (1: kept)",
                f"stretch       {self.stretch_l2:.4f} (L2), {self.stretch_max:.3f} (L∞)",
                f"filled        {100.0 * self.filled:.1f} % of the square, {100.0 * self.overlap:.2g} % of that more than once",
            )
        )


def uv_distortion(mesh: Mesh) -> Distortion:
    """Measure how texture coordinates distort the triangles of a mesh.

    Raises SceneError where the mesh has none.

    Examples
    --------
    >>> from limner.mesh.shapes.primitives import box
    >>> found = uv_distortion(box((1.0, 1.0, 2.0)))
    >>> found.conformal.round(6).tolist()
    [2.0, 2.0, 2.0, 2.0, 2.0, 2.0, 2.0, 2.0, 1.0, 1.0, 1.0, 1.0]
    """
    points, texture = _corners(mesh)
    first, second = points[:, 1] - points[:, 0], points[:, 2] - points[:, 0]
    e, f = texture[:, 1] - texture[:, 0], texture[:, 2] - texture[:, 0]
    signed = 0.5 * (e[:, 0] * f[:, 1] - e[:, 1] * f[:, 0])
    areas = 0.5 * np.linalg.norm(np.cross(first, second), axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        length = np.linalg.norm(first, axis=1)
        x, y = np.einsum("ij,ij->i", first, second) / length, 2.0 * areas / length
        along = e / length[:, None]
        across = (f - along * x[:, None]) / y[:, None]
        det = along[:, 0] * across[:, 1] - along[:, 1] * across[:, 0]
        # Half sums and differences, so that nothing cancels where s1 = s2
        close = np.hypot(along[:, 0] + across[:, 1], along[:, 1] - across[:, 0])
        apart = np.hypot(along[:, 0] - across[:, 1], along[:, 1] + across[:, 0])
        scale = np.sqrt(np.abs(signed[areas > 0.0]).sum() / areas.sum()) if (areas > 0.0).any() else 1.0
        s1, s2 = 0.5 * (close + apart) / scale, 0.5 * np.abs(close - apart) / scale
        conformal = s1 / s2
    none = ~(areas > 0.0)
    s1, s2, conformal, det = (np.where(none, np.nan, values) for values in (s1, s2, conformal, det))
    return Distortion(np.stack([s1, s2], axis=1), conformal, s1 * s2, det < 0.0)


def uv_charts(mesh: Mesh) -> Indices:
    """(m,) int64: the chart of each triangle: neighbours across an edge are of one where they name the same texture coordinates."""
    surface = Surface(mesh)
    joined = _joined(mesh, surface)
    h = np.flatnonzero(joined)
    return components(len(mesh.triangles), surface.kept[h // 3], surface.kept[surface.mates[h] // 3])


def rim_edges(mesh: Mesh) -> NDArray[np.float32]:
    """(k, 2, 2) float32: the texture coordinates between which the rims of the charts run."""
    _corners(mesh)
    assert mesh.uvs is not None
    surface = Surface(mesh)
    indices = (mesh.triangles if mesh.uv_triangles is None else mesh.uv_triangles)[surface.kept]
    ends = np.stack([indices, np.roll(indices, -1, axis=1)], axis=-1).reshape(-1, 2)
    return mesh.uvs[ends[~_joined(mesh, surface)]]


def unwrap_report(mesh: Mesh) -> UnwrapReport:
    """Measure the texture coordinates of a mesh.

    Raises SceneError where it has none.
    """
    points, texture = _corners(mesh)
    areas = 0.5 * np.linalg.norm(np.cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0]), axis=1)
    found, surface, charts = uv_distortion(mesh), Surface(mesh), uv_charts(mesh)
    solid = areas > 0.0
    total = float(areas.sum())
    weights = areas[solid] / total if total > 0.0 else areas[solid]
    collapsed = solid & (found.area == 0.0)
    flipped, mirrored = _against_their_charts(charts, found.mirrored & ~collapsed, solid & ~collapsed)

    def mean_and_max(values: Floats) -> tuple[float, float]:
        return (float(values @ weights), float(values.max())) if len(values) else (1.0, 1.0)

    with np.errstate(divide="ignore", invalid="ignore"):
        s1, s2 = found.stretch[solid].T
        scale = found.area[solid]
        areas_off = mean_and_max(np.maximum(scale, 1.0 / scale))
        stretch = mean_and_max(0.5 * (1.0 / (s1 * s1) + 1.0 / (s2 * s2)))[0], mean_and_max(1.0 / s2)[1]
    cut = ~_joined(mesh, surface) & (surface.mates > np.arange(len(surface.mates)))
    e, f = texture[:, 1] - texture[:, 0], texture[:, 2] - texture[:, 0]
    return UnwrapReport(
        len(mesh.triangles),
        int((~solid).sum()),
        len(np.unique(charts[solid])),
        float(surface.lengths[cut].sum()),
        *mean_and_max(found.conformal[solid]),
        *areas_off,
        float(np.sqrt(stretch[0])),
        stretch[1],
        float(np.abs(e[:, 0] * f[:, 1] - e[:, 1] * f[:, 0]).sum() / 2.0),
        flipped,
        mirrored,
        int(collapsed.sum()),
        _overlap(texture),
    )


def _corners(mesh: Mesh) -> tuple[Floats, Floats]:
    """(m, 3, 3) positions and (m, 3, 2) texture coordinates of the corners."""
    if mesh.uvs is None:
        raise SceneError("the mesh has no texture coordinates: unwrap it first", mesh.name)
    indices = mesh.triangles if mesh.uv_triangles is None else mesh.uv_triangles
    return mesh.positions[mesh.triangles].astype(np.float64), mesh.uvs[indices].astype(np.float64)


def _joined(mesh: Mesh, surface: Surface) -> NDArray[np.bool_]:
    """(3 k,): whether a half-edge of the surface has a mate with the same texture coordinates."""
    indices = (mesh.triangles if mesh.uv_triangles is None else mesh.uv_triangles)[surface.kept]
    starts, ends = indices.reshape(-1), np.roll(indices, -1, axis=1).reshape(-1)
    mates = np.maximum(surface.mates, 0)
    joined: NDArray[np.bool_] = (surface.mates >= 0) & (starts == ends[mates]) & (ends == starts[mates]) if len(mates) else mates > 0
    return joined


def _against_their_charts(charts: Indices, mirrored: NDArray[np.bool_], counted: NDArray[np.bool_]) -> tuple[int, int]:
    """How many triangles are mirrored against most of their chart, and how many charts are mirrored."""
    n = int(charts.max()) + 1 if len(charts) else 0
    face_down = np.bincount(charts[counted & mirrored], minlength=n)
    face_up = np.bincount(charts[counted & ~mirrored], minlength=n)
    return int(np.minimum(face_down, face_up).sum()), int((face_down > face_up).sum())


def _overlap(texture: Floats) -> float:
    layers = np.zeros((_LOOKED_AT, _LOOKED_AT), dtype=np.int64)
    _count_layers(np.ascontiguousarray(texture * _LOOKED_AT), layers)
    covered = int((layers > 0).sum())
    return float((layers > 1).sum() / covered) if covered else 0.0
