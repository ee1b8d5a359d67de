"""The panels of `limner.produce.stages`: what a study has, turned into pictures, keys and a word about each."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..draw.canvas import Canvas as Drawing
from ..draw.stroke import Pen
from ..draw.wireframe import Seen, draw_wireframe, visible_segments
from ..image.image import Image
from ..linear.projection import camera_from_world
from ..scene.camera import PerspectiveCamera
from .facts import number
from .false_color import COVERAGE, DEPTH, LAYERS, LEVELS, Ramp, Swatches, along, from_unit, picture
from .sheet import Rgb
from .stage_study import COVERAGE_SAMPLES, Look, Study, cuts, face_keys
from .wireframe import lines_seen

if TYPE_CHECKING:
    from ..raster.stages import Capture

__all__ = ["FAINT", "INK", "PAPER", "SHOW", "Panel"]

Floats = NDArray[np.float64]

PAPER: Rgb = (248, 249, 250)
INK: Rgb = (30, 34, 40)
FAINT: Rgb = (96, 104, 114)

_GROUND: Rgb = (225, 229, 234)
_MODEL: Rgb = (196, 203, 212)  # where there is a surface, and no more is said of it
_WHOLE: Rgb = (74, 104, 146)
_CUT: Rgb = (222, 96, 30)
_LENS = 0.36  # of the panel's width
_NOTICED = 90.0  # of three times 255: a difference that nobody overlooks


class Panel(NamedTuple):
    """A picture, what is measured in it, and its key."""

    image: Image
    measure: str = ""
    key: Ramp | Swatches | None = None


def _show_wireframe(study: Study) -> Panel:
    drawing = Drawing(study.width, study.height, _ink(_GROUND))
    _draw_lines(drawing, study.lines, min(1.0, study.edge_length / 5.0))
    image = drawing.image()
    if study.zoom > 2:
        close = Drawing(study.width, study.height, _ink(_GROUND))
        _draw_lines(close, lines_seen(study.edges, study.close.camera, study.close.taken.channels["depth"]), 1.0)
        image = _with_lens(study, image, close.image())
    return Panel(image, f"{_counted(len(study.edges.starts), 'edge')}")


def _draw_lines(drawing: Drawing, seen: Seen, strength: float) -> None:
    """Lines thinner where they are dense, lest they run together."""
    width = 0.55 + 0.45 * strength
    hidden = _ink(FAINT, 0.22 * strength)
    draw_wireframe(drawing, seen, _ink(INK, 0.35 + 0.65 * strength), Pen(width, cap="round"), hidden, Pen(0.8 * width, cap="round"))


def _show_clipping(study: Study) -> Panel:
    close, (window, corner) = study.close, study.window
    x, y = corner
    height, width = window.taken.layers.shape
    drawing = Drawing(study.width, study.height, _ink(_GROUND))
    drawing.paste(_painted(close.taken.seen, (215, 220, 226)), 0, 0)
    outside = lines_seen(study.edges, close.camera, close.taken.channels["depth"])
    draw_wireframe(drawing, outside, _ink(FAINT, 0.45), Pen(0.6))
    drawing.rectangle(x - 0.5, y - 0.5, width, height, fill=_ink(PAPER))
    pieces = window.taken.screen[window.taken.cut]
    is_cut = np.isin(face_keys(window.taken.faces[..., 0], window.taken.faces[..., 1]), face_keys(pieces["instance"], pieces["triangle"]))
    drawing.paste(_painted(window.taken.seen & ~is_cut, (206, 217, 233)), x, y)
    drawing.paste(_painted(window.taken.seen & is_cut, (252, 216, 184)), x, y)
    for cut, color, pen in ((False, _WHOLE, 0.9), (True, _CUT, 1.1)):
        seen = _outlines(window, window.taken.screen[window.taken.cut == cut])
        drawing.segments(seen.lines[seen.visible] + np.array([x, y, x, y]), _ink(color), Pen(pen, cap="round"))
    drawing.rectangle(x - 0.5, y - 0.5, width, height, stroke=_ink(INK), pen=1.6)
    told = cuts(window.taken)
    key = Swatches(((_WHOLE, f"{told['whole']:,} whole"), (_CUT, f"{told['cut']:,} cut into {told['pieces']:,}")))
    return Panel(drawing.image(), f"enlarged {study.zoom} x" if study.zoom > 1 else "", key)


def _outlines(look: Look, screen: NDArray[np.void]) -> Seen:
    """The sides of screen triangles, cut where surfaces hide them: taken back into the world by their depths."""
    from ..raster.layouts import SUBPIXELS

    height, width = look.taken.layers.shape
    x, y = (screen[name].astype(np.float64) / SUBPIXELS for name in ("x", "y"))
    column, row = (screen[name].astype(np.float64)[:, None] for name in ("x_reference", "y_reference"))
    z, dzdx, dzdy = (screen[name].astype(np.float64)[:, None] for name in ("z", "dzdx", "dzdy"))
    held = z + dzdx * (x - column) + dzdy * (y - row)
    near, far = (float(look.view.camera[name][0]) for name in ("near", "far"))
    perspective = isinstance(look.camera, PerspectiveCamera)
    with np.errstate(divide="ignore"):
        depth = near / held if perspective else far - held * (far - near)
    depth = np.where(depth > 0.0, depth, np.inf) if perspective else depth
    corners = look.camera.unproject(np.stack([x, height - 1.0 - y], axis=-1), depth, width, height)
    starts, ends = corners.reshape(-1, 3), corners[:, [1, 2, 0]].reshape(-1, 3)
    return visible_segments(
        starts, ends, camera_from_world(look.camera), look.camera.intrinsics(width, height), perspective=perspective, width=width,
        height=height, depth=look.taken.channels["depth"],
    )  # fmt: skip


def _show_coverage(study: Study) -> Panel:
    samples, left_out = study.covered
    codes = along(samples, 1, COVERAGE_SAMPLES - 1, COVERAGE)
    codes[samples == COVERAGE_SAMPLES] = _WHOLE
    image = _on_ground(picture(codes, samples > 0))
    partly = int(((samples > 0) & (samples < COVERAGE_SAMPLES)).sum())
    if partly:
        image = _with_lens(study, image, image, _busiest(study, samples))
    words = ", without the plane" if left_out else ""
    return Panel(image, f"{_counted(partly, 'pixel')} in part{words}", Ramp((*COVERAGE, _WHOLE), "1", "16"))


def _show_overdraw(study: Study) -> Panel:
    layers = study.main.taken.layers
    most = len(LAYERS)
    codes = np.array(LAYERS, dtype=np.uint8)[np.clip(layers, 1, most) - 1]
    entries = tuple((color, f"{k + 1}" if k + 1 < most else f"{k + 1}+") for k, color in enumerate(LAYERS))
    seen = layers[layers > 0]
    return Panel(_on_ground(picture(codes, layers > 0)), f"mean {seen.mean():.2f}" if len(seen) else "", Swatches(entries))


def _show_depth(study: Study) -> Panel:
    taken = study.main.taken
    depth = taken.channels["depth"]
    told = depth[taken.seen]
    if not len(told):
        return _nothing(study, "nothing is seen")
    low, high = float(told.min()), float(told.max())
    key = Ramp(DEPTH, f"{number(low)} m", f"{number(high)} m")
    if isinstance(study.camera, PerspectiveCamera):  # the z-buffer holds near / depth
        low, high, depth = -1.0 / low, -1.0 / high, -1.0 / depth
    return Panel(_on_ground(picture(along(depth, low, high, DEPTH), taken.seen)), "", key)


def _show_barycentrics(study: Study) -> Panel:
    def shown(taken: Capture) -> Image:
        # As light: the middle of a triangle, a third of each, is then no darker than its corners.
        pixels = np.concatenate([np.nan_to_num(taken.barycentrics), taken.seen[..., None]], axis=2)
        return _on_ground(Image(np.clip(pixels, 0.0, 1.0, dtype=np.float32)))

    image = shown(study.main.taken)
    if study.zoom > 2:
        image = _with_lens(study, image, shown(study.close.taken))
    faces = study.main.taken.faces[study.main.taken.seen]
    n = len(np.unique(face_keys(faces[:, 0], faces[:, 1])))
    key = Swatches((((224, 40, 40), "a"), ((40, 190, 60), "b"), ((50, 70, 224), "c")))
    return Panel(image, f"{_counted(n, 'triangle')} seen", key)


def _show_normals(study: Study) -> Panel:
    taken = study.main.taken
    key = Swatches((((224, 40, 40), "x"), ((40, 190, 60), "y"), ((50, 70, 224), "z")))
    return Panel(_on_ground(picture(from_unit(taken.channels["normal"] * 0.5 + 0.5), taken.seen)), "", key)


def _show_uv(study: Study) -> Panel:
    taken = study.main.taken
    if not study.has_uv.any():
        return _nothing(study, "the model has no texture coordinates")
    uv = np.where(study.has_uv[..., None], taken.channels["uv"], 0.0).astype(np.float64)
    within = uv - np.floor(uv)
    light = np.where((np.floor(uv * 8.0).sum(axis=2) % 2.0) == 0.0, 1.0, 0.8)
    codes = from_unit(np.dstack([within, np.full(within.shape[:2], 0.22)]) * light[..., None])
    codes[~study.has_uv] = _MODEL
    low, high = uv[study.has_uv].min(axis=0), uv[study.has_uv].max(axis=0)
    words = f"u {low[0]:.2f} to {high[0]:.2f}, v {low[1]:.2f} to {high[1]:.2f}"
    return Panel(_on_ground(picture(codes, taken.seen)), words, Swatches((((224, 40, 56), "u"), ((40, 200, 56), "v"))))


def _show_flat(study: Study) -> Panel:
    return Panel(_on_ground(study.render(study.clay, samples=1, shading="flat")), "one colour for each triangle")


def _show_gouraud(study: Study) -> Panel:
    return Panel(_on_ground(study.render(study.clay, samples=1, shading="vertex")), "three colours for each triangle")


def _show_phong(study: Study) -> Panel:
    return Panel(_on_ground(study.render(study.clay, samples=1)), "one colour for each pixel")


def _show_mip_level(study: Study) -> Panel:
    levels = study.dressed[1].mip_level
    has_one = np.isfinite(levels)
    if not has_one.any():
        return _nothing(study, "the model has no texture")
    codes = along(levels, 0.0, len(LEVELS) - 1.0, LEVELS)
    codes[~has_one] = _MODEL
    most = min(int(np.ceil(np.nanmax(levels))), len(LEVELS) - 1)
    entries = tuple((LEVELS[k], f"{k}") for k in range(most + 1))
    return Panel(_on_ground(picture(codes, study.main.taken.seen)), _borrowed(study), Swatches(entries))


def _show_texture(study: Study) -> Panel:
    taken = study.dressed[1]
    if not np.isfinite(taken.mip_level).any():
        return Panel(_of_albedo(taken), "plain colours: there is no texture")
    textures = np.unique(study.tables.materials["color_texture"])
    sizes = [f"{study.tables.textures[k]['width']} x {study.tables.textures[k]['height']}" for k in textures[textures >= 0]]
    return Panel(_of_albedo(taken), _borrowed(study) or ", ".join(dict.fromkeys(sizes)))


def _of_albedo(taken: Capture) -> Image:
    pixels = np.concatenate([taken.channels["albedo"], taken.seen[..., None].astype(np.float32)], axis=2)
    return _on_ground(Image(np.ascontiguousarray(pixels, dtype=np.float32)))


def _show_lit(study: Study) -> Panel:
    _, box = _enlarged(study)
    drawing = Drawing.on(_on_ground(study.aliased))
    _frame(drawing, box)
    return Panel(drawing.image(), _borrowed(study) or "1 sample a pixel")


def _show_antialiasing(study: Study) -> Panel:
    times, box = _enlarged(study)
    drawing = Drawing(study.width, study.height, _ink(_GROUND))
    middle = study.width // 2
    for image, x in ((study.aliased, 0), (study.smooth, middle)):
        drawing.paste(_cropped(_on_ground(image), box, times, study.width - middle, study.height), x, 0)
    drawing.line(middle - 0.5, -0.5, middle - 0.5, study.height, _ink(PAPER), 3.0)
    return Panel(drawing.image(), f"1 sample, {study.samples} samples, enlarged {times} x")


def _show_picture(study: Study) -> Panel:
    return Panel(_on_ground(study.picture), f"{study.samples} samples a pixel")


SHOW: tuple[Callable[[Study], Panel], ...] = (
    _show_wireframe, _show_clipping, _show_coverage, _show_overdraw, _show_depth, _show_barycentrics, _show_normals, _show_uv,
    _show_flat, _show_gouraud, _show_phong, _show_mip_level, _show_texture, _show_lit, _show_antialiasing, _show_picture,
)  # fmt: skip


def _nothing(study: Study, words: str) -> Panel:
    """Where the model is, and why there is no more."""
    drawing = Drawing.on(_on_ground(_painted(study.main.taken.seen, _MODEL)))
    x, y, size = study.width / 2.0, study.height / 2.0, max(10.0, study.width / 27)
    drawing.text(x, y, words, _ink(INK), size=size, align="center", baseline="middle")
    return Panel(drawing.image())


def _borrowed(study: Study) -> str:
    return "a borrowed chessboard" if study.borrows else ""


def _counted(n: int, what: str) -> str:
    return f"{n:,} {what}{'' if n == 1 else 's'}"


# --- pictures -------------------------------------------------------------------------------------------------------------


def _ink(color: Rgb, alpha: float = 1.0) -> str:
    return "#" + "".join(f"{part:02x}" for part in (*color, round(255 * alpha)))


def _painted(shown: NDArray[np.bool_], color: Rgb) -> Image:
    return picture(np.broadcast_to(np.array(color, dtype=np.uint8), (*shown.shape, 3)), shown)


def _on_ground(image: Image) -> Image:
    return Drawing(image.width, image.height, _ink(_GROUND)).paste(image, 0, 0).image()


def _as_seen(image: Image) -> Floats:
    """(height, width, 3): on the ground, in the steps of a screen."""
    return _on_ground(image).to_uint8()[..., :3].astype(np.float64)


def _frame(drawing: Drawing, box: tuple[float, float, float, float]) -> None:
    """A line round a part of a picture that can be seen on anything."""
    x, y, w, h = box
    drawing.rectangle(x - 0.5, y - 0.5, w, h, stroke=_ink(PAPER), pen=3.2)
    drawing.rectangle(x - 0.5, y - 0.5, w, h, stroke=_ink(INK), pen=1.2)


def _cropped(image: Image, box: tuple[int, int, int, int], times: int, width: int, height: int) -> Image:
    """A part of a picture with its pixels as large squares, cut to a size."""
    left, top, w, h = box
    part = image.pixels[top : top + h + 1, left : left + w + 1]
    large = np.pad(part.repeat(times, axis=0).repeat(times, axis=1), ((0, height), (0, width), (0, 0)), mode="edge")
    return Image(np.ascontiguousarray(large[:height, :width]))


def _enlarged(study: Study) -> tuple[int, tuple[int, int, int, int]]:
    """How many times antialiasing is enlarged, and what: the box in which it changes most; left, top, width, height."""
    times = max(4, round(study.width / 45))
    w, h = study.width // 2 // times, study.height // times
    change = np.abs(_as_seen(study.smooth) - _as_seen(study.aliased)).sum(axis=2)
    inside = _sums_in_boxes(np.minimum(change, _NOTICED), w, h)  # many changes, rather than a few great ones
    top, left = divmod(int(np.argmax(inside)), inside.shape[1])
    return times, (left, top, w, h)


def _sums_in_boxes(values: NDArray[Any], w: int, h: int) -> NDArray[Any]:
    """The sum of every box of w x h pixels, by its upper left corner."""
    sums = np.pad(values.cumsum(axis=0).cumsum(axis=1), ((1, 0), (1, 0)))
    inside: NDArray[Any] = sums[h:, w:] - sums[:-h, w:] - sums[h:, :-w] + sums[:-h, :-w]
    return inside


def _busiest(study: Study, samples: NDArray[np.int32]) -> tuple[int, tuple[int, int, int, int]]:
    """(times, box): what a lens enlarges, an outline that bends: through many rows and columns, with many numbers of samples."""
    times = max(4, round(study.width / 50))
    side = max(4, round(_LENS * study.width) // times)
    partly = ((samples > 0) & (samples < COVERAGE_SAMPLES)).astype(np.int64)
    rows = _sums_in_boxes((_sums_in_boxes(partly, side, 1) > 0).astype(np.int64), 1, side)
    columns = _sums_in_boxes((_sums_in_boxes(partly, 1, side) > 0).astype(np.int64), side, 1)
    numbers = sum((_sums_in_boxes((samples == k).astype(np.int64), side, side) > 0).astype(np.int64) for k in range(1, COVERAGE_SAMPLES))
    score = rows + columns + numbers
    top, left = divmod(int(np.argmax(score)), score.shape[1])
    return times, (left, top, side, side)


def _with_lens(study: Study, image: Image, close: Image, spot: tuple[int, tuple[int, int, int, int]] | None = None) -> Image:
    """Lay an enlarged part into the corner where least is lost, and frame where it is from.

    `spot` (times, box): its pixels enlarged; None: the middle of a picture of the close look.
    """
    if spot is None:
        times, side = study.zoom, round(_LENS * study.width)
        left, top = (study.width - side) // 2, (study.height - side) // 2
        lens = Image(np.ascontiguousarray(close.pixels[max(top, 0) : max(top, 0) + side, left : left + side]))
        at = study.middle[0] - side / 2.0 / times, study.middle[1] - side / 2.0 / times
        box: tuple[float, float, float, float] = (*at, side / times, side / times)
    else:
        times, box = spot[0], spot[1]
        lens = _cropped(close, spot[1], times, spot[1][2] * times, spot[1][3] * times)
    gap = max(4, study.width // 50)
    right, bottom = study.width - gap - lens.width, study.height - gap - lens.height
    corners = [(x, y) for y in (gap, bottom) for x in (right, gap)]
    seen = study.main.taken.seen
    x, y = min(corners, key=lambda at: _hidden_by(seen, at, lens, box))
    drawing = Drawing.on(image)
    _frame(drawing, box)
    drawing.paste(lens, x, y)
    _frame(drawing, (x, y, lens.width, lens.height))
    return drawing.image()


def _hidden_by(seen: NDArray[np.bool_], at: tuple[int, int], lens: Image, box: tuple[float, float, float, float]) -> int:
    """How many visible pixels a lens would cover; far more where it covers what it enlarges."""
    (x, y), (left, top, w, h) = at, box
    covers = x < left + w and left < x + lens.width and y < top + h and top < y + lens.height
    return int(seen[y : y + lens.height, x : x + lens.width].sum()) + (seen.size if covers else 0)
