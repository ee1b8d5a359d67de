"""The fans of polygons round a vertex, in order: where a limit surface has one tangent plane.

Round a smooth vertex there is one fan, which closes; sharp edges part the polygons round a vertex into several, each of which has a
normal of its own. A fan is walked by turning from a side to the one before it in the same polygon, and over to that side's twin.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .creases import Sharpness
from .faces import Faces, summed

__all__ = ["Sectors", "border_weights", "sectors_of", "unit_normals"]

Values = NDArray[np.float64]
Indices = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Sectors:
    """Fans of polygons.

    Attributes
    ----------
    of_corner : (h,) int64
        The fan that each corner is in.
    place : (h,) int64
        Which one of the fan it is, counter-clockwise.
    vertex, count : (s,) int64
        The vertex of each fan, and how many polygons are in it.
    closes : (s,) bool
        Whether the last polygon has a side in common with the first.
    first, last : (s,) int64
        The first and the last corner.
    """

    of_corner: Indices
    place: Indices
    vertex: Indices
    count: Indices
    closes: NDArray[np.bool_]
    first: Indices
    last: Indices


def sectors_of(faces: Faces, sharp: Sharpness) -> Sectors:
    """Find the fans that are left when the surface is cut along creases; where a single one ends in a vertex, that is smooth."""
    h = len(faces.vertex)
    is_cut = ((sharp.crease > 0.0) | (sharp.corner > 0.0))[faces.vertex]
    before = faces.preceding
    twin = np.where(is_cut & sharp.along[faces.edge_of], -1, faces.twin)
    # The corner that is next, counter-clockwise; -1: here the fan ends
    turned = np.where(is_cut & sharp.along[faces.edge_of[before]], -1, faces.twin[before])
    of_corner, place = np.full(h, -1, dtype=np.int64), np.zeros(h, dtype=np.int64)
    firsts, lasts, closes, n = [], [], [], 0
    # Fans with an end first; those without may begin anywhere, one of each vertex at a time
    begins = np.flatnonzero(twin < 0)
    while True:
        here, number = begins, n + np.arange(len(begins))
        last = begins.copy()
        step = 0
        while len(here):
            of_corner[here], place[here], last[number - n] = number, step, here
            onwards = turned[here]
            going = (onwards >= 0) & (of_corner[onwards] < 0)
            here, number, step = onwards[going], number[going], step + 1
        firsts.append(begins)
        lasts.append(last)
        closes.append(turned[last] == begins)
        n += len(begins)
        left = np.flatnonzero(of_corner < 0)
        if not len(left):
            break
        chosen = np.full(faces.n_vertices, -1, dtype=np.int64)
        chosen[faces.vertex[left[::-1]]] = left[::-1]
        begins = chosen[chosen >= 0]
    first, last = np.concatenate(firsts), np.concatenate(lasts)
    return Sectors(of_corner, place, faces.vertex[first].astype(np.int64), place[last] + 1, np.concatenate(closes), first, last)


def border_weights(eigenvalue: Values, at_ends: Values, at_vertex: Values) -> tuple[Values, Values]:
    """What the border's points weigh in the tangent across it.

    That tangent is a left eigenvector of the matrix that takes a vertex of a smooth border and what is around it through a step. Its
    weights within the fan, sin(i pi / k) on the spokes, are known; this solves the two rows that are left, with v' = 3/4 v + 1/8 both
    neighbours b on the border, and b' = (v + b) / 2.

    Parameters
    ----------
    eigenvalue : (s,) float64
    at_ends, at_vertex : (s,) float64
        What the inner weights give a neighbour on the border and the vertex in one step.

    Returns
    -------
    neighbour, vertex : (s,) float64
    """
    a, b = eigenvalue - 0.5, eigenvalue - 0.75
    determinant = a * b - 0.125
    return (b * at_ends + 0.125 * at_vertex) / determinant, (at_ends + a * at_vertex) / determinant


def unit_normals(sectors: Sectors, faces: Faces, points: Values, tangents: tuple[Values, Values]) -> Values:
    """The unit normals (s, 3) of fans with two tangents each, the second to the left of the first seen from outside.

    Where tangents vanish or are parallel that of the polygons stands in, weighted by area.
    """
    normals = _cross(*tangents)
    lengths = np.sqrt((normals * normals).sum(axis=1))
    scale = np.sqrt((tangents[0] ** 2).sum(axis=1) * (tangents[1] ** 2).sum(axis=1))
    sound = lengths > 1e-9 * scale
    normals *= (1.0 / np.where(sound, lengths, 1.0))[:, None]
    if not sound.all():
        corners = np.flatnonzero(~sound[sectors.of_corner])
        a, b, c = (points[faces.vertex[k]] for k in (faces.preceding[corners], corners, faces.following[corners]))
        flat = summed(sectors.of_corner[corners], _cross(c - b, a - b), len(normals))[~sound]
        sizes = np.linalg.norm(flat, axis=1, keepdims=True)
        normals[~sound] = np.where(sizes > 0.0, flat / np.where(sizes > 0.0, sizes, 1.0), (0.0, 0.0, 1.0))
    return normals


def _cross(p: Values, q: Values) -> Values:
    x, y, z = p.T
    a, b, c = q.T
    return np.stack([y * c - z * b, z * a - x * c, x * b - y * a], axis=1)
