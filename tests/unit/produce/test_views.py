"""Contact sheets and facts: what is drawn stands where the cameras say, what is told is true of the scene."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image as Picture

import limner
from limner.errors import SceneError, UnsupportedError
from limner.linear import transform
from limner.mesh.shapes import primitives
from limner.produce.facts import dominant_colors, facts, guess_up, report_of_pixels, tight_bounds
from limner.produce.sheet import Canvas, Grid, Stroke, grid_for, shortened, text_width, wrapped
from limner.produce.views import ARROW, VIEWS, Sheet, axis_tips, glyph_origin, standard_cameras, views
from limner.scene.library import builtin

SIZE = 160
MARGIN = 1.38
GROUND = (188, 194, 201)


def _scene(*shapes: limner.Shape, **fields: Any) -> limner.Scene:
    return limner.Scene(limner.Node("world", shapes=shapes), **fields)


def _block() -> limner.Scene:
    """2 x 4 x 6 around (10, 0, 0), in a strong green."""
    place = transform.translate(10.0, 0.0, 0.0)
    green = limner.Lambert((0.02, 0.6, 0.05), name="green")
    return limner.Scene(limner.Node("block", place, shapes=(limner.Shape(primitives.box((2.0, 4.0, 6.0)), (green,)),)), name="block")


@pytest.fixture(scope="module")
def sheet() -> Sheet:
    return views(_block(), size=SIZE, samples=4, threads=1)


def _cell(sheet: Sheet, name: str) -> np.ndarray:
    """(size, size, 3) uint8: a view as it stands on the sheet."""
    (view,) = (view for view in sheet.facts["views"] if view["name"] == name)
    x, y, width, height = view["cell"]
    return sheet.image.to_uint8()[y : y + height, x : x + width, :3]


# --- the sheet ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "across", "up"), [("front", 2, 4), ("right", 6, 4), ("back", 2, 4), ("left", 6, 4), ("top", 2, 6), ("bottom", 2, 6)]
)
def test_each_view_covers_what_the_block_covers(sheet: Sheet, name: str, across: float, up: float) -> None:
    """Parallel, at one scale: the largest edge, 6, takes 1 / 1.38 of the side; so coverage and box are known, and centred."""
    (view,) = (view for view in sheet.facts["views"] if view["name"] == name)
    scale = SIZE / (MARGIN * 6.0)
    assert view["coverage"] == pytest.approx(across * up * scale**2 / SIZE**2, rel=0.05)
    left, top, width, height = view["box"]
    np.testing.assert_allclose([width, height], [across * scale, up * scale], atol=2.0)
    np.testing.assert_allclose([left + width / 2, top + height / 2], [SIZE / 2, SIZE / 2], atol=1.0)


def test_the_sheet_is_made_of_its_cells(sheet: Sheet) -> None:
    """Four columns, two rows; the model is green in the middle of each view, the ground is grey in between, and nothing overlaps."""
    assert [view["name"] for view in sheet.facts["views"]] == list(VIEWS)
    grid = Grid(4, 2, SIZE, SIZE, SIZE // 32)
    assert (sheet.image.width, sheet.image.height) == grid.size
    for index, view in enumerate(sheet.facts["views"]):
        assert tuple(view["cell"][:2]) == grid.corner(index)
        cell = _cell(sheet, view["name"]).astype(int)
        middle = cell[SIZE // 2 + 5, SIZE // 2 + 5]
        assert middle[1] > 2 * max(middle[0], middle[2]), view["name"]
        assert tuple(cell[SIZE // 4, 3]) == GROUND
    assert sheet.finished


def test_the_same_scene_makes_the_same_sheet(sheet: Sheet, tmp_path: Any) -> None:
    """To the byte, also through a file."""
    again = views(_block(), size=SIZE, samples=4, threads=2)
    np.testing.assert_array_equal(again.image.to_uint8(), sheet.image.to_uint8())
    assert again.facts == sheet.facts
    sheet.image.save(tmp_path / "sheet.png")
    with Picture.open(tmp_path / "sheet.png") as saved:
        np.testing.assert_array_equal(np.asarray(saved.convert("RGB")), sheet.image.to_uint8()[..., :3])


@pytest.mark.parametrize("projection", ["orthographic", "perspective"])
@pytest.mark.parametrize("name", list(VIEWS))
def test_axes_point_where_the_camera_says(name: str, projection: str) -> None:
    """Two points of the world, one step along an axis apart round the middle of the picture, are seen one beside the other in the
    direction of the arrow; the part that is not in the picture lies along the gaze."""
    corners = np.array([[x, y, z] for x in (-1.0, 1.0) for y in (-2.0, 2.0) for z in (0.0, 3.0)])
    camera = standard_cameras(corners, projection)[name]
    middle = np.array([0.0, 0.0, 1.5])
    for axis, tip in enumerate(axis_tips(camera).values()):
        assert np.linalg.norm(tip) == pytest.approx(1.0)
        step = 1e-4 * np.eye(3)[axis]
        places, depth = camera.project(np.array([middle - step, middle + step]), 100, 100)
        right, down = places[1] - places[0]
        if abs(tip.towards) < 0.999:
            assert np.array([right, -down]) @ [tip.right, tip.up] == pytest.approx(np.hypot(right, down) * np.hypot(tip.right, tip.up))
        assert (depth[0] - depth[1]) == pytest.approx(2e-4 * tip.towards, abs=1e-9)


@pytest.mark.parametrize(
    ("name", "arrows"),
    [("front", {"x": (1, 0), "y": (0, 1)}), ("right", {"z": (-1, 0), "y": (0, 1)}), ("top", {"x": (1, 0), "z": (0, -1)})],
)
def test_arrows_are_drawn_in_their_colours(sheet: Sheet, name: str, arrows: dict[str, tuple[int, int]]) -> None:
    """In the lower left corner of the view: from the origin along the arrow there are pixels of the axis's hue, the other way none."""
    cell = _cell(sheet, name).astype(int)
    at = glyph_origin(SIZE)
    for axis, (right, up) in arrows.items():
        channel = "xyz".index(axis)

        def tinted(sign: int, right: int = right, up: int = up, channel: int = channel) -> bool:
            x, y = np.rint(at + sign * 0.7 * ARROW * SIZE * np.array([right, -up])).astype(int)
            patch = cell[y - 1 : y + 2, x - 1 : x + 2].reshape(-1, 3)
            others = np.delete(patch, channel, axis=1).max(axis=1)
            return bool((patch[:, channel] > others + 25).any())

        assert tinted(1), axis
        assert not tinted(-1), axis


