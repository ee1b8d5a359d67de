"""Scene files: what is written is read again to the bit, and the schema names what there is."""

from __future__ import annotations

import dataclasses
import inspect
import io
import json
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any, get_args

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from menagerie import ODD_NAME, menagerie, seamed, texels
from staging import SLOW_AS_PYTHON

from limner.errors import RenderError, SceneError, UnsupportedError
from limner.files.load import load
from limner.files.scene_file import save_scene, schema, settings_of
from limner.files.scene_file_arrays import INLINE, inline, outline
from limner.files.scene_file_kinds import DISTANCES, TABLES, kind_names, members_of
from limner.files.scene_file_settings import Settings
from limner.files.scene_file_yaml import compose, emit
from limner.linear import transform
from limner.mesh.mesh import Mesh
from limner.scene import camera, distance, light, material, procedural
from limner.scene import material_extensions as parts
from limner.scene.animation import Animation, FieldChannel, NodeChannel, WeightsChannel
from limner.scene.digest import scene_digest
from limner.scene.displacement import Displacement
from limner.scene.environment import Environment
from limner.scene.fog import Fog
from limner.scene.library import builtin
from limner.scene.line_set import LineSet
from limner.scene.motion import KeyedMotion, Motion
from limner.scene.node import MAX_DEPTH, Node
from limner.scene.points import PointCloud
from limner.scene.rig import Binding, Morph, Skin
from limner.scene.scene import Scene
from limner.scene.shape import (
    BilinearPatch,
    Box,
    Complement,
    Cone,
    Cylinder,
    Difference,
    Disk,
    DistanceField,
    Intersection,
    Plane,
    Quadric,
    Shape,
    Solid,
    Sphere,
    Torus,
    Union,
)
from limner.scene.texture import Texture
from limner.scene.track import Track

AXIS = (0.3, -0.7, 0.11)


# --- one of everything ----------------------------------------------------------------------------------------------------


def _distances() -> distance.Distance:
    """Every field of distances, in one."""
    ball = distance.Sphere(0.4)
    leaves = [
        distance.Box((0.3, 0.4, 0.5)), distance.Capsule(0.1, 0.7), distance.Cone(0.3, 0.5, 0.1), distance.Cylinder(0.2, 0.4),
        distance.Ellipsoid((0.3, 0.2, 0.1)), distance.Gyroid(0.7, 0.05) & distance.Box((1, 1, 1)), distance.MengerSponge(0.9, 2),
        distance.Octahedron(0.35), distance.Plane() & ball, distance.QuaternionJulia(iterations=5), distance.RoundedBox((1, 1, 1), 0.2),
        distance.Segment((0, 0, 0), (0.1, 0.2, 0.3), 0.05), distance.Torus(0.5, 0.1), distance.Offset(ball, -0.1),
        distance.Shell(ball, 0.02), ball.rotated((1, 2, 3), 33).scaled(0.7), ball.elongated(0.1, 0, 0.3), ball.mirrored("xz"),
        ball.repeated(1.0, (2, 1, 3)), ball.repeated((0.5, 0, 0), 4, alternating=True), distance.Twisted(distance.Box((0.2, 1, 0.3)), 40.0),
    ]  # fmt: skip
    return distance.Union(distance.Difference(leaves[0], leaves[1], radius=0.02), *leaves[2:], radius=0.1)


