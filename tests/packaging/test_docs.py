"""The documentation is true where a machine can tell: links, commands, calls, tables, and that it builds without a warning."""

from __future__ import annotations

import ast
import importlib
import inspect
import re
import shlex
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import click
import pytest

import limner
from limner.cli.commands import limner as commands

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
PAGES = sorted(DOCS.rglob("*.md"))
WRITTEN = [*PAGES, ROOT / "README.md", ROOT / "CHANGELOG.md"]
RUN = ("tour", "howto/researchers", "howto/science", "howto/teachers", "errors")

_LINK = re.compile(r"\[[^\]]*\]\(([^)\s]+)\)")


def _name(page: Path) -> str:
    return page.relative_to(ROOT).as_posix()


def _blocks(page: Path, language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```", page.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL)


def _anchors(page: Path) -> set[str]:
    titles = re.findall(r"^#+ (.*)$", page.read_text(encoding="utf-8"), flags=re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-") for title in titles}


@pytest.fixture
def reference(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """What makes the generated pages."""
    monkeypatch.syspath_prepend(str(DOCS))
    return importlib.import_module("reference")


# --- links and pages ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("page", WRITTEN, ids=_name)
def test_links_lead_somewhere(page: Path) -> None:
    """Files that are named exist, and so do the headings in them."""
    for link in _LINK.findall(re.sub(r"```.*?```", "", page.read_text(encoding="utf-8"), flags=re.DOTALL)):
        if "://" in link:
            continue
        file, _, anchor = link.partition("#")
        target = (page.parent / file).resolve() if file else page
        assert target.exists(), link
        assert not anchor or anchor in _anchors(target), link


def test_every_page_can_be_reached() -> None:
    """From the first page, by tables of contents."""
    found, waiting = set(), [DOCS / "index.md"]
    while waiting:
        page = waiting.pop()
        found.add(page)
        listed = (line for block in _blocks(page, r"\{toctree\}") for line in block.splitlines())
        waiting += [path for line in listed if line and not line.startswith(":") for path in page.parent.glob(f"{line}.md")]
    assert found == set(PAGES)


def test_every_picture_is_shown() -> None:
    """What lies in the folder of pictures is asked for by a page."""
    text = "\n".join(page.read_text(encoding="utf-8") for page in WRITTEN)
    assert [path.name for path in (DOCS / "images").rglob("*.*") if path.name not in text] == []


# --- commands -------------------------------------------------------------------------------------------------------------


def _command_lines() -> Iterator[Any]:
    for page in PAGES:
        for block in _blocks(page, "sh"):
            for line in block.splitlines():
                if "limner " in line and not line.startswith(("docker", ".venv")) and "COMMAND" not in line:
                    yield pytest.param(line[line.index("limner ") :], id=f"{page.stem}: {line}")


@pytest.mark.parametrize("line", list(_command_lines()))
def test_command_lines_are_understood(line: str) -> None:
    """The real parser takes them; nothing is run."""
    words = shlex.split(line)[1:]
    command: click.Command = commands
    context = click.Context(commands, info_name="limner")
    while isinstance(command, click.Group):
        found = command.get_command(context, words.pop(0))
        assert found is not None, line
        command = found
    if "--help" not in words:
        command.make_context("limner", words, parent=context)


def test_every_option_is_told_of(reference: ModuleType) -> None:
    """The page of commands names each command and each of its options."""
    text = reference.commands_markdown()

    def check(group: click.Group, path: str) -> None:
        context = click.Context(group)
        for name in group.list_commands(context):
            command = group.get_command(context, name)
            assert command is not None, name
            assert f"# {path} {name}\n" in text
            options = [option for option in command.params if isinstance(option, click.Option) and not option.hidden]
            assert [option.opts for option in options if not all(word in text for word in option.opts)] == []
            if isinstance(command, click.Group):
                check(command, f"{path} {name}")

    check(commands, "limner")


# --- Python ---------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("page", [page for page in PAGES if _blocks(page, "python")], ids=_name)
def test_calls_fit_their_functions(page: Path) -> None:
    """Every `limner.name` exists, and takes the arguments that it is given."""
    for block in _blocks(page, "python"):
        for node in ast.walk(ast.parse(block)):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute):
                function = _public(node.func)
                if function is not None:
                    inspect.signature(function).bind(*node.args, **{word.arg: None for word in node.keywords if word.arg})


def _public(node: ast.expr) -> Any:
    """What `limner.a.b` is; None for what begins otherwise."""
    if isinstance(node, ast.Name) and node.id == "limner":
        return limner
    parent = _public(node.value) if isinstance(node, ast.Attribute) else None
    return None if parent is None else getattr(parent, node.attr)  # type: ignore[attr-defined]


@pytest.mark.parametrize("name", RUN)
def test_lines_of_python_run(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    """One block after the other, with a small built-in scene in the model's place."""
    monkeypatch.chdir(tmp_path)
    text = "\n".join(_blocks(DOCS / f"{name}.md", "python")).replace('limner.load("model.glb")', 'limner.builtin("cornell")')
    for large, small in (("640", "64"), ("480", "48"), ("320", "32"), ("240", "24"), ("160, 120", "16, 12")):
        text = text.replace(large, small)
    exec(compile(text, name, "exec"), {})


def test_scene_files_are_read(tmp_path: Path) -> None:
    """What pages show of scene files makes scenes."""
    blocks = [block for page in PAGES for block in _blocks(page, "yaml")]
    for block in blocks:
        (tmp_path / "scene.yaml").write_text(block, encoding="utf-8")
        assert limner.load(tmp_path / "scene.yaml").shapes()
    assert blocks


# --- tables ---------------------------------------------------------------------------------------------------------------


def _first_cells(page: str) -> list[str]:
    return re.findall(r"^\| (.*?) \|", (DOCS / page).read_text(encoding="utf-8"), flags=re.MULTILINE)


def test_the_table_of_extensions_is_complete() -> None:
    """It names what the reader of glTF knows, and nothing else."""
    from limner.files.gltf import HANDLED

    told = [name for cell in _first_cells("formats.md") for name in re.findall(r"`((?:KHR|EXT)_\w+)`", cell)]
    assert sorted(told) == sorted(HANDLED)


def test_the_tables_of_formats_are_complete() -> None:
    """Every extension that is read as a model or written as a picture has its place."""
    from limner.files.load import EXTENSIONS
    from limner.image.formats import FORMATS

    text = (DOCS / "formats.md").read_text(encoding="utf-8")
    models, _, rest = text.partition("## glTF")
    assert all(f"`{extension}`" in models for extension in EXTENSIONS)
    pictures = re.findall(r"`(\.\w+)`", " ".join(_first_cells("formats.md")))
    assert sorted(pictures) == sorted(FORMATS)
    assert "## Pictures out" in rest


def test_the_table_of_findings_is_complete() -> None:
    """Each kind that the doctor names has its row, and each in a row is one of the doctor's."""
    source = "\n".join(path.read_text(encoding="utf-8") for path in (ROOT / "src" / "limner" / "explain").glob("*.py"))
    section = (DOCS / "errors.md").read_text(encoding="utf-8").partition("## What the doctor finds")[2]
    told = set(re.findall(r"`([a-z-]+)`(?=,| \|)", section))
    assert set(re.findall(r"Finding\(\s*\"([a-z-]+)\"", source)) <= told
    assert sorted(kind for kind in told if f'"{kind}"' not in source) == []


def test_every_benchmark_is_told_of() -> None:
    """The page of performance lists the scripts; what they import is none."""
    told = {cell.strip("`") for cell in _first_cells("performance.md") if cell.endswith(".py`")}
    imported = {"pairs.py"} | {path.name for path in (ROOT / "benchmarks").glob("raster_*.py")}
    assert told == {path.name for path in (ROOT / "benchmarks").glob("*.py")} - imported


# --- the site -------------------------------------------------------------------------------------------------------------


def test_every_public_name_has_a_page(reference: ModuleType) -> None:
    """Each room has a page, and the pages together hold what limner names."""
    rooms = {path.stem for path in (DOCS / "api").glob("*.md")} - {"index"}
    assert rooms - {"limner"} == {path.parent.name for path in (ROOT / "src" / "limner").glob("*/__init__.py")}
    told = [name for room in rooms for name in reference.names_of_room(room)]
    assert sorted(told) == sorted(set(limner.__all__) - {"__version__"})


def test_docstrings_become_markdown(reference: ModuleType) -> None:
    """Sections become lists, examples and indented blocks become code, and what stands in angles is no tag."""
    made = importlib.import_module("docstrings").markdown_of(
        """Do it.

    a drawing --- |v|

Parameters
----------
size : int
    In pixels, <name>.

>>> 1 + 1
2
"""
    )
    assert "```text\na drawing --- |v|\n```" in made
    assert "**Parameters**\n\n`size` int\n: In pixels, \\<name>." in made
    assert "```pycon\n>>> 1 + 1\n2\n```" in made


def test_it_builds_without_a_warning(tmp_path: Path) -> None:
    """Sphinx reads every page, resolves every reference, and has nothing to say."""
    for package in ("sphinx", "furo", "myst_parser"):
        pytest.importorskip(package, reason="the extra docs is not installed")
    words = ["-W", "-q", "-b", "dummy", "-d", str(tmp_path / "trees"), str(DOCS), str(tmp_path / "site")]
    done = subprocess.run([sys.executable, "-m", "sphinx", *words], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def test_the_container_is_made_of_what_is_there() -> None:
    """What the Dockerfile copies exists and is not kept out; the kernels are compiled by the user who runs."""
    text = (ROOT / "Dockerfile").read_text(encoding="utf-8")
    kept = [line[1:] for line in (ROOT / ".dockerignore").read_text(encoding="utf-8").splitlines() if line.startswith("!")]
    copied = [word for line in re.findall(r"^COPY (.*)$", text, flags=re.MULTILINE) for word in line.split()[:-1]]
    assert sorted(copied) == sorted(kept)
    assert all((ROOT / name).exists() for name in copied)
    assert text.index("USER limner") < text.index("RUN limner warmup") < text.index("ENTRYPOINT")
