"""A BSP tree over triangles in space, built and walked (FoCG 12.4; Fuchs, Kedem and Naylor 1980).

A fragment is a convex part of a triangle: FIRST and COUNT of its vertices, its TRIANGLE, the last of its cuts (PARENT links them), how
many CUTS there are, and the NEXT fragment in its list. A node's plane is that of one of its triangles; fragments in the plane stay with
the node, the others go to the front or the back, and what crosses the plane is cut in two.
"""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ..tables.layouts import PERSPECTIVE
from .assemble import screen_plane
from .fill import vertices_of

__all__ = ["build_tree", "rank_triangles", "walk_tree"]

f32, f64 = np.float32, np.float64
_ZERO = f64(0.0)
FIRST, COUNT, TRIANGLE, CUTS, LAST_CUT, NEXT = 0, 1, 2, 3, 4, 5
FRONT, BACK, LIST, PLANE = 0, 1, 2, 3
CUT_TRIANGLE, CUT_SIDE, CUT_PARENT = 0, 1, 2
_CANDIDATES = 7
_SPLIT_COST = 8  # how many fragments of imbalance one more cut is worth
_ON, _BEFORE, _BEHIND, _ACROSS = 0, 1, 2, 3


@kernel
def _distance(planes, plane: int, points, row: int) -> np.float64:
    return planes[plane, 0] * points[row, 0] + planes[plane, 1] * points[row, 1] + planes[plane, 2] * points[row, 2] + planes[plane, 3]


@kernel
def _side_of(fragments, fragment: int, points, planes, plane: int, tolerance: np.float64) -> int:
    """On which side of a plane a fragment lies; what is nearer than the tolerance lies on it."""
    low, high = _ZERO, _ZERO
    first = fragments[fragment, FIRST]
    for row in range(first, first + fragments[fragment, COUNT]):
        d = _distance(planes, plane, points, row)
        low, high = min(low, d), max(high, d)
    if low >= -tolerance:
        return _ON if high <= tolerance else _BEFORE
    return _BEHIND if high <= tolerance else _ACROSS


@kernel
def _nth(fragments, head: int, n: int) -> int:
    for _ in range(n):
        head = fragments[head, NEXT]
    return head


@kernel
def _largest(fragments, head: int, areas) -> int:
    best, f = head, head
    while f >= 0:
        if areas[fragments[f, TRIANGLE]] > areas[fragments[best, TRIANGLE]]:
            best = f
        f = fragments[f, NEXT]
    return best


@kernel
def _choose(fragments, head: int, points, planes, areas, tolerance: np.float64, seed: int) -> int:
    """The fragment whose plane cuts few others and leaves the halves alike: the best of some, the largest always among them."""
    length, f = 0, head
    while f >= 0:
        length += 1
        f = fragments[f, NEXT]
    best, best_cost = head, -1
    for k in range(min(_CANDIDATES, length)):
        candidate = _largest(fragments, head, areas) if k == 0 else _nth(fragments, head, (seed * 40503 + k * 30011) % length)
        plane = fragments[candidate, TRIANGLE]
        before, behind, across, f = 0, 0, 0, head
        while f >= 0:
            side = _side_of(fragments, f, points, planes, plane, tolerance)
            before += 1 if side == _BEFORE else 0
            behind += 1 if side == _BEHIND else 0
            across += 1 if side == _ACROSS else 0
            f = fragments[f, NEXT]
        cost = _SPLIT_COST * across + abs(before - behind)
        if best_cost < 0 or cost < best_cost:
            best, best_cost = candidate, cost
    return best


@kernel
def _cut_half(fragments, fragment: int, points, planes, plane: int, sign: np.float64, tolerance: np.float64, place: int) -> int:
    """Write the part of a fragment on one side of a plane from `place` on. Returns its number of vertices."""
    first, n = fragments[fragment, FIRST], fragments[fragment, COUNT]
    count = 0
    for k in range(n):
        i, j = first + k, first + (k + 1 if k + 1 < n else 0)
        da, db = sign * _distance(planes, plane, points, i), sign * _distance(planes, plane, points, j)
        if da >= -tolerance:
            for c in range(3):
                points[place + count, c] = points[i, c]
            count += 1
        if (da > tolerance and db < -tolerance) or (da < -tolerance and db > tolerance):
            t = da / (da - db)
            for c in range(3):
                points[place + count, c] = points[i, c] + t * (points[j, c] - points[i, c])
            count += 1
    return count


