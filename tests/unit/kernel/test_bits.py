"""The same bits in every mode and on every CPU: what all pictures' reproducibility rests on.

Each kernel of this room answers some thousand questions, edges included, in processes of their own: compiled for this CPU,
compiled for the plainest of its family, as Python, and traced.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

_PROGRAM = Path(__file__).with_name("fingerprint.py")


def _fingerprint(**environment: str) -> dict[str, str]:
    cleared = ("LIMNER_MODE", "NUMBA_DISABLE_JIT", "NUMBA_CPU_NAME", "NUMBA_CPU_FEATURES")
    kept = {name: value for name, value in os.environ.items() if name not in cleared}
    done = subprocess.run(
        [sys.executable, str(_PROGRAM)], env={**kept, **environment}, capture_output=True, text=True, timeout=300, check=False
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


@pytest.fixture(scope="module")
def as_python() -> dict[str, str]:
    """The reference: the kernels as they are written."""
    return _fingerprint(LIMNER_MODE="python")


@pytest.mark.compiled
@pytest.mark.parametrize("cpu", ["", "generic"])
def test_compiled_is_python_to_the_bit(as_python: dict[str, str], cpu: str) -> None:
    """With AVX and fused multiply-add at hand, and without either."""
    assert _fingerprint(**({"NUMBA_CPU_NAME": cpu} if cpu else {})) == as_python


def test_tracing_changes_nothing(as_python: dict[str, str]) -> None:
    """What explains a pixel computes the same pixel."""
    assert _fingerprint(LIMNER_MODE="traced") == as_python
