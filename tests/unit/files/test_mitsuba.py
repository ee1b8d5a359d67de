"""Mitsuba scenes: what stands where, of what, in which light; by numbers that Mitsuba itself gives, and by what must not be believed."""

from __future__ import annotations

import math
import struct
import zlib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from PIL import Image

from limner.errors import FileFormatError, LimnerWarning
from limner.files.load import load
from limner.files.mitsuba import settings_of
from limner.files.mitsuba_color import black_body, rgb_from_emission, rgb_from_reflectance
from limner.files.mitsuba_conductor import CONDUCTORS, normal_reflectance
from limner.files.notes import Notes
from limner.files.report import load_report
from limner.linear.transform import transform_points
from limner.mesh.mesh import Mesh
from limner.scene.camera import OrthographicCamera, PerspectiveCamera
from limner.scene.light import DirectionalLight, DiskLight, PointLight, RectangleLight, SphereLight, SpotLight
from limner.scene.material import BlinnPhong, Dielectric, Lambert, MetallicRoughness
from limner.scene.material_extensions import Conductor
from limner.scene.procedural import Checker
from limner.scene.scene import Scene
from limner.scene.shape import Cylinder, Disk, Sphere
from limner.scene.texture import Texture

FILM = '<film type="hdrfilm"><integer name="width" value="200"/><integer name="height" value="100"/></film>'
SENSOR = f'<sensor type="perspective">{{}}{FILM}</sensor>'


def scene_of(folder: Path, body: str, version: str = "3.0.0") -> Scene:
    """The scene of some elements."""
    (folder / "scene.xml").write_text(f'<?xml version="1.0"?>\n<scene version="{version}">\n{body}\n</scene>')
    return load(folder / "scene.xml")


def material_of(folder: Path, bsdf: str) -> Any:
    """What a ball of a surface is made of."""
    return scene_of(folder, f'<shape type="sphere">{bsdf}</shape>').shapes()[0][1].materials[0]


def bsdf_of(kind: str, *properties: str) -> str:
    return f'<bsdf type="{kind}">{"".join(properties)}</bsdf>'


# Placements and shapes


def test_transformations_apply_in_the_order_of_the_file(tmp_path: Path) -> None:
    """Scaled, then turned by 90 degrees about z, then moved: (1, 0, 0) goes to (5, 2, 0)."""
    steps = '<scale x="2"/><rotate z="1" angle="90"/><translate x="5"/>'
    body = f'<shape type="rectangle"><transform name="to_world">{steps}</transform></shape>'
    placed, _ = scene_of(tmp_path, body).shapes()[0]
    assert_allclose(transform_points(placed.world_from_object, [[1.0, 0.0, 0.0]]), [[5.0, 2.0, 0.0]], atol=1e-12)


def test_rectangles_face_z_with_v_down(tmp_path: Path) -> None:
    """Its front is +z, it spans [-1, 1], and the first row of a picture lies at its lower edge."""
    mesh = scene_of(tmp_path, '<shape type="rectangle"/>').shapes()[0][1].geometry
    assert isinstance(mesh, Mesh)
    a, b, c = mesh.positions[mesh.triangles[0]]
    assert np.cross(b - a, c - a)[2] > 0.0
    assert mesh.uvs is not None
    assert_allclose(mesh.uvs[mesh.positions[:, 1] < 0.0][:, 1], 1.0)


def test_a_cube_is_closed_and_faces_outwards(tmp_path: Path) -> None:
    """Its volume by the divergence theorem is 8, and every face shows the whole picture."""
    mesh = scene_of(tmp_path, '<shape type="cube"/>').shapes()[0][1].geometry
    assert isinstance(mesh, Mesh)
    a, b, c = (mesh.positions[mesh.triangles[:, k]].astype(np.float64) for k in range(3))
    assert_allclose(np.einsum("ij,ij->", np.cross(a, b), c) / 6.0, 8.0)
    assert mesh.uvs is not None
    assert_allclose(np.sort(mesh.uvs.reshape(6, 4, 2)[:, :, 0], axis=1), np.tile([0.0, 0.0, 1.0, 1.0], (6, 1)))


def test_spheres_disks_and_cylinders_are_exact(tmp_path: Path) -> None:
    """Each in its place, with Mitsuba's +z where limner has +y."""
    scene = scene_of(tmp_path, '''
        <shape type="sphere"><point name="center" x="1" y="2" z="3"/><float name="radius" value="0.5"/></shape>
        <shape type="disk"><transform name="to_world"><translate z="4"/></transform></shape>
        <shape type="cylinder"><point name="p0" value="0, 0, 1"/><point name="p1" value="0, 3, 1"/><float name="radius" value="2"/></shape>
    ''')  # fmt: skip
    (ball, sphere), (plate, disk), (tube, cylinder) = scene.shapes()
    assert isinstance(sphere.geometry, Sphere)
    assert isinstance(disk.geometry, Disk)
    assert isinstance(cylinder.geometry, Cylinder)
    assert_allclose(ball.world_from_object[:3, 3], (1.0, 2.0, 3.0))
    assert_allclose(plate.world_from_object @ (0.0, 1.0, 0.0, 0.0), (0.0, 0.0, 1.0, 0.0), atol=1e-12)
    assert (sphere.geometry.radius, cylinder.geometry.radius, cylinder.geometry.height) == (0.5, 2.0, 3.0)
    ends = transform_points(tube.world_from_object, [[0.0, 1.5, 0.0], [0.0, -1.5, 0.0]])
    assert_allclose(ends, [[0.0, 0.0, 1.0], [0.0, 3.0, 1.0]], atol=1e-12)


