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
BATCHES = 6

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


@pytest.mark.parametrize("name", ["cornell", "bunny"])
def test_path_has_mitsubas_mean(name):
    """At least 99.75 % of the pixels lie within the two-sided 1 % level, corrected for their number (Šidák)."""
    folder = REFERENCES / name
    if not folder.is_dir():
        pytest.skip("the reference pictures are not here")
    scene, mean, variance_of_mean = reference_scene(folder)
    batches = []
    for seed in range(BATCHES):
        with Renderer(scene, renderer="path", width=256, height=256, samples=16, seed=seed, max_depth=7, default_lights=False) as renderer:
            batches.append(renderer.render().pixels[..., :3].astype(np.float64))
    ours = np.mean(batches, axis=0)
    variance = np.var(batches, axis=0, ddof=1) / BATCHES
    # The variance of six batches is itself noisy: its mean over the neighbours is what a pixel is tested with.
    kernel = np.ones((5, 5)) / 25.0
    padded = np.pad(variance, ((2, 2), (2, 2), (0, 0)), mode="edge")
    smooth = sum(padded[i : i + 256, j : j + 256] * kernel[i, j] for i in range(5) for j in range(5))
    z = (ours - mean) / np.sqrt(np.maximum(smooth, variance) + variance_of_mean + 1e-10)
    level = 1.0 - (1.0 - 0.01) ** (1.0 / z.size)
    limit = norm.ppf(1.0 - level / 2.0)
    assert (np.abs(z) <= limit).mean() >= 0.9975
    # No drift of the whole: the mean of z over many independent pixels is near zero, and so is the relative difference of the means.
    assert abs(ours.mean() / mean.mean() - 1.0) < 0.004