@pytest.mark.parametrize("projection", ["orthographic", "perspective"])
@given(seed=st.integers(0, 1000))
def test_the_box_round_the_model_is_in_every_view(projection: str, seed: int) -> None:
    """All eight corners, with room for measures, for boxes of any proportions anywhere."""
    rng = np.random.default_rng(seed)
    low = rng.uniform(-100.0, 100.0, size=3)
    high = low + 10.0 ** rng.uniform(-3.0, 3.0, size=3)
    corners = np.array([[(low, high)[k >> axis & 1][axis] for axis in range(3)] for k in range(8)])
    for camera in standard_cameras(corners, projection).values():
        places, depth = camera.project(corners, 200, 200)
        assert (depth > 0.0).all()
        assert (np.abs(places - 99.5) < 100.0 / 1.15).all()


def test_names_and_measures_are_legible(sheet: Sheet) -> None:
    """Dark letters stand in the upper left corner of each view, and the panel is written on."""
    for view in sheet.facts["views"]:
        assert _cell(sheet, view["name"])[:18, :40].max(axis=2).min() < 90
    x, y = Grid(4, 2, SIZE, SIZE, SIZE // 32).corner(7)
    panel = sheet.image.to_uint8()[y : y + SIZE, x : x + SIZE, :3]
    dark_rows = (panel.max(axis=2) < 120).any(axis=1)
    assert int(np.diff(dark_rows.astype(int)).clip(0).sum()) >= 6  # lines of text


def test_planes_and_backgrounds_are_left_out() -> None:
    """The teapot without its endless floor: no view is full, the floor is told of, and the bounds are the pot's."""
    made = views(builtin("teapot"), size=128, samples=1)
    assert max(view["coverage"] for view in made.facts["views"]) < 0.6
    assert "infinite planes are left out" in made.facts["notes"]
    assert made.facts["warnings"] == []
    assert made.facts["shapes_by_kind"] == {"Plane": 1, "Mesh": 1}


# --- what is wrong with a picture -----------------------------------------------------------------------------------------


def test_nothing_to_see_is_told() -> None:
    """An empty scene makes a sheet, and says that it is blank."""
    made = views(limner.Scene(), size=128, samples=1)
    assert made.facts["blank"]
    assert made.facts["bounds"] is None
    assert made.facts["colors"] == []
    assert "the model cannot be seen in any view" in made.facts["warnings"]
    assert "there is nothing to see: no shape is visible" in made.facts["warnings"]


def test_a_model_that_shows_its_back_is_told_of() -> None:
    """A one-sided sheet that faces +z: nothing from the back, left, right, top and bottom; the rest is fine."""
    corners = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], dtype=float)
    one_sided = limner.MetallicRoughness(metallic=0.0, double_sided=False)
    made = views(_scene(limner.Shape(primitives.quad(corners), (one_sided,))), size=128, samples=1)
    seen = {view["name"] for view in made.facts["views"] if view["coverage"] > 0.01}
    assert seen == {"front", "corner"}
    assert not made.facts["blank"]
    assert any("nothing is seen from the right, back, left, top, bottom" in warning for warning in made.facts["warnings"])