OBJ = "mtllib gone.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0.25\nvt 1 1\nvt 0 1\nusemtl a\nf 1/1 2/2 3/3\nf 1/1 3/3 4/4\n"


def serialized(version: int = 4, flags: int = 0x1002, n_vertices: int = 3) -> bytes:
    """One triangle with texture coordinates, as Mitsuba stores it."""
    body = struct.pack("<I", flags) + (b"name\0" if version == 4 else b"") + struct.pack("<QQ", n_vertices, 1)
    body += np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], dtype="<f4").tobytes()
    body += np.array([[0, 0], [1, 0], [0, 0.25]], dtype="<f4").tobytes()
    body += np.array([0, 1, 2], dtype="<u4").tobytes()
    stream = struct.pack("<HH", 0x041C, version) + zlib.compress(body)
    return stream + struct.pack("<Q" if version == 4 else "<I", 0) + struct.pack("<I", 1)


def test_meshes_from_files(tmp_path: Path) -> None:
    """OBJ keeps its v and forgets its materials; serialized meshes have v turned; facets where the scene asks for them."""
    (tmp_path / "quad.obj").write_text(OBJ)
    (tmp_path / "mesh.serialized").write_bytes(serialized())
    scene = scene_of(tmp_path, '''
        <shape type="obj"><string name="filename" value="quad.obj"/></shape>
        <shape type="obj"><string name="filename" value="quad.obj"/><boolean name="face_normals" value="true"/>
            <boolean name="flip_tex_coords" value="false"/></shape>
        <shape type="serialized"><string name="filename" value="mesh.serialized"/></shape>
    ''')  # fmt: skip
    assert scene.notes == ()
    smooth, faceted, stored = (shape.geometry for _, shape in scene.shapes())
    assert all(isinstance(mesh, Mesh) for mesh in (smooth, faceted, stored))
    assert sorted(smooth.uvs[:, 1].tolist()) == [0.0, 0.25, 1.0, 1.0]
    assert sorted(faceted.uvs[:, 1].tolist()) == [0.0, 0.0, 0.75, 1.0]
    assert_allclose(smooth.normals, np.tile([0.0, 0.0, 1.0], (len(smooth.normals), 1)), atol=1e-6)
    assert faceted.normals is None
    assert sorted(stored.uvs[:, 1].tolist()) == [0.75, 1.0, 1.0]


def test_colours_of_vertices_are_shown_where_the_surface_asks(tmp_path: Path) -> None:
    """A PLY file's colours are left out, unless a mesh_attribute names them."""
    properties = "".join(f"property float {c}\n" for c in "xyz") + "".join(f"property uchar {c}\n" for c in ("red", "green", "blue"))
    rows = "0 0 0 255 0 0\n1 0 0 0 255 0\n0 1 0 0 0 255\n3 0 1 2\n"
    header = f"ply\nformat ascii 1.0\nelement vertex 3\n{properties}element face 1\nproperty list uchar int vertex_indices\nend_header\n"
    (tmp_path / "a.ply").write_text(header + rows)
    shape = '<shape type="ply"><string name="filename" value="a.ply"/>{}</shape>'
    attribute = '<texture type="mesh_attribute" name="reflectance"><string name="name" value="vertex_color"/></texture>'
    (_, plain), (_, colored) = scene_of(tmp_path, shape.format("") + shape.format(bsdf_of("diffuse", attribute))).shapes()
    assert plain.geometry.colors is None
    assert_allclose(colored.geometry.colors[:, :3], np.eye(3))
    assert colored.materials[0].color == (1.0, 1.0, 1.0)


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"", "cut off"), (b"PK\3\4" * 9, "no serialized mesh"), (serialized()[:40], "cut off|outside|no list"),
        (serialized(n_vertices=1 << 40), "limits"), (serialized(n_vertices=4), "cut off"), (serialized(flags=0x2000), "cut off"),
    ],
)  # fmt: skip
def test_broken_serialized_meshes_are_left_out(tmp_path: Path, data: bytes, message: str) -> None:
    """Whatever is in the file, the scene is read without it, and says why."""
    (tmp_path / "mesh.serialized").write_bytes(data)
    with pytest.warns(LimnerWarning, match=message):
        scene = scene_of(tmp_path, '<shape type="serialized"><string name="filename" value="mesh.serialized"/></shape>')
    assert not scene.shapes()


