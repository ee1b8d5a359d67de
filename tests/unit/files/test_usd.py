"""OpenUSD: stages written here as text, and what becomes of them."""

from __future__ import annotations

import math
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("pxr", reason="the usd extra is not installed")

from PIL import Image
from written_usd import stage, the_mesh, written

from limner.errors import FileFormatError, LimnerError, LimnerWarning
from limner.files.limits import Limits
from limner.files.load import load
from limner.files.report import load_report
from limner.scene.camera import OrthographicCamera, PerspectiveCamera
from limner.scene.light import DirectionalLight, DiskLight, PointLight, RectangleLight, SphereLight, SpotLight
from limner.scene.line_set import LineSet
from limner.scene.material import Lambert, MetallicRoughness
from limner.scene.points import PointCloud
from limner.scene.shape import Box, Cone, Cylinder, Sphere
from limner.scene.texture import Texture

CUBE = """
    point3f[] points = [(0,0,0), (2,0,0), (2,2,0), (0,2,0), (0,0,2), (2,0,2), (2,2,2), (0,2,2)]
    int[] faceVertexCounts = [4, 4, 4, 4, 4, 4]
    int[] faceVertexIndices = [0,3,2,1, 4,5,6,7, 0,1,5,4, 3,7,6,2, 0,4,7,3, 1,2,6,5]
"""
SQUARE = """
    uniform token subdivisionScheme = "none"
    point3f[] points = [(0,0,0), (1,0,0), (1,1,0), (0,1,0), (2,0,0), (2,1,0)]
    int[] faceVertexCounts = [4, 4]
    int[] faceVertexIndices = [0,1,2,3, 1,4,5,2]
"""


def test_axes_and_units(tmp_path: Path) -> None:
    """+z up becomes +y up, and centimetres become metres, with everything that stands in a graph of transforms."""
    text = 'def Xform "car" { double3 xformOp:translate = (100, 0, 50)\n uniform token[] xformOpOrder = ["xformOp:translate"]\n'
    text += 'def Mesh "body" { uniform token subdivisionScheme = "none"' + CUBE + "} }"
    scene = stage(tmp_path, text, up="Z", unit=0.01)
    assert [placed.path for placed, _ in scene.shapes()] == ["world/car/body"]
    assert np.allclose(scene.bounds(), [[1.0, 0.5, -0.02], [1.02, 0.52, 0.0]])


def test_a_mesh_with_all_that_lives_on_it(tmp_path: Path) -> None:
    """Coordinates of corners, normals of vertices, one colour; faces of four are cut, and left-handed ones turned."""
    more = """
    texCoord2f[] primvars:st = [(0,0), (1,0), (1,1), (0,1)] (interpolation = "faceVarying")
    int[] primvars:st:indices = [0,1,2,3, 3,2,1,0]
    normal3f[] normals = [(0,0,2), (0,0,2), (0,0,2), (0,0,2), (0,0,2), (0,0,2)] (interpolation = "vertex")
    color3f[] primvars:displayColor = [(0.5, 0.25, 0.125)]
    """
    scene = stage(tmp_path, 'def Mesh "m" {' + SQUARE + more + "}")
    mesh = the_mesh(scene)
    assert len(mesh.triangles) == 4
    assert mesh.uvs is not None
    assert mesh.uv_triangles is not None
    corner = {int(p): mesh.uvs[u].tolist() for p, u in zip(mesh.triangles[:2].ravel(), mesh.uv_triangles[:2].ravel(), strict=True)}
    assert corner == {0: [0, 0], 1: [1, 0], 2: [1, 1], 3: [0, 1]}
    corner = {int(p): mesh.uvs[u].tolist() for p, u in zip(mesh.triangles[2:].ravel(), mesh.uv_triangles[2:].ravel(), strict=True)}
    assert corner == {1: [0, 1], 4: [1, 1], 5: [1, 0], 2: [0, 0]}
    assert mesh.normals is not None
    assert (mesh.normals == [0, 0, 1]).all()
    assert scene.shapes()[0][1].materials[0] == Lambert((0.5, 0.25, 0.125))
    turned = the_mesh(stage(tmp_path, 'def Mesh "m" {' + SQUARE + more + 'uniform token orientation = "leftHanded" }'))
    assert (turned.triangles == mesh.triangles[:, ::-1]).all()
    assert turned.uv_triangles is not None
    assert (turned.uv_triangles == mesh.uv_triangles[:, ::-1]).all()