def _materials() -> tuple[material.Material, ...]:
    picture = Texture(texels(1, srgb=False), "clamp", "mirror", "nearest", offset=(0, 1), rotation=0.1, mapping="triplanar")
    patterns = (
        procedural.Checker(scale=2), procedural.Stripes(axis=AXIS), procedural.Gradient(((0, 0, 0, 1), (1, 1, 1, 0.5)), wrap="mirror"),
        procedural.Noise(positions=(0.3, 0.7)), procedural.Turbulence(octaves=3, seed=-4), procedural.Marble(axis=AXIS, amount=2),
        procedural.Wood(axis=AXIS, scale=(3, 1, 3)),
    )  # fmt: skip
    return (
        material.Lambert((0.1, 0.2, 0.3), picture, name="lambert", bump_texture=patterns[0], bump_scale=0.02),
        material.BlinnPhong(ambient=0.1, mirror=0.2, mirror_blur=0.01, highlight="phong", diffuse_texture=patterns[1]),
        material.MetallicRoughness(base_color_texture=patterns[2], normal_texture=picture, emissive_texture=patterns[3], name=ODD_NAME),
        material.Dielectric(1.33, priority=3, absorption=(0.1, 0.0, 0.5), tint_texture=patterns[4]),
        material.ShadowCatcher("floor"),
        material.CoolToWarm(towards=AXIS),
        material.MetallicRoughness(
            ior=1.3, dispersion=0.1, clearcoat=parts.Clearcoat(0.5, factor_texture=picture), sheen=parts.Sheen((0.1, 0.2, 0.3)),
            specular=parts.Specular(color_texture=patterns[0]), transmission=parts.Transmission(0.25),
            volume=parts.Volume(0.1, None, 2.0, (0.5, 1.0, 1.0)), anisotropy=parts.Anisotropy(0.5, -1.0, picture),
            iridescence=parts.Iridescence(0.5), diffuse_transmission=parts.DiffuseTransmission(0.5), name="rich",
            conductor=parts.Conductor.named("gold"), energy_compensation=True,
            variants=(material.Variant("red", material.Lambert((1.0, 0.0, 0.0), name="red")),),
        ),
        material.Lambert(texture=patterns[5], alpha_texture=patterns[6], alpha_mode="mask", alpha_channel="g"),
        material.Lambert(texture=picture),
    )


def _solid(black: material.Material) -> Difference:
    turned = transform.rotate((1, 2, 3), 0.5)
    return Difference(
        Intersection(Box(1.0), Solid(Sphere(0.68), turned), Complement(Torus())), Solid(Union(Cylinder(0.2), Cone(0.3)), material=black),
        Solid(Quadric((1, 1, 1, 0, 0, 0, 0, 0, 0, -0.01)), transform.translate(0.5, 0, 0)), Plane(),
    )  # fmt: skip