def test_instances_show_a_group_in_several_places(tmp_path: Path) -> None:
    """The group itself is not seen; its instances share its meshes."""
    scene = scene_of(tmp_path, '''
        <shape type="shapegroup" id="group"><shape type="cube"/><shape type="sphere"/></shape>
        <shape type="instance"><ref id="group"/></shape>
        <shape type="instance"><ref id="group"/><transform name="to_world"><translate x="9"/></transform></shape>
    ''')  # fmt: skip
    shapes = scene.shapes()
    assert len(shapes) == 4
    assert shapes[0][1].geometry is shapes[2][1].geometry
    assert shapes[2][0].world_from_object[0, 3] == 9.0


# Surfaces


def test_diffuse(tmp_path: Path) -> None:
    """Its reflectance, however it is said; half where it is not."""
    assert material_of(tmp_path, bsdf_of("diffuse")).color == (0.5, 0.5, 0.5)
    assert material_of(tmp_path, bsdf_of("diffuse", '<rgb name="reflectance" value="0.1 0.2, 0.3"/>')).color == (0.1, 0.2, 0.3)
    encoded = material_of(tmp_path, bsdf_of("diffuse", '<rgb name="reflectance" value="#ff8000"/>')).color
    assert_allclose(encoded, (1.0, ((128 / 255 + 0.055) / 1.055) ** 2.4, 0.0), rtol=1e-6)


@pytest.mark.filterwarnings("ignore::limner.errors.LimnerWarning")
def test_rough_diffuse(tmp_path: Path) -> None:
    """Slopes that vary by alpha / sqrt(2) along an axis; what the short formula leaves out is said where the file asks for it."""
    fast = '<boolean name="use_fast_approx" value="true"/>'
    for alpha, degrees in (("", math.degrees(0.2 / math.sqrt(2.0))), ('<float name="alpha" value="0.5"/>', 20.257117)):
        assert_allclose(material_of(tmp_path, bsdf_of("roughdiffuse", alpha, fast)).roughness_degrees, degrees, rtol=1e-5)
    assert material_of(tmp_path, bsdf_of("diffuse")).roughness_degrees == 0.0
    shapes = [f'<shape type="sphere">{bsdf_of("roughdiffuse", one)}</shape>' for one in (fast, "")]
    assert [any("short formula" in note for note in scene_of(tmp_path, shape).notes) for shape in shapes] == [False, True]


@pytest.mark.parametrize(("alpha", "roughness"), [(0.25, 0.5), (0.01, 0.1), (1.0, 1.0)])
def test_alpha_is_the_square_of_roughness(tmp_path: Path, alpha: float, roughness: float) -> None:
    """For metals, coats and glass alike."""
    ggx = f'<string name="distribution" value="ggx"/><float name="alpha" value="{alpha}"/>'
    for kind in ("roughconductor", "roughplastic", "roughdielectric"):
        assert material_of(tmp_path, bsdf_of(kind, ggx)).roughness == pytest.approx(roughness)


def test_metals_by_name_and_by_their_constants(tmp_path: Path) -> None:
    """A name gives the table's F0; three n and k a measured metal, an n of 0 its F0; without either, all is reflected."""
    gold = material_of(tmp_path, bsdf_of("conductor", '<string name="material" value="Au"/>'))
    assert (gold.base_color, gold.metallic, gold.roughness) == (CONDUCTORS["Au"], 1.0, 0.0)
    assert material_of(tmp_path, bsdf_of("conductor", '<string name="material" value="Ag_palik"/>')).base_color == CONDUCTORS["Ag"]
    own = material_of(tmp_path, bsdf_of("conductor", '<rgb name="eta" value="0.2, 1, 1.5"/>', '<rgb name="k" value="4, 2, 0"/>'))
    assert (own.base_color, own.conductor) == ((1.0, 1.0, 1.0), Conductor((0.2, 1.0, 1.5), (4.0, 2.0, 0.0)))
    none = material_of(tmp_path, bsdf_of("conductor", '<rgb name="eta" value="0, 1, 1.5"/>', '<rgb name="k" value="4, 2, 0"/>'))
    assert_allclose(none.base_color, [normal_reflectance(n, k) for n, k in ((0.0, 4.0), (1.0, 2.0), (1.5, 0.0))])
    assert none.conductor is None
    mirror = material_of(tmp_path, bsdf_of("conductor"))
    assert isinstance(mirror, BlinnPhong)
    assert mirror.mirror == (1.0, 1.0, 1.0)
    with pytest.warns(LimnerWarning, match="'Xx' is not known"):
        assert material_of(tmp_path, bsdf_of("conductor", '<string name="material" value="Xx"/>')).base_color == CONDUCTORS["Cr"]


def test_what_light_goes_through(tmp_path: Path) -> None:
    """Indices by number and by name, relative to what is outside; thin glass reflects 2R/(1 + R)."""
    glass = material_of(tmp_path, bsdf_of("dielectric", '<float name="intIOR" value="1.5"/>', '<float name="extIOR" value="1.2"/>'))
    assert isinstance(glass, Dielectric)
    assert glass.ior == pytest.approx(1.25)
    named = '<string name="int_ior" value="water"/><string name="ext_ior" value="vacuum"/>'
    water = material_of(tmp_path, bsdf_of("dielectric", named))
    assert water.ior == 1.333
    thin = material_of(tmp_path, bsdf_of("thindielectric", '<float name="int_ior" value="1.5"/>', '<float name="ext_ior" value="1"/>'))
    assert thin.alpha == pytest.approx(2 * 0.04 / 1.04)


