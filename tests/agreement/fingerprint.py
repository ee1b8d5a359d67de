"""Print a digest of a small picture by each renderer, and of one of all exact shapes by rays, as JSON: colours and channels, all bits.

With --warm-up: compile everything first, and tell how long it took and which kernels there are.

A program, run by `test_bits.py` in each mode and for several CPUs. The scene has something of everything that kernels branch on:
textures, a normal map, masks, blended layers, mirrors, shadows, every light and kind of shape, a triangle through the near plane.
"""

from __future__ import annotations

import hashlib
import json
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from staging import checkers, grid, lit_from, place, point_light_at, scene_of

from limner._door import warm_up
from limner._jit import MODE
from limner.aov import CHANNELS
from limner.linear import transform
from limner.mesh.shapes import primitives
from limner.render import render
from limner.scene.camera import PerspectiveCamera
from limner.scene.fog import Fog
from limner.scene.light import AmbientLight, DiskLight, PointLight, RectangleLight, SphereLight, SpotLight
from limner.scene.material import BlinnPhong, CoolToWarm, Dielectric, Lambert, MetallicRoughness
from limner.scene.motion import Motion
from limner.scene.node import Node
from limner.scene.scene import Scene
from limner.scene.shape import (
    BilinearPatch,
    Box,
    Cone,
    Cylinder,
    Difference,
    Disk,
    Intersection,
    Plane,
    Quadric,
    Shape,
    Solid,
    Sphere,
    Torus,
    Union,
)


def small_scene() -> Scene:
    """Fits a picture of 24 x 16."""
    bumps = checkers(4, filter="bilinear")
    return scene_of(
        place(grid(3, 4.0), Lambert(color=1, texture=checkers(8, scale=(6.0, 6.0)))),
        place(Sphere(0.5), BlinnPhong(diffuse=0.1, specular=0.6, exponent=30, mirror=(0.7, 0.6, 0.5)), at=(-0.6, 0.5, 0.1)),
        place(Box((0.6, 0.8, 0.4)), MetallicRoughness(metallic=0.3, roughness=0.4, normal_texture=bumps), at=(0.6, 0.4, -0.2)),
        place(primitives.sphere(0.3, 5), Lambert(texture=checkers(4, alpha=0, filter="nearest"), alpha_mode="mask"), at=(0.1, 0.3, 0.9)),
        place(Sphere(0.35), Lambert(color=(0.2, 0.9, 0.3), alpha=0.4, alpha_mode="blend"), at=(0.5, 0.5, 0.8)),
        place(Plane(), matrix=transform.translate(0, 0, -2) @ transform.rotate_x(1.3)),
        lit_from((0.5, 1.0, 0.7)),
        point_light_at((-1.0, 1.5, 1.0), PointLight(color=(1, 0.7, 0.4), intensity=3.0, range=6.0)),
        lit_from((1.0, 2.0, 0.5), SpotLight(intensity=8.0, inner_degrees=5, outer_degrees=30)),
        Node(lights=(AmbientLight(intensity=0.1),)),
        camera=PerspectiveCamera.look_at((0.2, 1.0, 2.6), (0.0, 0.4, 0.0), yfov_degrees=45),
        background=(0.1, 0.2, 0.4),
    )


