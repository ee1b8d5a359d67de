"""limner in the raster benchmark: its main way, and others beside it."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

from raster_job import AMBIENT, BACKGROUND, COLOR, DIFFUSE, N_VIEWS, UP, YFOV_DEGREES, Drawing, Job, Model, Pixels
from raster_views import light_frame


def limner_matte(job: Job, model: Model) -> Drawing:
    """Matte, straight to uint8."""
    renderer, cameras = _limner_renderer(job, model)
    return Drawing(lambda view: renderer.render(cameras(view), output="uint8"), job.samples)


def limner_4(job: Job, model: Model) -> Drawing:
    return limner_matte(replace(job, samples=min(4, job.samples)), model)


def limner_gltf(job: Job, model: Model) -> Drawing:
    """The material that a glTF file has, with its highlight: what f3d and pyrender always compute."""
    renderer, cameras = _limner_renderer(job, model, metallic_roughness=True)
    return Drawing(lambda view: renderer.render(cameras(view), output="uint8"), job.samples)


def limner_image(job: Job, model: Model) -> Drawing:
    """An Image of float32, as `limner.render` returns it."""
    renderer, cameras = _limner_renderer(job, model)
    return Drawing(lambda view: renderer.render(cameras(view)).pixels, job.samples, linear=True)


def limner_still(job: Job, model: Model) -> Drawing:
    """The same camera again and again."""
    renderer, cameras = _limner_renderer(job, model)
    still = cameras(0)
    return Drawing(lambda view: renderer.render(still, output="uint8"), job.samples)


def limner_pose(job: Job, model: Model) -> Drawing:
    """The model turns before a camera that stands still: another scene for each picture."""
    from dataclasses import replace as changed

    from limner.linear import transform

    renderer, cameras = _limner_renderer(job, model)
    scene, still = renderer.scene, cameras(0)
    posed, *rest = scene.root.children

    def draw(view: int) -> Pixels:
        turn = transform.rotate_about(job.target, UP, -2.0 * math.pi * view / N_VIEWS)
        children = (changed(posed, parent_from_node=turn), *rest)
        renderer.scene = scene.replace(root=changed(scene.root, children=children))
        return renderer.render(still, output="uint8")

    return Drawing(draw, job.samples)


def _limner_renderer(job: Job, model: Model, *, metallic_roughness: bool = False) -> tuple[Any, Callable[[int], Any]]:
    """A Renderer, and what makes its camera of a view's number."""
    import limner
    from limner.scene.light import AmbientLight, DirectionalLight
    from limner.scene.material import Lambert, Material, MetallicRoughness
    from limner.scene.node import Node
    from limner.scene.shape import Shape
    from limner.scene.texture import Texels, Texture

    texture = Texture(Texels(model.texels)) if model.texels.size else None
    color = (1.0, 1.0, 1.0) if texture else COLOR
    material: Material = Lambert(color, texture, double_sided=False)
    if metallic_roughness:
        material = MetallicRoughness(color, metallic=0.0, roughness=1.0, base_color_texture=texture)
    mesh = limner.Mesh(model.positions, model.triangles, normals=model.normals, uvs=model.uvs if texture else None)
    sun = Node("sun", light_frame(), lights=(DirectionalLight(intensity=math.pi * DIFFUSE),))
    sky = Node("sky", lights=(AmbientLight(intensity=AMBIENT),))
    scene = limner.Scene(Node(children=(Node("model", shapes=(Shape(mesh, (material,)),)), sun, sky)), background=BACKGROUND)
    renderer = limner.Renderer(scene, width=job.width, height=job.height, samples=job.samples, threads=job.threads)

    def camera(view: int) -> Any:
        return limner.Camera.look_at(job.eyes[view], job.target, UP, yfov_degrees=YFOV_DEGREES, near=job.near, far=job.far)

    return renderer, camera
