"""What the story of a pixel tells: spaces, the depth test, the tree of rays, blockers, MIS weights."""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from staging import SLOW_AS_PYTHON, checkers, flat_picture, lit_from, place, scene_of, two_triangles

from limner.errors import SceneError, UnsupportedError
from limner.explain.explain import Explanation, explain
from limner.explain.story import Step
from limner.scene.light import SphereLight
from limner.scene.material import BlinnPhong, Dielectric, Lambert
from limner.scene.node import Node
from limner.scene.scene import Scene
from limner.scene.shape import Sphere

SQUARE = two_triangles((-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0))


def _layers() -> Scene:
    """Two squares, the farther one drawn last, textured the nearer one."""
    textured = two_triangles((-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0))
    uvs = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=np.float32)
    near = type(textured)(textured.positions, textured.triangles, uvs=uvs)
    front = Node("front", shapes=place(near, Lambert(texture=checkers())).shapes)
    back = Node("back", place(SQUARE, at=(0, 0, -1)).parent_from_node, shapes=place(SQUARE).shapes)
    return scene_of(front, back, camera=flat_picture(2.0))


def _glass() -> Scene:
    """A glass ball before a mirror, and a ball that hides the lamp."""
    lamp = Node("lamp", place(SQUARE, at=(0, 3, 0)).parent_from_node, lights=(SphereLight(intensity=30.0, radius=0.2),))
    return scene_of(
        Node("ball", shapes=(place(Sphere(0.5), Dielectric(ior=1.5)).shapes)),
        Node("mirror", place(SQUARE, at=(0, 0, -1)).parent_from_node, shapes=place(SQUARE, BlinnPhong(mirror=(0.8, 0.8, 0.8))).shapes),
        Node("lid", place(SQUARE, at=(0, 1.5, -0.5)).parent_from_node, shapes=place(Sphere(0.7), Lambert()).shapes),
        lamp, lit_from((0.3, 1.0, 1.0)),
        camera=flat_picture(2.0),
    )  # fmt: skip


@cache
def _told(renderer: str) -> Explanation:
    scene = _layers() if renderer == "raster" else _glass()
    return explain(scene, 11, 9, width=24, height=18, renderer=renderer, samples=1)


def _steps(told: Explanation, kernel: str) -> list[Step]:
    return [step for step in told.story.walk() if step.kernel.endswith(kernel)]


@SLOW_AS_PYTHON
def test_raster_tells_of_every_space_and_of_who_lost_the_depth_test() -> None:
    """The nearer square's triangle stands in all seven spaces, has weights that sum to 1 there, and the farther one lost to it."""
    told = _told("raster")
    (spaces,) = (step for step in told.story.steps if step.kind == "spaces")
    assert "(world/front)" in spaces.title
    names = [space.title.split()[0] for space in spaces.steps[0].steps]
    assert names == ["object", "world", "camera", "clip", "ndc", "raster", "pixel"]
    object_space, clip = spaces.steps[1].steps[0].result, spaces.steps[1].steps[3].result
    assert object_space in [[float(x) for x in corner] for corner in SQUARE.positions]
    assert clip[3] == pytest.approx(1.0)  # the square's depth
    (weights,) = {json.dumps(step.result) for step in _steps(told, "barycentrics_at")}
    assert sum(json.loads(weights)[name] for name in ("b0", "b1", "b2")) == pytest.approx(1.0, abs=1e-6)
    (screen,) = (step for step in spaces.steps if step.kind == "screen")
    raster = [vertex.steps[5].result[:2] for vertex in spaces.steps[:3]]
    assert np.abs(np.sort(np.array(screen.result), axis=0) - np.sort(np.array(raster), axis=0)).max() <= 0.5 / 256 + 1e-4
    contest = [step for step in told.story.walk() if step.kind == "triangle"]
    assert any("lost to triangle" in outcome.title for step in contest for outcome in step.steps)
    (seen,) = (step for step in told.story.walk() if step.title == "seen in the end")
    assert all("(world/front)" in name for name in seen.result)


@SLOW_AS_PYTHON
def test_raster_tells_of_texels_with_their_weights_and_of_each_term() -> None:
    """Four texels and their weights give the texture's colour; the sum of light ends in what the fragment returns."""
    told = _told("raster")
    assert _steps(told, "texture.sample_texture") or _steps(told, "texture.sample_place")
    assert len(_steps(told, "texture._texel")) >= 4
    assert _steps(told, "lambert.eval_lambert")
    sums = [step for step in told.story.walk() if step.kind == "change" and step.title == "radiance"]
    (shaded,) = _steps(told, "fragment._shade")
    assert sums[-1].result == shaded.result[0]
    assert told.pixel[:3].tolist() == np.array(shaded.result[0], dtype=np.float32).tolist()