@pytest.mark.parametrize(
    ("numbers", "said"),
    [
        ('<float name="specular" value="0.9"/>', "head on is drawn as of an index of refraction of 1.5"),
        ('<float name="eta" value="2.4"/>', "head on is drawn as of an index of refraction of 1.5"),
        ('<float name="specular" value="0.5"/><float name="specular_sampling_rate" value="2"/>', ""),
    ],
)
def test_what_principled_reflects_is_said(tmp_path: Path, numbers: str, said: str) -> None:
    """What changes the picture is not passed over; what only spreads samples is."""
    path = tmp_path / "scene.xml"
    path.write_text(f'<scene version="3.0.0"><shape type="sphere">{bsdf_of("principled", numbers)}</shape></scene>')
    notes = load(path).notes
    assert any(said in note for note in notes) if said else not any("principled" in note for note in notes)


def test_coats_and_principled(tmp_path: Path) -> None:
    """Plastic is no metal; principled keeps its numbers; its glass is glass."""
    plastic = material_of(tmp_path, bsdf_of("plastic", '<rgb name="diffuse_reflectance" value="0.1 0.2 0.3"/>'))
    assert isinstance(plastic, MetallicRoughness)
    assert (plastic.base_color, plastic.metallic, plastic.roughness) == ((0.1, 0.2, 0.3), 0.0, 0.0)
    numbers = '<float name="roughness" value="0.3"/><float name="metallic" value="0.7"/>'
    principled = material_of(tmp_path, bsdf_of("principled", numbers))
    assert (principled.metallic, principled.roughness) == (0.7, 0.3)
    glass = material_of(tmp_path, bsdf_of("principled", '<float name="spec_trans" value="1"/><float name="eta" value="1.4"/>'))
    assert isinstance(glass, Dielectric)
    assert glass.ior == 1.4


def test_what_stands_around_a_surface(tmp_path: Path) -> None:
    """Masks, bumps and normals become fields of what they stand around; names follow the outermost id."""
    Image.fromarray(np.full((2, 2, 3), 128, dtype=np.uint8)).save(tmp_path / "map.png")
    picture = '<texture type="bitmap" {}><string name="filename" value="map.png"/></texture>'
    mask = material_of(tmp_path, f'<bsdf type="mask" id="veil"><float name="opacity" value="0.3"/>{bsdf_of("diffuse")}</bsdf>')
    assert (mask.alpha, mask.alpha_mode, mask.name) == (0.3, "blend", "veil")
    bump = material_of(tmp_path, bsdf_of("bumpmap", picture.format('name="a"'), '<float name="scale" value="2"/>', bsdf_of("diffuse")))
    assert bump.bump_scale == 2.0
    assert not bump.bump_texture.texels.srgb
    normal = material_of(tmp_path, bsdf_of("normalmap", picture.format('name="normalmap"'), bsdf_of("twosided", bsdf_of("diffuse"))))
    assert normal.normal_texture is not None


def test_references_by_id(tmp_path: Path) -> None:
    """A surface that several shapes refer to is one; a missing one, and a circle, are errors with their line."""
    scene = scene_of(tmp_path, f'''
        <bsdf type="diffuse" id="red"><rgb name="reflectance" value="1, 0, 0"/></bsdf><alias id="red" as="crimson"/>
        <shape type="sphere"><ref id="red"/></shape><shape type="cube">{bsdf_of("twosided", '<ref id="crimson"/>')}</shape>
    ''')  # fmt: skip
    first, second = (shape.materials[0] for _, shape in scene.shapes())
    assert first is second
    assert (first.name, first.color) == ("red", (1.0, 0.0, 0.0))
    with pytest.raises(FileFormatError, match=r"line 3.*no object of the id 'gone'"):
        scene_of(tmp_path, '<shape type="sphere"><ref id="gone"/></shape>')
    with pytest.raises(FileFormatError, match="deeper in each other"):
        scene_of(tmp_path, '<bsdf type="twosided" id="a"><ref id="a"/></bsdf><shape type="sphere"><ref id="a"/></shape>')


