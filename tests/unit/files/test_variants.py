"""The variants of a scene: which there are, and what each shows."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from limner.errors import SceneError
from limner.files.gltf import read
from limner.files.notes import Notes
from limner.files.write_gltf import write
from limner.scene.material import Lambert, MetallicRoughness, Variant
from limner.scene.node import Node
from limner.scene.scene import Scene
from limner.scene.shape import Shape, Sphere
from limner.scene.variants import variant_names, with_variant

DATA = Path(__file__).resolve().parents[3] / ".." / "shared" / "data"


def colors(scene: Scene) -> list[str]:
    """What the first material of each shape is called."""
    return [shape.materials[0].name for _, shape in scene.shapes()]


@pytest.fixture
def shoe(writer: Any) -> Any:
    """Two primitives: the first is red, blue or green, the second red or blue."""
    names = ("red", "blue", "green")
    writer.document["materials"] = [{"name": name} for name in names]
    writer.document["extensions"] = {"KHR_materials_variants": {"variants": [{"name": "A"}, {"name": "B"}, {}, {"name": "A"}]}}
    first = writer.primitive([[0, 0, 0], [1, 0, 0], [0, 1, 0]], material=0)
    second = writer.primitive([[0, 0, 1], [1, 0, 1], [0, 1, 1]])
    first["extensions"] = {"KHR_materials_variants": {"mappings": [
        {"material": 2, "variants": [2, 1]}, {"material": 1, "variants": [0]},
    ]}}  # fmt: skip
    second["extensions"] = {"KHR_materials_variants": {"mappings": [{"material": 1, "variants": [3]}]}}
    return writer


def test_mappings(shoe: Any) -> None:
    """Each variant shows what the file maps it to; where it maps nothing, the material stays; names are told apart."""
    scene = read(shoe.glb(), "model.glb", notes=Notes())
    assert variant_names(scene) == ("A", "B", "variant 2", "A (3)")
    assert colors(scene) == ["red", ""]
    shown = {name: colors(with_variant(scene, name)) for name in variant_names(scene)}
    assert shown == {"A": ["blue", ""], "B": ["green", ""], "variant 2": ["green", ""], "A (3)": ["red", "blue"]}


def test_one_after_the_other(shoe: Any) -> None:
    """From a variant every other can be chosen; what it says nothing about stays as it is."""
    scene = with_variant(read(shoe.glb(), "model.glb", notes=Notes()), "A")
    assert variant_names(scene) == ("A", "B", "variant 2", "A (3)")
    assert colors(with_variant(scene, "B")) == ["green", ""]


def test_unknown() -> None:
    """There is no variant of another name, and the message lists those that there are."""
    with pytest.raises(SceneError, match="'x'; it has none"):
        with_variant(Scene(), "x")
    shape = Shape(Sphere(1.0), (MetallicRoughness(variants=(Variant("red", Lambert()),)),))
    with pytest.raises(SceneError, match="its variants are 'red'"):
        with_variant(Scene(Node(shapes=(shape,))), "x")


def test_sharing() -> None:
    """What is shared stays shared, what does not change is the very same, and hidden nodes count."""
    shape = Shape(Sphere(1.0), (MetallicRoughness(variants=(Variant("matte", Lambert(name="matte")),)),))
    shared, other = Node("shared", shapes=(shape,)), Node("other", shapes=(Shape(Sphere(2.0)),))
    root = Node(children=(Node(children=(shared,)), Node(children=(shared,), visible=False), other))
    made = with_variant(Scene(root), "matte").root
    assert made.children[0].children[0] is made.children[1].children[0]
    assert made.children[2] is other
    assert made.children[0].children[0].shapes[0].materials[0].name == "matte"
    assert made.children[0].children[0].shapes[0].geometry is shape.geometry


def test_deep_graphs() -> None:
    """A graph as deep as any may be is no trouble."""
    node = Node(shapes=(Shape(Sphere(1.0), (MetallicRoughness(variants=(Variant("a", Lambert()),)),)),))
    for _ in range(500):
        node = Node(children=(node,))
    assert len(with_variant(Scene(node), "a").shapes()) == 1


@pytest.mark.parametrize(
    "broken",
    [
        7, {"mappings": 7}, {"mappings": [{"material": 9, "variants": [0]}]}, {"mappings": [{"material": 1, "variants": [9]}]},
        {"mappings": [7]},
    ],
)  # fmt: skip
def test_broken_mappings(shoe: Any, broken: Any) -> None:
    """A broken mapping is left out with a word; the primitive is shown."""
    notes = Notes()
    shoe.document["meshes"][0]["primitives"][0]["extensions"]["KHR_materials_variants"] = broken
    scene = read(shoe.glb(), "model.glb", notes=notes)
    assert colors(scene) == ["red", ""]
    assert any("a variant is left out" in line for line in notes.lines())


def test_written_and_read(shoe: Any, tmp_path: Path) -> None:
    """Written and read again, each variant shows what it did; materials that several show are written once."""
    first = read(shoe.glb(), "model.glb", notes=Notes())
    write(first, tmp_path / "again.glb")
    again = read((tmp_path / "again.glb").read_bytes(), "again.glb", notes=Notes())
    assert set(variant_names(again)) == set(variant_names(first))
    for name in variant_names(first):
        assert colors(with_variant(again, name)) == colors(with_variant(first, name))
    assert (tmp_path / "again.glb").read_bytes().count(b'"blue"') == 1


@pytest.mark.filterwarnings("ignore::limner.errors.LimnerWarning")
@pytest.mark.skipif(not DATA.is_dir(), reason="the sample models are not here")
def test_samples() -> None:
    """The sofa of Khronos comes in five colours."""
    path = DATA / "khronos" / "GlamVelvetSofa" / "GlamVelvetSofa.glb"
    scene = read(path.read_bytes(), path, notes=Notes())
    assert variant_names(scene) == ("Champagne", "Navy", "Gray", "Black", "Pale Pink")
    assert "GlamVelvetSofa_fabric_navy" in colors(with_variant(scene, "Navy"))
