"""Pixels at random, told by `limner.explain`, against the pixels that `limner.render` stores: the same bits, in every renderer.

    python tests/agreement/explain_pixels.py                          a hundred pixels of a dozen scenes, by each renderer
    python tests/agreement/explain_pixels.py --pixels 20 --renderer path --scene layered
    python tests/agreement/explain_pixels.py --pixels 5 --model a.glb --model b.glb

In the dozen scenes everything that a renderer can do happens somewhere: layered materials, textures and patterns, skies, exact shapes,
solids of solids, fog, liquids, motion, lenses. Of every pixel all samples are told, and three things must hold to the bit: the traced
kernels find what the compiled ones add to the film, in every sample; the pixel is that of the picture; the story ends in the pixel.
`test_explain_pixels.py` does the same for one pixel of each scene.
"""

from __future__ import annotations

import argparse
import functools
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

if __name__ == "__main__":
    sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # for what tests share

from menagerie import menagerie
from staging import checkers, grid, lit_from, point_light_at

import limner
from limner.linear.transform import rotate, translate

__all__ = ["RENDERERS", "SCENES", "check_pixel", "picture"]

RENDERERS = ("raster", "ray", "path")
WIDTH, HEIGHT = 40, 30


def _camera(eye: Any = (0.0, 1.2, 4.0), target: Any = (0.0, 0.3, 0.0), **fields: Any) -> Any:
    return limner.Camera.look_at(eye, target, yfov_degrees=35).replace(**fields)


def _node(geometry: Any, material: Any, *at: float, **fields: Any) -> limner.Node:
    return limner.Node(parent_from_node=translate(*(at or (0.0, 0.0, 0.0))), shapes=(limner.Shape(geometry, (material,), **fields),))


def _floor(material: Any = None) -> limner.Node:
    return _node(grid(3, 3.0), material or limner.Lambert((0.6, 0.6, 0.6)), 0.0, -0.5, 0.0)


def _stage(*nodes: limner.Node, camera: Any = None, **fields: Any) -> limner.Scene:
    lamp = point_light_at((1.5, 2.5, 2.0), limner.PointLight((1.0, 0.9, 0.8), 20.0))
    return limner.Scene(limner.Node(children=(*nodes, lamp)), camera or _camera(), **fields)


def _sky() -> limner.Environment:
    texels = np.random.default_rng(4).random((8, 16, 3), dtype=np.float32) ** 4
    texels[2, 5] = 40.0
    return limner.Environment(texels)