def test_textures(tmp_path: Path) -> None:
    """A picture's placement is seen in the mirror v -> 1 - v; a checkerboard's two colours lie as Mitsuba lays them."""
    Image.fromarray(np.zeros((4, 4, 3), dtype=np.uint8)).save(tmp_path / "a.png")
    place = '<transform name="to_uv"><scale x="2" y="3"/><translate x="0.1" y="0.2"/></transform>'
    texture = '<texture type="bitmap" name="reflectance"><string name="filename" value="a.png"/>{}</texture>'
    found = material_of(tmp_path, bsdf_of("diffuse", texture.format(place + '<string name="wrap_mode" value="mirror"/>'))).texture
    assert isinstance(found, Texture)
    # (0, 0) of the texture is (0, 1) of limner's, so at v = 1 it is 1 - (3 * 0 + 0.2).
    assert_allclose((found.offset[1] + found.scale[1], found.offset[0], found.scale[0]), (0.8, 0.1, 2.0))
    assert found.wrap_u == "mirror"
    colors = '<rgb name="color0" value="1 0 0"/><rgb name="color1" value="0 1 0"/>'
    checks = f'<texture type="checkerboard" name="reflectance">{colors}</texture>'
    pattern = material_of(tmp_path, bsdf_of("diffuse", checks)).texture
    assert isinstance(pattern, Checker)
    # At u, v = (0.1, 0.9) with v up stands (0.1, 0.1) with v down, which is color0: the cell (0, 1), not the one at the origin.
    assert pattern.colors == ((0.0, 1.0, 0.0), (1.0, 0.0, 0.0))
    assert (pattern.scale, pattern.mapping) == ((2.0, 2.0, 1.0), "uv")
    with pytest.warns(LimnerWarning, match=r"without its texture 'gone.png'"):
        assert material_of(tmp_path, bsdf_of("diffuse", texture.format("").replace("a.png", "gone.png"))).color == (0.5, 0.5, 0.5)


def test_pictures_that_lie_mirrored(tmp_path: Path) -> None:
    """Mitsuba's green points along n x dp/du: on a rectangle, whose v runs down in pictures, a normal map's green is turned; in OBJ not."""
    Image.fromarray(np.full((2, 2, 3), (128, 200, 255), dtype=np.uint8)).save(tmp_path / "n.png")
    (tmp_path / "quad.obj").write_text(OBJ)
    texture = '<texture type="bitmap" name="normalmap"><string name="filename" value="n.png"/></texture>'
    surface = f'<bsdf type="twosided" id="a">{bsdf_of("normalmap", texture, bsdf_of("diffuse"))}</bsdf>'
    obj = '<shape type="obj"><string name="filename" value="quad.obj"/>{}<ref id="a"/></shape>'
    turned = '<boolean name="flip_tex_coords" value="false"/>'
    scene = scene_of(tmp_path, surface + '<shape type="rectangle"><ref id="a"/></shape>' + obj.format("") + obj.format(turned))
    greens = [shape.materials[0].normal_texture.texels.pixels[0, 0, 1] for _, shape in scene.shapes()]
    assert greens == [55, 200, 55]
    assert scene.shapes()[0][1].materials[0] is scene.shapes()[2][1].materials[0]


def test_heights_are_luminance(tmp_path: Path) -> None:
    """A coloured bump map is as high as it is bright, in every channel; a grey one is what it was."""
    Image.fromarray(np.array([[[255, 0, 0], [90, 90, 90]]], dtype=np.uint8)).save(tmp_path / "h.png")
    texture = '<texture type="bitmap"><string name="filename" value="h.png"/></texture>'
    found = material_of(tmp_path, bsdf_of("bumpmap", texture, bsdf_of("diffuse"))).bump_texture
    assert found.texels.pixels[0, :, :3].tolist() == [[54] * 3, [90] * 3]


def test_cylinders_begin_where_mitsubas_do(tmp_path: Path) -> None:
    """Mitsuba 3.9.1 has u, v = (0.2015, 0.4) at (0.3, 0.954, 0.4) of the unit cylinder: with v up, v = 0.6."""
    placed, shape = scene_of(tmp_path, '<shape type="cylinder"/>').shapes()[0]
    assert isinstance(shape.geometry, Cylinder)
    x, y, z = transform_points(np.linalg.inv(placed.world_from_object), [[0.3, 0.953939, 0.4]])[0]
    assert 0.5 + math.atan2(-z, x) / (2.0 * math.pi) == pytest.approx(0.2015, abs=1e-4)
    assert y / shape.geometry.height + 0.5 == pytest.approx(0.6)


# Lights


def test_lights_without_a_surface(tmp_path: Path) -> None:
    """Intensity and irradiance as they stand; what shines along +z in Mitsuba shines along the node's -z."""
    scene = scene_of(tmp_path, '''
        <emitter type="point"><point name="position" x="1" y="2" z="3"/><rgb name="intensity" value="4, 2, 1"/></emitter>
        <emitter type="spot"><transform name="to_world"><lookat origin="0,5,0" target="0,0,0" up="0,0,1"/></transform>
            <float name="cutoff_angle" value="30"/></emitter>
        <emitter type="directional"><vector name="direction" x="1" y="-1" z="0"/><float name="irradiance" value="3"/></emitter>
    ''')  # fmt: skip
    (bulb, point), (lamp, spot), (sun, beam) = scene.lights()
    assert isinstance(point, PointLight)
    assert isinstance(spot, SpotLight)
    assert isinstance(beam, DirectionalLight)
    assert bulb.world_from_object[:3, 3].tolist() == [1.0, 2.0, 3.0]
    assert_allclose(np.multiply(point.color, point.intensity), (4.0, 2.0, 1.0))
    assert_allclose(-lamp.world_from_object[:3, 2], (0.0, -1.0, 0.0), atol=1e-12)
    assert (spot.inner_degrees, spot.outer_degrees) == (22.5, 30.0)
    assert_allclose(-sun.world_from_object[:3, 2], np.array([1.0, -1.0, 0.0]) / math.sqrt(2.0), atol=1e-12)
    assert np.multiply(beam.color, beam.intensity).tolist() == [3.0, 3.0, 3.0]


