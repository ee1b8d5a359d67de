"""A second picture on a machine starts without the compiler: its kernels are loaded as machine code."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

_RENDER = """
import json, sys
import limner
scene = limner.Scene(limner.Node("world", shapes=(limner.Shape(limner.Sphere(1.0)),)))
limner.render(scene, width=16, height=16, renderer=sys.argv[1]).save("a.png")
print(json.dumps(sorted(sys.modules)))
"""


def _loaded(renderer: str, folder: Path, cache: Path) -> set[str]:
    done = subprocess.run(
        [sys.executable, "-W", "ignore", "-c", _RENDER, renderer],
        cwd=folder, env={**os.environ, "LIMNER_CACHE_DIR": str(cache)}, capture_output=True, text=True, check=True,
    )  # fmt: skip
    return set(json.loads(done.stdout.splitlines()[-1]))


@pytest.mark.compiled
@pytest.mark.parametrize("renderer", ["raster", "ray"])
def test_a_warm_run_never_imports_numba(tmp_path: Path, renderer: str) -> None:
    """The first run, with an empty cache, compiles; the second loads what the first kept, and only that."""
    cache = tmp_path / "cache"
    assert "numba" in _loaded(renderer, tmp_path, cache)
    warm = _loaded(renderer, tmp_path, cache)
    assert "llvmlite" in warm
    heavy = {"numba", "PIL", "OpenEXR", "click", "rich", "scipy", "trimesh"}
    assert not heavy & warm


def test_code_for_any_processor_does_not_know_this_one(monkeypatch: pytest.MonkeyPatch) -> None:
    """Told to compile for a generic processor, a cache is named alike on all machines; otherwise each kind has files of its own."""
    import llvmlite.binding

    from limner import _door

    def keys() -> tuple[bytes, bytes]:
        here = _door._machine()
        with monkeypatch.context() as elsewhere:
            elsewhere.setattr(llvmlite.binding, "get_host_cpu_name", lambda: "another")
            return here, _door._machine()

    monkeypatch.delenv("NUMBA_CPU_NAME", raising=False)
    here, there = keys()
    assert here != there
    monkeypatch.setenv("NUMBA_CPU_NAME", "generic")
    generic_here, generic_there = keys()
    assert generic_here == generic_there != here