@kernel
def build_tree(triangles, planes, areas, tolerance, points, fragments, cuts, nodes, stack, used):
    """Build the tree over triangles (n, 3, 3), their planes (n, 4) and areas (n,).

    Fills points (p, 3), fragments (f, 6), cuts (c, 3: of which triangle's plane, side, the cut before), nodes (f, 4: front, back, first
    fragment, triangle); stack (f + 1, 3) is scratch. used: how many (points, fragments, cuts, nodes), and 1 in [4] if there was no room.
    """
    n = triangles.shape[0]
    for k in range(n):
        for i in range(3):
            for c in range(3):
                points[3 * k + i, c] = triangles[k, i, c]
        fragments[k, FIRST], fragments[k, COUNT], fragments[k, TRIANGLE] = 3 * k, 3, k
        fragments[k, CUTS], fragments[k, LAST_CUT], fragments[k, NEXT] = 0, -1, k + 1 if k + 1 < n else -1
    n_points, n_fragments, n_cuts, n_nodes = 3 * n, n, 0, 0
    used[4] = 0
    stack[0, 0], stack[0, 1], stack[0, 2] = 0, -1, FRONT
    top = 1 if n > 0 else 0
    while top > 0:
        top -= 1
        head, parent, child = stack[top, 0], stack[top, 1], stack[top, 2]
        splitter = _choose(fragments, head, points, planes, areas, tolerance, n_nodes)
        plane = fragments[splitter, TRIANGLE]
        node = n_nodes
        n_nodes += 1
        nodes[node, FRONT], nodes[node, BACK], nodes[node, LIST], nodes[node, PLANE] = -1, -1, -1, plane
        if parent >= 0:
            nodes[parent, child] = node
        front, front_end, back, back_end = -1, -1, -1, -1
        f = head
        while f >= 0:
            following = fragments[f, NEXT]
            fragments[f, NEXT] = -1
            side = _ON if f == splitter else _side_of(fragments, f, points, planes, plane, tolerance)
            behind = f
            if side == _ACROSS:
                count = fragments[f, COUNT]
                if n_points + 2 * count + 4 > points.shape[0] or n_fragments + 1 > fragments.shape[0] or n_cuts + 2 > cuts.shape[0]:
                    used[4] = 1
                    return
                behind = n_fragments
                n_fragments += 1
                n_before = _cut_half(fragments, f, points, planes, plane, f64(1.0), tolerance, n_points)
                n_behind = _cut_half(fragments, f, points, planes, plane, f64(-1.0), tolerance, n_points + n_before)
                for s in range(2):
                    cuts[n_cuts + s, CUT_TRIANGLE], cuts[n_cuts + s, CUT_SIDE] = plane, 1 - 2 * s
                    cuts[n_cuts + s, CUT_PARENT] = fragments[f, LAST_CUT]
                fragments[behind, FIRST], fragments[behind, COUNT] = n_points + n_before, n_behind
                fragments[behind, TRIANGLE], fragments[behind, CUTS] = fragments[f, TRIANGLE], fragments[f, CUTS] + 1
                fragments[behind, LAST_CUT], fragments[behind, NEXT] = n_cuts + 1, -1
                fragments[f, FIRST], fragments[f, COUNT] = n_points, n_before
                fragments[f, CUTS], fragments[f, LAST_CUT] = fragments[f, CUTS] + 1, n_cuts
                n_points += n_before + n_behind
                n_cuts += 2
            if side == _ON:
                # Later ones first: of what lies in one plane the first of the scene shall be on top.
                fragments[f, NEXT] = nodes[node, LIST]
                nodes[node, LIST] = f
            if side in (_BEFORE, _ACROSS):
                if front < 0:
                    front = f
                else:
                    fragments[front_end, NEXT] = f
                front_end = f
            if side in (_BEHIND, _ACROSS):
                if back < 0:
                    back = behind
                else:
                    fragments[back_end, NEXT] = behind
                back_end = behind
            f = following
        if front >= 0:
            stack[top, 0], stack[top, 1], stack[top, 2] = front, node, FRONT
            top += 1
        if back >= 0:
            stack[top, 0], stack[top, 1], stack[top, 2] = back, node, BACK
            top += 1
    used[0], used[1], used[2], used[3] = n_points, n_fragments, n_cuts, n_nodes