BLACK = '<bsdf type="diffuse"><rgb name="reflectance" value="0"/></bsdf>'
SHINES = BLACK + '<emitter type="area"><rgb name="radiance" value="8, 4, 2"/></emitter>'


def test_shapes_that_shine(tmp_path: Path) -> None:
    """Rectangles, disks and balls become lights of the same radiance, size, place and front; others shine by emission, to their front."""
    scene = scene_of(tmp_path, f'''
        <shape type="rectangle"><transform name="to_world"><scale x="2" y="0.5"/><rotate x="1" angle="90"/></transform>{SHINES}</shape>
        <shape type="disk"><transform name="to_world"><scale value="3"/></transform>{SHINES}</shape>
        <shape type="sphere"><point name="center" x="1"/><transform name="to_world"><scale value="2"/></transform>{SHINES}</shape>
        <shape type="sphere"><transform name="to_world"><scale x="2"/></transform>{SHINES}</shape>
    ''')  # fmt: skip
    assert scene.notes == ()
    (panel, rectangle), (_, disk), (globe, ball) = scene.lights()
    assert isinstance(rectangle, RectangleLight)
    assert (rectangle.width, rectangle.height) == (4.0, 1.0)
    assert_allclose(-panel.world_from_object[:3, 2], (0.0, -1.0, 0.0), atol=1e-12)
    assert_allclose(panel.world_from_object[:3, 0], (1.0, 0.0, 0.0), atol=1e-12)
    assert isinstance(disk, DiskLight)
    assert disk.radius == pytest.approx(3.0)
    assert isinstance(ball, SphereLight)
    assert (ball.radius, globe.world_from_object[0, 3]) == (2.0, 2.0)
    assert_allclose(np.multiply(rectangle.color, rectangle.intensity), (8.0, 4.0, 2.0))
    ((_, egg),) = scene.shapes()
    assert egg.materials[0].emission == (8.0, 4.0, 2.0)
    assert not egg.materials[0].double_sided


def test_skies(tmp_path: Path) -> None:
    """One radiance all around; or a picture, turned by a quarter against limner's, and by what the scene turns it about y."""
    even = '<emitter type="constant"><rgb name="radiance" value="1 2 3"/></emitter>'
    assert scene_of(tmp_path, even).environment.source == (1.0, 2.0, 3.0)
    pixels = np.zeros((8, 16, 3), dtype="<f4")
    pixels[3:5, 3:5] = 1.0  # around u = 1/4, where Mitsuba has +x
    (tmp_path / "sky.pfm").write_bytes(b"PF\n16 8\n-1.0\n" + pixels[::-1].tobytes())
    sky = '<emitter type="envmap"><string name="filename" value="sky.pfm"/><float name="scale" value="2"/>{}</emitter>'
    turned = '<transform name="to_world"><rotate {} angle="{}"/></transform>'
    around_y = scene_of(tmp_path, sky.format(turned.format('y="1"', 40))).environment
    assert (around_y.rotation_degrees, around_y.intensity) == (pytest.approx(-50.0), 2.0)
    # About z by 90 degrees, +x goes to +y: the light stands overhead, in the first row of limner's picture.
    laid = scene_of(tmp_path, sky.format(turned.format('z="1"', 90))).environment
    assert np.argmax(laid.source.mean(axis=(1, 2))) == 0


def test_a_sky_that_lights_and_is_not_seen(tmp_path: Path) -> None:
    """`hide_emitters` leaves black behind everything, and the light where it is."""
    sky = '<emitter type="constant"/>'
    assert scene_of(tmp_path, sky).background == "environment"
    hidden = scene_of(tmp_path, '<integrator type="path"><boolean name="hideEmitters" value="true"/></integrator>' + sky)
    assert hidden.background == (0.0, 0.0, 0.0)
    assert hidden.environment is not None


# Sensors


@pytest.mark.parametrize(
    ("said", "half_height"),
    [
        ('<float name="fov" value="90"/>', 0.5), ('<float name="fov" value="90"/><string name="fov_axis" value="y"/>', 1.0),
        ('<float name="fov" value="90"/><string name="fovAxis" value="smaller"/>', 1.0),
        ('<float name="fov" value="90"/><string name="fov_axis" value="larger"/>', 0.5),
        ('<float name="fov" value="90"/><string name="fov_axis" value="diagonal"/>', 1.0 / math.sqrt(5.0)),
        ('<string name="focal_length" value="50mm"/>', math.hypot(36, 24) / 100 / math.sqrt(5.0)),
        ("", math.hypot(36, 24) / 100 / math.sqrt(5.0)),
    ],
)  # fmt: skip
def test_fields_of_view(tmp_path: Path, said: str, half_height: float) -> None:
    """Of a film twice as wide as high, however the angle is measured; without any, a lens of 50 mm."""
    camera = scene_of(tmp_path, SENSOR.format(said)).camera
    assert isinstance(camera, PerspectiveCamera)
    assert camera.half_height() == pytest.approx(half_height)


