"""Styles of lines, and pages made of lines in them."""

from __future__ import annotations

import numpy as np
import pytest

from limner.artistic.lines import Drawing, FeatureLine, LineKind
from limner.artistic.plate import page_of
from limner.artistic.style import STYLES, LineLook, LineStyle, line_style
from limner.draw.page import Patch, Trace, page_image
from limner.errors import SceneError, UnsupportedError
from limner.scene.camera import OrthographicCamera, PerspectiveCamera


def line(points: object, kind: LineKind = "crease", hidden_by: int = 0, depth: tuple[float, float] = (1.0, 1.0)) -> FeatureLine:
    made = np.array(points, dtype=np.float64)
    ends = np.linspace(depth[0], depth[1], len(made))
    return FeatureLine(kind, made, ends, np.zeros((len(made), 3)), hidden_by, 0, bool((made[0] == made[-1]).all()))


def drawing(*lines: FeatureLine, pixels_per_metre: float | None = 100.0) -> Drawing:
    camera = PerspectiveCamera() if pixels_per_metre is None else OrthographicCamera(height=0.6)
    return Drawing(lines, 80, 60, camera, pixels_per_metre, ("part",))


SQUARE = line([(10, 10), (70, 10), (70, 50), (10, 50), (10, 10)], "silhouette")
ACROSS = line([(10, 30), (70, 30)], "crease", 1)
DEEPER = line([(10, 20), (70, 20)], "crease", 2)


def test_classes_have_layers_and_looks() -> None:
    """Hidden lines lie below those that are seen; widths and dashes are the style's, in millimetres."""
    page = page_of(drawing(SQUARE, ACROSS, DEEPER), "technical", scale=0.5)
    assert [layer.name for layer in page.layers] == ["hidden-crease", "visible-silhouette"]
    assert [layer.classes for layer in page.layers] == [("hidden", "crease"), ("visible", "silhouette")]
    (outline,), hidden = page.layers[1].marks, page.layers[0].marks
    assert isinstance(outline, Trace)
    assert (outline.closed, len(outline.points), outline.pen.width) == (True, 4, 0.5)
    assert [mark.pen.dashes for mark in hidden if isinstance(mark, Trace)] == [(1.5, 0.375), (3.0, 0.75)]


def test_lengths_are_those_of_the_part() -> None:
    """At 1:2 a part of 0.6 m that is 60 pixels wide measures 300 mm on paper, and what is in pixels has its pixels."""
    page = page_of(drawing(SQUARE), "technical", scale=0.5)
    assert (page.unit, page.width, page.height) == ("mm", 400.0, 300.0)
    (mark,) = page.layers[0].marks
    assert np.isclose(np.ptp(mark.points[:, 0]), 300.0)  # type: ignore[union-attr]
    inches = page_of(drawing(SQUARE), "technical", scale=2.0, unit_mm=25.4)
    assert np.isclose(np.ptp(inches.layers[0].marks[0].points[:, 0]), 0.6 * 25.4 * 2.0)  # type: ignore[union-attr]
    plain = page_of(drawing(SQUARE, pixels_per_metre=None))
    assert (plain.unit, plain.width) == ("px", 80.0)
    assert (page_image(plain).pixels[9:11, 30, 0] < 0.2).all()  # the line at y = 10, in the rows 9 and 10


def test_far_lines_are_thinner_and_fainter() -> None:
    """In steps along one line; the near end as the style says; opaque, so that no joint is seen."""
    page = page_of(drawing(line([(0, 30), (80, 30)], depth=(1.0, 3.0))), LineStyle(LineLook(2.0), depth_cue=1.0))
    marks = [mark for mark in page.layers[0].marks if isinstance(mark, Trace)]
    widths = [mark.pen.width for mark in marks]
    assert widths[0] == 2.0
    assert (np.diff(widths) < 0.0).all()
    assert (np.diff([mark.color[0] for mark in marks]) > 0.0).all()
    assert {mark.color[3] for mark in marks} == {1.0}


def test_a_hand_draws_areas_the_same_every_time() -> None:
    """Tapered strokes are outlines; the same drawing is the same to the bit, and another seed is another hand."""
    one, two = (page_of(drawing(SQUARE, ACROSS), "sketch").layers for _ in range(2))
    assert all(isinstance(mark, Patch) for layer in one for mark in layer.marks)
    for a, b in zip(one[0].marks, two[0].marks, strict=True):
        assert (a.rings[0] == b.rings[0]).all()  # type: ignore[union-attr]
    other = page_of(drawing(SQUARE), STYLES["sketch"].replace(seed=5)).layers
    assert other[0].marks[0].rings[0].tolist() != one[0].marks[0].rings[0].tolist()  # type: ignore[union-attr]


def test_nothing_to_draw() -> None:
    """No lines, or none that the style shows: an empty page."""
    assert page_of(drawing()).layers == ()
    assert page_of(drawing(ACROSS), "plain").layers == ()
    assert not line_style("plain").shows_hidden
    assert line_style("technical").shows_hidden


def test_slips() -> None:
    """One line each."""
    with pytest.raises(UnsupportedError, match="plain, technical"):
        line_style("pretty")
    with pytest.raises(UnsupportedError, match="perspective has no scale"):
        page_of(drawing(SQUARE, pixels_per_metre=None), "technical", scale=1.0)
    with pytest.raises(SceneError, match="scale must be positive"):
        page_of(drawing(SQUARE), "technical", scale=-1.0)
    with pytest.raises(UnsupportedError, match="kind of line"):
        LineStyle(visible_kinds={"edge": None})
    with pytest.raises(SceneError, match="width must be positive"):
        LineLook(0.0)
    with pytest.raises(SceneError, match="taper"):
        LineStyle(taper=2.0)
    with pytest.raises(SceneError, match="dashes"):
        LineLook(1.0, dashes=(0.0, 0.0))
