"""Fields of distances for tests: one of each kind, and some that are made of many."""

from __future__ import annotations

from limner.linear.transform import in_order, rotate, scale, translate
from limner.scene import distance
from limner.scene.distance import Distance

__all__ = ["FIELDS", "INFINITE"]

_BALL, _BLOCK, _RING = distance.Sphere(0.8), distance.Box((1.0, 0.6, 1.4)), distance.Torus(0.7, 0.25)

INFINITE: dict[str, Distance] = {
    "plane": distance.Plane(),
    "gyroid": distance.Gyroid(0.9, 0.15),
    "half of space": distance.Gyroid(1.1, 0.0),
    "lattice": distance.Sphere(0.2).translated(0.05, 0.0, 0.0).repeated((0.6, 0.7, 0.5)),
    "mirrored lattice": distance.Cone(0.2, 0.4).translated(0.05, 0.0, 0.1).repeated((0.6, 0.0, 0.5), alternating=True),
}
"""What has no end."""

FIELDS: dict[str, Distance] = {
    "ball": _BALL,
    "block": _BLOCK,
    "rounded block": distance.RoundedBox((1.0, 0.6, 1.4), 0.2),
    "ring": _RING,
    "segment": distance.Segment((-0.5, 0.1, 0.2), (0.6, 0.4, -0.3), 0.2),
    "point": distance.Segment((0.1, 0.1, 0.2), (0.1, 0.1, 0.2), 0.5),
    "capsule": distance.Capsule(0.3, 1.4),
    "cylinder": distance.Cylinder(0.6, 1.1),
    "cone": distance.Cone(0.7, 1.2),
    "frustum": distance.Cone(0.4, 1.0, 0.7),
    "ellipsoid": distance.Ellipsoid((0.9, 0.4, 0.6)),
    "octahedron": distance.Octahedron(0.9),
    "sponge": distance.MengerSponge(1.6, 3),
    "julia": distance.QuaternionJulia((-0.2, 0.6, 0.2, 0.2), 8),
    "union": _BALL | _BLOCK | _RING,
    "intersection": _BALL & _BLOCK,
    "difference": _BALL - _BLOCK - _RING,
    "smooth union": distance.Union(_BALL, _BLOCK, _RING, radius=0.3),
    "smooth intersection": distance.Intersection(_BALL, _BLOCK, radius=0.2),
    "smooth difference": distance.Difference(_BALL, _BLOCK, radius=0.2),
    "grown": _BLOCK.offset(0.15),
    "shrunk": _BLOCK.offset(-0.1),
    "shell": (_BALL - distance.Box(1.0).translated(0.5, 0.5, 0.5)).shell(0.1),
    "placed": _BLOCK.placed(in_order(scale(0.7, 0.7, -0.7), rotate((1, 2, 3), 0.8), translate(0.2, -0.3, 0.1))),
    "elongated": distance.Cone(0.4, 0.6).elongated(0.3, 0.0, 0.5),
    "mirrored": _RING.translated(0.5, 0.2, 0.0).mirrored("xz"),
    "row": distance.Cone(0.2, 0.5).repeated((0.4, 0.0, 0.5), (4, 1, 3)),
    "mirrored row": distance.Cone(0.2, 0.4).translated(0.0, 0.0, 0.05).repeated((0.0, 0.4, 0.5), (1, 3, 2), alternating=True),
    "rows of rows": distance.Sphere(0.1).repeated((0.25, 0.3, 0.0), (2, 2, 1)).repeated((0.0, 0.8, 0.9), (1, 2, 2)),
    "twisted": distance.RoundedBox((0.8, 1.8, 0.5), 0.1).twisted(80.0),
    **{f"{name} in a ball": field & distance.Sphere(1.2) for name, field in INFINITE.items()},
}
"""What has an end."""