def test_cameras_see_what_mitsubas_do(tmp_path: Path) -> None:
    """Without a placement it looks along +z with +x to the left; look-at is as everywhere; the principal point moves the picture."""
    camera = scene_of(tmp_path, SENSOR.format('<float name="fov" value="90"/>')).camera
    xy, depth = camera.project([[0.0, 0.0, 2.0], [1.0, 0.0, 2.0], [0.0, 0.5, 2.0]], 200, 100)
    assert_allclose(depth, 2.0)
    assert_allclose(xy, [[99.5, 49.5], [49.5, 49.5], [99.5, 24.5]], atol=1e-9)
    shifted = '<float name="fov" value="90"/><float name="principal_point_offset_x" value="0.1"/>'
    aimed = '<transform name="to_world"><lookat origin="3,4,5" target="0,0,0" up="0,1,0"/></transform>'
    camera = scene_of(tmp_path, SENSOR.format(shifted + aimed)).camera
    xy, depth = camera.project([[0.0, 0.0, 0.0]], 200, 100)
    # Mitsuba 3.9 shows a ball on the gaze a tenth of the width to the left of the middle.
    assert_allclose((*xy[0], depth[0]), (99.5 - 20.0, 49.5, math.sqrt(50.0)), atol=1e-9)


def test_lenses_and_parallel_projection(tmp_path: Path) -> None:
    """A thin lens keeps its numbers; an orthographic film is two units wide before its placement scales it."""
    lens = '<sensor type="thinlens"><float name="aperture_radius" value="0.2"/><float name="focus_distance" value="3"/></sensor>'
    camera = scene_of(tmp_path, lens).camera
    assert isinstance(camera, PerspectiveCamera)
    assert (camera.aperture_radius, camera.focus_distance) == (0.2, 3.0)
    parallel = SENSOR.replace("perspective", "orthographic").format('<transform name="to_world"><scale x="3" y="3"/></transform>')
    camera = scene_of(tmp_path, parallel).camera
    assert isinstance(camera, OrthographicCamera)
    assert camera.height == pytest.approx(3.0)


def test_settings(tmp_path: Path) -> None:
    """What the file says about its picture becomes arguments of render; Mitsuba's depth counts one more."""
    (tmp_path / "scene.xml").write_text('''<scene version="3.0.0">
        <integrator type="path"><integer name="max_depth" value="6"/></integrator>
        <sensor type="perspective"><sampler type="multijitter"><integer name="sample_count" value="32"/></sampler><film type="hdrfilm">
        <integer name="width" value="320"/><integer name="height" value="240"/><rfilter type="tent"/></film></sensor>
        </scene>''')  # fmt: skip
    settings = load_report(tmp_path / "scene.xml").settings
    # A path tracer has no filter that reaches beyond a pixel.
    expected = {"renderer": "path", "max_depth": 5, "width": 320, "height": 240, "samples": 32, "default_lights": False}
    assert settings == expected
    assert settings_of(tmp_path / "scene.xml") == expected


def test_several_and_mirrored_sensors(tmp_path: Path) -> None:
    """The first is the scene's camera, all can be chosen by name; a mirrored one sees unmirrored, and the scene says so."""
    named = '<sensor type="perspective" id="{}"><transform name="to_world"><scale x="{}"/></transform></sensor>'
    with pytest.warns(LimnerWarning, match="flip it from left to right"):
        scene = scene_of(tmp_path, named.format("near", 2) + named.format("far", -1))
    assert scene.camera is not None
    assert scene.camera.name == "near"
    assert [camera.name for camera in scene.cameras()] == ["near", "far"]
    for camera in scene.cameras():
        axes = camera.world_from_camera[:3, :3]
        assert_allclose(axes.T @ axes, np.eye(3), atol=1e-12)
        assert np.linalg.det(axes) > 0.0


# Colours


def test_spectra() -> None:
    """White stays white, by any light; a black body of 6504 K is nearly neutral, of 3000 K red; what Mitsuba has for one spectrum."""
    assert_allclose(rgb_from_reflectance(np.ones(471)), (1.0, 1.0, 1.0))
    red, green, blue = rgb_from_emission(black_body(3000.0))
    assert red > 2.0 * green > 5.0 * blue
    neutral = np.array(rgb_from_emission(black_body(6504.0)))
    assert_allclose(neutral / neutral.mean(), 1.0, atol=0.04)


def test_spectra_in_a_scene(tmp_path: Path) -> None:
    """Mitsuba 3.9.1 (rgb) makes (0.8561, 0.4041, 0.1124) of this reflectance and (3.273, 2.371, 1.253) of this intensity."""
    curve = bsdf_of("diffuse", '<spectrum name="reflectance" value="400:.1, 500:.2, 600:.7, 700:.9"/>')
    assert_allclose(material_of(tmp_path, curve).color, (0.8561, 0.4041, 0.1124), atol=0.015)
    body = '<emitter type="point"><spectrum name="intensity" value="400:1, 500:2 600:3, 700:1"/></emitter>'
    ((_, light),) = scene_of(tmp_path, body).lights()
    assert_allclose(np.multiply(light.color, light.intensity), (3.273, 2.371, 1.253), rtol=0.01)


