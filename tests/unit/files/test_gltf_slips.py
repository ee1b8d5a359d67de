"""What a glTF document says against its rules is told, and nothing is said of one that keeps them."""

from __future__ import annotations

import json
import warnings
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from limner.errors import LimnerError
from limner.files.document import Element
from limner.files.gltf_slips import note_slips
from limner.files.load import load
from limner.files.notes import Notes

VALIDATOR = Path(__file__).resolve().parents[3] / ".." / "shared" / "data" / "validator"


def told(document: Any) -> tuple[str, ...]:
    """What is said of a document."""
    notes = Notes()
    note_slips(Element(document, "", "a.gltf"), notes)
    return notes.lines()


@pytest.mark.parametrize(
    ("document", "said"),
    [
        ({"meshes": []}, "/meshes: an empty list"),
        ({"nodes": [{"children": []}]}, "/nodes/0/children: an empty list"),
        ({"nodes": [{"mesh": 3}]}, "/nodes/0/mesh: refers to none of the 0 meshes"),
        ({"materials": [{"emissiveTexture": {"index": 0}}]}, "/materials/0/emissiveTexture/index: refers to none of the 0 textures"),
        ({"accessors": [{"count": 1, "type": "SCALAR"}]}, "/accessors/0: has no componentType"),
        ({"images": ["a.png"]}, "/images/0: must be an object, got 'a.png'"),
        ({"images": [{}], "textures": [{"source": 0}]}, "/images/0: must have one of uri and bufferView"),
        ({"images": [{"uri": "a.png"}]}, "/images/0: is in no texture and is not read"),
        ({"extensionsUsed": ["A", "A"]}, "/extensionsUsed: an extension that is named twice"),
        ({"extensions": {"EXT_unheard": {}}}, "/extensions/EXT_unheard: an extension that is not among the extensionsUsed"),
        ({"nodes": [{"extensions": {"KHR_materials_unlit": {}}}]}, "/nodes/0/extensions/KHR_materials_unlit: an extension where it"),
        ({"materials": [{"extensions": {"KHR_materials_ior": {"ior": 0.5}}}]}, "/materials/0/extensions/KHR_materials_ior/ior: is out of"),
        ({"nodes": [{"rotation": [0, 0, 0, 2]}]}, "/nodes/0/rotation: a quaternion whose length is not 1"),
        ({"nodes": [{"matrix": [1] * 16, "scale": [1, 1, 1]}]}, "/nodes/0: has both a matrix and its parts"),
        ({"nodes": [{"children": [1]}, {}], "scenes": [{"nodes": [0, 1]}]}, "/scenes/0/nodes/1: a node of a scene that has a parent"),
        ({"nodes": [{}, {}], "skins": [{"joints": [0, 1]}]}, "/skins/0/joints: its joints have no node above all of them"),
        ({"cameras": [{"type": "orthographic", "orthographic": {"znear": 2, "zfar": 1}}]}, "/cameras/0/orthographic: its far plane"),
        ({"buffers": [{"byteLength": 1, "uri": "data:text/plain;base64,AA=="}]}, "/buffers/0/uri: is data of the kind 'text/plain'"),
        ({"buffers": [{"byteLength": 4}], "bufferViews": [{"buffer": 0, "byteLength": 8}]}, "/bufferViews/0: reaches beyond the 4 bytes"),
    ],
)  # fmt: skip
def test_each_slip_is_told_with_its_place(document: dict[str, Any], said: str) -> None:
    """A line that begins with the pointer."""
    assert any(line.startswith(said) for line in told(document)), told(document)


def test_what_has_been_said_is_not_said_again() -> None:
    """A place of which the reader has spoken already."""
    notes = Notes()
    notes.slip("is left out", "/nodes/0/mesh")
    note_slips(Element({"nodes": [{"mesh": 3}]}, "", "a.gltf"), notes)
    assert notes.lines() == ("/nodes/0/mesh: is left out",)


VALUES = st.recursive(
    st.none() | st.booleans() | st.integers(-2, 9) | st.floats() | st.sampled_from(["", "VEC3", "data:,", "spot"]),
    lambda held: st.lists(held, max_size=3)
    | st.dictionaries(
        st.sampled_from(["nodes", "children", "mesh", "skins", "joints", "extensions", "KHR_lights_punctual", "lights", "images", "source",
                         "accessors", "bufferView", "sparse", "count", "type", "rotation", "buffers", "uri", "inverseBindMatrices"]),
        held, max_size=4,
    ),
    max_leaves=20,
)  # fmt: skip


@settings(max_examples=30, deadline=None, suppress_health_check=[HealthCheck.too_slow], derandomize=True)
@given(document=st.dictionaries(st.sampled_from(["nodes", "skins", "accessors", "buffers", "bufferViews", "images", "extensions"]), VALUES))
def test_whatever_a_document_holds_is_no_crash(document: dict[str, Any]) -> None:
    """Values of every type in every place."""
    told(document)


def test_what_the_validator_calls_valid_is_read_and_what_it_calls_wrong_is_told() -> None:
    """All of its own files: none that is valid says a slip of this kind, and of ten with errors nine are refused or said."""
    if not VALIDATOR.is_dir():
        pytest.skip("the validator's files are not here")
    silent, n_wrong = 0, 0
    for path in sorted(path for path in VALIDATOR.rglob("*") if path.suffix in (".gltf", ".glb")):
        report = path.with_name(path.name + ".report.json")
        if not report.is_file():
            continue
        n_errors = json.loads(report.read_text())["issues"]["numErrors"]
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                said = load(path).notes
        except LimnerError as error:
            said = (str(error),)
            if not n_errors and "version '2.1'" not in said[0]:
                pytest.fail(f"{path} is valid: {said[0]}")
        n_wrong += n_errors > 0
        silent += n_errors > 0 and not said
        if not n_errors:
            assert not any("which glTF has not" in note or "refers to none" in note or "does not belong" in note for note in said)
    assert n_wrong > 100
    assert silent <= n_wrong // 10