def test_the_back_is_as_bright_as_the_front_unless_own_lights_are_asked_for() -> None:
    """A lamp in front of a ball: with it, the back is black and the median brightness of the front much greater."""
    lamp = limner.Node("lamp", lights=(limner.DirectionalLight(intensity=3.0),))  # along -z: from +z
    scene = limner.Scene(limner.Node(shapes=(limner.Shape(limner.Sphere()),), children=(lamp,)))

    def brightness(**options: Any) -> dict[str, float]:
        made = views(scene, size=128, samples=1, **options)
        return {view["name"]: view["brightness"] for view in made.facts["views"]}

    usual, own = brightness(), brightness(own_lights=True)
    assert usual["back"] == pytest.approx(usual["front"], rel=0.05)
    assert own["back"] == 0.0
    assert own["front"] > 0.3


def test_black_and_burnt_out_models_are_told_of() -> None:
    """Under a lamp of no strength, and under one far too strong."""
    for intensity, message in ((0.0, "almost black in all views"), (500.0, "burnt out in front")):
        lamp = limner.Node("lamp", lights=(limner.AmbientLight(intensity=intensity),))
        scene = limner.Scene(limner.Node(shapes=(limner.Shape(limner.Sphere()),), children=(lamp,)))
        made = views(scene, size=128, samples=1, own_lights=True)
        assert any(message in warning for warning in made.facts["warnings"]), intensity


@pytest.mark.parametrize(
    ("change", "message"),
    [({"size": 100}, "size must be an integer from 128 to 2048"), ({"projection": "fisheye"}, "projection must be one of")],
)
def test_slips_are_told(change: dict[str, Any], message: str) -> None:
    with pytest.raises((SceneError, UnsupportedError), match=message):
        views(_block(), **change)


# --- facts ----------------------------------------------------------------------------------------------------------------


