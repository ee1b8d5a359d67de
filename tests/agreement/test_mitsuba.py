"""The path tracer against Mitsuba's converged pictures, pixel by pixel, as Mitsuba tests itself: a z-test.

The references (mean, and variance of that mean) are not part of the package; without them the test skips. Look at the picture of z as well
where it fails: structure in it is a bug even where the count passes.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import norm

from limner.mesh.mesh import Mesh
from limner.render import Renderer
from limner.scene.camera import PerspectiveCamera
from limner.scene.environment import Environment
from limner.scene.material import Lambert
from limner.scene.node import Node
from limner.scene.scene import Scene
from limner.scene.shape import Shape

REFERENCES = Path(__file__).resolve().parents[3] / "shared" / "reference" / "mitsuba"
BATCHES = 16

pytestmark = pytest.mark.compiled


def reference_scene(folder: Path) -> tuple[Scene, np.ndarray, np.ndarray]:
    """The scene of a reference, its mean and the variance of the mean."""
    told = json.loads((folder / "scene.json").read_text())
    stored = np.load(folder / "reference.npz")
    nodes = []
    for mesh in told["meshes"]:
        material = Lambert(
            color=tuple(told["materials"][mesh["material"]]),
            emission=tuple(mesh.get("emission", (0.0, 0.0, 0.0))),
            double_sided="emission" not in mesh,
        )
        if "vertices" in mesh:
            faces = np.array(mesh["faces"])
            triangles = np.concatenate([faces[:, [0, 1, 2]], faces[:, [0, 2, 3]]]) if faces.shape[1] == 4 else faces
            vertices = np.array(mesh["vertices"], dtype=np.float32)
        else:
            vertices, triangles = stored["bunny_vertices"], stored["bunny_faces"]
        nodes.append(Node(mesh["name"], shapes=(Shape(Mesh(vertices, triangles), (material,)),)))
    camera = told["camera"]
    eye = PerspectiveCamera.look_at(camera["origin"], camera["target"], camera["up"], yfov_degrees=camera["fov_deg"])
    environment = Environment(tuple(told["environment"])) if any(told["environment"]) else None
    background = "environment" if environment is not None else (0.0, 0.0, 0.0)
    dark = Node("no default light", lights=())
    scene = Scene(Node(children=(*nodes, dark)), camera=eye, environment=environment, background=background)
    return scene, stored["mean"], stored["variance_of_mean"]


def z_scores(batches: list[np.ndarray], mean: np.ndarray, variance_of_mean: np.ndarray) -> np.ndarray:
    """How far the mean of independent batches lies from the reference, in standard deviations of both; where neither varies, they agree."""
    ours, variance = np.mean(batches, axis=0), np.var(batches, axis=0, ddof=1) / len(batches) + variance_of_mean
    steady = variance < 1e-12
    np.testing.assert_allclose(ours[steady], mean[steady], atol=1e-5)
    return (ours[~steady] - mean[~steady]) / np.sqrt(variance[~steady])


def blocks(picture: np.ndarray) -> np.ndarray:
    """Means of blocks of 16 by 16 pixels."""
    return picture.reshape(16, 16, 16, 16, 3).mean(axis=(1, 3))


@pytest.mark.parametrize("name", ["cornell", "bunny"])
def test_path_has_mitsubas_mean(name):
    """At least 99.75 % of the pixels lie within the two-sided 1 % level, corrected for their number (Šidák)."""
    folder = REFERENCES / name
    if not folder.is_dir():
        pytest.skip("the reference pictures are not here")
    scene, mean, variance_of_mean = reference_scene(folder)
    batches = []
    for seed in range(BATCHES):
        with Renderer(scene, renderer="path", width=256, height=256, samples=8, seed=seed, max_depth=7, default_lights=False) as renderer:
            batches.append(renderer.render().pixels[..., :3].astype(np.float64))
    ours = np.mean(batches, axis=0)
    z = z_scores(batches, mean, variance_of_mean)
    level = 1.0 - (1.0 - 0.01) ** (1.0 / z.size)
    limit = norm.ppf(1.0 - level / 2.0)
    assert (np.abs(z) <= limit).mean() >= 0.9975
    # Structure hides in pixels and shows in blocks of sixteen by sixteen, whose noise is a sixteenth.
    z = z_scores([blocks(batch) for batch in batches], blocks(mean), blocks(variance_of_mean) / 256.0)
    assert np.abs(z).max() < 5.5
    assert z.std() < 1.3
    # No drift of the whole: the mean of z over many independent pixels is near zero, and so is the relative difference of the means.
    assert abs(ours.mean() / mean.mean() - 1.0) < 0.004
