"""The styles of drawings and of pictures, by name; as in `limner.artistic.style` and `limner.produce.stylized`, which need NumPy."""

from __future__ import annotations

__all__ = ["LINE_STYLES", "PICTURE_STYLES"]

LINE_STYLES = ("plain", "technical", "sketch", "xray", "chalk")
PICTURE_STYLES = ("gooch", "toon", "xray")