def everything(folder: Path) -> Scene:
    """Two of much, one of everything; what is shared is shared."""
    (folder / "sky.hdr").write_bytes(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n\x80\x40\x20\x81\x10\x20\x30\x82")
    paints, (lambert, *_) = _materials(), _materials()
    wire = LineSet(np.eye(3), [[0, 1], [2, 2]], np.eye(3), [0.1, 0.2, 0.3], 2.0, {"heat": np.arange(3)}, "wire")
    cloud = PointCloud(
        np.random.default_rng(2).random((9, 3)), normals=np.random.default_rng(3).normal(size=(9, 3)), radii=np.linspace(0.1, 0.3, 9),
        scalars={"heat": np.arange(9)}, name="cloud",
    )  # fmt: skip
    mesh = dataclasses.replace(
        seamed(), vertex_attributes={"flags": np.array([True, False, True, True]), "z": np.arange(4) * 1j},
        face_attributes={"rows": np.arange(6, dtype=np.uint16).reshape(2, 3)}, edge_attributes={"l": np.arange(5) / 3},
    )  # fmt: skip
    rng = np.random.default_rng(7)
    bound = Shape(
        mesh, paints[:2], (Morph(rng.random((4, 3)), name="m"), Morph(None, rng.random((3, 3)))),
        Binding(np.tile([0, 1], (4, 1)), rng.random((4, 2))), Displacement(procedural.Noise(), 0.1, max_triangles=500),
    )  # fmt: skip
    exact = [BilinearPatch(), Disk(0.5), Plane(), DistanceField(_distances()), _solid(paints[1]), cloud, mesh, wire]
    shapes = tuple(Shape(geometry, paints[k : k + 2]) for k, geometry in enumerate(exact))
    keyed = KeyedMotion(Track([0, 1], [[0, 0, 0], [1, 2, 3]]), Track.constant((0, 0, 0, 1), rotates=True), Track.constant((1, 1, 1)))
    lights = (
        light.PointLight(range=3, falloff="none"), light.DirectionalLight((1, 0.5, 0.25)),
        light.SpotLight(inner_degrees=1, outer_degrees=30), light.AmbientLight(), light.RectangleLight(width=2),
        light.DiskLight(visible=False), light.SphereLight(radius=0.1, name="ball"),
    )  # fmt: skip
    eye = camera.PerspectiveCamera.look_at(
        (3, 2, 5), (0, 0, 0), focal_length_mm=50, f_number=2.8, blades=6, motion=Motion.shift(AXIS), near=0.1, name="eye"
    )
    twice = Node("twice", shapes=(Shape(Sphere(0.3), lambert),))
    root = Node("world", transform.scale(1, 2, 3), shapes, lights, (camera.OrthographicCamera(height=3),), (
        Node("turning", motion=Motion.turn((0, 1, 0), 200), children=(twice, Node("", visible=False, children=(twice,)))),
        Node("keyed", motion=keyed, shapes=bound, weights=(0.5, 1), skin=Skin(("world/turning", "world/keyed"), name="skin")),
    ))  # fmt: skip
    clip = Animation("clip", (
        NodeChannel("world/keyed", keyed), WeightsChannel("world/keyed", Track([0, 1], [[0, 1], [1, 0]], "step")),
        FieldChannel("material", "lambert", "color", Track([0, 2], [[[0, 0, 0]] * 3] * 2, "cubic")),
    ))  # fmt: skip
    return Scene(root, eye, "environment", "all", ("a note",), Environment(str(folder / "sky.hdr"), 2, 30), Fog(), (clip,))


def _descriptions(thing: Any, seen: dict[int, Any]) -> Iterator[Any]:
    if not dataclasses.is_dataclass(thing) or id(thing) in seen:
        return
    seen[id(thing)] = thing
    yield thing
    for field in dataclasses.fields(thing):
        held = getattr(thing, field.name, None)
        for one in held if isinstance(held, tuple) else (held,):
            yield from _descriptions(one, seen)


def _reachable(kind: type, found: set[type]) -> set[type]:
    if kind not in found:
        found.add(kind)
        for member in members_of(kind):
            for form in (member.form, member.form.many, member.form.by_name):
                for below in form.classes if form else ():
                    _reachable(below, found)
    return found


def test_everything_is_read_as_it_was_written(tmp_path: Path) -> None:
    """The scene holds an instance of each class that files know, so that none of them is lost or changed by a bit; and again."""
    scene = everything(tmp_path)
    held = list(_descriptions(scene, {}))
    assert {type(one) for one in held} >= _reachable(Scene, set())
    save_scene(scene, tmp_path / "all.yaml")
    read = load(tmp_path / "all.yaml")
    assert scene_digest(read) == scene_digest(scene)
    assert [one.name for one in _descriptions(read, {}) if hasattr(one, "name")] == [one.name for one in held if hasattr(one, "name")]
    assert read.notes == scene.notes
    text = (tmp_path / "all.yaml").read_bytes()
    save_scene(read, tmp_path / "all.yaml")
    assert (tmp_path / "all.yaml").read_bytes() == text
    known = _reachable(Scene, set()) - set(DISTANCES) - {Scene}
    assert json.loads(json.dumps(schema()))["$defs"].keys() >= {kind.__name__ for kind in known}


def test_what_is_shared_stays_shared(tmp_path: Path) -> None:
    """As many objects come back as went in: materials, textures, texels, geometries and nodes that several hold are one."""

    def counts(scene: Scene) -> Counter[str]:
        named = (Mesh, PointCloud, LineSet, Node, *TABLES["materials"], *TABLES["textures"], *TABLES["texels"])
        return Counter(type(one).__name__ for one in _descriptions(scene, {}) if isinstance(one, named))

    for scene in (everything(tmp_path), menagerie()):
        save_scene(scene, tmp_path / "shared.yaml")
        assert counts(load(tmp_path / "shared.yaml")) == counts(scene)


@pytest.mark.parametrize("name", ["teapot", "cornell", "menagerie"])
@SLOW_AS_PYTHON
def test_pictures_are_the_same_to_the_bit(tmp_path: Path, name: str) -> None:
    """A picture of the scene that was read is that of the scene that was written."""
    from limner.render import render

    scene = menagerie() if name == "menagerie" else builtin(name)
    save_scene(scene, tmp_path / "scene.limner", settings={"renderer": "ray", "width": 24, "height": 16, "samples": 2})
    read, said = load(tmp_path / "scene.limner"), settings_of(tmp_path / "scene.limner")
    assert scene_digest(read) == scene_digest(scene)
    assert np.array_equal(render(read, **said).pixels, render(scene, renderer="ray", width=24, height=16, samples=2).pixels)


# --- random scenes --------------------------------------------------------------------------------------------------------

FLOATS = st.floats(-1e6, 1e6)
POSITIVE = st.floats(1e-3, 1e3)
UNIT = st.floats(0.0, 1.0)
COLORS = st.tuples(*[st.floats(0.0, 10.0)] * 3)
NAMES = st.text(st.characters(exclude_categories=["Cs"]), max_size=6)
AXES = st.tuples(*[st.floats(-1, 1)] * 3).filter(lambda axis: any(abs(x) > 1e-3 for x in axis))
PATTERNS = st.one_of(
    st.builds(procedural.Marble, colors=st.tuples(COLORS, COLORS), axis=AXES, amount=FLOATS, seed=st.integers(-9, 9)),
    st.builds(procedural.Noise, scale=POSITIVE, gain=UNIT, octaves=st.integers(1, 12)),
)
MATERIALS = st.one_of(
    st.builds(material.Lambert, COLORS, st.none() | PATTERNS, name=NAMES, alpha=UNIT),
    st.builds(material.MetallicRoughness, COLORS, UNIT, UNIT, name=NAMES, unlit=st.booleans()),
    st.builds(material.Dielectric, POSITIVE, roughness=UNIT, name=NAMES),
)
CLOUDS = st.builds(
    lambda seed, n: PointCloud(np.random.default_rng(seed).normal(size=(n, 3)), normals=np.random.default_rng(seed).normal(size=(n, 3))),
    st.integers(0, 99), st.integers(1, 40),
)  # fmt: skip
SOLIDS = st.recursive(
    st.builds(Sphere, POSITIVE) | st.builds(Box, st.tuples(*[POSITIVE] * 3)) | st.builds(Cylinder, POSITIVE, POSITIVE),
    lambda parts: st.builds(lambda kind, a, b: kind(a, b), st.sampled_from([Union, Difference, Intersection]), parts, parts), max_leaves=4,
)  # fmt: skip
FIELDS = st.recursive(
    st.one_of(
        st.builds(distance.Sphere, POSITIVE), st.builds(lambda r, h: distance.Capsule(r, 2 * r + h), POSITIVE, POSITIVE)
    ),
    lambda parts: st.one_of(
        st.builds(lambda a, b, r: distance.Union(a, b, radius=r), parts, parts, UNIT), st.builds(distance.Shell, parts, POSITIVE)
    ), max_leaves=4,
)  # fmt: skip
LIGHTS = st.one_of(st.builds(light.PointLight, COLORS, POSITIVE, name=NAMES), st.builds(light.DiskLight, radius=POSITIVE))
PLACES = st.one_of(
    st.just(np.eye(4)), st.builds(transform.translate, FLOATS, FLOATS, FLOATS),
    st.builds(lambda rows: np.array([*rows, (0.0, 0.0, 0.0, 1.0)]), st.tuples(*[st.tuples(*[FLOATS] * 4)] * 3)),
)  # fmt: skip
GEOMETRIES = SOLIDS | CLOUDS | st.builds(DistanceField, FIELDS)
SHAPES = st.builds(Shape, GEOMETRIES, st.lists(MATERIALS, min_size=1, max_size=2).map(tuple))
NODES = st.recursive(
    st.builds(
        Node, NAMES, PLACES, st.lists(SHAPES, max_size=2).map(tuple), st.lists(LIGHTS, max_size=1).map(tuple), visible=st.booleans()
    ),
    lambda children: st.builds(Node, NAMES, PLACES, children=st.lists(children, max_size=3).map(lambda c: (*c, *c[:1]))), max_leaves=4,
)  # fmt: skip
SCENES = st.builds(Scene, NODES, background=st.none() | COLORS, name=NAMES, fog=st.none() | st.builds(Fog, COLORS, UNIT))


@settings(max_examples=30, suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow])
@given(scene=SCENES)
def test_random_scenes_are_read_as_they_were_written(tmp_path: Path, scene: Scene) -> None:
    """Any names, any numbers, any nesting, nodes that stand in two places."""
    save_scene(scene, tmp_path / "random.yaml")
    assert scene_digest(load(tmp_path / "random.yaml")) == scene_digest(scene)