@kernel
def walk_tree(nodes, fragments, planes, eye, stack, order, used):
    """Fill `order` with the fragments from back to front as seen from `eye`: (x, y, z, 1), or (direction to it, 0). used[0]: how many.

    Behind a plane lies all that is on the other side than the eye: first that side, then what is in the plane, then the eye's side.
    **Source**: Fuchs, Kedem and Naylor, *On visible surface generation by a priori tree structures*, 1980.
    """
    count, top = 0, 0
    if nodes.shape[0] > 0:
        stack[0, 0], stack[0, 1] = 0, 0
        top = 1
    while top > 0:
        top -= 1
        node, far_is_done = stack[top, 0], stack[top, 1] != 0
        plane = nodes[node, PLANE]
        d = planes[plane, 0] * eye[0] + planes[plane, 1] * eye[1] + planes[plane, 2] * eye[2] + planes[plane, 3] * eye[3]
        near, far = (nodes[node, FRONT], nodes[node, BACK]) if d >= _ZERO else (nodes[node, BACK], nodes[node, FRONT])
        if not far_is_done:
            stack[top, 0], stack[top, 1] = node, 1
            top += 1
            if far >= 0:
                stack[top, 0], stack[top, 1] = far, 0
                top += 1
            continue
        f = nodes[node, LIST]
        while f >= 0:
            order[count] = f
            count += 1
            f = fragments[f, NEXT]
        if near >= 0:
            stack[top, 0], stack[top, 1] = near, 0
            top += 1
    used[0] = count


@kernel
def _write_cut(cuts, place: int, value: np.float64, slope_x: np.float64, slope_y: np.float64, side: int):
    cut = cuts[place]
    cut["value"], cut["slope_x"], cut["slope_y"], cut["side"] = value, slope_x, slope_y, side


@kernel
def rank_triangles(
    instances, meshes, triangles, camera_table, vertices, first_vertex, fragment_of, world, planes, fragments, boxes, tree_cuts, screen,
    cuts, used,
):  # fmt: skip
    """Give screen triangles, in the order of drawing, their rank for depth and the cuts that bound their fragments.

    fragment_of (n,): of each screen triangle, -1: it is whole. boxes (f, 4): around the fragments on the
    screen, (low x, low y, high x, high y) on the subpixel grid. used[0]: how many cuts. What reaches beyond the far plane is cut there.
    """
    camera = camera_table[0]
    near, far = f64(camera["near"]), f64(camera["far"])
    count = 0
    for k in range(screen.shape[0]):
        row = screen[k]
        a, b, c = vertices_of(row, instances, meshes, triangles, vertices, first_vertex)
        xr, yr = np.int64(row["x_reference"]), np.int64(row["y_reference"])
        start = count
        if f64(a[2]) > far or f64(b[2]) > far or f64(c[2]) > far:
            farthest = near / far if camera["kind"] == PERSPECTIVE else _ZERO
            _write_cut(cuts, count, f64(row["z"]) - farthest, f64(row["dzdx"]), f64(row["dzdy"]), 1)
            count += 1
        fragment = fragment_of[k]
        if fragment >= 0:
            for axis in range(2):
                row["low"][axis] = max(row["low"][axis], boxes[fragment, axis])
                row["high"][axis] = min(row["high"][axis], boxes[fragment, 2 + axis])
        link = fragments[fragment, LAST_CUT] if fragment >= 0 else -1
        while link >= 0:
            own, plane = fragments[fragment, TRIANGLE], tree_cuts[link, CUT_TRIANGLE]
            corners = world[own]
            ra, rb, rc = _distance(planes, plane, corners, 0), _distance(planes, plane, corners, 1), _distance(planes, plane, corners, 2)
            fits, value, slope_x, slope_y = screen_plane(a, b, c, ra, rb, rc, xr, yr)
            if fits:
                _write_cut(cuts, count, value, slope_x, slope_y, np.int64(tree_cuts[link, CUT_SIDE]))
                count += 1
            link = tree_cuts[link, CUT_PARENT]
        row["first_cut"], row["n_cuts"] = start, count - start
        # Later is nearer: with its rank for depth, each triangle is drawn over all before it.
        row["z"], row["dzdx"], row["dzdy"] = f32(k + 1), f32(0.0), f32(0.0)
    used[0] = count
