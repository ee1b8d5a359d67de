"""What each stage of the pipeline leaves is what the pictures are made of, and the sheet shows it."""

from __future__ import annotations

import json
import threading
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from staging import SLOW_AS_PYTHON, checkers, flat_picture, grid, lit_from, place, scene_of, two_triangles

import limner
from limner.color.transfer import bytes_from_linear
from limner.errors import SceneError
from limner.image.image import Image
from limner.mesh.mesh import Mesh
from limner.mesh.shapes.primitives import uv_sphere
from limner.produce.false_color import COVERAGE, DEPTH, LAYERS, LEVELS, along
from limner.produce.sheet import Canvas
from limner.produce.stages import STAGES, stages
from limner.produce.views import Sheet
from limner.raster.layouts import SUBPIXELS
from limner.raster.stages import N_SAMPLES, Capture, capture
from limner.scene.camera import Camera, OrthographicCamera, PerspectiveCamera
from limner.scene.material import Lambert
from limner.scene.scene import Scene
from limner.scene.shape import Box, Plane, Sphere
from limner.scene.texture import Texels, Texture
from limner.tables.build import flatten, view
from limner.tables.layouts import SceneTables

W, H = 40, 30
CAMERA = PerspectiveCamera.look_at((1.0, 1.5, 4.0), (0, 0, 0), yfov_degrees=40)


def tables_of(scene: Scene, camera: Camera, width: int = W, height: int = H) -> SceneTables:
    return flatten(scene, camera, width, height).tables


def captured(scene: Scene, camera: Camera = CAMERA, width: int = W, height: int = H, **options: str) -> Capture:
    tables = tables_of(scene, camera, width, height)
    return capture(tables, view(scene, tables, camera, width, height), width, height, **options)  # type: ignore[arg-type]


def shapes() -> Scene:
    """A torn heap of triangles, and a floor that passes under the eye."""
    rng = np.random.default_rng(8)
    points = rng.uniform(-1.0, 1.0, (24, 3)).astype(np.float32)
    heap = Mesh(points, rng.permutation(24).reshape(8, 3).astype(np.int32))
    floor = two_triangles((-9, -1, -9), (-9, -1, 9), (9, -1, 9), (9, -1, -9))
    return scene_of(place(heap), place(floor), place(Sphere(0.4), at=(0.6, 0.2, 0.5)))


# --- what the stages leave ------------------------------------------------------------------------------------------------


def test_coverage_is_the_picture_s_alpha() -> None:
    """The alpha of a picture before nothing, of as many samples, is that share of them, in every pixel, exactly; no shading knows of it."""
    heap = Scene(root=shapes().root.children[0])
    taken = captured(heap)
    image = limner.render(heap, width=W, height=H, camera=CAMERA, samples=N_SAMPLES)
    assert (taken.samples == image.pixels[..., 3] * N_SAMPLES).all()
    assert ((taken.samples > 0) & (taken.samples < N_SAMPLES)).sum() > 20


def test_layers_and_faces_agree_with_the_ids() -> None:
    """A triangle covers the centre of just those pixels where the channels see one, also where it is clipped at the eye."""
    scene = shapes()
    taken = captured(scene)
    ids = limner.render(scene, width=W, height=H, camera=CAMERA, samples=1, aovs=("instance_id", "triangle_id")).aov
    assert ((taken.layers > 0) == (ids["instance_id"] >= 0)).all()
    assert (taken.faces[..., 0] == ids["instance_id"]).all()
    meshes = ids["triangle_id"] >= 0
    assert (taken.faces[..., 1] == ids["triangle_id"])[meshes].all()
    sphere = taken.faces[..., 0] == 2
    assert sphere.any()
    assert (taken.faces[..., 1][sphere] >= 0).all()


def test_sheets_one_behind_the_other_are_so_many_layers() -> None:
    """Five walls that fill the picture, of two triangles each, whose common edge draws no pixel twice."""
    walls = [place(grid(2, 9.0, np.array([[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, -z], [0, 0, 0, 1.0]]))) for z in range(5)]
    taken = captured(scene_of(*walls), flat_picture())
    assert (taken.layers == 5).all()
    assert (taken.samples == N_SAMPLES).all()


