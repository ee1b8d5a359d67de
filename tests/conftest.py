"""What all tests share: how Hypothesis searches, and a `limner` process to talk to."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable, Mapping
from pathlib import Path

import hypothesis
import pytest

hypothesis.settings.register_profile("limner", deadline=None, derandomize="CI" in os.environ, max_examples=50)
hypothesis.settings.load_profile("limner")

Finished = subprocess.CompletedProcess[str]


def _kernels_run_as_python() -> bool:
    mode = os.environ.get("LIMNER_MODE", "")
    return mode in ("python", "traced") or (not mode and os.environ.get("NUMBA_DISABLE_JIT", "0") not in ("", "0"))


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Leave out what is about machine code where there is none."""
    if _kernels_run_as_python():
        for item in items:
            if item.get_closest_marker("compiled"):
                item.add_marker(pytest.mark.skip(reason="kernels run as Python here"))


@pytest.fixture
def limner_process(tmp_path: Path) -> Callable[..., Finished]:
    """Run ``python -m limner`` in an empty folder, as a user's shell would, and return what became of it."""

    def run(*words: object, env: Mapping[str, str] | None = None, timeout: float = 300.0) -> Finished:
        return subprocess.run(
            [sys.executable, "-m", "limner", *map(str, words)],
            cwd=tmp_path,
            env={**os.environ, **(env or {})},
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            timeout=timeout,
            check=False,
        )

    return run