def test_facts_are_those_of_the_scene() -> None:
    """Counts, bounds, materials and textures of a scene that is known; JSON can hold them."""
    texels = limner.Texels.from_top_down(np.zeros((4, 8, 4), dtype=np.uint8), name="grid")
    paint = limner.MetallicRoughness(base_color=(1.0, 0.0, 0.0), base_color_texture=limner.Texture(texels), name="paint")
    box = primitives.box((2.0, 4.0, 6.0))
    children = (
        limner.Node("one", shapes=(limner.Shape(box, (paint,)),)),
        limner.Node("two", transform.translate(10.0, 0.0, 0.0), shapes=(limner.Shape(box, (paint,)),)),
        limner.Node("gone", visible=False, shapes=(limner.Shape(primitives.sphere()),)),
        limner.Node("lamp", lights=(limner.PointLight(name="bulb"),)),
    )
    told = facts(limner.Scene(limner.Node("world", children=children), name="pair", notes=("a note",)))
    assert json.loads(json.dumps(told, allow_nan=False)) == told
    assert told["bounds"] == [[-1.0, -2.0, -3.0], [11.0, 2.0, 3.0]]
    assert (told["size"], told["center"]) == ([12.0, 4.0, 6.0], [5.0, 0.0, 0.0])
    assert (told["nodes"], told["hidden_nodes"], told["shapes"], told["meshes"]) == (5, 1, 2, 1)
    assert (told["triangles"], told["drawn_triangles"]) == (len(box.triangles), 2 * len(box.triangles))
    assert told["materials"] == [
        {
            "name": "paint",
            "kind": "MetallicRoughness",
            "color": "#ff0000",
            "metallic": 1.0,
            "roughness": 1.0,
            "textures": {"base_color_texture": "grid"},
        }
    ]
    assert told["textures"] == [{"name": "grid", "width": 8, "height": 4}]
    assert told["lights"] == [{"kind": "PointLight", "name": "bulb", "node": "world/lamp"}]
    assert told["notes"] == ["a note"]


@given(angle=st.floats(0.0, 3.0), tilt=st.floats(0.0, 3.0))
def test_tight_bounds_are_those_of_the_points(angle: float, tilt: float) -> None:
    """A box as a mesh and as a shape, and a ball, stretched and turned: the extremes of the points, which boxes round boxes exceed."""
    place = transform.rotate_y(angle) @ transform.rotate_x(tilt) @ transform.scale(1.0, 2.0, 0.5)
    for geometry in (primitives.box((1.0, 2.0, 3.0)), limner.Box((1.0, 2.0, 3.0))):
        found = tight_bounds(limner.Scene(limner.Node("box", place, shapes=(limner.Shape(geometry),))))
        corners = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-1.0, 1.0) for z in (-1.5, 1.5)])
        moved = transform.transform_points(place, corners)
        np.testing.assert_allclose(found, [moved.min(axis=0), moved.max(axis=0)], atol=1e-6)
    found = tight_bounds(limner.Scene(limner.Node("ball", place, shapes=(limner.Shape(limner.Sphere(2.0)),))))
    around = np.random.default_rng(0).normal(size=(20_000, 3))
    moved = transform.transform_points(place, 2.0 * around / np.linalg.norm(around, axis=1, keepdims=True))
    np.testing.assert_allclose(found, [moved.min(axis=0), moved.max(axis=0)], atol=0.03)
    assert (found[0] <= moved.min(axis=0) + 1e-9).all()
    assert (found[1] >= moved.max(axis=0) - 1e-9).all()


def _pyramid(up: int) -> limner.Scene:
    """A square base at 0 and a tip above it, along y or z."""
    corners = np.array([[-1, 0, -1], [1, 0, -1], [1, 0, 1], [-1, 0, 1], [0, 2, 0]], dtype=np.float32)
    triangles = np.array([[0, 1, 2], [0, 2, 3], [0, 4, 1], [1, 4, 2], [2, 4, 3], [3, 4, 0]], dtype=np.int32)
    if up == 2:
        corners = corners[:, [0, 2, 1]] * np.array([1, -1, 1], dtype=np.float32)
    return _scene(limner.Shape(limner.Mesh(corners, triangles)))


def test_which_way_is_up_is_guessed_from_what_things_stand_on() -> None:
    """A pyramid stands on its base; lying on its side it is told of; a cube says nothing, and the usual axis is taken."""
    assert guess_up(_pyramid(1))["axis"] == "+y"
    told = guess_up(_pyramid(2))
    assert (told["axis"], told["confidence"]) == ("+z", "high")
    assert any(warning.startswith("+z seems to be up") for warning in facts(_pyramid(2))["warnings"])
    cube = guess_up(_scene(limner.Shape(primitives.box((1.0, 1.0, 1.0)))))
    assert (cube["axis"], cube["confidence"]) == ("+y", "low")
    assert guess_up(limner.Scene())["confidence"] == "low"