def test_barycentrics_lead_to_the_position() -> None:
    """They sum to one, lie in the triangle, and weigh its corners, taken to the world by NumPy, to the point that the channel has."""
    scene = shapes()
    taken, tables = captured(scene), tables_of(scene, CAMERA)
    seen = taken.seen
    weights = taken.barycentrics[seen].astype(np.float64)
    assert np.abs(weights.sum(axis=1) - 1.0).max() < 1e-6
    assert weights.min() > -1e-3
    assert np.isnan(taken.barycentrics[~seen]).all()
    instance, triangle = taken.faces[seen].T
    mesh = tables.meshes[tables.instances["mesh"][instance]]
    corners = tables.positions[tables.triangles[mesh["triangle"] + triangle] + mesh["position"][:, None]].astype(np.float64)
    matrix = tables.instances["world_from_object"][instance].astype(np.float64)
    world = np.einsum("nij,nkj->nki", matrix[:, :, :3], corners) + matrix[:, None, :, 3]
    at = (weights[..., None] * world).sum(axis=1)
    flat = instance != 2
    assert np.abs(at - taken.channels["position"][seen])[flat].max() < 2e-4
    # The channel has the sphere's own points; the triangles that stand for it lie just below.
    radius = np.linalg.norm(at[~flat] - (0.6, 0.2, 0.5), axis=1)
    assert 0.38 < radius.min() < radius.max() < 0.4001


def test_clipping_cuts_what_crosses_the_border() -> None:
    """A triangle round the whole picture becomes the picture, with the margin of a pixel; one inside stays; one outside goes."""
    camera = OrthographicCamera.look_at((0, 0, 5), (0, 0, 0), height=2.0)
    around = Mesh(np.array([[-50, -40, 0], [50, -40, 0], [0, 90, 0]], np.float32), np.array([[0, 1, 2]], np.int32))
    inside = Mesh(np.array([[-0.5, -0.4, 1], [0.5, -0.4, 1], [0, 0.5, 1]], np.float32), np.array([[0, 1, 2]], np.int32))
    beside = Mesh(np.array([[30, 0, 1], [31, 0, 1], [30, 1, 1]], np.float32), np.array([[0, 1, 2]], np.int32))
    scene = scene_of(place(around), place(inside), place(beside))
    taken = captured(scene, camera, clipping="world")
    assert set(taken.screen["instance"][taken.cut]) == {0}
    assert set(taken.screen["instance"][~taken.cut]) == {1}
    pieces = taken.screen[taken.cut]
    x, y = (pieces[name].astype(np.float64) / SUBPIXELS for name in ("x", "y"))
    areas = 0.5 * ((x[:, 1] - x[:, 0]) * (y[:, 2] - y[:, 0]) - (x[:, 2] - x[:, 0]) * (y[:, 1] - y[:, 0]))
    assert areas.sum() == pytest.approx((W + 2) * (H + 2), rel=1e-3)
    assert not captured(scene, camera).cut.any()


# --- mipmap levels --------------------------------------------------------------------------------------------------------


def wall(texels: int, scale: float = 1.0, **fields: str) -> Scene:
    """A square of two metres a side that faces the eye, with a texture over all of it."""
    texture = Texture(Texels(np.full((texels, texels, 4), 200, np.uint8)), scale=(scale, scale), **fields)  # type: ignore[arg-type]
    turned = np.array([[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1.0]])
    return scene_of(place(grid(2, 1.0, turned), Lambert(texture=texture)))