# XML


def test_defaults_parameters_and_includes(tmp_path: Path) -> None:
    """The first value of a parameter holds; included files see it; errors in them name them."""
    (tmp_path / "part.xml").write_text('<scene version="3.0.0">\n<shape type="sphere"><float name="radius" value="$r"/></shape></scene>')
    body = '<default name="r" value="2"/><default name="r" value="3"/><include filename="part.xml"/>'
    assert scene_of(tmp_path, body).shapes()[0][1].geometry == Sphere(2.0)
    with pytest.raises(FileFormatError, match=r"part.xml, line 2: the parameter \$r has no value"):
        scene_of(tmp_path, '<include filename="part.xml"/>')
    (tmp_path / "part.xml").write_text('<scene version="3.0.0"><include filename="part.xml"/></scene>')
    with pytest.raises(FileFormatError, match="includes too many files, or itself"):
        scene_of(tmp_path, '<include filename="part.xml"/>')


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("<scene><shape></scene>", "line 1: is no well-formed XML: mismatched tag"),
        ("<svg/>", "root is <scene>, got <svg>"),
        ('<!DOCTYPE scene [<!ENTITY a "b">]><scene>&a;</scene>', "document types and entities are not read"),
        ('<!DOCTYPE scene SYSTEM "file:///etc/passwd"><scene/>', "document types and entities are not read"),
        ("<scene>" + "<a>" * 100 + "</a>" * 100 + "</scene>", "deeper in each other"),
        ('<scene><include filename="../other.xml"/></scene>', "inside the model's folder"),
        ('<scene>\n<shape type="sphere"><float name="radius" value="big"/></shape></scene>', "line 2: value of <float> must be 1 finite"),
        ('<scene>\n\n<shape type="sphere"><float name="radius" value="-1"/></shape></scene>', "line 3: radius must be positive"),
        ('<scene><shape type="cube"><transform name="to_world"><matrix value="1 2"/></transform></shape></scene>', "9 finite numbers or"),
        ('<scene><emitter type="point"><rgb name="intensity" value="-1"/></emitter></scene>', "intensity: must not be negative"),
        ("<scene>" + '<default name="a0" value="' + "x" * 1000 + '"/>'
         + "".join(f'<default name="a{k}" value="{f"$a{k - 1}" * 20}"/>' for k in range(1, 9)) + "</scene>", "parameters fill in more"),
    ],
)  # fmt: skip
def test_what_is_refused(tmp_path: Path, text: str, message: str) -> None:
    """What is no scene, or means harm, is one line that says where."""
    (tmp_path / "scene.xml").write_text(text)
    with pytest.raises(FileFormatError, match=message):
        load(tmp_path / "scene.xml")


def test_what_is_not_read_is_told(tmp_path: Path) -> None:
    """Unknown plug-ins and unknown properties are named with their line, each once; the scene is read without them."""
    (tmp_path / "scene.xml").write_text('''<scene version="3.0.0">
        <shape type="hair"><string name="filename" value="a.hair"/></shape>
        <shape type="sphere"><float name="wobble" value="1"/>
            <bsdf type="measured"><string name="filename" value="a.bsdf"/></bsdf></shape>
        <emitter type="sunsky"/>
        <medium type="homogeneous" id="fog"/>
        </scene>''')  # fmt: skip
    report = load_report(tmp_path / "scene.xml")
    assert len(report.scene.shapes()) == 1
    told = {(entry.kind, entry.what, entry.where) for entry in report.entries if entry.kind != "read"}
    assert told == {
        ("ignored", "shape hair", "line 2"), ("ignored", "shape sphere", "line 3"), ("replaced", "bsdf measured", "line 4"),
        ("ignored", "emitter sunsky", "line 5"), ("ignored", "medium homogeneous", "line 6"),
    }  # fmt: skip
    assert not report.is_exact


def test_a_scene_without_an_extension(tmp_path: Path) -> None:
    """Text that begins like a scene is one."""
    (tmp_path / "scene").write_text('<?xml version="1.0"?>\n<!-- mine -->\n<scene version="3.0.0"><shape type="cube"/></scene>')
    assert len(load(tmp_path / "scene").shapes()) == 1


def test_values_from_outside(tmp_path: Path) -> None:
    """Parameters that are given go before the scene's own defaults."""
    from limner.files.mitsuba import read

    data = b'<scene><default name="r" value="1"/><shape type="sphere"><float name="radius" value="$r"/></shape></scene>'
    scene = read(data, tmp_path / "scene.xml", notes=Notes(), parameters={"r": "7"})
    assert scene.shapes()[0][1].geometry == Sphere(7.0)
    assert isinstance(scene.shapes()[0][1].materials[0], Lambert)
