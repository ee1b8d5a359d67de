"""Drawings and technical sheets from scenes: true to scale, in line, the same bytes; areas hide what they should."""

from __future__ import annotations

import threading
from pathlib import Path

import numpy as np
import pytest
from staging import place, scene_of

from limner.artistic.lines import Drawing
from limner.artistic.plate import Placing
from limner.draw.page import Caption, Page, Patch, Trace, page_image
from limner.errors import RenderError, SceneError, UnsupportedError
from limner.produce.draw_sheet import technical_sheet
from limner.produce.drawing import Plate, check_plate, drawing
from limner.produce.shade import shade_layers
from limner.render import render
from limner.scene.camera import OrthographicCamera, PerspectiveCamera
from limner.scene.material import MetallicRoughness
from limner.scene.node import Node
from limner.scene.scene import Scene
from limner.scene.shape import Box

PART = Scene(root=Node(children=(place(Box((4.0, 1.0, 2.0))), place(Box((1.0, 3.0, 1.0)), at=(-1.5, 1.0, 0.5)))))
"""4 x 3 x 2, from y = -0.5 to 2.5: a plate with a post."""


def extent(plate: Plate, area: tuple[float, float, float, float]) -> np.ndarray:
    """Size of what the lines cover within a part of the page, x, y, width, height."""
    points = [
        mark.points for layer in plate.page.layers if layer.name.startswith(("visible", "hidden")) for mark in layer.marks
        if isinstance(mark, Trace)
    ]  # fmt: skip
    x, y, width, height = area
    every = np.concatenate(points)
    inside = every[((every > (x, y)) & (every < (x + width, y + height))).all(axis=1)]
    return np.ptp(inside, axis=0)


def test_views_measure_the_part() -> None:
    """In millimetres at the scale that the sheet states, each view the two sides it shows; dimensions say the true lengths."""
    sheet = technical_sheet(PART, views=("front", "top", "right"), unit="cm", dimensions=True, title="plate", date="2020-01-01")
    assert (sheet.facts["scale"], sheet.facts["size"]) == ("5:1", [40.0, 30.0, 20.0]) or sheet.facts["scale"] == "2:1"
    scale = 5.0 if sheet.facts["scale"] == "5:1" else 2.0
    words = {mark.words for layer in sheet.page.layers for mark in layer.marks if isinstance(mark, Caption)}
    assert {"40", "30", "20", "plate", "2020-01-01", "A3", "first angle", sheet.facts["scale"], "front"} <= words
    for name, (across, down) in {"front": (40.0, 30.0), "top": (40.0, 20.0), "right": (20.0, 30.0)}.items():
        label = next(m for layer in sheet.page.layers for m in layer.marks if isinstance(m, Caption) and m.words == name)
        found = extent(sheet, (label.x - 1.0, label.y + 1.0, scale * across + 2.0, scale * down + 4.0))
        assert np.allclose(found, (scale * across, scale * down), atol=1e-6)


def test_a_sheet_is_the_same_bytes_and_has_its_layers() -> None:
    """Made twice: the same SVG, PDF and DXF. Hidden lines are dashed, on a layer of their own."""
    one, two = (technical_sheet(PART, views=("front", "iso"), paper="A4", projection="third") for _ in range(2))
    assert (one.svg(), one.pdf(), one.dxf()) == (two.svg(), two.pdf(), two.dxf())
    names = [layer.name for layer in one.page.layers]
    assert names[-2:] == ["notes", "border"]
    assert any(name.startswith("hidden-") for name in names)
    assert all(
        mark.pen.dashes for layer in one.page.layers if layer.name.startswith("hidden-") for mark in layer.marks if isinstance(mark, Trace)
    )


def test_sheets_of_any_size() -> None:
    """From a millionth to a million metres: a standard scale, and the same lines on paper."""
    for size in (1e-6, 1.0, 1e6):
        scene = Scene(root=Node(children=(place(Box((4.0 * size, 1.0 * size, 2.0 * size))),)))
        sheet = technical_sheet(scene, views=("front",))
        visible = [layer for layer in sheet.page.layers if layer.name.startswith("visible")]
        points = np.concatenate([mark.points for layer in visible for mark in layer.marks if isinstance(mark, Trace)])
        across, down = np.ptp(points, axis=0).tolist()
        assert np.isclose(across / down, 4.0)
        assert 100.0 < across < 390.0