@pytest.mark.parametrize("name", ["trilinear", "anisotropic", "ripmap"])
@pytest.mark.parametrize(("texels", "scale", "height"), [(256, 1.0, 2.0), (64, 2.0, 1.0), (256, 1.0, 0.1), (32, 40.0, 4.0)])
def test_mip_level_of_a_plane_that_faces_the_eye(name: str, texels: int, scale: float, height: float) -> None:
    """A pixel covers texels · scale / 2 · height / H texels each way: the level is log2 of that, between the full and the last one."""
    camera = OrthographicCamera.look_at((0, 0, 5), (0, 0, 0), height=height)
    taken = captured(wall(texels, scale, filter=name), camera)
    expected = min(max(np.log2(texels * scale / 2.0 * height / H), 0.0), np.log2(texels))
    assert taken.seen.any()
    assert np.abs(taken.mip_level[taken.seen] - expected).max() < 2e-3


def test_mip_level_in_perspective() -> None:
    """At distance d with half height 1 a pixel is 2 d / H high; twice as far is one level more."""
    near, far = (
        captured(wall(512), PerspectiveCamera.look_at((0, 0, d), (0, 0, 0), yfov_degrees=90)).mip_level[H // 2, W // 2] for d in (0.5, 1.0)
    )
    assert near == pytest.approx(np.log2(512 / 2.0 * 2.0 * 0.5 / H), abs=2e-3)
    assert far - near == pytest.approx(1.0, abs=2e-3)


def test_without_texture_there_is_no_level() -> None:
    taken = captured(scene_of(place(Box())))
    assert taken.seen.any()
    assert np.isnan(taken.mip_level).all()
    assert (captured(wall(64, filter="bilinear"), flat_picture()).mip_level == 0.0).any()


# --- colours --------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("stops", [DEPTH, COVERAGE, LAYERS, LEVELS])
def test_colours_run_through_their_stops(stops: tuple[tuple[int, int, int], ...]) -> None:
    """At the stops they are the stops, half way between the mean; beyond the ends, the ends."""
    n = len(stops) - 1
    assert along(np.arange(n + 1.0), 0.0, float(n), stops).tolist() == [list(stop) for stop in stops]
    assert np.abs(along(0.5, 0.0, float(n), stops) - np.mean(stops[:2], axis=0)).max() <= 0.5
    assert along([-5.0, 99.0, np.inf], 0.0, 1.0, stops).tolist() == [list(stops[0]), list(stops[-1]), list(stops[-1])]


# --- the sheet ------------------------------------------------------------------------------------------------------------


def dressed() -> Scene:
    """A box with a texture and a ball of few triangles on a floor, before a blue wall of nothing; all of it lit from one side."""
    box = place(Box((1.0, 1.0, 1.0)), Lambert(texture=checkers(64)))
    ball = place(uv_sphere(8, 6, 0.5), at=(1.1, 0.0, 0.6))
    floor = place(grid(5, 2.0), at=(0, -0.5, 0))
    return scene_of(box, ball, floor, lit_from((0.3, 1.0, 0.8)), camera=CAMERA, background=(0.1, 0.2, 0.5))


@pytest.fixture(scope="module")
def sheet() -> Sheet:
    return stages(dressed(), width=320, samples=4, threads=1)


def cell(sheet: Sheet, name: str) -> NDArray[np.uint8]:
    (found,) = (panel["cell"] for panel in sheet.facts["panels"] if panel["name"] == name)
    left, top, width, height = found
    return sheet.image.to_uint8()[top : top + height, left : left + width, :3]


@SLOW_AS_PYTHON
class TestSheet:
    def test_the_last_panel_is_the_picture(self, sheet: Sheet) -> None:
        """To the byte what `limner.render` makes."""
        image = limner.render(dressed(), width=320, height=240, samples=4)
        assert (cell(sheet, "picture") == image.to_uint8()[..., :3]).all()

    def test_what_is_nearer_is_brighter(self, sheet: Sheet) -> None:
        """Along the depths of all pixels, in order, luminance only falls, but for what rounding to codes allows."""
        depth = limner.render(dressed(), width=320, height=240, samples=1, aovs=("depth",)).aov["depth"]
        seen = np.isfinite(depth)
        luminance = cell(sheet, "depth")[seen].astype(np.float64) @ (0.2126, 0.7152, 0.0722)
        in_order = luminance[np.argsort(depth[seen], kind="stable")]
        assert (np.diff(in_order) <= 1.0).all()
        assert in_order[0] - in_order[-1] > 150.0

    def test_flat_shading_is_flat(self, sheet: Sheet) -> None:
        """All of a triangle of the ball has one colour; shaded at its corners, or in its pixels, it has many."""
        faces = captured(dressed(), CAMERA, 320, 240).faces
        n_colors: dict[str, list[int]] = {"flat": [], "gouraud": [], "phong": []}
        for triangle in np.unique(faces[faces[..., 0] == 1][:, 1]):
            inside = (faces == (1, triangle)).all(axis=2)
            for name, counts in n_colors.items():
                counts.append(len(np.unique(cell(sheet, name)[inside], axis=0)))
        assert set(n_colors["flat"]) == {1}
        assert np.median(n_colors["gouraud"]) > 5
        assert np.median(n_colors["phong"]) > 5
        assert (cell(sheet, "gouraud") != cell(sheet, "phong")).any()

    def test_normals_and_albedo_are_the_channels(self, sheet: Sheet) -> None:
        """(n + 1) / 2 as codes, and the base colour as light."""
        aov = limner.render(dressed(), width=320, height=240, samples=1, aovs=("normal", "albedo", "instance_id")).aov
        seen = aov["instance_id"] >= 0
        codes = np.rint((aov["normal"][seen].astype(np.float64) * 0.5 + 0.5) * 255.0)
        assert np.abs(cell(sheet, "normals")[seen] - codes).max() <= 1
        assert np.abs(cell(sheet, "texture")[seen].astype(int) - bytes_from_linear(aov["albedo"])[seen].astype(int)).max() <= 1

    def test_the_numbers_are_those_of_the_stages(self, sheet: Sheet) -> None:
        """Counted again from what the pipeline leaves; all of it is plain, and each panel lies on the sheet, beside the others."""
        told = json.loads(json.dumps(sheet.facts))
        taken = captured(dressed(), CAMERA, 320, 240)
        assert told["pixels"] == int(taken.seen.sum())
        assert told["fragments"] == int(taken.layers.sum())
        assert told["screen_triangles"] == len(taken.screen)
        assert told["triangles"] == 12 + len(uv_sphere(8, 6).triangles) + 32
        assert told["depth"]["least"] == pytest.approx(float(taken.channels["depth"].min()))
        covered = np.zeros((sheet.image.height, sheet.image.width), dtype=int)
        for panel in told["panels"]:
            left, top, width, height = panel["cell"]
            assert (width, height) == (320, 240)
            covered[top : top + height, left : left + width] += 1
        assert covered.sum() == len(STAGES) * 320 * 240
        assert covered.max() == 1
        assert [panel["name"] for panel in told["panels"]] == [stage.name for stage in STAGES]

    def test_threads_change_no_bit(self, sheet: Sheet) -> None:
        assert (stages(dressed(), width=320, samples=4, threads=2).image.pixels == sheet.image.pixels).all()

    def test_a_model_without_texture_borrows_one_and_says_so(self) -> None:
        """Where it has coordinates; the picture of the model itself does not wear it."""
        bare = scene_of(place(Box()), camera=CAMERA, background=(0.0, 0.0, 0.0))
        made = stages(bare, width=320, samples=2)
        assert any("borrowed" in note for note in made.facts["notes"])
        assert made.facts["mip_level"] is not None
        assert (cell(made, "picture") == limner.render(bare, width=320, height=240, samples=2).to_uint8()[..., :3]).all()
        faceted = scene_of(place(two_triangles((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0))), camera=CAMERA)
        assert stages(faceted, width=320, samples=2).facts["mip_level"] is None

    def test_a_floor_without_end_does_not_hide_outlines(self) -> None:
        """Where a plane covers every sample, coverage is that of the rest; depth, levels and light stay those of all."""
        scene = scene_of(place(Sphere(1.0), at=(0, 1, 0)), place(Plane()), camera=PerspectiveCamera.look_at((0, 6, 3), (0, 0.5, 0)))
        made = stages(scene, width=320, samples=2)
        assert made.facts["partly_covered"] == 0
        assert len(np.unique(cell(made, "coverage").reshape(-1, 3), axis=0)) > 8

    def test_a_floor_that_comes_first_may_be_left_out(self, monkeypatch: pytest.MonkeyPatch) -> None:
        """Bug: instances kept the number that they had before the floor went, and pixels were described by rows that were not there.

        Fix: what is left is numbered anew.
        """
        asked: list[tuple[int, int]] = []

        def spy(tables: SceneTables, *rest: Any, **options: Any) -> Capture:
            assert (tables.instances["owner"] == np.arange(len(tables.instances))).all()
            taken = capture(tables, *rest, **options)
            asked.append((len(tables.instances), int(taken.faces[..., 0].max())))
            return taken

        monkeypatch.setattr("limner.raster.stages.capture", spy)
        camera = PerspectiveCamera.look_at((0, 6, 3), (0, 0.5, 0))
        sheets = [
            stages(scene_of(*order, camera=camera), width=320, samples=2)
            for ball, floor in [(place(Sphere(1.0), at=(0, 1, 0)), place(Plane()))]
            for order in ((ball, floor), (floor, ball))
        ]
        assert (cell(sheets[0], "coverage") == cell(sheets[1], "coverage")).all()
        assert asked.count((1, 0)) == 2

    def test_nothing_to_see_is_said(self) -> None:
        """An empty scene makes a sheet, too."""
        made = stages(Scene(), width=320, samples=2)
        assert "nothing of the scene is seen" in made.facts["warnings"]
        assert made.facts["pixels"] == 0

    def test_a_cancelled_sheet_says_so(self) -> None:
        cancel = threading.Event()
        cancel.set()
        assert not stages(dressed(), width=320, cancel=cancel).finished


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"width": 100}, "width must be an integer from 320 to 1600, got 100"),
        ({"width": 320.5, "height": 200}, "width must be an integer"),
        ({"height": 10}, "height must be an integer from 160 to 1600, got 10"),
        ({"samples": 1}, "samples must be an integer from 2 to 64, got 1"),
    ],
)
def test_what_cannot_be_is_refused(options: dict[str, object], message: str) -> None:
    with pytest.raises(SceneError, match=message):
        stages(dressed(), **options)  # type: ignore[arg-type]


