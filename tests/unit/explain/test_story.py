"""The parts of which a story is told: values, sources, chapters, the tree, and changes of sums."""

from __future__ import annotations

import json
import os
import subprocess
import sys

import numpy as np
import pytest

from limner.explain.chapters import chapter_of
from limner.explain.parameters import parameters_of
from limner.explain.sources import formula_of, source_of
from limner.explain.story import Step
from limner.explain.values import Names, plain, shortest, text_of
from limner.kernel.lanes import f32x8
from limner.kernel.vec import Color, Vec3
from limner.shading.dielectric import Interface
from limner.tables.layouts import MATERIAL

f32 = np.float32


def test_numbers_keep_their_bits() -> None:
    """The shortest decimal of a float32, parsed from JSON, is the same float32; what JSON cannot hold is a word that float() reads."""
    random = np.random.default_rng(0)
    numbers = random.integers(0, 2**32, 400, dtype=np.uint64).astype(np.uint32).view(f32)
    for number in [*numbers[np.isfinite(numbers)], f32(0.1), f32(-0.0), f32(np.inf)]:
        back = f32(float(json.loads(json.dumps(shortest(number)))))
        assert back.tobytes() == number.tobytes()


def test_lanes_are_trimmed_to_what_differs() -> None:
    """What repeats the last lane is padding; eight times the same number is that number; a vector of lanes is a list of vectors."""
    assert plain(f32x8([3.0] * 8)) == 3.0
    assert plain(f32x8([1.0, 2.0, 5.0, 5.0, 5.0, 5.0, 5.0, 5.0])) == {"lanes": [1.0, 2.0, 5.0]}
    assert plain(Vec3(f32x8([1.0, 2.0] + [2.0] * 6), f32(0.5), f32(0.25))) == {"lanes": [[1.0, 0.5, 0.25], [2.0, 0.5, 0.25]]}
    assert plain(Color(f32(0.1), f32(0.2), f32(0.3))) == [0.1, 0.2, 0.3]
    assert plain(np.zeros(3)) is None
    assert text_of([0.1, True, {"t": 2.0}]) == "(0.1, yes, t 2)"


def test_named_fields_and_rows_of_tables_are_called_by_name() -> None:
    """A NamedTuple becomes its fields; a record of a table, by where it stands, what the scene calls it."""
    table = np.zeros(3, dtype=MATERIAL)
    names = Names({"material": (table, ("clay", "gold"))})
    assert [plain(table[k], names) for k in range(3)] == ["material 0 (clay)", "material 1 (gold)", "material 2"]
    assert plain(np.zeros(1, dtype=MATERIAL)[0], names) is None
    up = Vec3(0.0, 1.0, 0.0)
    assert plain(Interface(up, f32(0.25), up, f32(0.75)))["reflectance"] == 0.25


@pytest.mark.parametrize(
    ("kernel", "source"),
    [
        ("limner.shading.phong.eval_blinn_phong", "FoCG 4.5.2, 10.2"),
        ("limner.shading.fresnel.schlick", "FoCG 13.1"),
        ("limner.accel.walk.first_hit", "FoCG 12.3"),
        ("limner.raster.fragment._shade", "FoCG 8"),
    ],
)
def test_kernels_name_their_source(kernel: str, source: str) -> None:
    """Its own citation, else its module's, else its room's chapter."""
    assert source_of(kernel).startswith(source)


def test_a_formula_is_the_kernels_own_sentence() -> None:
    """Of one that is not there nothing is said, and nothing fails."""
    assert formula_of("limner.shading.microfacet.ggx_distribution") == "D = a^2 / (pi ((n.h)^2 (a^2 - 1) + 1)^2)"
    assert formula_of("limner.shading.microfacet.nothing_of_the_kind") == ""
    assert formula_of("limner.no_room.at_all") == ""


def test_unknown_kernels_are_folded_and_unknown_lobes_are_told() -> None:
    """A new lobe needs no line in the table; a new helper elsewhere is folded; what is machinery is hidden."""
    lobe = chapter_of("limner.shading.velvet.eval_velvet")
    assert lobe is not None
    assert not lobe.is_hidden
    assert chapter_of("limner.raytrace.whitted._new_helper") is None
    assert chapter_of("limner.shading.velvet._new_helper") is None
    hidden = chapter_of("limner.kernel.sampler.draw_2d")
    assert hidden is not None
    assert hidden.is_hidden


def test_a_tree_is_told_as_text_and_comes_back_from_plain_values() -> None:
    """Depth cuts; a source that was told just above is not repeated; the sum of a change needs none."""
    leaf = Step("total", {"was": [0.0, 0.0, 0.0]}, [1.0, 0.5, 0.25], "total = total + light", "raytrace.path:9", "FoCG 23", "change")
    hit = Step("a hit", source="FoCG 23", steps=[leaf])
    root = Step("a path", {}, 1.0, "L = E + T L", "raytrace.path.path_radiance", "FoCG 23", steps=[hit])
    assert root.text().splitlines() == [
        "a path = 1 — L = E + T L (FoCG 23)",
        "└─ a hit",
        "   └─ total = (1, 0.5, 0.25) [was (0, 0, 0)] — total = total + light",
    ]
    assert root.text(1).count("\n") == 1
    assert [step.title for step in root.walk()] == ["a path", "a hit", "total"]
    assert Step.from_dict(json.loads(json.dumps(root.as_dict()))) == root


_WATCHED = """
import json
import numpy as np
from limner._jit import kernel
from limner.explain.watch import watch
from limner.kernel.vec import ONE, ZERO, Color

@kernel
def light(k):
    return Color(ONE * np.float32(k), ZERO, ZERO)

@kernel
def gather(n):
    total = Color(ZERO, ZERO, ZERO)
    for k in range(n):
        total = (
            total
            + light(k)
        )
    return total

@kernel
def outer(n):
    return gather(n)

record = watch(outer, (3,), (gather,))
(top,) = record.calls
(inner,) = top.calls
changes = record.changes[id(inner)]
print(json.dumps({
    "names": [top.name, inner.name, *(call.name for call in inner.calls)],
    "places": [change.place for change in changes],
    "values": [float(change.value.r) for change in changes],
    "is_last_the_result": changes[-1].value is inner.result,
}))
"""


def test_changes_of_a_sum_stand_between_the_calls_that_made_them() -> None:
    """Each new value of `total` is written down after the call that it came from, and the last is what the kernel returned."""
    done = subprocess.run(
        [sys.executable, "-c", _WATCHED], env={**os.environ, "LIMNER_MODE": "traced"}, capture_output=True, text=True, check=True
    )
    told = json.loads(done.stdout)
    assert told["names"] == ["__main__.outer", "__main__.gather", "__main__.light", "__main__.light", "__main__.light"]
    assert told["places"] == [0, 1, 2, 3]
    assert told["values"] == [0.0, 0.0, 1.0, 3.0]
    assert told["is_last_the_result"]


def test_who_asks_never_imports_the_compiler() -> None:
    """The names of kernels' arguments are read off their sources; only the process that traces imports kernels."""
    script = (
        "import sys; import limner.explain.explain, limner.explain.doctor; from limner.explain.parameters import parameters_of; "
        "print(parameters_of('limner.raytrace.tile.trace_tile_exact')[:2], sorted({'numba', 'llvmlite', 'PIL'} & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "('instances', 'meshes') []"
    assert parameters_of("limner.raytrace.tile.nothing") == ()
    assert parameters_of("limner.no_room.at_all") == ()