def _layered() -> limner.Scene:
    """A coat, a sheen, a film, a grain, a thin sheet, an inside, a leaf, under a sky."""
    make, ball = limner.MetallicRoughness, limner.primitives.uv_sphere(24, 12, 0.4)
    materials = (
        make((0.7, 0.1, 0.1), 0.5, 0.4, clearcoat=limner.Clearcoat(roughness=0.1, roughness_texture=checkers())),
        make((0.2, 0.1, 0.5), 0.0, 0.9, sheen=limner.Sheen((0.9, 0.8, 0.9), 0.4)),
        make((0.9, 0.9, 0.9), 1.0, 0.1, iridescence=limner.Iridescence()),
        make((0.9, 0.6, 0.3), 1.0, 0.35, anisotropy=limner.Anisotropy(0.8, 0.4)),
        make((0.8, 0.9, 0.8), 0.0, 0.0, transmission=limner.Transmission(), specular=limner.Specular(0.6, (1.0, 0.7, 0.4))),
        make((1.0, 1.0, 1.0), 0.0, 0.2, ior=1.4, dispersion=0.5, transmission=limner.Transmission(0.9),
             volume=limner.Volume(0.5, attenuation_distance=0.4, attenuation_color=(0.9, 0.5, 0.2))),
        make((0.3, 0.6, 0.1), 0.0, 0.8, diffuse_transmission=limner.DiffuseTransmission(0.6, (0.5, 0.9, 0.2)), double_sided=True),
        make((1.0, 1.0, 1.0), 1.0, 0.5, energy_compensation=True),
    )  # fmt: skip
    balls = [_node(ball, material, 0.85 * (k % 4) - 1.3, 0.9 * (k // 4) - 0.1, 0.0) for k, material in enumerate(materials)]
    return _stage(*balls, _floor(), environment=_sky())


def _textured() -> limner.Scene:
    """Textures near and far, repeated and mirrored, holes, veils, normal maps, bumps, patterns, one over a displaced surface."""
    bumps = np.random.default_rng(2).integers(90, 166, (8, 8, 4), dtype=np.uint8)
    bumps[..., 2:] = 255
    normals = limner.Texture(limner.Texels(bumps, srgb=False), scale=(3.0, 3.0))
    square, ball = grid(2, 0.6, rotate((1, 0, 0), 1.3)), limner.primitives.uv_sphere(24, 12, 0.4)
    height = limner.Noise(scale=3.0)
    veil = limner.MetallicRoughness((0.4, 0.8, 0.9), 0.0, 0.5, alpha=0.4, alpha_mode="blend", normal_texture=normals)
    stone = limner.BlinnPhong(diffuse_texture=limner.Marble(), specular=(0.5, 0.5, 0.5), bump_texture=limner.Wood())
    return _stage(
        _floor(limner.Lambert(texture=checkers(32, wrap_u="mirror", scale=(9.0, 9.0)))),
        _node(square, limner.Lambert(texture=checkers(8, 0, filter="nearest"), alpha_mode="mask"), -0.9, 0.2, 0.6),
        _node(square, veil, 0.9, 0.2, 0.7), _node(ball, stone, -0.6, 0.5, -0.5),
        _node(ball, limner.Lambert(texture=limner.Stripes(scale=0.2)), 0.6, 0.5, -0.5, displacement=limner.Displacement(height, 0.08)),
    )  # fmt: skip


def _lamps() -> limner.Scene:
    """One of every lamp, seen and unseen, and a surface that shines."""
    lamps = (
        limner.RectangleLight((1.0, 0.8, 0.6), 20.0, 0.5, 0.5), limner.DiskLight((0.5, 0.7, 1.0), 30.0, 0.3),
        limner.SphereLight(intensity=20.0, radius=0.2), limner.SpotLight(intensity=30.0, inner_degrees=10.0, outer_degrees=30.0),
        limner.DirectionalLight(intensity=0.5), limner.PointLight(intensity=1.0, falloff="none", range=9.0),
    )  # fmt: skip
    places = ((-1.5, 1.6, 0.5), (1.5, 1.6, 0.5), (0.0, 1.3, -1.0), (0.4, 2.5, 2.0), (-1.0, 2.0, 2.0), (2.0, 2.0, 1.0))
    nodes = [lit_from(place, lamp) for place, lamp in zip(places, lamps, strict=True)]
    glow = _node(limner.primitives.box((0.3, 0.3, 0.3)), limner.Lambert(emission=(3.0, 2.0, 1.0)), 0.6, -0.3, 0.6)
    ball = _node(limner.primitives.icosphere(0.5, 2), limner.BlinnPhong(specular=(0.6, 0.6, 0.6), mirror=(0.2, 0.2, 0.2)), -0.4, 0.0, 0.0)
    return limner.Scene(limner.Node(children=(*nodes, glow, ball, _floor(), limner.Node(lights=(limner.AmbientLight(),)))), _camera())


def _solids() -> limner.Scene:
    """Exact shapes, a combination of them, a field of distances."""
    lens = limner.Intersection(limner.Sphere(0.5), limner.Solid(limner.Sphere(0.5), translate(0.4, 0.0, 0.0)))
    field = limner.distance.Union(limner.distance.Sphere(0.3), limner.distance.Torus(0.4, 0.1), radius=0.1)
    metal, blue = limner.MetallicRoughness((0.9, 0.7, 0.4), 1.0, 0.3), limner.Lambert((0.2, 0.4, 0.8))
    return _stage(
        _node(limner.Plane(), limner.Lambert(texture=limner.Checker(scale=0.5)), 0.0, -0.5, 0.0), _node(lens, metal, -0.9, 0.2, 0.3),
        _node(limner.DistanceField(field), blue, 0.9, 0.1, 0.2), _node(limner.Torus(0.4, 0.12), metal, 0.0, 0.9, -0.3),
        _node(limner.Cone(0.3, 0.6), blue, 0.0, 0.0, 0.4), _node(limner.Cylinder(0.2, 0.8), metal, -1.5, 0.0, -0.8), environment=_sky(),
    )  # fmt: skip


def _liquids() -> limner.Scene:
    """Glass, tinted and frosted, one in another, in fog: what light goes through."""
    clear, tinted = limner.Dielectric(1.5, absorption=(0.3, 0.6, 0.9)), limner.Dielectric(1.33, tint=(0.5, 0.9, 0.6), priority=1)
    frosted = limner.Dielectric(1.5, roughness=0.3, haze=(0.1, 0.1, 0.1))
    return _stage(
        _floor(limner.Lambert(texture=checkers(16))),
        _node(limner.Sphere(0.55), clear, -0.5, 0.2, 0.0), _node(limner.Sphere(0.3), tinted, -0.4, 0.2, 0.2),
        _node(limner.primitives.icosphere(0.45, 3), frosted, 0.8, 0.1, 0.2),
        environment=_sky(), fog=limner.Fog((0.6, 0.6, 0.7), 0.15),
    )  # fmt: skip


def _moving() -> limner.Scene:
    """A ball that slides, a box that turns, before an eye that moves."""
    slide = limner.Motion((0.0, 1.0), [translate(-0.7, 0.0, 0.0), translate(0.5, 0.3, 0.2)])
    turn = limner.Motion((0.0, 1.0), [translate(0.8, 0.0, 0.0), translate(0.8, 0.0, 0.0) @ rotate((0, 1, 0), 1.0)])
    ball = limner.Node("ball", motion=slide, shapes=(limner.Shape(limner.Sphere(0.4), (limner.BlinnPhong(specular=(0.5, 0.5, 0.5)),)),))
    chess = limner.Shape(limner.primitives.box((0.6, 0.6, 0.6)), (limner.Lambert(texture=checkers()),))
    box = limner.Node("box", motion=turn, shapes=(chess,))
    camera = _camera()
    pan = limner.Motion((0.0, 1.0), [camera.world_from_camera, translate(0.1, 0.05, 0.0) @ camera.world_from_camera])
    return _stage(ball, box, _floor(), camera=camera.replace(motion=pan))


def _lens() -> limner.Scene:
    """Mirrors that blur, behind a lens with blades."""
    rough = limner.BlinnPhong(diffuse=(0.1, 0.1, 0.1), mirror=(0.7, 0.7, 0.7), mirror_blur=0.1)
    nodes = [_node(limner.primitives.icosphere(0.35, 2), rough, 0.8 * k - 0.8, 0.0, 0.9 - 0.9 * k) for k in range(3)]
    return _stage(*nodes, _floor(limner.Lambert(texture=checkers(8))), camera=_camera(aperture_radius=0.08, focus_distance=3.5, blades=5))


def _clouds() -> limner.Scene:
    """Points, lines, vertex colours, matte paint of Oren and Nayar, a catcher of shadows, in parallel projection."""
    rng = np.random.default_rng(3)
    dust = limner.PointCloud(rng.normal(0.0, 0.3, (60, 3)), rng.random((60, 3)), radii=0.05)
    wire = limner.LineSet(np.array([[-1, 0, 0], [0, 1, 0], [1, 0, 0], [0, 0.2, 0.5]], dtype=np.float32), radii=0.03)
    eye = limner.OrthographicCamera(_camera().world_from_camera, 2.4)
    return _stage(
        _node(dust, limner.Lambert(), -0.7, 0.4, 0.0), _node(wire, limner.Lambert((0.9, 0.5, 0.1))), _floor(limner.ShadowCatcher()),
        _node(limner.primitives.icosphere(0.35, 2), limner.Lambert(roughness_degrees=25.0), 0.8, 0.0, 0.3),
        camera=eye, background=(0.2, 0.3, 0.4),
    )  # fmt: skip


def _instances() -> limner.Scene:
    """One mesh many times, as a drawing of cool and warm and as plain plaster."""
    mesh = limner.primitives.torus(0.25, 0.1)
    shapes = [limner.Shape(mesh, (material,)) for material in (limner.CoolToWarm(), limner.Lambert())]
    nodes = [limner.Node(f"{i} {j}", translate(0.6 * i - 1.2, 0.5 * j - 0.2, -0.3 * j) @ rotate((1, 1, 0), i + j), (shapes[(i + j) % 2],))
             for i in range(5) for j in range(3)]  # fmt: skip
    return _stage(*nodes, _floor())


SCENES: dict[str, tuple[Callable[[], Any], dict[str, Any]]] = {
    "teapot": (lambda: limner.builtin("teapot"), {}),
    "cornell": (lambda: limner.builtin("cornell"), {"emitters": True, "sampler": "halton"}),
    "layered": (_layered, {"glossy": True}),
    "textured": (_textured, {"shadows": True}),
    "lamps": (_lamps, {"samples": 4, "sampler": "multijittered"}),
    "solids": (_solids, {"filter": "mitchell", "antialiasing": "supersample"}),
    "liquids": (_liquids, {"tinted_shadows": True, "max_depth": 5}),
    "moving": (_moving, {"shutter": (0.2, 0.9)}),
    "lens": (_lens, {"glossy": True, "seed": 7}),
    "clouds": (_clouds, {"culling": "none", "shading": "flat"}),
    "instances": (_instances, {"shading": "vertex", "hidden_surfaces": "painter", "clipping": "world"}),
    "animated": (menagerie, {"time": 0.6}),
}
"""By name: a scene, and what its picture is asked for with; what a renderer does not know it is not told."""

_ONLY = {
    "raster": ("filter", "antialiasing", "culling", "shading", "hidden_surfaces", "clipping"),
    "ray": ("sampler", "glossy", "emitters", "tinted_shadows", "shutter", "max_depth"),
    "path": ("sampler", "tinted_shadows", "shutter", "max_depth"),
}


def options_of(name: str, renderer: str) -> dict[str, Any]:
    """What the picture of a scene is asked for with by a renderer."""
    foreign = {option for options in _ONLY.values() for option in options} - set(_ONLY[renderer])
    asked = {"samples": 8 if renderer == "raster" else 2, **SCENES[name][1]}
    return {"width": WIDTH, "height": HEIGHT, "renderer": renderer} | {key: value for key, value in asked.items() if key not in foreign}


def picture(name: str, renderer: str) -> tuple[Any, Any]:
    """The scene of that name and its picture."""
    scene = SCENES[name][0]()
    return scene, limner.render(scene, threads=1, **options_of(name, renderer))


def check_pixel(scene: Any, image: Any, name: str, renderer: str, x: int, y: int) -> str:
    """What is not to the bit in the story of a pixel; nothing: all is."""
    told = limner.explain(scene, x, y, sample="all", **options_of(name, renderer))
    stored = image.pixels[y, x]
    if told.pixel.tobytes() != stored.tobytes():
        return f"the pixel is {stored.tolist()}, told is {told.pixel.tolist()}"
    if not told.is_exact:
        return "the traced kernels found other bits than the compiled ones"
    if len(told.told) != len(told.contributions):
        return f"{len(told.told)} of {len(told.contributions)} contributions are told"
    ends = np.array(told.as_dict()["story"]["result"], dtype=np.float32)
    return "" if ends.tobytes() == stored.tobytes() else "the story ends otherwise"


def main() -> int:
    """Check as many pixels as the command line says, by each renderer, and count."""
    parser = argparse.ArgumentParser(description="Pixels at random, told, against those of pictures.")
    parser.add_argument("--pixels", type=int, default=100, help="by each renderer, over all scenes; 100 unless told")
    parser.add_argument("--renderer", choices=RENDERERS, action="append")
    parser.add_argument("--scene", choices=sorted(SCENES), action="append")
    parser.add_argument("--model", action="append", default=[], metavar="FILE", help="this instead of the scenes that are built here")
    parser.add_argument("--seed", type=int, default=0)
    asked = parser.parse_args()
    SCENES.update({model: (functools.partial(limner.load, model), {}) for model in asked.model})
    names, wrong, total, began = asked.model or asked.scene or list(SCENES), 0, 0, time.perf_counter()
    for renderer in asked.renderer or RENDERERS:
        shares = [len(part) for part in np.array_split(np.arange(asked.pixels), len(names))]
        for name, share in zip(names, shares, strict=True):
            rng = np.random.default_rng((asked.seed, names.index(name), RENDERERS.index(renderer)))
            scene, image = picture(name, renderer)
            for x, y in rng.integers((0, 0), (WIDTH, HEIGHT), (share, 2)).tolist():
                slip = check_pixel(scene, image, name, renderer, x, y)
                wrong, total = wrong + bool(slip), total + 1
                if slip:
                    print(f"{name} by {renderer}, pixel ({x}, {y}): {slip}", flush=True)  # noqa: T201
        print(f"after {renderer}: {total} pixels, {wrong} not to the bit, {time.perf_counter() - began:.0f} s", flush=True)  # noqa: T201
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