WORDS = NAMES | st.sampled_from(["yes", "1e3", "~", "null", ".nan", "0x1f", "- a"])
PLAIN = st.recursive(
    st.one_of(st.none(), st.booleans(), st.integers(), st.floats(), WORDS),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(NAMES, inner, max_size=3), max_leaves=12,
)  # fmt: skip


@given(plain=st.dictionaries(NAMES, PLAIN))
def test_yaml_of_plain_values_gives_them_back(plain: dict[str, Any]) -> None:
    """Of the same types, and floats to the bit; words that look like numbers stay words."""
    assert repr(compose(emit(plain), "x").top) == repr(plain)


@given(bits=st.lists(st.integers(0, 2**32 - 1), min_size=1, max_size=8))
def test_few_numbers_stand_in_the_text_to_the_bit(bits: list[int]) -> None:
    """Of any float32, numbers or not: what the text says is what was there, or it is left to the file of arrays."""
    array = np.array(bits, dtype=np.uint32).view(np.float32)
    for dtypes in ((array.dtype,), ()):
        said = inline(array, dtypes)
        if said is not None:
            made = np.array(said).astype(np.float32) if isinstance(said, list) else outline(said)
            assert made.tobytes() == array.tobytes()
        else:
            assert np.isnan(array).any()
    assert inline(np.zeros(INLINE + 1), ()) is None


