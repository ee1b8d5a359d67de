"""Many pictures of one scene: what a Renderer keeps, and that keeping changes nothing."""

from __future__ import annotations

import pickle
import threading
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from limner.errors import UnsupportedError
from limner.linear import transform
from limner.mesh.shapes import primitives
from limner.render import Renderer, render
from limner.scene.camera import OrthographicCamera, PerspectiveCamera
from limner.scene.light import DirectionalLight
from limner.scene.material import BlinnPhong, Lambert
from limner.scene.node import Node
from limner.scene.scene import Scene
from limner.scene.shape import Box, Plane, Shape, Sphere
from limner.scene.texture import Texels, Texture
from limner.tables.build import flatten

RENDERERS = ("raster", "ray", "path")
SIZE = {"width": 24, "height": 16, "samples": 2}


def still_life(turn: float = 0.3) -> Scene:
    checks = Texels.from_top_down(np.kron([[0, 255], [255, 0]], np.ones((4, 4))).astype(np.uint8), name="checks")
    shiny = BlinnPhong((0.7, 0.2, 0.1), (0.5, 0.5, 0.5), 40.0, mirror=(0.2, 0.2, 0.2))
    return Scene(
        Node(
            "world",
            children=(
                Node("floor", shapes=(Shape(Plane(), (Lambert(texture=Texture(checks)),)),)),
                Node("ball", transform.translate(0, 1, 0), shapes=(Shape(Sphere(1.0), (shiny,)),)),
                Node("box", transform.translate(1.5, 0.5, 1) @ transform.rotate_y(turn), shapes=(Shape(Box((1, 1, 1))),)),
                Node("mesh", transform.translate(-1.5, 0.5, 1), shapes=(Shape(primitives.sphere(0.5, 8)),)),
                Node("sun", transform.rotate_x(-0.9), lights=(DirectionalLight(intensity=3.0),)),
            ),
        ),
        camera=PerspectiveCamera.look_at((2, 2, 6), (0, 0.6, 0)),
    )


CAMERAS = (
    None,
    PerspectiveCamera.look_at((-3, 1, 4), (0, 0.5, 0), yfov_degrees=50.0),
    OrthographicCamera.look_at((0, 5, 5), (0, 0, 0), height=6.0),
)


@pytest.mark.parametrize("name", RENDERERS)
def test_every_picture_is_the_one_that_render_makes(name):
    """Camera after camera, then another scene: kept tables and trees never show."""
    with Renderer(still_life(), renderer=name, **SIZE) as renderer:
        for camera in (*CAMERAS, CAMERAS[0]):
            expected = render(still_life(), renderer=name, camera=camera, **SIZE)
            assert np.array_equal(renderer.render(camera).pixels, expected.pixels)
        renderer.scene = still_life(turn=1.1)
        assert np.array_equal(renderer.render().pixels, render(still_life(turn=1.1), renderer=name, **SIZE).pixels)


def test_what_did_not_change_is_not_built_again():
    """The same meshes and textures are the same arrays; a moved node changes the instances alone."""
    scene = still_life()
    first = flatten(scene, scene.camera, 24, 16, tessellate=False)
    again = flatten(scene.replace(background=(0, 0, 0)), CAMERAS[1], 24, 16, first, tessellate=False)
    assert again.tables.positions is first.tables.positions
    assert again.tables.texels is first.tables.texels
    moved = scene.replace(root=Node("moved", transform.translate(1, 0, 0), children=(scene.root,)))
    other = flatten(moved, scene.camera, 24, 16, first, tessellate=False)
    assert other.tables.positions is first.tables.positions
    assert not np.array_equal(other.tables.instances, first.tables.instances)


@pytest.mark.parametrize("name", RENDERERS)
def test_bytes_are_those_of_the_image(name):
    """output="uint8" is the same picture, encoded at once."""
    with Renderer(still_life(), renderer=name, **SIZE) as renderer:
        assert np.array_equal(renderer.render(output="uint8"), renderer.render().to_uint8())
        with pytest.raises(UnsupportedError, match="output"):
            renderer.render(output="jpeg")


