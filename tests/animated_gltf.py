"""Animations in the glTF files that tests write."""

from __future__ import annotations

from typing import Any

__all__ = ["TRIANGLE", "channel", "pointer"]

TRIANGLE = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]


def channel(writer: Any, target: dict[str, Any], times: Any, values: Any, interpolation: str = "LINEAR", **fields: Any) -> None:
    """Add a channel to the document's only animation."""
    animation = writer.document.setdefault("animations", [{"name": "go", "samplers": [], "channels": []}])[0]
    sampler = {"input": writer.accessor(times), "output": writer.accessor(values, **fields), "interpolation": interpolation}
    animation["samplers"].append(sampler)
    animation["channels"].append({"sampler": len(animation["samplers"]) - 1, "target": target})


def pointer(path: str) -> dict[str, Any]:
    """The target of KHR_animation_pointer."""
    return {"path": "pointer", "extensions": {"KHR_animation_pointer": {"pointer": path}}}