@SLOW_AS_PYTHON
def test_ray_tells_of_the_tree_of_rays_with_fresnels_share() -> None:
    """Below the ray that meets the glass stand the reflected and the refracted one; their shares sum to 1; a total is the sample."""
    told = _told("ray")
    rays = [step for step in told.story.walk() if step.kind == "ray"]
    assert "(world/ball)" in rays[0].title
    assert len([step for step in rays[0].steps if step.kind == "ray"]) == 2
    met = _steps(told, "dielectric.meet_interface")[0].result
    assert met["reflectance"] + met["transmittance"] == pytest.approx(1.0, abs=1e-6)
    totals = [step for step in told.story.walk() if step.kind == "change" and step.title == "total" and "was" in step.terms]
    traced = next(step for step in told.story.walk() if step.kernel == "raytrace.whitted.radiance")
    assert traced.result[0] in [step.result for step in totals]
    assert np.array(traced.result[0], dtype=np.float32).tobytes() == told.contributions[0][:3].tobytes()


@SLOW_AS_PYTHON
def test_path_tells_of_vertices_throughput_and_weights() -> None:
    """A path's rays stand one below the other; throughput only falls here; MIS weights are the balance of their two densities."""
    told = explain(_glass(), 11, 2, width=24, height=18, renderer="path", samples=8, sample="all")
    assert told.told == tuple(range(8))
    assert told.is_exact
    balance = _steps(told, "balance")
    assert balance
    for step in balance:
        a, b = (np.float32(step.terms[name]) for name in ("a", "b"))
        assert np.float32(step.result) == (a / (a + b) if a + b > 0 else np.float32(0.0))
    throughput = [step.result for step in told.story.walk() if step.kind == "change" and step.title == "throughput"]
    assert throughput[0] == [1.0, 1.0, 1.0]
    assert _steps(told, "sample.sample_bsdf")
    assert "pdf" in _steps(told, "sample.sample_bsdf")[0].result


@SLOW_AS_PYTHON
def test_every_step_of_a_kernel_names_a_source() -> None:
    """FoCG, a paper or a standard; and no line of text is empty."""
    for renderer in ("raster", "ray"):
        for step in _told(renderer).story.walk():
            assert step.title
            assert step.source or step.kind in ("note", "sample", "vertex"), step


@SLOW_AS_PYTHON
def test_a_page_is_whole_and_holds_pictures(tmp_path: Path) -> None:
    """Rays, a picture with the pixel marked, a lobe; every tag is closed; nothing comes from elsewhere."""
    told = _told("ray")
    told.save(tmp_path / "pixel.html")
    page = (tmp_path / "pixel.html").read_text(encoding="utf-8")
    assert page == told.html()
    for tag in ("details", "summary", "figure", "svg", "div"):
        assert page.count(f"<{tag}") == page.count(f"</{tag}>")
    assert page.count("<line") >= 3
    assert "data:image/png;base64," in page
    assert 'name="viewport"' in page
    assert sorted(path.name for path in tmp_path.iterdir()) == ["pixel.html"]


@SLOW_AS_PYTHON
def test_json_holds_the_bits() -> None:
    """The sum of the contributions over the number of samples is the pixel, where nothing is transparent."""
    told = json.loads(_told("ray").json())
    assert np.array(told["pixel"], dtype=np.float32).tobytes() == _told("ray").pixel.tobytes()
    assert len(told["contributions"]) == told["samples"] == 1
    assert told["story"]["title"].startswith("pixel (11, 9) by ray")


@SLOW_AS_PYTHON
def test_a_pixel_that_nothing_touches_is_told_of() -> None:
    """Bug: where no triangle lies near a pixel the rasteriser is never called, and there was nothing to tell. Fix: it is said."""
    told = explain(Scene(Node("empty")), 4, 3, width=9, height=6)
    assert told.pixel.tolist() == [0.0, 0.0, 0.0, 0.0]
    assert told.is_exact
    assert "nothing touches" in told.text()
    assert told.html().startswith("<!doctype html>")


@SLOW_AS_PYTHON
def test_what_is_not_there_is_refused() -> None:
    """A pixel beyond the picture, a sample beyond the last, a file of another kind."""
    with pytest.raises(SceneError, match=r"x must be an integer from 0 to 23 in a picture of 24 x 18, got 24"):
        explain("cornell", 24, 0, width=24, height=18)
    with pytest.raises(SceneError, match=r'sample must be "all" or an integer from 0 to 1, got 2'):
        explain("cornell", 2, 2, width=24, height=18, samples=2, renderer="ray", sample=2)
    with pytest.raises(UnsupportedError, match=r"saved as \.txt, \.json, \.html, got 'pixel\.pdf'"):
        _told("ray").save("pixel.pdf")
