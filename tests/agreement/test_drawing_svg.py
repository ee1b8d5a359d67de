"""What another program makes of a drawing's SVG, and the edges in the channels of the rasteriser: ids, places, normals."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from staging import SLOW_AS_PYTHON, place, scene_of

from limner.files.load import load
from limner.linear import transform
from limner.mesh.shapes import primitives
from limner.produce.drawing import drawing
from limner.render import render
from limner.scene.camera import Camera, OrthographicCamera, PerspectiveCamera
from limner.scene.framing import with_defaults
from limner.scene.primitive import Box, Cone, Cylinder, Torus
from limner.scene.scene import Scene

MESHES = Path(__file__).resolve().parents[2] / ".." / "shared" / "data" / "meshes"
WIDTH, HEIGHT = 200, 150
CREASE = np.cos(np.radians(30.0))

pytestmark = SLOW_AS_PYTHON

CAMERAS = (
    PerspectiveCamera.look_at((2.4, 2.2, 3.4), (0, 0, 0), yfov_degrees=45),
    OrthographicCamera.look_at((-2.0, 1.7, 3.0), (0, 0, 0), height=4.0),
)


def parts() -> Scene:
    """A plate with a post through it, a tube, a cone, a ring, a tilted box, a sheet."""
    tilted = transform.translate(-1.1, 0.45, 0.8) @ transform.rotate_y(0.4) @ transform.rotate_x(0.3)
    return scene_of(
        place(Box((3.6, 0.3, 3.0)), at=(0.0, -0.55, 0.0)),
        place(Box((0.6, 1.9, 0.6)), at=(0.2, 0.0, -0.6)),
        place(Cylinder(0.4, 0.8), at=(1.1, 0.0, 0.6)),
        place(Cone(0.5, 0.9), at=(0.0, 0.2, 0.7)),
        place(Torus(0.55, 0.12), at=(0.2, 0.6, -0.6)),
        place(primitives.box((0.7, 0.5, 0.6)), matrix=tilted),
        place(primitives.quad([[-1.6, -0.3, -1.2], [-0.4, -0.3, -1.3], [-0.4, 0.9, -1.3], [-1.6, 0.9, -1.2]])),
    )


def ink(svg: str) -> NDArray[np.float64]:
    """How dark resvg makes each pixel, from 0 to 1."""
    resvg = pytest.importorskip("resvg_py", reason="needs resvg-py: an independent renderer of SVG")
    from PIL import Image as Pictures

    return 1.0 - np.asarray(Pictures.open(io.BytesIO(bytes(resvg.svg_to_bytes(svg_string=svg)))).convert("L")) / 255.0


def edges(scene: Scene, camera: Camera) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """The pixels beside which there is another shape, another part of the same one in front or behind, or a normal that is turned by more
    than creases are: those where it must be drawn, and those where it may be, for what is nearly one is left out of the first."""
    picture = render(
        scene.replace(camera=camera), width=WIDTH, height=HEIGHT, samples=1, aovs=("instance_id", "position", "normal_geometric", "depth")
    )
    ids, places, normals = (picture.aov[name] for name in ("instance_id", "position", "normal_geometric"))
    depth = np.where(np.isfinite(picture.aov["depth"]), picture.aov["depth"], 0.0)
    pixel = 4.0 / HEIGHT if isinstance(camera, OrthographicCamera) else depth * 2.0 * np.tan(np.radians(22.5)) / HEIGHT
    must, may = np.zeros(ids.shape, dtype=bool), np.zeros(ids.shape, dtype=bool)
    for axis in (0, 1):
        a, b = [slice(None)] * 2, [slice(None)] * 2
        a[axis], b[axis] = slice(None, -1), slice(1, None)
        one, other = tuple(a), tuple(b)
        way = places[other] - places[one]
        # How far each point is from the plane of the other.
        apart = np.minimum(np.abs((way * normals[one]).sum(axis=2)), np.abs((way * normals[other]).sum(axis=2)))
        cosine = (normals[one] * normals[other]).sum(axis=2)
        seen = (ids[one] >= 0) & (ids[other] >= 0)
        size = np.broadcast_to(pixel, ids.shape)[one]
        other_shape, jump = ids[one] != ids[other], seen & (apart > 3.0 * size)
        must[one] |= other_shape | jump | (seen & (cosine < CREASE - 0.1))
        for side in (one, other):
            may[side] |= other_shape | (seen & (apart > 0.3 * size)) | (seen & (cosine < CREASE + 0.05))
    return must, may


def grown(marked: NDArray[np.bool_], by: int = 1) -> NDArray[np.bool_]:
    wide = np.pad(marked, by)
    return np.any([wide[j : j + marked.shape[0], i : i + marked.shape[1]] for j in range(2 * by + 1) for i in range(2 * by + 1)], axis=0)


@pytest.mark.parametrize("camera", CAMERAS, ids=["perspective", "parallel"])
def test_the_svg_is_the_picture_of_the_edges(camera: Camera) -> None:
    """Wherever ids, places or normals change there is ink within a pixel, and there is ink nowhere else: of shapes with creases, round
    ones, and such as run through each other."""
    scene = parts()
    dark = ink(drawing(scene, camera=camera, width=WIDTH, height=HEIGHT, style="plain").svg())
    must, may = edges(scene, camera)
    assert must.sum() > 800
    assert not (must & ~grown(dark > 0.3)).any()
    assert not ((dark > 0.6) & ~grown(may)).any()


def test_the_svg_of_a_part_is_the_picture_of_its_edges() -> None:
    """Of the fandisk, a part with sharp and with fading edges."""
    path = MESHES / "fandisk.obj"
    if not path.is_file():
        pytest.skip(f"the optional mesh {path.name} is not there")
    scene, _ = with_defaults(load(path), WIDTH / HEIGHT)
    assert scene.camera is not None
    dark = ink(drawing(scene, camera=scene.camera, width=WIDTH, height=HEIGHT).svg())
    must, _ = edges(scene, scene.camera)
    assert must.sum() > 300
    assert not (must & ~grown(dark > 0.3)).any()