@pytest.mark.parametrize("camera", [CAMERA, OrthographicCamera.look_at((1, 2, 5), (0, 0, 0), height=3.0, shift_x=0.2, shift_y=-0.1)])
def test_a_part_of_a_camera_sees_that_part(camera: Camera) -> None:
    """The channels of a box of pixels are those of the whole, there."""
    from limner.produce.stage_study import part_of

    scene = scene_of(place(Box()), place(grid(3, 2.0), at=(0, -0.5, 0)))
    left, top, w, h = 6, 9, 22, 14
    whole = limner.render(scene, width=W, height=H, camera=camera, samples=1, aovs=("position", "instance_id")).aov
    part = limner.render(scene, width=w, height=h, camera=part_of(camera, W, H, (left, top, w, h)), samples=1, aovs=tuple(whole)).aov
    inside = np.s_[top : top + h, left : left + w]
    same = whole["instance_id"][inside] == part["instance_id"]
    assert (~same).sum() <= 2
    assert np.abs(whole["position"][inside] - part["position"])[same].max() < 1e-4


def test_a_false_picture_has_its_codes() -> None:
    """Codes become light and codes again."""
    from limner.produce.false_color import picture

    codes = np.arange(36, dtype=np.uint8).reshape(3, 4, 3) * 7
    image = picture(codes, np.ones((3, 4), dtype=bool))
    assert isinstance(image, Image)
    canvas = Canvas(4, 3, (0, 0, 0))
    canvas.picture(0, 0, image)
    assert (canvas.to_uint8() == codes).all()