def exact_scene() -> Scene:
    """All exact shapes, and solids cut out of each other."""
    drill = Solid(Cylinder(0.2, 2.0), transform.rotate_x(0.4), material=Lambert(color=(0.9, 0.2, 0.1)))
    cut = Difference(Intersection(Box(0.9), Sphere(0.6)), drill)
    shapes = (
        Cylinder(0.3, 0.6), Cone(0.3, 0.6, 0.1, capped=False), Torus(0.3, 0.12), Disk(0.3), BilinearPatch(), cut,
        Quadric((1, -1, 1, 0, 0, 0, 0, 0, 0, -0.03), low=-0.4, high=0.4),
        Union(Sphere(0.3), Solid(Torus(0.3, 0.1), transform.rotate_z(1.0))),
    )  # fmt: skip
    nodes = [
        place(shape, Lambert(color=(0.2, 0.5, 0.9), texture=checkers(4)), matrix=transform.translate(k % 4 - 1.5, 0.6 * (k // 4), 0.1 * k))
        for k, shape in enumerate(shapes)
    ]
    return scene_of(*nodes, place(Plane(), at=(0, -0.5, 0)), camera=PerspectiveCamera.look_at((0.4, 1.6, 3.4), (0, 0.2, 0)))


def distributed_scene() -> Scene:
    """Glass in glass, fog, lights with an area, a lens, mirrors that are not perfect, and things that move."""
    return scene_of(
        place(Plane(), Lambert(texture=checkers(2))),
        place(Sphere(0.5), Dielectric(1.5, absorption=(0.2, 0.1, 0.4)), at=(-0.8, 0.5, 0)),
        place(Sphere(0.2), Dielectric(1.0, fresnel="schlick"), at=(-0.8, 0.5, 0)),
        place(Box((0.6, 0.6, 0.6)), Dielectric(1.3, roughness=0.3), at=(0.3, 0.3, 0.6)),
        place(Sphere(0.4), MetallicRoughness((0.9, 0.6, 0.3), roughness=0.3, double_sided=True), at=(0.8, 0.4, -0.3)),
        place(Sphere(0.3), BlinnPhong(diffuse=0.1, mirror=0.8, mirror_blur=0.3), at=(0.1, 0.3, -0.8)),
        place(Sphere(0.2), CoolToWarm(), at=(0.0, 0.2, 1.1)),
        Node(parent_from_node=transform.translate(0, 1.2, 0), shapes=(Shape(Sphere(0.2)),), motion=Motion.shift((0.5, 0.3, 0))),
        Node(
            parent_from_node=transform.translate(1, 1.3, 0), shapes=(Shape(Box((0.3,) * 3), (Lambert(0, emission=3),)),),
            motion=Motion.turn((1, 1, 0), 80),
        ),
        Node(parent_from_node=transform.frame_from_gaze((1, 3, 1), (-1, -3, -1), (0, 0, 1)), lights=(DiskLight(intensity=6.0),)),
        Node(parent_from_node=transform.translate(-2, 2, 1), lights=(SphereLight(intensity=9.0, radius=0.2),)),
        Node(parent_from_node=transform.translate(0, 1, 4), lights=(RectangleLight(visible=False),)),
        camera=PerspectiveCamera.look_at((0.2, 1.6, 3.6), (0, 0.6, 0), aperture_radius=0.03, blades=5, motion=Motion.shift((0.05, 0, 0))),
        background=(0.1, 0.2, 0.3),
    ).replace(fog=Fog(density=0.02))  # fmt: skip


DISTRIBUTED = {"glossy": True, "emitters": True, "shutter": (0.0, 1.0), "max_depth": 4}


def digest(renderer: str, scene: Scene, **options: Any) -> str:
    image = render(scene, **{"width": 24, "height": 16, "renderer": renderer, "samples": 1, "aovs": CHANNELS, "threads": 1, **options})
    found = hashlib.blake2b(digest_size=16)
    for array in (image.pixels, *(image.aov[name] for name in CHANNELS)):
        found.update((array + array.dtype.type(0)).tobytes())  # -0 and 0 are one number
    assert np.isfinite(image.pixels).all()
    return found.hexdigest()


def signatures() -> dict[str, list[str]]:
    """For every kernel that was compiled in this process, the types of arguments it was compiled for."""
    from numba.core.dispatcher import Dispatcher

    found = {}
    for name, module in sorted(sys.modules.items()):
        if name.startswith("limner."):
            for value in vars(module).values():
                if isinstance(value, Dispatcher) and value.signatures:
                    python = value.py_func
                    found[f"{python.__module__}.{python.__qualname__}"] = [str(signature) for signature in value.signatures]
    return found


if __name__ == "__main__":
    answer: dict[str, object] = {"mode": MODE}
    if "--warm-up" in sys.argv:
        started = time.perf_counter()
        warm_up()
        answer |= {"seconds": time.perf_counter() - started, "signatures": signatures()}
    answer["pictures"] = {renderer: digest(renderer, small_scene()) for renderer in ("raster", "ray")}
    answer["pictures"] |= {"exact": digest("ray", exact_scene())}
    for renderer, sampler in (("ray", "multijittered"), ("ray", "halton"), ("path", "jittered")):
        small = digest(renderer, distributed_scene(), width=12, height=8, sampler=sampler, **DISTRIBUTED)
        answer["pictures"] |= {f"distributed {renderer} {sampler}": small}
    print(json.dumps(answer))  # noqa: T201 - this is its answer