@pytest.mark.parametrize("name", RENDERERS)
def test_refine_yields_what_render_makes(name):
    """From rough to fine, and the last to the bit; leaving early is fine."""
    with Renderer(still_life(), renderer=name, width=16, height=12, samples=5, antialiasing="supersample") as renderer:
        steps = list(renderer.refine())
        assert [step.recipe["samples"] for step in steps] == [1, 2, 4, 5]
        assert np.array_equal(steps[-1].pixels, renderer.render().pixels)
        assert next(renderer.refine()).recipe["samples"] == 1


def test_multisamples_are_refined_in_whole_groups():
    """Eight at a time, so that the last picture is the one that `render` makes."""
    with Renderer(still_life(), width=16, height=12, samples=20) as renderer:
        steps = list(renderer.refine())
        assert [step.recipe["samples"] for step in steps] == [8, 16, 20]
        assert np.array_equal(steps[-1].pixels, renderer.render().pixels)


def test_multisampling_keeps_edges_and_agrees_inside():
    """Coverage is exactly that of supersampling; where a pixel sees one even surface, so is the colour, nearly."""
    scene = still_life().replace(camera=PerspectiveCamera.look_at((0, 1, 8), (0, 1, 0), yfov_degrees=30.0))
    full = render(scene, width=48, height=32, samples=8, antialiasing="supersample")
    fast = render(scene, width=48, height=32, samples=8)
    assert np.array_equal(full.pixels[..., 3], fast.pixels[..., 3])
    assert np.median(np.abs(full.pixels - fast.pixels)) < 1e-3
    with pytest.raises(UnsupportedError, match="antialiasing"):
        render(scene, antialiasing="fxaa")


@pytest.mark.parametrize("thing", ["scene", "image", "tables", "renderer"])
def test_pickles(thing):
    """What is described, flattened, drawn, or draws can go to another process and means the same there."""
    scene = still_life()
    renderer = Renderer(scene, **SIZE)
    image = renderer.render()
    if thing == "scene":
        assert np.array_equal(render(pickle.loads(pickle.dumps(scene)), **SIZE).pixels, image.pixels)
    elif thing == "image":
        assert np.array_equal(pickle.loads(pickle.dumps(image)).pixels, image.pixels)
    elif thing == "tables":
        tables = flatten(scene, scene.camera, 24, 16).tables
        for one, other in zip(pickle.loads(pickle.dumps(tables)), tables, strict=True):
            assert one.tobytes() == other.tobytes()
    else:
        assert np.array_equal(pickle.loads(pickle.dumps(renderer)).render().pixels, image.pixels)


def test_two_renderers_in_two_threads():
    """Side by side they make the pictures that they make alone."""
    scenes = [still_life(turn) for turn in (0.1, 0.7)]
    alone = [[render(scene, renderer=name, **SIZE).pixels for name in RENDERERS] for scene in scenes]

    def all_pictures(scene: Scene) -> list[np.ndarray]:
        return [Renderer(scene, renderer=name, **SIZE).render().pixels for name in RENDERERS]

    with ThreadPoolExecutor(2) as pool:
        together = list(pool.map(all_pictures, scenes))
    for one, other in zip(alone, together, strict=True):
        assert all(np.array_equal(a, b) for a, b in zip(one, other, strict=True))


def test_a_cancelled_picture_is_sound():
    """What is finished has its final bits, the rest is empty, and the picture says so."""

    class AfterTwentyTiles(threading.Event):
        asked = 0

        def is_set(self) -> bool:
            self.asked += 1
            return self.asked > 20

    with Renderer(still_life(), renderer="ray", width=48, height=48, samples=2, tile_size=8, threads=1) as renderer:
        whole = renderer.render()
        part = renderer.render(cancel=AfterTwentyTiles())
    assert whole.finished
    assert not part.finished
    done = part.pixels[..., 3] > 0.0
    assert done.any()
    assert np.array_equal(part.pixels[done], whole.pixels[done])
