"""Every example runs, reduced, as a user runs it; and its picture has not changed since someone looked at it.

The second is regression, and proves nothing else: of each picture the mean colours of eight by six fields stand in `examples.json`. Where
an example is meant to change, look at its picture and keep what it says now:

    python tests/pictures/test_examples.py whitted glass        (without names: all)
"""

from __future__ import annotations

import ast
import contextlib
import io
import json
import runpy
import sys
import tempfile
import time
import warnings
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

ROOT = Path(__file__).resolve().parents[2]
EXAMPLES, DOCS = ROOT / "examples", ROOT / "docs"
KEPT = Path(__file__).with_name("examples.json")
FIELDS = (8, 6)
NEEDED = {"trimesh_interop": ("trimesh",), "usd_scene": ("pxr",)}  # by extras
CLIPS = {"turntable", "animation_clip"}
NAMES = sorted(path.stem for path in EXAMPLES.glob("*.py") if "__main__" in path.read_text(encoding="utf-8"))

pytestmark = pytest.mark.skipif(not EXAMPLES.exists(), reason="the examples are not part of this installation")


def made(name: str, folder: Path) -> Path:
    """Run an example reduced, in this process: what it wrote."""
    target = folder / f"{name}{'.webp' if name in CLIPS else '.png'}"
    before, path = sys.argv, list(sys.path)
    sys.argv = [str(EXAMPLES / f"{name}.py"), str(target), "--small"]
    sys.path.insert(0, str(EXAMPLES))
    try:
        with contextlib.redirect_stdout(io.StringIO()):
            runpy.run_path(sys.argv[0], run_name="__main__")
    finally:
        sys.argv, sys.path[:] = before, path
    return target


def fingerprint(path: Path) -> list[int]:
    """Mean codes of red, green and blue in eight by six fields, row by row; of a clip's first picture."""
    with Image.open(path) as opened:
        whole = opened.convert("RGB")
    return [int(value) for value in np.asarray(whole.resize(FIELDS, Image.Resampling.BOX)).reshape(-1)]


def kept() -> dict[str, list[int]]:
    """What was looked at."""
    found: dict[str, list[int]] = json.loads(KEPT.read_text(encoding="utf-8"))
    return found


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.filterwarnings("default")
def test_example(name: str, tmp_path: Path) -> None:
    """It runs without an error, there is a picture with something in it, and it is the one that was looked at."""
    for library in NEEDED.get(name, ()):
        pytest.importorskip(library)
    path = made(name, tmp_path)
    with Image.open(path) as picture:
        assert np.ptp(np.asarray(picture.convert("L")).astype(int)) > 40
    now, before = np.array(fingerprint(path)), np.array(kept()[name])
    apart: NDArray[np.int64] = np.abs(now - before)
    assert apart.max() <= 6, f"{name} has changed by up to {apart.max()} codes; look at it, then: python {Path(__file__).name} {name}"


def test_every_example_is_shown() -> None:
    """In the gallery, with its picture; and what the gallery says is what the scripts say."""
    gallery = runpy.run_path(str(DOCS / "make_gallery.py"))
    shown = [name for names in gallery["GROUPS"].values() for name in names]
    assert sorted(shown) == NAMES
    assert len(shown) >= 40
    assert gallery["page"]() == (DOCS / "gallery.md").read_text(encoding="utf-8"), "python docs/make_gallery.py --page"
    pictures = list((DOCS / "images" / "gallery").iterdir())
    assert sorted(path.stem for path in pictures) == NAMES
    assert sum(path.stat().st_size for path in pictures) < 6 << 20


@pytest.mark.parametrize("name", NAMES)
def test_every_example_says_how_to_run_it(name: str) -> None:
    """In its docstring, and takes a picture's name and --small."""
    text = (EXAMPLES / f"{name}.py").read_text(encoding="utf-8")
    assert f"python examples/{name}.py " in (ast.get_docstring(ast.parse(text)) or "")
    assert "def main(target: str, small: bool = False)" in text


def test_the_notebook_runs() -> None:
    """Cell by cell, in order; what stands last in a cell is a picture or nothing."""
    notebook = json.loads((EXAMPLES / "notebook.ipynb").read_text(encoding="utf-8"))
    assert (notebook["nbformat"], notebook["nbformat_minor"]) == (4, 5)
    names: dict[str, object] = {}
    n_pictures = 0
    for cell in notebook["cells"]:
        if cell["cell_type"] != "code":
            continue
        steps = ast.parse(cell["source"])
        last = steps.body.pop() if isinstance(steps.body[-1], ast.Expr) else None
        with contextlib.redirect_stdout(io.StringIO()):
            exec(compile(steps, "cell", "exec"), names)
            value = eval(compile(ast.Expression(last.value), "cell", "eval"), names) if isinstance(last, ast.Expr) else None
        if hasattr(value, "_repr_png_"):
            n_pictures += 1
            assert value._repr_png_()[:4] == b"\x89PNG"
    assert n_pictures == 3


def keep(names: list[str]) -> None:
    """Write the fingerprints of the given examples anew, and say how long each took."""
    found = kept() if KEPT.exists() else {}
    for name in names:
        start = time.process_time()
        with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings():
            warnings.simplefilter("ignore")
            found[name] = fingerprint(made(name, Path(folder)))
        lines = (f"{json.dumps(key)}: {json.dumps(found[key], separators=(',', ':'))}" for key in sorted(set(found) & set(NAMES)))
        KEPT.write_text("{\n" + ",\n".join(lines) + "\n}\n", encoding="utf-8")
        sys.stdout.write(f"{name}: {time.process_time() - start:.2f} s\n")
        sys.stdout.flush()


if __name__ == "__main__":
    keep(sys.argv[1:] or NAMES)
