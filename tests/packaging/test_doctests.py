"""The examples in docstrings are true."""

from __future__ import annotations

import doctest
import importlib
import pkgutil

import pytest

import limner

_KERNEL_ROOMS = ("kernel", "intersect", "accel", "shading", "raytrace", "raster")  # kernels cannot be called from Python


def _modules() -> list[str]:
    names = (module.name for module in pkgutil.walk_packages(limner.__path__, "limner."))
    return ["limner", *(name for name in names if name.split(".")[1] not in (*_KERNEL_ROOMS, "__main__"))]


@pytest.mark.parametrize("name", _modules())
def test_examples_are_true(name: str) -> None:
    """Each example gives what it says it gives."""
    assert doctest.testmod(importlib.import_module(name), optionflags=doctest.NORMALIZE_WHITESPACE).failed == 0
