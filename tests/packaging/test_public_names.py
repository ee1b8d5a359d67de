"""`import limner`: what it offers, and how little it costs."""

from __future__ import annotations

import json
import subprocess
import sys

import pytest

import limner


def _modules_after(statements: str) -> set[str]:
    script = f"import json, sys\n{statements}\nprint(json.dumps(sorted(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    return set(json.loads(done.stdout.splitlines()[-1]))


def test_the_names_are_sorted_and_there() -> None:
    """`__all__` reads like an index, and each name leads to something documented."""
    assert sorted(limner.__all__) == limner.__all__
    assert set(limner.__all__) <= set(dir(limner))
    for name in limner.__all__:
        assert getattr(limner, name).__doc__, name


def test_an_unknown_name_is_an_attribute_error() -> None:
    """And not an ImportError from some room."""
    with pytest.raises(AttributeError, match="module 'limner' has no attribute 'rendre'"):
        _ = limner.rendre


def test_importing_limner_imports_neither_numpy_nor_the_compiler() -> None:
    """Names are loaded on first use."""
    assert not {"numpy", "numba", "llvmlite", "click", "PIL", "OpenEXR"} & _modules_after("import limner")


def test_describing_a_scene_and_holding_a_picture_never_import_the_compiler() -> None:
    """Every public name but `render` and `Renderer` stays clear of Numba and llvmlite."""
    names = ", ".join(name for name in limner.__all__ if name not in {"render", "Renderer"})
    assert not {"numba", "llvmlite", "PIL", "OpenEXR", "trimesh"} & _modules_after(f"from limner import {names}")


def test_render_stays_a_function() -> None:
    """Bug: importing the module `limner.render` puts it in the place of the function. Fix: the package puts it back."""
    checks = ("import limner.render", "assert callable(limner.render)", "from limner import render", "assert callable(render)")
    assert "limner.render" in _modules_after("\n".join(checks))


def test_the_doors_of_the_architecture_are_public() -> None:
    """What a program holds: one picture, many pictures, rays, a data set, cameras."""
    assert {"Camera", "Environment", "Image", "RayCaster", "Renderer", "Scene", "dataset", "load", "render"} <= set(limner.__all__)
