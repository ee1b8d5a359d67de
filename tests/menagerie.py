"""A small scene with one of everything that glTF can say."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from limner.linear import transform
from limner.mesh.mesh import Mesh
from limner.scene.animation import Animation, Channel, FieldChannel, NodeChannel, WeightsChannel
from limner.scene.camera import OrthographicCamera, PerspectiveCamera
from limner.scene.light import DirectionalLight, PointLight, SpotLight
from limner.scene.material import MetallicRoughness
from limner.scene.motion import KeyedMotion
from limner.scene.node import Node
from limner.scene.points import PointCloud
from limner.scene.rig import Binding, Morph, Skin
from limner.scene.scene import Scene
from limner.scene.shape import Shape
from limner.scene.texture import Texels, Texture
from limner.scene.track import Track

__all__ = ["ODD_NAME", "menagerie", "seamed", "texels"]

ODD_NAME = 'a/b "\\\n\té😀#'


def texels(seed: int, *, srgb: bool, alpha: bool = False) -> Texels:
    """A picture of noise."""
    pixels = np.random.default_rng(seed).integers(0, 256, (4, 6, 4), dtype=np.uint8)
    pixels[..., 3] = pixels[..., 3] if alpha else 255
    return Texels(pixels, srgb=srgb, name=f"noise {seed}")


def seamed() -> Mesh:
    """Two triangles of a square whose normals differ along the diagonal and whose texture coordinates do not; two materials."""
    return Mesh(
        np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], dtype=np.float32),
        np.array([[0, 1, 2], [0, 2, 3]]),
        normals=np.array([[0, 0, 1], [0.6, 0, 0.8], [0, 0.6, 0.8]], dtype=np.float32), normal_triangles=np.array([[0, 1, 0], [2, 0, 2]]),
        uvs=np.array([[0, 0], [1.5, 0], [1.5, 1], [0, 1]], dtype=np.float32),
        uvs1=np.array([[1, 2], [3, 4], [5, 6], [7, 7]], dtype=np.float32) / 8,
        colors=np.array([[1, 0.5, 0.25, 1], [1, 1, 1, 1], [0.5, 1, 1, 1], [0, 1, 1, 1]], dtype=np.float32),
        triangle_materials=np.array([1, 0]), name="seamed", scalars={"heat": np.arange(4, dtype=np.float32)},
    )  # fmt: skip


def _materials() -> tuple[MetallicRoughness, MetallicRoughness]:
    packed = texels(2, srgb=False)
    lit = MetallicRoughness(
        (0.9, 0.5, 0.3), metallic=0.25, roughness=0.7, name="lit", alpha=0.75, alpha_mode="mask", alpha_cutoff=0.3, double_sided=True,
        base_color_texture=Texture(texels(1, srgb=True, alpha=True), "mirror", "clamp", "bilinear", offset=(0.1, 0.2), scale=(2.0, 3.0),
                                   rotation=0.4),
        metallic_roughness_texture=Texture(packed), occlusion_texture=Texture(packed, uv_set=1), occlusion_strength=0.6,
        normal_texture=Texture(texels(3, srgb=False), filter="nearest"), normal_scale=0.8,
        emission=(5.0, 0.3, 0.0), emissive_texture=Texture(texels(4, srgb=True)),
    )  # fmt: skip
    return lit, MetallicRoughness((0.2, 0.8, 0.4), name="flat", unlit=True, double_sided=True, alpha=0.5, alpha_mode="blend")


def _bent() -> Node:
    """A strip on two joints, with two morphs of which the second moves one vertex of many."""
    positions = np.array([[x, y, 0] for y in range(11) for x in (0, 1)], dtype=np.float32) * 0.1
    steps = 2 * np.arange(10)
    triangles = np.concatenate([np.stack([steps, steps + 1, steps + 3], 1), np.stack([steps, steps + 3, steps + 2], 1)])
    normals = np.tile(np.array([0, 0, 1], dtype=np.float32), (22, 1))
    tangents = np.tile(np.array([1, 0, 0, 1], dtype=np.float32), (22, 1))
    mesh = Mesh(positions, triangles, normals=normals, tangents=tangents, uvs=np.round(positions[:, :2] * 16) / 16, name="strip")
    one = np.zeros((22, 3), dtype=np.float32)
    one[7] = (0, 0, 0.2)
    morphs = (Morph(positions * np.float32(0.3), normals * np.float32(0.1), name="grow"), Morph(one, name="dent"))
    share = np.linspace(0, 1, 22, dtype=np.float32)
    binding = Binding(np.tile([0, 1, 0, 0, 1], (22, 1)), np.stack([1 - share, share, *np.zeros((3, 22))], axis=1))
    skin = Skin(("world/bones", "world/bones/tip"), np.stack([np.eye(4), transform.translate(0, -0.5, 0)]), name="spine")
    shape = Shape(mesh, (_materials()[0],), morphs, binding)
    return Node("strip", transform.translate(1.2, 0, 0), (shape,), weights=(0.25, 0.5), skin=skin)


def _walk() -> Animation:
    half = math.sqrt(0.5)
    turns = Track([0.0, 1.0], [[0, 0, 0, 1], [0, 0, half, half]], rotates=True)
    bend = KeyedMotion(Track.constant((0, 0.5, 0)), turns, Track.constant((1, 1, 1)))
    cubic = Track([0.5, 1.5], [[[0, 0, 0], [0, 0, 0], [1, 0, 0]], [[0, 1, 0], [0, 0.5, 0], [0, 0, 0]]], "cubic")
    shift = KeyedMotion(cubic, Track.constant((0, 0, 0, 1), rotates=True), Track([0.0, 1.0], [[1, 1, 1], [2, 1, 1]], "step"))

    def field(kind: Any, target: str, name: str, values: Any) -> FieldChannel:
        return FieldChannel(kind, target, name, Track([0.0, 1.0], values))

    channels: tuple[Channel, ...] = (
        NodeChannel("world/bones/tip", bend), NodeChannel("world/pair/first", shift),
        WeightsChannel("world/strip", Track([0.0, 1.0], [[0.0, 1.0], [1.0, 0.25]])),
        FieldChannel("node", "world/hidden", "visible", Track([0.0, 0.5], [0.0, 1.0], "step")),
        field("material", "lit", "base_color", [[1, 0, 0], [0, 1, 0]]), field("material", "lit", "alpha", [1.0, 0.5]),
        field("material", "lit", "emission", [[0, 0, 0], [9, 3, 0]]), field("material", "lit", "roughness", [0.0, 1.0]),
        field("material", "lit", "base_color_texture.offset", [[0, 0], [1, 0.5]]),
        field("light", "light 0", "intensity", [1.0, 4.0]), field("light", "light 0", "outer_degrees", [30.0, 60.0]),
        field("camera", "camera 0", "yfov_degrees", [30.0, 60.0]),
    )  # fmt: skip
    return Animation("walk", channels)


def menagerie() -> Scene:
    """One of everything."""
    square = Shape(seamed(), _materials())
    points = PointCloud(np.random.default_rng(5).random((9, 3), dtype=np.float32), np.full((9, 3), 0.5, dtype=np.float32), name="dust")
    turned = transform.translate(-1.5, 0.25, 0) @ transform.rotate_x(0.3) @ transform.rotate_y(-0.8) @ transform.scale(0.5, 0.75, 1.25)
    pair = Node("pair", turned, children=(Node("first", shapes=(square,)), Node("second", transform.translate(0, 2, 0), (square,))))
    hidden = Node("hidden", transform.scale(-0.4, 0.4, 0.4), (square,), visible=False)
    bones = Node("bones", transform.translate(1.2, -0.5, 0), children=(Node("tip", transform.translate(0, 0.5, 0)),))
    eye = transform.translate(0, 0, 5)
    cameras = (
        PerspectiveCamera(yfov_degrees=36.87, near=0.1, aspect=1.5, name="camera 0"),
        OrthographicCamera(transform.rotate_x(-0.1), 3.3, None, 20.0, 1.3, name="flat"),
    )
    lights = (
        SpotLight((1, 2, 3), 40.0, 10.0, 33.3, 50.0, name="light 0"), PointLight((1, 0.9, 0.8), 3.0, name="bulb"),
        DirectionalLight(intensity=2.5, name="sun"),
    )  # fmt: skip
    # Swaps axes with exact zeros, as exporters do whose +z points up.
    upright = np.array([[1.0, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]])
    dust = Node(ODD_NAME, upright, (Shape(points, MetallicRoughness(name="dusty")),))
    root = Node(children=(Node("eye", eye, lights=lights, cameras=cameras), pair, hidden, bones, _bent(), dust))
    return Scene(root, name="menagerie", animations=(_walk(),))