# --- files ----------------------------------------------------------------------------------------------------------------


def test_skies_elsewhere_are_copied(tmp_path: Path) -> None:
    """An environment's file in another folder comes along, and the scene is still the same; one that is missing is told."""
    (tmp_path / "there").mkdir()
    scene = everything(tmp_path)
    save_scene(scene, tmp_path / "there" / "a.yaml")
    assert scene_digest(load(tmp_path / "there" / "a.yaml")) == scene_digest(scene)
    assert load(tmp_path / "there" / "a.yaml").environment.source.startswith(str(tmp_path / "there" / "a.yaml.sky-"))
    with pytest.raises(SceneError, match="missing"):
        save_scene(Scene(environment=Environment("none.hdr")), tmp_path / "b.yaml")
    assert not (tmp_path / "b.yaml").exists()


def test_what_is_still_named_is_kept(tmp_path: Path) -> None:
    """Writing a scene where it was read from, with its sky, and where a copy of the text still names the old arrays."""
    (tmp_path / "there").mkdir()
    path, copy = tmp_path / "there" / "a%b.yaml", tmp_path / "there" / "copy.yaml"
    scene = everything(tmp_path)
    save_scene(scene, path)
    save_scene(load(path), path)
    assert scene_digest(load(path)) == scene_digest(scene)
    copy.write_bytes(path.read_bytes())
    save_scene(builtin("teapot"), path)
    assert scene_digest(load(copy)) == scene_digest(scene)


