"""A Mitsuba scene file gives the picture that Mitsuba makes of it, and the one that limner makes of the same scene described by hand."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from limner.files.report import load_report
from limner.linear import transform
from limner.mesh.mesh import Mesh
from limner.render import render
from limner.scene.camera import PerspectiveCamera
from limner.scene.light import PointLight
from limner.scene.material import Lambert
from limner.scene.node import Node
from limner.scene.scene import Scene
from limner.scene.shape import Shape, Sphere

REFERENCES = Path(__file__).resolve().parents[3] / "shared" / "reference" / "mitsuba"

BATCHES = 24

pytestmark = pytest.mark.compiled

SCENE = """<scene version="3.0.0">
    <integrator type="path"><integer name="max_depth" value="{depth}"/></integrator>
    <sensor type="perspective">
        <float name="fov" value="{fov}"/>
        <transform name="to_world"><lookat origin="{origin}" target="{target}" up="0, 1, 0"/></transform>
        <sampler type="independent"><integer name="sample_count" value="{samples}"/></sampler>
        <film type="hdrfilm"><integer name="width" value="{size}"/><integer name="height" value="{size}"/><rfilter type="box"/></film>
    </sensor>
    {body}
</scene>"""


def test_the_same_scene_by_hand_is_the_same_picture(tmp_path: Path) -> None:
    """A ball over a floor by a bulb: units, angles, directions and reflectances arrive as they are."""
    body = """
        <shape type="rectangle"><transform name="to_world"><rotate x="1" angle="-90"/><scale value="4"/></transform>
            <bsdf type="twosided"><bsdf type="diffuse"><rgb name="reflectance" value="0.7, 0.6, 0.5"/></bsdf></bsdf></shape>
        <shape type="sphere"><point name="center" x="0.5" y="1" z="0"/><float name="radius" value="0.75"/><bsdf type="diffuse"/></shape>
        <emitter type="point"><point name="position" x="-2" y="4" z="1"/><rgb name="intensity" value="40, 30, 20"/></emitter>"""
    text = SCENE.format(depth=2, fov=50, origin="3, 3, 5", target="0, 0.5, 0", samples=1, size=48, body=body)
    (tmp_path / "scene.xml").write_text(text)
    report = load_report(tmp_path / "scene.xml")
    assert report.is_exact
    corners = np.array([[-4, 0, 4], [4, 0, 4], [4, 0, -4], [-4, 0, -4]], dtype=np.float32)
    floor = Shape(Mesh(corners, np.array([[0, 1, 2], [0, 2, 3]], dtype=np.int32)), (Lambert((0.7, 0.6, 0.5)),))
    by_hand = Scene(
        Node(
            children=(
                Node(shapes=(floor,)),
                Node(parent_from_node=transform.translate(0.5, 1.0, 0.0), shapes=(Shape(Sphere(0.75), (Lambert((0.5, 0.5, 0.5)),)),)),
                Node(parent_from_node=transform.translate(-2.0, 4.0, 1.0), lights=(PointLight((1.0, 0.75, 0.5), 40.0),)),
            )
        ),
        camera=PerspectiveCamera.look_at((3, 3, 5), (0, 0.5, 0), yfov_degrees=50),
        background=(0.0, 0.0, 0.0),
    )
    read, made = (render(scene, **report.settings, threads=1).pixels for scene in (report.scene, by_hand))
    assert made[..., :3].mean() > 0.05
    np.testing.assert_allclose(read, made, atol=1e-5)


def mitsuba_text(folder: Path, told: dict, size: int, samples: int) -> str:
    """The scene file of a reference, its meshes written beside it as OBJ."""
    surfaces = [
        f'<bsdf type="twosided" id="{name}"><bsdf type="diffuse"><rgb name="reflectance" value="{color}"/></bsdf></bsdf>'
        for name, color in ((name, ", ".join(map(str, rgb))) for name, rgb in told["materials"].items())
    ]
    shapes = []
    for mesh in told["meshes"]:
        rows = [f"v {x!r} {y!r} {z!r}" for x, y, z in mesh["vertices"]] + ["f " + " ".join(str(k + 1) for k in f) for f in mesh["faces"]]
        (folder / f"{mesh['name']}.obj").write_text("\n".join(rows) + "\n")
        light = ""
        if "emission" in mesh:
            light = f'<emitter type="area"><rgb name="radiance" value="{", ".join(map(str, mesh["emission"]))}"/></emitter>'
        shapes.append(
            f'<shape type="obj" id="{mesh["name"]}"><string name="filename" value="{mesh["name"]}.obj"/>'
            f'<boolean name="face_normals" value="true"/><ref id="{mesh["material"]}"/>{light}</shape>'
        )
    camera = told["camera"]
    return SCENE.format(
        depth=told["max_depth"], fov=camera["fov_deg"], origin=", ".join(map(str, camera["origin"])),
        target=", ".join(map(str, camera["target"])), samples=samples, size=size, body="\n".join(surfaces + shapes),
    )  # fmt: skip


def test_a_scene_file_has_mitsubas_mean(tmp_path: Path) -> None:
    """Mitsuba's Cornell box as a scene file, against its converged picture: in blocks, by the noise of both, and as a whole."""
    folder = REFERENCES / "cornell"
    if not folder.is_dir():
        pytest.skip("the reference pictures are not here")
    told, stored = json.loads((folder / "scene.json").read_text()), np.load(folder / "reference.npz")
    (tmp_path / "scene.xml").write_text(mitsuba_text(tmp_path, told, 64, 16))
    report = load_report(tmp_path / "scene.xml")
    assert report.is_exact
    assert (report.settings["max_depth"], report.settings["renderer"]) == (7, "path")
    batches = np.array([render(report.scene, **report.settings, seed=seed).pixels[..., :3].astype(np.float64) for seed in range(BATCHES)])
    # A pixel of 64 covers four by four of the reference's 256, and both are means over it.
    blocks = batches.reshape(BATCHES, 16, 4, 16, 4, 3).mean(axis=(2, 4))
    mean, variance = (stored[name].astype(np.float64).reshape(16, 16, 16, 16, 3).mean(axis=(1, 3)) for name in ("mean", "variance_of_mean"))
    own = blocks.var(axis=0, ddof=1) / BATCHES
    z = (blocks.mean(axis=0) - mean) / np.sqrt(own + variance / 256.0 + 1e-12)
    assert np.abs(z).max() < 5.0
    assert z.std() < 1.2
    assert abs(batches.mean() / stored["mean"].mean() - 1.0) < 0.01