@pytest.mark.parametrize(("of", "n"), [("uniform", 2), ("vertex", 6), ("faceVarying", 8)])
def test_colours_of_faces_vertices_and_corners(tmp_path: Path, of: str, n: int) -> None:
    """Each corner of a triangle shows what the file says of it, also where neighbours differ."""
    values = np.arange(3 * n).reshape(n, 3) / 32.0
    written = ", ".join(str(tuple(row)) for row in values.tolist())
    text = f'color3f[] primvars:displayColor = [{written}] (interpolation = "{of}") }}'
    mesh = the_mesh(stage(tmp_path, 'def Mesh "m" {' + SQUARE + text))
    assert mesh.colors is not None
    places = {(x, y): k for k, (x, y, _) in enumerate([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (2, 0, 0), (2, 1, 0)])}
    indices = [0, 1, 2, 3, 1, 4, 5, 2]
    for face, triangle in zip((0, 0, 1, 1), mesh.triangles, strict=True):
        for row in triangle:
            vertex = places[float(mesh.positions[row, 0]), float(mesh.positions[row, 1])]
            corner = 4 * face + indices[4 * face : 4 * face + 4].index(vertex)
            expected = values[{"uniform": face, "vertex": vertex, "faceVarying": corner}[of]]
            assert np.allclose(mesh.colors[row], expected)


