"""All that fields of distances are made of, under their own names; some of them are those of exact shapes, too.

    from limner.scene import distance

    ring = distance.Torus(0.8, 0.2) - distance.Box((0.3, 1, 3))
    blob = distance.Union(ring, distance.Sphere(0.4), radius=0.3)
    shape = Shape(DistanceField(blob), (Dielectric(ior=1.5),))

What they are: `limner.scene.distance_field`. The leaves: `limner.scene.distance_leaves`.
"""

from __future__ import annotations

from .distance_field import (
    Difference,
    Distance,
    DistanceField,
    Elongated,
    Intersection,
    Mirrored,
    Offset,
    Placed,
    Repeated,
    Shell,
    Twisted,
    Union,
)
from .distance_leaves import (
    Box,
    Capsule,
    Cone,
    Cylinder,
    Ellipsoid,
    Gyroid,
    MengerSponge,
    Octahedron,
    Plane,
    QuaternionJulia,
    RoundedBox,
    Segment,
    Sphere,
    Torus,
)

__all__ = [
    "Box",
    "Capsule",
    "Cone",
    "Cylinder",
    "Difference",
    "Distance",
    "DistanceField",
    "Ellipsoid",
    "Elongated",
    "Gyroid",
    "Intersection",
    "MengerSponge",
    "Mirrored",
    "Octahedron",
    "Offset",
    "Placed",
    "Plane",
    "QuaternionJulia",
    "Repeated",
    "RoundedBox",
    "Segment",
    "Shell",
    "Sphere",
    "Torus",
    "Twisted",
    "Union",
]  # fmt: skip
