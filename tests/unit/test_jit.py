"""The three modes: chosen by the environment, before import."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from typing import Any

import numpy as np
import pytest
from compiled import over

from limner import _jit
from limner.kernel import elementary


def _run(program: str, **environment: str) -> subprocess.CompletedProcess[str]:
    kept = {k: v for k, v in os.environ.items() if k not in ("LIMNER_MODE", "NUMBA_DISABLE_JIT")}
    return subprocess.run(
        [sys.executable, "-c", program], env={**kept, **environment}, capture_output=True, text=True, timeout=60, check=False
    )


def _mode(**environment: str) -> str:
    done = _run("from limner._jit import MODE; print(MODE)", **environment)
    return done.stdout.strip() or done.stderr.strip().splitlines()[-1]


def test_the_environment_chooses_the_mode() -> None:
    """LIMNER_MODE by name; NUMBA_DISABLE_JIT as Numba reads it; LIMNER_MODE wins; a slip is an error that lists the names."""
    assert _mode() == "compiled"
    assert _mode(NUMBA_DISABLE_JIT="1") == "python"
    assert _mode(NUMBA_DISABLE_JIT="0") == "compiled"
    assert _mode(LIMNER_MODE="traced", NUMBA_DISABLE_JIT="1") == "traced"
    assert "must be compiled, python or traced, got 'fast'" in _mode(LIMNER_MODE="fast")


_TRACE = """
import json
import numpy as np
from limner._jit import recording
from limner.kernel import elementary, vec

np.seterr(all="ignore")
vec.normalize(vec.Vec3(1, 2, 2))  # outside: not recorded
with recording() as calls:
    y = elementary.power(np.float32(2.0), np.float32(10.0))
    n = vec.reflect(vec.Vec3(1, -1, 0), vec.Vec3(0, 1, 0))
    with recording() as inner:
        vec.luminance(vec.Color(1, 1, 1))
    vec.length(vec.Vec3(3, 4, 0))

def plain(call):
    return {"name": call.name, "arguments": [str(a) for a in call.arguments], "result": str(call.result),
            "source": call.source, "calls": [plain(c) for c in call.calls]}

print(json.dumps({"calls": [plain(c) for c in calls], "inner": [plain(c) for c in inner],
                  "walk": [c.name for call in calls for c in call.walk()]}))
"""


@pytest.fixture(scope="module")
def trace() -> dict[str, Any]:
    """What a traced process recorded."""
    done = _run(_TRACE, LIMNER_MODE="traced")
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def test_a_trace_is_the_tree_of_calls(trace: dict[str, Any]) -> None:
    """power calls log2, then exp2; each with its arguments, its result and the first line of its docstring."""
    power = trace["calls"][0]
    assert power["name"] == "limner.kernel.elementary.power"
    assert power["arguments"] == ["2.0", "10.0"]
    assert power["result"] == "1024.0"
    assert power["source"].startswith("x^p for x >= 0")
    assert [(call["name"], call["arguments"], call["result"]) for call in power["calls"]] == [
        ("limner.kernel.elementary.log2", ["2.0"], "1.0"),
        ("limner.kernel.elementary.exp2", ["10.0"], "1024.0"),
    ]


def test_values_are_recorded_as_they_are_written(trace: dict[str, Any]) -> None:
    """Vectors read as vectors; the formula's source is there."""
    reflect = trace["calls"][1]
    assert reflect["arguments"] == ["Vec3(1.0, -1.0, 0.0)", "Vec3(0.0, 1.0, 0.0)"]
    assert reflect["result"] == "Vec3(1.0, 1.0, 0.0)"
    assert "FoCG 4.8" in reflect["source"]


def test_recordings_nest_and_end(trace: dict[str, Any]) -> None:
    """An inner recording keeps its calls to itself; the outer one goes on after it."""
    assert [call["name"] for call in trace["inner"]] == ["limner.kernel.vec.luminance"]
    assert [call["name"].rpartition(".")[2] for call in trace["calls"]] == ["power", "reflect", "length"]
    assert [name.rpartition(".")[2] for name in trace["walk"]] == ["power", "log2", "exp2", "reflect", "dot", "length", "dot"]


def test_recording_outside_the_traced_mode_stays_empty() -> None:
    """No cost and no record where kernels are not wrapped."""
    if _jit.MODE == "traced":
        pytest.skip("this is the traced mode")
    with _jit.recording() as calls:
        over(elementary.exp2, [1.0])
    assert calls == []


@pytest.mark.compiled
def test_a_compiled_kernel_refuses_to_be_called_from_python() -> None:
    """It has no entry for Python; the error says what to do.

    Bug: the stand-in that Numba insists on was `list.append`, and calling a kernel returned None. Fix: a stand-in that raises.
    """
    with pytest.raises(TypeError, match="sin is compiled into doors: call it from a kernel, or with LIMNER_MODE=python"):
        elementary.sin(np.float32(1.0))