def test_subdivision(tmp_path: Path) -> None:
    """Without a word a mesh is a surface of subdivision: a cube becomes round, closed, and is reported; creases keep it a cube."""
    report = _report(tmp_path, 'def Mesh "m" {' + CUBE + "}")
    mesh = the_mesh(report.scene)
    assert len(mesh.triangles) == 2 * 6 * 16
    sides = np.sort(mesh.triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    assert (np.unique(sides, axis=0, return_counts=True)[1] == 2).all()
    assert np.ptp(np.linalg.norm(mesh.positions - 1.0, axis=1)) < 0.15
    assert any(entry.kind == "approximated" and "divided 2 times" in entry.text for entry in report.entries)
    chains = "int[] creaseIndices = [0,1,2,3,0, 4,5,6,7,4, 0,4, 1,5, 2,6, 3,7]\nint[] creaseLengths = [5, 5, 2, 2, 2, 2]\n"
    creased = the_mesh(_report(tmp_path, 'def Mesh "m" {' + CUBE + chains + "float[] creaseSharpnesses = [10, 10, 10, 10, 10, 10] }").scene)
    assert np.allclose(creased.positions.max(axis=0), 2.0)
    assert np.allclose(np.abs(creased.positions - 1.0).max(axis=1), 1.0)


def _report(folder: Path, text: str) -> Any:
    (folder / "a.usda").write_text(written(text))
    return load_report(folder / "a.usda")


def test_materials_of_faces(tmp_path: Path) -> None:
    """Subsets of faces have materials of their own; the rest has that of the mesh, bound above it."""
    materials = "".join(
        f'def Material "{name}" {{ token outputs:surface.connect = </M/{name}/s.outputs:surface>\n def Shader "s" {{'
        f' uniform token info:id = "UsdPreviewSurface"\n color3f inputs:diffuseColor = {color}\n float inputs:metallic = 0.25\n'
        f" float inputs:roughness = 0.75\n float inputs:opacity = {opacity}\n token outputs:surface }} }}\n"
        for name, color, opacity in (("red", "(1,0,0)", 1.0), ("blue", "(0,0,1)", 0.5))
    )
    mesh = (
        'def Xform "x" (prepend apiSchemas = ["MaterialBindingAPI"]) { rel material:binding = </M/red>\n def Mesh "m" {' + SQUARE
        + 'def GeomSubset "half" (prepend apiSchemas = ["MaterialBindingAPI"]) { uniform token elementType = "face"\n int[] indices = [1]\n'
        + 'uniform token familyName = "materialBind"\n rel material:binding = </M/blue> } } }'
    )  # fmt: skip
    scene = stage(tmp_path, f'def Scope "M" {{ {materials} }}\n{mesh}')
    ((_, shape),) = scene.shapes()
    made = the_mesh(scene)
    assert made.triangle_materials is not None
    assert made.triangle_materials.tolist() == [0, 0, 1, 1]
    red, blue = shape.materials
    assert isinstance(red, MetallicRoughness)
    assert isinstance(blue, MetallicRoughness)
    assert (red.name, red.base_color, red.metallic, red.roughness, red.alpha_mode) == ("red", (1, 0, 0), 0.25, 0.75, "opaque")
    assert (blue.alpha, blue.alpha_mode) == (0.5, "blend")


def test_pictures(tmp_path: Path) -> None:
    """Pictures of colour, roughness and metallic (of one channel each), opacity and normals; coordinates by name, moved."""
    Image.fromarray(np.arange(48, dtype=np.uint8).reshape(4, 4, 3)).save(tmp_path / "a.png")
    Image.fromarray(np.full((2, 2, 3), (10, 20, 30), dtype=np.uint8)).save(tmp_path / "b.png")

    def reader(name: str, file: str, more: str = "") -> str:
        return (
            f'def Shader "{name}" {{ uniform token info:id = "UsdUVTexture"\n asset inputs:file = @./{file}@\n'
            f' float2 inputs:st.connect = </m/move.outputs:result>\n token inputs:wrapS = "mirror"\n token inputs:wrapT = "clamp"\n{more}\n'
            " float3 outputs:rgb\n float outputs:r\n float outputs:g\n float outputs:a }\n"
        )

    material = """
def Material "m" {
    token outputs:surface.connect = </m/s.outputs:surface>
    def Shader "s" {
        uniform token info:id = "UsdPreviewSurface"
        color3f inputs:diffuseColor.connect = </m/color.outputs:rgb>
        float inputs:roughness.connect = </m/data.outputs:r>
        float inputs:metallic.connect = </m/color.outputs:g>
        float inputs:opacity.connect = </m/data.outputs:g>
        float inputs:opacityThreshold = 0.25
        normal3f inputs:normal.connect = </m/bumps.outputs:rgb>
        float inputs:clearcoat = 0.5
        float inputs:ior = 1.4
        token outputs:surface
    }
    def Shader "name" { uniform token info:id = "UsdPrimvarReader_float2"
        string inputs:varname = "other"
        float2 outputs:result }
    def Shader "move" { uniform token info:id = "UsdTransform2d"
        float2 inputs:in.connect = </m/name.outputs:result>
        float2 inputs:scale = (2, 3)
        float2 inputs:translation = (0.5, 0.25)
        float inputs:rotation = 90
        float2 outputs:result }
"""
    material += reader("color", "a.png", "float4 inputs:scale = (0.5, 0.5, 0.5, 1)") + reader("data", "b.png")
    material += reader("bumps", "b.png", "float4 inputs:scale = (2,2,2,1)\n float4 inputs:bias = (-1,-1,-1,0)") + "}\n"
    coordinates = "".join(
        f'texCoord2f[] primvars:{name} = [({k},0),(0,0),(0,0),(0,0),(0,0),(0,0)] (interpolation = "vertex")\n'
        for k, name in enumerate(("st", "other"), 3)
    )
    mesh = f'def Mesh "x" (prepend apiSchemas = ["MaterialBindingAPI"]) {{ {SQUARE} {coordinates} rel material:binding = </m> }}'
    scene = stage(tmp_path, material + mesh)
    made = the_mesh(scene)
    assert made.uvs is not None
    assert made.uvs[0].tolist() == [4, 0]
    surface = scene.shapes()[0][1].materials[0]
    assert isinstance(surface, MetallicRoughness)
    base, data = surface.base_color_texture, surface.metallic_roughness_texture
    assert isinstance(base, Texture)
    assert isinstance(data, Texture)
    assert base.texels.srgb
    assert base.texels.pixels[3, 0].tolist() == [0, 1, 2, 255]
    assert (base.wrap_u, base.wrap_v, base.scale, base.offset) == ("mirror", "clamp", (2, 3), (0.5, 0.25))
    assert base.rotation == pytest.approx(math.pi / 2)
    assert surface.base_color == (0.5, 0.5, 0.5)
    assert not data.texels.srgb
    assert (data.texels.pixels[..., 1] == 10).all()
    assert surface.alpha_texture is not None
    assert (surface.alpha_channel, surface.alpha_mode, surface.alpha_cutoff) == ("g", "mask", 0.25)
    assert isinstance(surface.normal_texture, Texture)
    assert not surface.normal_texture.texels.srgb
    assert surface.clearcoat is not None
    assert (surface.clearcoat.factor, surface.ior) == (0.5, pytest.approx(1.4))


def test_packages(tmp_path: Path) -> None:
    """A .usdz brings its pictures along."""
    tools = pytest.importorskip("pxr.UsdUtils")
    Image.fromarray(np.full((2, 2, 3), 7, dtype=np.uint8)).save(tmp_path / "a.png")
    text = """
def Material "m" { token outputs:surface.connect = </m/s.outputs:surface>
    def Shader "s" { uniform token info:id = "UsdPreviewSurface"
        color3f inputs:diffuseColor.connect = </m/t.outputs:rgb>
        token outputs:surface }
    def Shader "t" { uniform token info:id = "UsdUVTexture"
        asset inputs:file = @a.png@
        float3 outputs:rgb } }
def Sphere "ball" (prepend apiSchemas = ["MaterialBindingAPI"]) { rel material:binding = </m> }
"""
    (tmp_path / "a.usda").write_text(written(text))
    assert tools.CreateNewUsdzPackage(str(tmp_path / "a.usda"), str(tmp_path / "a.usdz"))
    (tmp_path / "a.png").unlink()
    surface = load(tmp_path / "a.usdz").shapes()[0][1].materials[0]
    assert isinstance(surface, MetallicRoughness)
    assert isinstance(surface.base_color_texture, Texture)
    assert surface.base_color_texture.texels.pixels[0, 0].tolist() == [7, 7, 7, 255]


def test_instances_are_shared(tmp_path: Path) -> None:
    """Native instances and those of an instancer show one mesh; what an instancer spreads is not shown where it stands."""
    text = (
        'class "proto" { def Mesh "m" {' + SQUARE + "} }\n"
        + "".join(
            f'def Xform "i{k}" (instanceable = true\n prepend inherits = </proto>) {{ double3 xformOp:translate = ({k},0,0)\n'
            ' uniform token[] xformOpOrder = ["xformOp:translate"] }\n' for k in range(3)
        )
        + 'def PointInstancer "spread" { rel prototypes = [</spread/a>, </spread/b>]\n int[] protoIndices = [0, 1, 1]\n'
        + " point3f[] positions = [(0,5,0), (0,6,0), (0,7,0)]\n float3[] scales = [(1,1,1), (2,2,2), (1,1,1)]\n"
        + " int64[] invisibleIds = [2]\n"
        + ' def Sphere "a" { double radius = 0.5 }\n def Cube "b" { double size = 3 } }'
    )  # fmt: skip
    scene = stage(tmp_path, text)
    found = {placed.path: (placed.world_from_object, shape.geometry) for placed, shape in scene.shapes()}
    assert list(found) == [*(f"world/i{k}/m" for k in range(3)), "world/spread/0/a", "world/spread/1/b"]
    assert len({id(geometry) for path, (_, geometry) in found.items() if path.endswith("/m")}) == 1
    assert [matrix[0, 3] for path, (matrix, _) in found.items() if path.endswith("/m")] == [0, 1, 2]
    assert found["world/spread/0/a"][1] == Sphere(0.5)
    assert found["world/spread/1/b"][1] == Box((3, 3, 3))
    assert np.allclose(found["world/spread/1/b"][0], [[2, 0, 0, 0], [0, 2, 0, 6], [0, 0, 2, 0], [0, 0, 0, 1]])


def test_what_moves(tmp_path: Path) -> None:
    """Time samples are keys in seconds; an angle that goes a whole turn between two of them does so; and what is hidden comes and goes."""
    text = """
def Xform "wheel" {
    float xformOp:rotateY.timeSamples = { 0: 0, 48: 360 }
    double3 xformOp:translate.timeSamples = { 0: (0,0,0), 24: (2,0,0) }
    uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:rotateY"]
    def Cube "box" { token visibility.timeSamples = { 0: "inherited", 24: "invisible" } }
}
"""
    scene = stage(tmp_path, text)
    assert scene.animations[0].end == pytest.approx(2.0)
    matrix = scene.at(0.5).shapes()[0][0].world_from_object
    assert np.allclose(matrix[:3, 3], [1, 0, 0])
    assert np.allclose(matrix[:3, 0], [0, 0, -1], atol=1e-6)
    assert np.allclose(scene.at(0.75).shapes()[0][0].world_from_object[:3, 0], [-math.sqrt(0.5), 0, -math.sqrt(0.5)], atol=1e-6)
    assert not scene.at(1.5).shapes()


def test_cameras(tmp_path: Path) -> None:
    """Field of view, shift, depth of field and range, in metres; parallel projection."""
    text = """
def Camera "eye" {
    float focalLength = 50
    float horizontalAperture = 36
    float verticalAperture = 24
    float verticalApertureOffset = 6
    float2 clippingRange = (1, 1000)
    float fStop = 2
    float focusDistance = 300
    double3 xformOp:translate = (0, 0, 500)
    uniform token[] xformOpOrder = ["xformOp:translate"]
}
def Camera "plan" { token projection = "orthographic"
    float verticalAperture = 200 }
"""
    eye, plan = stage(tmp_path, text, unit=0.01).cameras()
    assert isinstance(eye, PerspectiveCamera)
    assert eye.yfov_degrees == pytest.approx(2 * math.degrees(math.atan(12 / 50)))
    assert (eye.aspect, eye.shift_y, eye.near, eye.far) == (pytest.approx(1.5), pytest.approx(0.5), pytest.approx(0.01), pytest.approx(10))
    assert eye.aperture_radius == pytest.approx(0.05 / 4)
    assert eye.focus_distance == pytest.approx(3.0)
    assert np.allclose(eye.world_from_camera[:3, 3], [0, 0, 5])
    assert isinstance(plan, OrthographicCamera)
    assert plan.height == pytest.approx(0.2)


def test_lights(tmp_path: Path) -> None:
    """Radiance, normalised or not, with exposure; sizes in metres; cones; a distant light of the sun's width in lux."""
    text = """
def SphereLight "ball" { float inputs:intensity = 10
    float inputs:exposure = 1
    float inputs:radius = 50 }
def SphereLight "dot" { float inputs:intensity = 10
    bool treatAsPoint = 1
    float inputs:radius = 100 }
def SphereLight "cone" (prepend apiSchemas = ["ShapingAPI"]) { float inputs:radius = 100
    float inputs:intensity = 1
    float inputs:shaping:cone:angle = 30
    float inputs:shaping:cone:softness = 0.5 }
def RectLight "window" { float inputs:intensity = 8
    bool inputs:normalize = 1
    float inputs:width = 2
    float inputs:height = 4 }
def DiskLight "disk" { float inputs:intensity = 3
    color3f inputs:color = (1, 0.5, 0) }
def DistantLight "sun" { float inputs:intensity = 1000
    float inputs:angle = 0.53 }
def CylinderLight "tube" { float inputs:radius = 1
    float inputs:length = 20
    float inputs:intensity = 2 }
def DomeLight "sky" { color3f inputs:color = (0.25, 0.5, 1)
    float inputs:intensity = 2 }
"""
    scene = stage(tmp_path, text, unit=0.01)
    found = {light.name: light for placed in scene.root.walk() for light in placed.node.lights}
    assert isinstance(found["ball"], SphereLight)
    assert (found["ball"].intensity, found["ball"].radius) == (20.0, pytest.approx(0.5))
    assert isinstance(found["dot"], PointLight)
    assert found["dot"].intensity == pytest.approx(10 * math.pi)
    cone = found["cone"]
    assert isinstance(cone, SpotLight)
    assert (cone.inner_degrees, cone.outer_degrees, cone.intensity) == (pytest.approx(15), pytest.approx(30), pytest.approx(math.pi))
    window, disk = found["window"], found["disk"]
    assert isinstance(window, RectangleLight)
    assert (window.intensity, window.width, window.height) == (1.0, pytest.approx(0.02), pytest.approx(0.04))
    assert isinstance(disk, DiskLight)
    assert (disk.color, disk.intensity, disk.radius) == ((1, 0.5, 0), 3.0, pytest.approx(0.005))
    sun = found["sun"]
    assert isinstance(sun, DirectionalLight)
    assert sun.intensity == pytest.approx(1000 * math.pi * math.sin(math.radians(0.265)) ** 2)
    ((placed, tube),) = scene.shapes()
    assert isinstance(tube.geometry, Cylinder)
    assert tube.materials[0].emission == (2, 2, 2)
    assert np.allclose(np.abs(placed.world_from_object[:3, 1]), [0.01, 0, 0])
    assert scene.environment is not None
    assert scene.environment.source == (0.5, 1.0, 2.0)
    assert scene.background == "environment"


@pytest.mark.parametrize("up", ["Y", "Z"])
def test_the_sky_looks_where_the_file_says(tmp_path: Path, up: str) -> None:
    """The middle of a dome's picture is seen towards its own +z, a quarter to the left of it +x, whatever turns the dome."""
    from limner.scene.environment import uv_from_direction

    Image.fromarray(np.zeros((2, 4, 3), dtype=np.uint8)).save(tmp_path / "sky.png")
    turns = 'float xformOp:rotateY = 30\n uniform token[] xformOpOrder = ["xformOp:rotateY"]'
    if up == "Z":
        turns = 'float xformOp:rotateZ = 30\nfloat xformOp:rotateX = 90\n'
        turns += 'uniform token[] xformOpOrder = ["xformOp:rotateZ", "xformOp:rotateX"]'
    scene = stage(tmp_path, f'def DomeLight "sky" {{ asset inputs:texture:file = @sky.png@\n {turns} }}', up=up)
    sky = scene.environment
    assert sky is not None
    turn = math.radians(30)
    middle = [math.sin(turn), 0, math.cos(turn)]
    left = [math.cos(turn), 0, -math.sin(turn)]
    assert np.allclose(uv_from_direction([middle, left], sky.rotation_degrees), [[0.5, 0.5], [0.25, 0.5]], atol=1e-6)


def test_other_geometries(tmp_path: Path) -> None:
    """Points, curves and solids along any axis; what is not known is left out, with a word."""
    text = """
def Points "cloud" { point3f[] points = [(0,0,0), (1,0,0)]
    float[] widths = [0.5, 1] (interpolation = "vertex") }
def BasisCurves "hair" { uniform token type = "linear"
    int[] curveVertexCounts = [3, 2]
    point3f[] points = [(0,0,0), (1,0,0), (2,0,0), (0,1,0), (1,1,0)]
    float[] widths = [0.1] (interpolation = "constant") }
def Cylinder "log" { token axis = "X"
    double height = 6
    double radius = 1 }
def Cone "hat" { token axis = "Z"
    double height = 2 }
def Plane "floor" { double width = 4
    double length = 2
    token axis = "Y" }
def Capsule "pill" {}
def NurbsPatch "patch" {}
"""
    with pytest.warns(LimnerWarning, match="NurbsPatch is not supported"):
        scene = stage(tmp_path, text)
    found = {placed.path.split("/")[1]: (placed.world_from_object, shape.geometry) for placed, shape in scene.shapes()}
    cloud, hair = found["cloud"][1], found["hair"][1]
    assert isinstance(cloud, PointCloud)
    assert cloud.point_radii.tolist() == [0.25, 0.5]
    assert isinstance(hair, LineSet)
    assert hair.ends.tolist() == [[0, 1], [1, 2], [3, 4]]
    assert hair.radii == pytest.approx(0.05)
    assert found["log"][1] == Cylinder(1, 6)
    assert np.allclose(found["log"][0][:3, 1], [1, 0, 0])
    assert isinstance(found["hat"][1], Cone)
    assert np.allclose(found["hat"][0][:3, 1], [0, 0, 1])
    assert np.ptp(found["floor"][1].positions, axis=0).tolist() == [4, 0, 2]  # type: ignore[union-attr]
    assert np.allclose(np.ptp(found["pill"][1].positions, axis=0), [1, 2, 1], atol=1e-6)  # type: ignore[union-attr]
    assert np.allclose(found["pill"][0][:3, 1], [0, 0, 1])


@pytest.mark.parametrize("rate", [0, -1])
def test_a_clock_that_does_not_run(tmp_path: Path, rate: int) -> None:
    """A rate at which no time passes is refused, where the library would not come back."""
    (tmp_path / "below.usda").write_text(
        '#usda 1.0\n( timeCodesPerSecond = 24 )\ndef Sphere "a" { double3 xformOp:translate.timeSamples = { 0: (0,0,0), 9: (1,0,0) }\n'
        'uniform token[] xformOpOrder = ["xformOp:translate"] }'
    )
    with pytest.raises(FileFormatError, match=f"timeCodesPerSecond must be positive, got {rate}"):
        stage(tmp_path, "", more=f"timeCodesPerSecond = {rate}\n subLayers = [@./below.usda@]")


def test_values_of_another_kind_than_the_schema_says(tmp_path: Path) -> None:
    """Points that are numbers alone: that mesh is left out, with a word, and the others are read."""
    bad = SQUARE.replace("point3f[] points", "int[] points").replace("(0,0,0)", "0")
    start = bad.index("int[] points")
    bad = bad[:start] + "int[] points = [0, 1, 2, 3, 4]" + bad[bad.index("]", start + 12) + 1 :]
    with pytest.warns(LimnerWarning, match="a value is not as its schema says"):
        scene = stage(tmp_path, 'def Mesh "bad" {' + bad + '}\ndef Mesh "good" {' + SQUARE + "}")
    assert [placed.path for placed, _ in scene.shapes()] == ["world/good"]


def test_guides_and_what_is_hidden(tmp_path: Path) -> None:
    """Guides and proxies are left out; what is invisible stays, unseen."""
    text = 'def Sphere "a" { uniform token purpose = "guide" }\ndef Sphere "b" { token visibility = "invisible" }\ndef Sphere "c" {}'
    scene = stage(tmp_path, text)
    assert [placed.path for placed, _ in scene.shapes()] == ["world/c"]
    assert any("guides" in note for note in scene.notes)


def test_what_is_broken(tmp_path: Path) -> None:
    """No stage, layers from elsewhere, too much, and faces to nowhere, each in one line."""
    (tmp_path / "a.usda").write_text("#usda 1.0\ndef Mesh {{{")
    with pytest.raises(FileFormatError, match="OpenUSD cannot read it"):
        load(tmp_path / "a.usda")
    (tmp_path / "in").mkdir()
    (tmp_path / "out.usda").write_text('#usda 1.0\ndef Sphere "ball" {}\n')
    with pytest.raises(FileFormatError, match="inside the model's folder"):
        stage(tmp_path / "in", "", more="subLayers = [@../out.usda@]")
    (tmp_path / "a.usda").write_text(written('def Mesh "m" {' + SQUARE + "}"))
    for limits, name in ((Limits(max_vertices=5), "max_vertices"), (Limits(max_triangles=3), "max_triangles")):
        with pytest.warns(LimnerWarning, match=name):
            assert not load(tmp_path / "a.usda", limits=limits).shapes()
    with pytest.raises(FileFormatError, match="max_nodes"):
        load(tmp_path / "a.usda", limits=Limits(max_nodes=0))
    broken = SQUARE.replace("[0,1,2,3, 1,4,5,2]", "[0,1,2,3, 1,4,5,77]")
    with pytest.warns(LimnerWarning, match="1 faces that refer to no finite point"):
        assert len(the_mesh(stage(tmp_path, 'def Mesh "m" {' + broken + "}")).triangles) == 2


QUAD = "point3f[] points = [(0,0,0), (1,0,0), (1,1,0), (0,1,0)]\n"
QUAD += "int[] faceVertexCounts = [4]\nint[] faceVertexIndices = [0,1,2,3]\n"
ODD = (
    *(f'def {kind} "p" {{}}' for kind in ("Points", "BasisCurves", "NurbsPatch", "Mesh", "PointInstancer", "DomeLight_1", "Nothing")),
    'def Sphere "s" { double radius = -1 }',
    'def RectLight "l" { float inputs:width = 0\nbool inputs:normalize = 1 }',
    'def SphereLight "l" { float inputs:intensity = nan }',
    'def SphereLight "l" { float inputs:exposure = 1e30 }',
    'def DomeLight "l" { asset inputs:texture:file = @../../missing.hdr@ }',
    'def Camera "c" { float focalLength = 0\nfloat2 clippingRange = (-1, 0)\nfloat fStop = inf }',
    'def Camera "c" { float verticalAperture = 0\nfloat horizontalAperture = 0 }',
    f'def Mesh "m" {{ {QUAD} color3f[] primvars:displayColor = [(1,0,0), (1,1,0)] (interpolation = "vertex") }}',
    f'def Mesh "m" {{ {QUAD} texCoord2f[] primvars:st = [(0,0)] (interpolation = "faceVarying")\nint[] primvars:st:indices = [0,5,0,0] }}',
    f'def Mesh "m" {{ {QUAD} int[] creaseIndices = [0,9]\nint[] creaseLengths = [2]\nfloat[] creaseSharpnesses = [nan] }}',
    f'def Mesh "m" {{ {QUAD} int[] holeIndices = [7,-3] }}',
    f'def Mesh "m" {{ {QUAD} uniform token subdivisionScheme = "loop" }}',
    'def Mesh "m" { point3f[] points = [(0,0,0), (1,0,0), (0,1,0)]\n'
    'int[] faceVertexCounts = [3,-3]\nint[] faceVertexIndices = [0,1,1,0,1,2] }',
    'def PointInstancer "x" { rel prototypes = [</nope>]\nint[] protoIndices = [0,5,-1]\npoint3f[] positions = [(0,0,0)] }',
    'def PointInstancer "x" { rel prototypes = [</x>]\nint[] protoIndices = [0]\npoint3f[] positions = [(0,0,0)] }',
    'def Material "m" { token outputs:surface.connect = </m/s.outputs:surface>\n'
    'def Shader "s" { uniform token info:id = "UsdPreviewSurface"\n'
    'color3f inputs:diffuseColor.connect = </m/s.inputs:diffuseColor>\nfloat inputs:ior = -4\nfloat inputs:roughness = 9\n'
    'string inputs:metallic = "x"\ntoken outputs:surface } }\ndef Sphere "s" { rel material:binding = </m> }',
    'def Sphere "s" (prepend references = @nope.usda@) {}',
    'def Xform "x" {' * 400 + "}" * 400,
)  # fmt: skip


def test_nothing_odd_ends_in_anything_but_a_scene_or_a_line(tmp_path: Path) -> None:
    """What has no sense is left out or refused; nothing crashes, and no number that is none comes through."""
    for text in ODD:
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", LimnerWarning)
                scene = stage(tmp_path, text.replace('" {', '" {\n'))
        except LimnerError:
            continue
        bounds = scene.bounds()
        assert not np.isnan(bounds).any(), text


@pytest.mark.parametrize("scheme", ["none", "catmullClark"])
def test_points_that_move(tmp_path: Path, scheme: str) -> None:
    """Keys of points become morphs: between two keys points go straight, surfaces of subdivision as those of the points there."""
    moving = "point3f[] points.timeSamples = {{ 0: {0}, 24: {1}, 36: {2} }}\n"
    moving += "int[] faceVertexCounts = [4]\nint[] faceVertexIndices = [0,1,2,3]\n"
    flat = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
    keys = [flat, [(x, y, x) for x, y, _ in flat], [(x, y, 2 * y) for x, y, _ in flat]]
    form = f'uniform token subdivisionScheme = "{scheme}"\n'
    scene = stage(tmp_path, 'def Mesh "m" {\n' + form + moving.format(*keys) + "}")
    for time, height in ((0.0, (0.0, 0.0)), (0.5, (0.5, 0.0)), (1.25, (0.5, 1.0)), (9.0, (0.0, 2.0))):
        mesh = the_mesh(scene.at(time))
        x, y, z = mesh.positions.T
        np.testing.assert_allclose(z, height[0] * x + height[1] * y, atol=1e-6)
        assert len(mesh.triangles) == (2 if scheme == "none" else 32)


def test_skins_are_led_by_their_skeletons(tmp_path: Path) -> None:
    """A joint that lifts its half of a square lifts it in the scene; the file's own layer stays as it was."""
    text = """
def SkelRoot "body" {
    def Skeleton "bones" (prepend apiSchemas = ["SkelBindingAPI"]) {
        uniform token[] joints = ["a", "b"]
        uniform matrix4d[] bindTransforms = [((1,0,0,0),(0,1,0,0),(0,0,1,0),(0,0,0,1)), ((1,0,0,0),(0,1,0,0),(0,0,1,0),(0,0,0,1))]
        uniform matrix4d[] restTransforms = [((1,0,0,0),(0,1,0,0),(0,0,1,0),(0,0,0,1)), ((1,0,0,0),(0,1,0,0),(0,0,1,0),(0,0,0,1))]
        rel skel:animationSource = </body/lift>
    }
    def SkelAnimation "lift" {
        uniform token[] joints = ["a", "b"]
        float3[] translations.timeSamples = { 0: [(0,0,0), (0,0,0)], 24: [(0,0,0), (0,0,4)] }
        quatf[] rotations = [(1,0,0,0), (1,0,0,0)]
        half3[] scales = [(1,1,1), (1,1,1)]
    }
    def Mesh "skin" (prepend apiSchemas = ["SkelBindingAPI"]) {
        uniform token subdivisionScheme = "none"
        point3f[] points = [(0,0,0), (1,0,0), (1,1,0), (0,1,0)]
        int[] faceVertexCounts = [4]
        int[] faceVertexIndices = [0,1,2,3]
        rel skel:skeleton = </body/bones>
        int[] primvars:skel:jointIndices = [0, 1, 1, 0] (interpolation = "vertex"
            elementSize = 1)
        float[] primvars:skel:jointWeights = [1, 1, 1, 1] (interpolation = "vertex"
            elementSize = 1)
    }
}
"""
    for _ in range(2):
        scene = stage(tmp_path, text)
        for time, z in ((0.0, 0.0), (0.5, 2.0), (1.0, 4.0)):
            mesh = the_mesh(scene.at(time))
            np.testing.assert_allclose(mesh.positions[:, 2], z * mesh.positions[:, 0], atol=1e-5)