@pytest.mark.parametrize(
    ("size", "offset", "message"),
    [
        (5000.0, 0.0, "is it in millimetres?"),
        (1e-5, 0.0, "is it in kilometres?"),
        (1.0, 1000.0, "far beyond its own size"),
        (1.0, 0.0, None),
    ],
)
def test_sizes_that_nobody_means_are_told_of(size: float, offset: float, message: str | None) -> None:
    place = transform.translate(offset, 0.0, 0.0)
    scene = limner.Scene(limner.Node("box", place, shapes=(limner.Shape(limner.Box((size, size, size))),)))
    warnings = facts(scene)["warnings"]
    assert any(message in warning for warning in warnings) if message else warnings == []


def test_dominant_colours_count_what_is_visible() -> None:
    """Three quarters red, one quarter blue; what is transparent does not count."""
    pixels = np.zeros((4, 4, 4), dtype=np.float32)
    pixels[:3, :, 0], pixels[3:, :, 2] = 1.0, 1.0
    pixels[..., 3] = 1.0
    around = np.pad(pixels, ((2, 2), (2, 2), (0, 0)))
    assert dominant_colors(around) == [{"color": "#ff0000", "share": 0.75}, {"color": "#0000ff", "share": 0.25}]
    told = report_of_pixels(around)
    assert (told["coverage"], told["box"]) == (0.25, [2, 2, 4, 4])
    assert told["brightness"] == pytest.approx(0.2126, abs=1e-4)
    assert report_of_pixels(np.zeros((3, 3, 4), dtype=np.float32))["box"] is None


# --- drawing --------------------------------------------------------------------------------------------------------------


def test_pictures_are_mixed_in_linear_light() -> None:
    """Half of white over black is middle grey as light, 188 as bytes, not 128."""
    canvas = Canvas(4, 4, (0, 0, 0))
    pixels = np.ones((2, 2, 4), dtype=np.float32)
    pixels[..., 3] = 0.5
    canvas.picture(1, 1, limner.Image(pixels))
    drawn = canvas.to_uint8()
    assert (drawn[1:3, 1:3] == 188).all()
    assert (drawn[0] == 0).all()


def test_lines_have_their_width_and_place() -> None:
    """A horizontal line of width 2 round y = 10: two full rows; a slanted one covers its length times its width, with smooth edges."""
    canvas = Canvas(40, 20, (0, 0, 0))
    canvas.lines([Stroke([(5, 10), (35, 10)], (255, 255, 255), 2.0)])
    drawn = canvas.to_uint8()[..., 0]
    assert (drawn[9:11, 8:32] == 255).all()
    assert (drawn[:8] == 0).all()
    assert (drawn[12:] == 0).all()
    slanted = Canvas(60, 60, (0, 0, 0))
    slanted.lines([Stroke([(10, 10), (50, 40)], (255, 255, 255), 2.0)])
    drawn = slanted.to_uint8()[..., 0].astype(float)
    assert drawn.sum() / 255.0 == pytest.approx(2.0 * 50.0, rel=0.2)
    assert ((drawn > 20) & (drawn < 235)).sum() > 30
    Canvas(5, 5, (0, 0, 0)).lines([Stroke([(100, 100), (200, 200)], (255, 0, 0)), Stroke([(np.nan, 0), (1, 1)], (255, 0, 0))])


@given(words=st.text(max_size=60), width=st.integers(30, 300))
def test_words_fit(words: str, width: int) -> None:
    """Whatever they are, shortened and wrapped words take no more room than there is."""
    assert text_width(shortened(words, 12, width), 12) <= max(width, text_width("a...a", 12))
    for line in wrapped(words, 12, width):
        assert text_width(line, 12) <= max(width, text_width("a...a", 12))


@given(n=st.integers(1, 500))
def test_grids_hold_all_cells(n: int) -> None:
    """Enough cells, no empty row, and none beyond the sheet."""
    grid = grid_for(n, 20, 30, 4)
    assert grid.columns * (grid.rows - 1) < n <= grid.columns * grid.rows
    x, y = grid.corner(n - 1)
    assert x + 20 + 4 <= grid.size[0]
    assert y + 30 + 4 <= grid.size[1]