def test_a_drawing_is_saved_as_what_its_name_says(tmp_path: Path) -> None:
    """Each format begins as it must; a picture has the drawing's pixels; nothing is left beside them."""
    plate = drawing(PART, width=64, height=48)
    for name, start in {"a.svg": b"<svg", "a.pdf": b"%PDF", "a.dxf": b"  0", "a.png": b"\x89PNG"}.items():
        plate.save(tmp_path / name)
        assert (tmp_path / name).read_bytes().startswith(start)
    assert plate.image().pixels.shape == (48, 64, 4)
    assert (render(PART, renderer="lines", width=64, height=48).pixels == plate.image().pixels).all()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.dxf", "a.pdf", "a.png", "a.svg"]


def test_a_drawing_to_scale() -> None:
    """By a parallel camera, at 1:100 of metres: a part of 4 m is 40 mm wide."""
    camera = OrthographicCamera.look_at((0, 1, 9), (0, 1, 0), height=6.0)
    page = drawing(PART, camera=camera, style="technical", scale=0.01, width=80, height=60).page
    points = np.concatenate([mark.points for layer in page.layers for mark in layer.marks if isinstance(mark, Trace)])
    assert (page.unit, page.width, page.height) == ("mm", 80.0, 60.0)
    assert np.allclose(np.ptp(points, axis=0), (40.0, 30.0))


@pytest.mark.parametrize("crossed", [False, True])
def test_areas_show_what_raster_shows(crossed: bool) -> None:
    """Each pixel away from edges has the area's colour of the shape that raster sees there; boxes one behind the other, and crossed."""
    red, blue = (MetallicRoughness(base_color=c, unlit=True) for c in ((1.0, 0.0, 0.0), (0.0, 0.0, 1.0)))
    far = (0.0, 0.2, 0.0) if crossed else (0.5, 0.2, -3.0)
    scene = scene_of(place(Box((2.0, 1.0, 1.0)), red), place(Box((1.0, 2.0, 0.6)), blue, at=far))
    camera = PerspectiveCamera.look_at((2.0, 2.0, 5.0), (0, 0, 0), yfov_degrees=35.0)
    plain = Drawing((), 56, 42, camera, None, ())
    (layer,) = shade_layers(scene, plain, Placing(), tone=None, fill=True, color=(0.0, 0.0, 0.0, 1.0))
    assert all(isinstance(mark, (Patch, Trace)) for mark in layer.marks)
    drawn = page_image(Page(56, 42, "px", (layer,))).pixels
    seen = render(scene, camera=camera, width=56, height=42, aovs=("instance_id",)).aov["instance_id"]
    around = np.lib.stride_tricks.sliding_window_view(seen, (3, 3))
    flat = np.ptp(around, axis=(2, 3)) == 0
    inner, ids = drawn[1:-1, 1:-1][flat], seen[1:-1, 1:-1][flat]
    wanted = np.array([(1.0, 0.0, 0.0, 1.0), (0.0, 0.0, 1.0, 1.0), (0.0, 0.0, 0.0, 0.0)])[ids]
    assert (np.bincount(ids + 1, minlength=3) > 15).all()
    assert np.abs(inner - wanted).max() < (0.15 if crossed else 0.02)  # seams are covered by hairlines


def test_slips(tmp_path: Path) -> None:
    """One line each, before anything is drawn."""
    for options, message in (
        ({"views": ("front", "side")}, "a view must be one of"), ({"views": ()}, "views must be names"),
        ({"views": ("front", "front")}, "twice"), ({"unit": "ft"}, "unit must be"), ({"paper": "A9"}, "paper must be"),
        ({"projection": "second"}, "projection must be"), ({"style": "nice"}, "line style"), ({"scale": "9"}, "do not fit"),
    ):  # fmt: skip
        with pytest.raises((SceneError, UnsupportedError), match=message):
            technical_sheet(PART, **options)  # type: ignore[arg-type]
    with pytest.raises(SceneError, match="nothing to draw"):
        technical_sheet(Scene())
    with pytest.raises(UnsupportedError, match="tone must be"):
        drawing(PART, tone="dark")
    with pytest.raises(UnsupportedError, match=r"\.svg, \.pdf, \.dxf"):
        check_plate(tmp_path / "a.doc")
    stop = threading.Event()
    stop.set()
    with pytest.raises(RenderError, match="stopped"):
        drawing(PART, cancel=stop)
