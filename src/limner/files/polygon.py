"""Polygons as files have them are cut where meshes are made: `limner.mesh.polygons`."""

from __future__ import annotations

from ..mesh.polygons import MAX_CLIPPED_CORNERS, triangulate

__all__ = ["MAX_CLIPPED_CORNERS", "triangulate"]
