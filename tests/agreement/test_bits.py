"""What cannot change a bit of a picture: threads, tiles, the mode kernels run in, the CPU they are compiled for."""

from __future__ import annotations

import importlib.util
import json
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from limner.aov import CHANNELS
from limner.render import render
from limner.scene.library import builtin

_PROGRAM = Path(__file__).with_name("fingerprint.py")
_GENERIC = {"limner.kernel.transform.transform_vector": 2, "limner.accel.walk.exact_tables": 2}  # (3, 4) and (3, 3) matrices; below
# Fragments are shaded with and without shadows, by doors of their own.
_GENERIC |= dict.fromkeys(
    [f"limner.raster.fragment.{name}" for name in ("_shade", "_gouraud", "_shade_eight", "shade_fragments")]
    + [f"limner.raster.tile.{name}" for name in ("_supersample", "_multisample", "_expose", "_draw")],
    2,
)
# Batches of float32 and of float64 rays have doors of their own, so that nothing is converted; what rays look at is counted or not.
_GENERIC |= dict.fromkeys(
    [f"limner.accel.ray_block.{name}" for name in ("put_rays", "_gather", "_put_three")]
    + [f"limner.accel.{name}" for name in ("batch_kernel._trace_block", "near_ray.near_ray", "flight.follow_rays")],
    2,
)
# What doors for scenes of all exact shapes pass on, where those for triangles, spheres and planes have None
_TABLES = [f"Array({kind}, {n}, 'C', False, aligned=True)" for kind, n in (("float32", 1), ("int32", 1), ("float64", 2))]
_EXACT = f"Tuple(({', '.join(_TABLES)}))"


def _small_scene() -> Any:
    spec = importlib.util.spec_from_file_location("picture_fingerprint", _PROGRAM)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.small_scene()


def _fingerprint(*words: str, **environment: str) -> dict[str, Any]:
    cleared = ("LIMNER_MODE", "NUMBA_DISABLE_JIT", "NUMBA_CPU_NAME", "NUMBA_CPU_FEATURES")
    kept = {name: value for name, value in os.environ.items() if name not in cleared}
    done = subprocess.run(
        [sys.executable, str(_PROGRAM), *words], env={**kept, **environment}, capture_output=True, text=True, timeout=600, check=False
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def _where_they_differ(types: list[str]) -> str:
    """The arguments, counted from 0, that have several types, shortened: records are long."""
    outer = [re.split(r", (?![^(\[{]*[)\]}])", kind) for kind in types]
    columns = [sorted({kind[-40:] for kind in column}) for column in zip(*outer, strict=False)]
    return "; ".join(f"{len(types)} times, such as {' | '.join(kinds)}" for kinds in columns if len(kinds) > 1)[:300]


@pytest.fixture(scope="module")
def as_python() -> dict[str, Any]:
    """The reference: the kernels as they are written."""
    found = _fingerprint(LIMNER_MODE="python")
    assert found["mode"] == "python"
    return found["pictures"]


@pytest.fixture(scope="module")
def for_any_cpu(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """Everything compiled anew for the plainest CPU of the family."""
    folder = str(tmp_path_factory.mktemp("compiled"))
    return _fingerprint("--warm-up", NUMBA_CPU_NAME="generic", LIMNER_CACHE_DIR=folder)


@pytest.mark.compiled
def test_compiled_is_python(as_python):
    """Both renderers, every channel, with the instructions that this CPU has."""
    found = _fingerprint()
    assert found["mode"] == "compiled"
    assert found["pictures"] == as_python


@pytest.mark.compiled
def test_every_cpu_computes_the_same(as_python, for_any_cpu):
    """Without AVX and fused multiply-add too."""
    assert for_any_cpu["pictures"] == as_python


def _of_one(types: str) -> str:
    """A signature with the lanes as if they were numbers, and exact shapes as if there were none; those of other materials are one."""
    if re.search(r"has_layers|only_matte|Layers(x8)?\(", types):
        return "layered"
    types = types.replace(_EXACT, "none")
    kinds = (("f32x8", "float32"), ("f64x8", "float64"), ("i32x8", "int64"), ("i64x8", "int64"), ("bool8", "bool"))
    kinds = (*kinds, ("3x8", "3"), ("rx8", "r"))  # Vec3x8, Colorx8
    for lanes, number in kinds:
        types = types.replace(lanes, number)
    return re.sub(r"(\w+) x (\d+)", lambda many: ", ".join([many[1]] * int(many[2])), types)


def test_tracing_changes_nothing(as_python):
    assert _fingerprint(LIMNER_MODE="traced")["pictures"] == as_python


@pytest.mark.compiled
def test_kernels_are_compiled_once(for_any_cpu, record_property):
    """A kernel that is called with int32 here and int64 there is compiled twice, and so is all below it: a slip of types.

    Once for numbers and once for lanes is what the shading is made for, with exact shapes and without what the ray tracers are; what
    layered materials and matte ones ask for is not counted. Those that take tables of several kinds by design are named in `_GENERIC`.
    """
    found = for_any_cpu["signatures"]
    record_property("kernels", len(found))
    record_property("seconds", for_any_cpu["seconds"])
    assert len(found) > 60
    twice = {
        name: types for name, types in found.items() if len({_of_one(kind) for kind in types} - {"layered"}) > _GENERIC.get(name, 1)
    }
    assert not twice, "".join(f"\n{name}: {_where_they_differ(types)}" for name, types in twice.items())


@pytest.mark.compiled
@pytest.mark.parametrize("renderer", ["raster", "ray"])
def test_threads_and_tiles_change_nothing(renderer):
    """A picture and its channels are the same bits on 1, 2 and 7 threads, in tiles of 16, 64 and 100 pixels."""
    for scene in (_small_scene(), builtin("cornell")):
        images = [
            render(scene, width=150, height=110, renderer=renderer, samples=2, threads=threads, tile_size=tile, aovs=CHANNELS)
            for threads, tile in ((1, 64), (2, 16), (7, 100), (7, 16))
        ]
        for image in images[1:]:
            np.testing.assert_array_equal(image.pixels, images[0].pixels)
            for name in CHANNELS:
                np.testing.assert_array_equal(image.aov[name], images[0].aov[name])


@pytest.mark.compiled
@pytest.mark.parametrize("renderer", ["raster", "ray"])
def test_rendering_twice_is_rendering_once(renderer):
    """No state is left between pictures, and the camera's place in a larger picture's tiles is none either."""
    scene = _small_scene()
    first = render(scene, width=60, height=40, renderer=renderer, samples=3)
    render(builtin("teapot"), width=31, height=17, renderer=renderer, samples=1)
    np.testing.assert_array_equal(render(scene, width=60, height=40, renderer=renderer, samples=3).pixels, first.pixels)