def test_there_is_never_half_a_scene(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A failure leaves the old text with the old arrays; success leaves no arrays that nobody names."""
    path = tmp_path / "scene.yaml"
    save_scene(menagerie(), path)
    before = {beside.name: beside.read_bytes() for beside in tmp_path.iterdir()}
    assert len(before) == 2
    with monkeypatch.context() as broken:
        broken.setattr("limner.files.write_gltf_files.os.replace", _full_disk)
        with pytest.raises(RenderError, match="cannot write"):
            save_scene(builtin("teapot"), path)
    assert {beside.name: beside.read_bytes() for beside in tmp_path.iterdir()} == before
    save_scene(builtin("teapot"), path)
    assert scene_digest(load(path)) == scene_digest(builtin("teapot"))
    assert len(list(tmp_path.iterdir())) == 2
    save_scene(builtin("cornell"), path)
    assert [beside.name for beside in tmp_path.iterdir()] == ["scene.yaml"]


def _full_disk(*_: Any) -> None:
    raise OSError(28, "No space left on device")


def test_equal_scenes_make_equal_files(tmp_path: Path) -> None:
    """Texts and arrays alike, whenever they are written; equal arrays are kept once."""
    for name in ("a", "b"):
        (tmp_path / name).mkdir()
        save_scene(menagerie(), tmp_path / name / "scene.yaml")
    files = [{beside.name: beside.read_bytes() for beside in (tmp_path / name).iterdir()} for name in ("a", "b")]
    assert files[0] == files[1]
    arrays = next(data for name, data in files[0].items() if name.endswith(".npz"))
    with np.load(io.BytesIO(arrays)) as held:
        contents = [(array.dtype, array.shape, array.tobytes()) for array in held.values()]
    assert len(set(contents)) == len(contents)


def test_what_cannot_be_written_is_told(tmp_path: Path) -> None:
    """No such setting, no such folder, another extension, text that is no Unicode; nothing is left behind."""
    with pytest.raises(SceneError, match=r"settings.render: unknown key 'render'; did you mean 'renderer'\?"):
        save_scene(Scene(), tmp_path / "a.yaml", settings={"render": "ray"})
    with pytest.raises(RenderError, match="there is no folder"):
        save_scene(Scene(), tmp_path / "none" / "a.yaml")
    with pytest.raises(SceneError, match="must end in"):
        save_scene(Scene(), tmp_path / "a.json")
    with pytest.raises(UnsupportedError, match="Unicode"):
        save_scene(Scene(name="\ud800"), tmp_path / "a.yaml")
    assert not list(tmp_path.iterdir())


def test_deep_graphs_are_no_recursion(tmp_path: Path) -> None:
    """As deep as a scene may be: what is too deep for a text becomes subtrees."""
    node = Node("leaf")
    for k in range(MAX_DEPTH):
        node = Node(f"n{k}", transform.translate(k, 0, 0), children=(node,))
    save_scene(Scene(node), tmp_path / "deep.yaml")
    assert scene_digest(load(tmp_path / "deep.yaml")) == scene_digest(Scene(node))


# --- the schema -----------------------------------------------------------------------------------------------------------


def test_settings_are_those_of_render() -> None:
    """Every setting of a picture can be said in a file, and nothing else."""
    from limner.image.reconstruct import FILTERS
    from limner.kernel.sampler_kinds import SAMPLERS
    from limner.raster.pipeline import CULLINGS
    from limner.render import RENDERERS, render

    of_the_machine = {"scene", "camera", "threads", "tile_size", "on_progress", "cancel"}
    of_the_machine |= {"checkpoint", "checkpoint_seconds", "resume", "on_snapshot"}
    assert {field.name for field in dataclasses.fields(Settings)} == set(inspect.signature(render).parameters) - of_the_machine
    words = {member.name: set(get_args(member.form.plain[0])) for member in members_of(Settings)}
    for name, known in {"renderer": RENDERERS, "sampler": SAMPLERS, "culling": CULLINGS, "filter": FILTERS}.items():
        assert words[name] == set(known)


def test_kinds_are_called_by_one_rule() -> None:
    """No two classes that may stand in one place share a name, and every family is as its table says."""
    for family in (*TABLES.values(), DISTANCES, get_args(light.Light), get_args(camera.Camera)):
        assert len(kind_names(family)) == len(family)
    assert list(kind_names(get_args(light.Light)))[:3] == ["point", "directional", "spot"]


def test_the_schema_names_what_there_is() -> None:
    """Of a material its fields with their defaults; of a mapping of kinds, that it has one key."""
    described = schema()["$defs"]
    assert described["Lambert"]["properties"]["alpha"]["default"] == 1.0
    assert described["materials_kinds"]["maxProperties"] == 1
    assert set(described["SceneFile"]["required"]) == {"limner"}
    assert described["Sphere"]["additionalProperties"] is False
