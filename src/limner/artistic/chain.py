"""From pieces of lines to long strokes: a pen is put down once for a curve, not once for each edge of a mesh.

Pieces of one kind whose ends meet are one chain; where more than two meet, those go on into each other that turn least. A chain is parted
where the number of surfaces in front of it changes, and where it leaves the picture. Parts too short to be seen take the number of the
part beside them: dense meshes fold by less than a pixel at their outline. What is left of the folds of a rough surface, too short for a
dash, is left out, as are points without which a stroke looks the same.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .crowded import beside_others
from .sight_lines import SightLines
from .simplify import points_that_show
from .visibility import Parts, Thrown

__all__ = ["Stroke", "strokes_of"]

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]

_LEAST = 0.5  # pixels: what is shorter is not seen as a part of its own
_LEAST_SMOOTH = 2.0  # pixels: for smooth silhouettes, which the mesh that they smooth may hide here and there
_LEAST_DASH = 4.0  # pixels: of parts of these that are hidden
_LEAST_SEEN = 6.0  # pixels: of whole chains of these that are seen
_SPECK = 0.1  # of all lines of a shape: what is longer is no speck of it
_GRAIN, _TUFT, _FADING = 4.0, 6.0, 8.0  # pixels: of what does not stand out between parts that do, of these, and of where it fades
_SAME = 0.1  # pixels that a stroke may stray for having fewer points
_STAR = 32  # lines that meet in a point: more are rays of a star, each of which is a stroke
_PASSES = 4  # in which short parts give way to those beside them


class Stroke(NamedTuple):
    """Points on the picture (n, 2), their depths and places in the world, what holds of all of them, and which of the pieces between them,
    (n - 1,), only go with those beside them."""

    picture: Floats
    depth: Floats
    world: Floats
    kind: int
    hidden_by: int
    instance: int
    closed: bool
    bridged: NDArray[np.bool_]


class _Chains(NamedTuple):
    """Pieces in the order of chains: which, whether run from end to start, of which chain; and which chains are closed."""

    piece: Indices
    backwards: NDArray[np.bool_]
    chain: Indices
    closed: NDArray[np.bool_]


class _Path(NamedTuple):
    """Parts of pieces in the order of chains: of which line, from where to where, hidden by how many, of which chain; whether each goes on
    from the one before; how long it is, and how long it must be to be seen, pixels; whether it is drawn as
    seen though it is hidden, or the other way round, being too short to be seen as a part of its own."""

    line: Indices
    span: Floats
    hidden_by: Indices
    chain: Indices
    joined: NDArray[np.bool_]
    length: Floats
    least: Floats
    bridged: NDArray[np.bool_]


def strokes_of(
    found: Thrown, parts: Parts, sight: SightLines, smooth: NDArray[np.bool_], faint: NDArray[np.bool_] | None = None
) -> list[Stroke]:
    """Join what visibility has parted; `smooth`, (k,), says which lines run beside those of the mesh, or on a rough one, and `faint`, (k,),
    which do not stand out from it."""
    if not len(parts.line):
        return []
    chains = _chains_of(found)
    path = _path_of(found, parts, chains, smooth)
    if faint is not None and faint.any():
        path = _without_faint(path, faint[path.line])
    shown = _without_short(path)
    path = _merged(path._replace(hidden_by=shown, bridged=((shown > 0) != (path.hidden_by > 0)) & (path.length > _SAME)))
    path = _without_specks(found, path)
    path = _without_crowded(path, _crowded(found, path))
    return _simplified(_strokes(found, path, chains, sight))


# --- which pieces follow each other ---------------------------------------------------------------------------------------


def _chains_of(found: Thrown) -> _Chains:
    segments, n = found.segments, len(found.segments.kind)
    partner = _partners(found)
    follows = partner.tolist()
    seen = bytearray(n)
    piece: list[int] = []
    backwards: list[bool] = []
    chain: list[int] = []
    closed: list[bool] = []
    open_ends = np.flatnonzero(partner < 0).tolist()
    # Open chains from one of their ends; what is left are rings, which begin at their first piece.
    for end in [*open_ends, *range(0, 2 * n, 2)]:
        if seen[end >> 1]:
            continue
        number, at = len(closed), end
        while at >= 0 and not seen[at >> 1]:
            seen[at >> 1] = 1
            piece.append(at >> 1)
            backwards.append(bool(at & 1))
            chain.append(number)
            at = follows[at ^ 1]
        closed.append(at == end and at >= 0)
    order = np.argsort(segments.kind[np.array(piece, dtype=np.int64)], kind="stable")
    return _Chains(
        np.array(piece, dtype=np.int64)[order], np.array(backwards, dtype=bool)[order], np.array(chain, dtype=np.int64)[order],
        np.array(closed, dtype=bool),
    )  # fmt: skip


def _partners(found: Thrown) -> Indices:
    """(2 n,): for each end of each piece, 2 i + 0 or 1, the end that it goes on into; -1: none."""
    segments, n = found.segments, len(found.segments.kind)
    group = _groups(segments.ends.reshape(-1, 3), np.repeat(segments.kind, 2), np.repeat(segments.instance, 2))
    order = np.argsort(group, kind="stable")
    first = np.flatnonzero(np.append(True, group[order][1:] != group[order][:-1])) if n else np.zeros(0, dtype=np.int64)
    count = np.diff(np.append(first, 2 * n))
    partner = np.full(2 * n, -1, dtype=np.int64)
    one, other = order[first[count == 2]], order[first[count == 2] + 1]
    partner[one], partner[other] = other, one
    for n_ends in np.unique(count[(count > 2) & (count <= _STAR)]).tolist():
        _pair_straightest(found.lines, order[first[count == n_ends][:, None] + np.arange(n_ends)], partner)
    return partner


def _groups(ends: Floats, kind: Indices, instance: Indices) -> Indices:
    """Number rows so that equal ones have one number."""
    columns = [*(ends + 0.0).T.copy().view(np.int64), kind, instance]
    made = np.zeros(len(ends), dtype=np.int64)
    for column in columns:
        _, index = np.unique(column, return_inverse=True)
        _, made = np.unique(made * (len(ends) + 1) + index.reshape(-1), return_inverse=True)
        made = made.reshape(-1)
    return made


def _pair_straightest(lines: Floats, ends: Indices, partner: Indices) -> None:
    """Of the ends that meet in points, one row of `ends` each, let those go on into each other that turn least, by less than a right
    angle."""
    piece, side = ends >> 1, ends & 1
    way = lines[piece, 1 - side, :2] - lines[piece, side, :2]
    length = np.hypot(way[:, :, 0], way[:, :, 1])
    way = way / np.where(length > 0.0, length, 1.0)[:, :, None]
    i, j = np.triu_indices(ends.shape[1], 1)
    turn = (way[:, i] * way[:, j]).sum(axis=2)
    turn[piece[:, i] == piece[:, j]] = 1.0
    rows = np.arange(len(ends))
    for _ in range(ends.shape[1] // 2):
        least = turn.argmin(axis=1)
        rows = rows[turn[rows, least[rows]] < 0.0]
        a, b = i[least[rows]], j[least[rows]]
        partner[ends[rows, a]], partner[ends[rows, b]] = ends[rows, b], ends[rows, a]
        # Neither goes on anywhere else.
        taken = (i == a[:, None]) | (j == a[:, None]) | (i == b[:, None]) | (j == b[:, None])
        turn[rows] = np.where(taken, 1.0, turn[rows])


# --- their parts, one after the other -------------------------------------------------------------------------------------


def _path_of(found: Thrown, parts: Parts, chains: _Chains, smooth: NDArray[np.bool_]) -> _Path:
    n = len(found.segments.kind)
    first = np.searchsorted(parts.line, np.arange(n + 1))
    count = np.diff(first)[chains.piece]
    of = np.repeat(np.arange(len(count)), count)
    k = np.arange(len(of)) - np.repeat(np.cumsum(count) - count, count)
    turned = chains.backwards[of]
    part = first[chains.piece[of]] + np.where(turned, count[of] - 1 - k, k)
    span = np.where(turned[:, None], parts.span[part][:, ::-1], parts.span[part])
    line, chain = parts.line[part], chains.chain[of]
    whole_start, whole_end = span[:, 0] == turned, span[:, 1] == ~turned
    goes_on = np.zeros(len(of), dtype=bool)
    same = of[1:] == of[:-1]
    # Neighbours in the chain: the one runs to its very end, the other from its very start.
    goes_on[1:] = (chain[1:] == chain[:-1]) & (same | ((of[1:] == of[:-1] + 1) & whole_end[:-1] & whole_start[1:]))
    way = found.lines[line, 1, :2] - found.lines[line, 0, :2]
    length = np.hypot(way[:, 0], way[:, 1]) * np.abs(span[:, 1] - span[:, 0])
    least = np.where(smooth[line], _LEAST_SMOOTH, _LEAST)
    return _Path(line, span, parts.hidden_by[part], chain, goes_on, length, least, np.zeros(len(of), dtype=bool))


def _without_short(path: _Path) -> Indices:
    """What hides each part, those that are too short to be seen taking the number of the longer part beside them."""
    hidden_by = path.hidden_by.copy()
    for _ in range(_PASSES):
        begins = ~path.joined.copy()
        begins[1:] |= hidden_by[1:] != hidden_by[:-1]
        first = np.flatnonzero(begins)
        run = np.cumsum(begins) - 1
        length = np.add.reduceat(path.length, first)
        joined = path.joined[first]
        before = np.where(joined, np.append(0.0, length[:-1]), 0.0)
        goes_on = np.append(joined[1:], False)
        after = np.where(goes_on, np.append(length[1:], 0.0), 0.0)
        # What is hidden between two parts that are seen, and too short for a dash, would be a gap.
        number = hidden_by[first]
        seen = joined & goes_on & (np.append(1, number[:-1]) == 0) & (np.append(number[1:], 1) == 0)
        least = np.where(seen & (path.least[first] > _LEAST), _LEAST_DASH, path.least[first])
        short = (length < least) & (np.maximum(before, after) > length)
        # Of two short ones side by side, the shorter first.
        short &= ~(joined & np.append(False, short[:-1]) & (before < length)) & ~(goes_on & np.append(short[1:], False) & (after < length))
        if not short.any():
            break
        taken = np.where(before >= after, np.append(0, number[:-1]), np.append(number[1:], 0))
        hidden_by = np.where(short, taken, number)[run]
    return hidden_by


def _without_faint(path: _Path, faint: NDArray[np.bool_]) -> _Path:
    """Leave out what does not stand out, (n,) bool, for longer than a gap; what stands out for no more than a speck is left out with it."""
    faint = _where_short(path, faint, _GRAIN, ends=False)
    faint = ~_where_short(path, ~faint, _TUFT, ends=True)
    return _chosen(path, ~_where_short(path, faint, _FADING, ends=True))


def _crowded(found: Thrown, path: _Path) -> NDArray[np.bool_]:
    """Which hidden parts of smooth lines run beside other lines of their shape, (n,)."""
    if not ((path.least > _LEAST) & (path.hidden_by > 0)).any():
        return np.zeros(len(path.line), dtype=bool)
    begins = ~path.joined.copy()
    begins[1:] |= path.hidden_by[1:] != path.hidden_by[:-1]
    start, way = found.lines[path.line, 0, :2], found.lines[path.line, 1, :2] - found.lines[path.line, 0, :2]
    ends = start[:, None] + path.span[:, :, None] * way[:, None]
    instance = found.segments.instance[path.line]
    return beside_others(ends, path.hidden_by > 0, instance, np.cumsum(begins) - 1, path.length) & (path.least > _LEAST)


def _without_crowded(path: _Path, crowded: NDArray[np.bool_]) -> _Path:
    """Leave out what runs beside other lines, (n,) bool, for longer than a gap, and what of it is left over between."""
    crowded = _where_short(path, crowded, _GRAIN, ends=False)
    return _chosen(path, _where_short(path, ~crowded, _TUFT, ends=True) | (path.hidden_by == 0))


def _where_short(path: _Path, flag: NDArray[np.bool_], least: float, *, ends: bool) -> NDArray[np.bool_]:
    """The flags without runs of them that are shorter than `least` pixels and go on into what has none: at both ends, or, with `ends`, at
    one."""
    begins = ~path.joined.copy()
    begins[1:] |= flag[1:] != flag[:-1]
    first = np.flatnonzero(begins)
    run = np.cumsum(begins) - 1
    length = np.add.reduceat(path.length, first)
    before = path.joined[first]
    after = np.append(before[1:], False)
    short = flag[first] & (length < least) & ((before | after) if ends else (before & after))
    return np.asarray(flag & ~short[run])


def _chosen(path: _Path, kept: NDArray[np.bool_]) -> _Path:
    joined = path.joined.copy()
    joined[1:] &= kept[:-1]
    return _Path(
        path.line[kept], path.span[kept], path.hidden_by[kept], path.chain[kept], joined[kept], path.length[kept], path.least[kept],
        path.bridged[kept],
    )  # fmt: skip


def _merged(path: _Path) -> _Path:
    """Make one of parts of a line that one number of surfaces hides."""
    goes_on = path.joined.copy()
    goes_on[1:] &= (path.line[1:] == path.line[:-1]) & (path.hidden_by[1:] == path.hidden_by[:-1])
    goes_on[1:] &= path.bridged[1:] == path.bridged[:-1]
    first = np.flatnonzero(~goes_on)
    last = np.append(first[1:], len(goes_on)) - 1
    span = np.stack([path.span[first, 0], path.span[last, 1]], axis=1)
    return _Path(
        path.line[first], span, path.hidden_by[first], path.chain[first], path.joined[first], np.add.reduceat(path.length, first),
        path.least[first], path.bridged[first],
    )  # fmt: skip


def _without_specks(found: Thrown, path: _Path) -> _Path:
    """Leave out chains, and hidden parts, of smooth silhouettes that are too short to be seen, if their shape has more to show: of what
    is seen little, for a short piece may close a gap."""
    instance = found.segments.instance[path.line]
    whole = np.bincount(instance, path.length)[instance]
    begins = ~path.joined.copy()
    begins[1:] |= path.hidden_by[1:] != path.hidden_by[:-1]
    run = np.cumsum(begins) - 1
    length = np.bincount(run, path.length)[run]
    chain = np.bincount(path.chain, path.length)[path.chain]
    short = np.where(path.hidden_by > 0, length < _LEAST_DASH, chain < _LEAST_SEEN)
    kept = ~short | (path.least == _LEAST) | (chain > _SPECK * whole)
    return _chosen(path, kept)


# --- strokes --------------------------------------------------------------------------------------------------------------


def _strokes(found: Thrown, path: _Path, chains: _Chains, sight: SightLines) -> list[Stroke]:
    hidden_by = path.hidden_by
    begins = ~path.joined.copy()
    begins[1:] |= hidden_by[1:] != hidden_by[:-1]
    first = np.flatnonzero(begins)
    last = np.append(first[1:], len(begins)) - 1
    starts, ends = _points(found, path.line, path.span[:, 0], sight), _points(found, path.line, path.span[:, 1], sight)
    chain = path.chain[first]
    chain_first = np.append(True, chain[1:] != chain[:-1])
    chain_last = np.append(chain[1:] != chain[:-1], True)
    # A ring that is parted somewhere need not be parted where it begins.
    meets = np.zeros(len(first), dtype=bool)
    ring = chains.closed[chain] & chain_first
    head, tail = np.flatnonzero(ring), np.flatnonzero(chains.closed[chain] & chain_last)
    meets[head] = (
        (starts[2][first[head]] == ends[2][last[tail]]).all(axis=1) & (hidden_by[first[head]] == hidden_by[first[tail]])
    )  # fmt: skip
    tail_of = dict(zip(head.tolist(), tail.tolist(), strict=True))
    swallowed = {tail_of[k] for k in np.flatnonzero(meets).tolist() if tail_of[k] != k}
    made = []
    for k, (i, j) in enumerate(zip(first.tolist(), last.tolist(), strict=True)):
        if k in swallowed:
            continue
        rows = [(i, j)]
        closed = bool(meets[k]) and tail_of[k] == k
        if meets[k] and not closed:
            t = tail_of[k]
            rows = [(int(first[t]), int(last[t])), (i, j)]
        parts = [np.concatenate([starts[c][a : a + 1], *(ends[c][a : b + 1] for a, b in rows)]) for c in range(3) for a in rows[0][:1]]
        line = int(path.line[i])
        made.append(
            Stroke(
                parts[0], parts[1], parts[2], int(found.segments.kind[line]), int(hidden_by[i]), int(found.segments.instance[line]), closed,
                np.concatenate([path.bridged[a : b + 1] for a, b in rows]),
            )
        )
    return made


def _simplified(strokes: list[Stroke]) -> list[Stroke]:
    """Without points that do not show."""
    if not strokes:
        return strokes
    count = np.array([len(stroke.depth) for stroke in strokes])
    shown = points_that_show(np.concatenate([stroke.picture for stroke in strokes]), count, _SAME)
    # Where parts begin and end that only go with their neighbours, so that no more is said of them than is true.
    bridged = np.concatenate([np.append(stroke.bridged, stroke.bridged[-1:]) for stroke in strokes])
    shown[1:] |= bridged[1:] != bridged[:-1]
    kept = np.split(shown, np.cumsum(count)[:-1])
    return [
        stroke._replace(
            picture=stroke.picture[rows], depth=stroke.depth[rows], world=stroke.world[rows],
            bridged=np.logical_or.reduceat(stroke.bridged, np.flatnonzero(rows)[:-1]),
        )
        for stroke, rows in zip(strokes, kept, strict=True)
    ]


def _points(found: Thrown, line: Indices, t: Floats, sight: SightLines) -> tuple[Floats, Floats, Floats]:
    """Places on lines: on the picture (n, 2), depth (n,), in the world (n, 3)."""
    a, b = found.lines[line, 0], found.lines[line, 1]
    at = np.where((t == 1.0)[:, None], b, a + t[:, None] * (b - a))
    # Even steps on the picture are no even steps in space (FoCG 11.3.1).
    s = t * b[:, 2] / at[:, 2] if sight.perspective else t
    start, end = found.segments.ends[line, 0], found.segments.ends[line, 1]
    world = np.where((t == 1.0)[:, None], end, start + s[:, None] * (end - start))
    return at[:, :2], sight.depth_of(at[:, 2]), world
