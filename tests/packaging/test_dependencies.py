"""What pyproject.toml asks to be installed is what the code imports: nothing missing, nothing for show."""

from __future__ import annotations

import ast
import re
import sys
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
_IMPORT_NAMES = {"imageio-ffmpeg": "imageio_ffmpeg", "pillow": "PIL", "pycollada": "collada", "pyyaml": "yaml"}


def _project() -> dict[str, object]:
    return tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]


def _import_names(requirements: list[str]) -> set[str]:
    names = (re.match(r"[\w-]+", requirement).group() for requirement in requirements)  # type: ignore[union-attr]
    return {_IMPORT_NAMES.get(name, name) for name in names}


def _imported() -> set[str]:
    """The top-level packages from elsewhere that any module imports, at its top or inside a function."""
    found = set()
    for path in (ROOT / "src" / "limner").rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Import):
                found |= {alias.name.partition(".")[0] for alias in node.names}
            elif isinstance(node, ast.ImportFrom) and node.level == 0 and node.module:
                found.add(node.module.partition(".")[0])
    return found - set(sys.stdlib_module_names) - {"limner"}


def test_what_is_imported_is_asked_for_and_the_reverse() -> None:
    """Mandatory packages are all used; what else is imported belongs to an extra."""
    project = _project()
    mandatory = _import_names(project["dependencies"])  # type: ignore[arg-type]
    extras = project["optional-dependencies"]
    optional = set().union(*(_import_names(extras[name]) for name in extras if name != "test"))  # type: ignore[index]
    assert mandatory <= _imported()
    assert _imported() <= mandatory | optional


def test_every_requirement_has_its_reason() -> None:
    """A line that cannot say why it is there should not be."""
    text = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    requirements = re.findall(r"^    \"[\w\[\]-]+(?:[<>=].*?)?\",.*$", text, flags=re.MULTILINE)
    assert len(requirements) >= 7
    asked = [line for line in requirements if re.match(r"    \"[\w\[\]-]+[<>=\]]", line)]
    assert all(re.search(r"\",\s+# \w", line) for line in asked)
