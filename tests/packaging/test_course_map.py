"""The course map (docs/course-map.md) leaves no section out and names nothing that does not exist.

Names are looked up in the source text, not by importing: kernels need not be compiled to be found.
"""

from __future__ import annotations

import ast
import re
from functools import cache
from pathlib import Path
from typing import NamedTuple

import pytest

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "course-map.md"

# Every numbered heading of the course's chapters, what they leave out that a renderer needs, and the parts easily forgotten.
SECTIONS = """
3.1 Raster Devices
3.1.1 Displays
3.1.2 Hardcopy Devices
3.1.2 print size and dots per inch
3.1.2 halftoning
3.1.3 Input Devices
3.1.3 EXIF orientation
3.2 Images, Pixels, and Geometry
3.2 an image as a function: Image.sample(x, y, filter)
3.2 column and row from the bottom left: Image.at(i, j)
3.2.1 Pixel Values
3.2.2 Monitor Intensities and Gamma
4.4 Ray–Object Intersection
4.5 Shading
4.5.1 Lambertian Shading
4.5.2 Blinn–Phong Shading
4.5.3 Ambient Shading
4.5.4 Multiple Point Lights
4.7 Shadows
4.8 Ideal Specular Reflection
6.1 2D Linear Transformations
6.1.1 Scaling
6.1.2 Shearing
6.1.3 Rotation
6.1.4 Reflection
6.1.5 Composition of Transformations
6.2 3D Linear Transformations
6.2.1 Arbitrary 3D Rotations
6.2.2 Transforming Normal Vectors
6.2.2 the matrix of cofactors
6.3 Translation and Affine Transformations
6.4 Inverses of Transformation Matrices
7.1 Viewing Transformations
7.1.1 The Viewport Transformation
7.1.2 The Orthographic Projection Transformation
7.1.3 The Camera Transform
7.3 Perspective Projection
8.1 Rasterization
8.1.1 Line Drawing
8.1.2 Triangle Rasterization
8.1.2 a fill rule: each pixel of two adjacent triangles once
8.1.3 Clipping
8.1.4 Clipping Before the Transform (Option 1)
8.1.5 Clipping in Homogeneous Coordinates (Option 2)
8.1.6 Clipping against a Plane
8.2 Operations Before and After Rasterization
8.2.1 Simple 2D Drawing
8.2.2 A Minimal 3D Pipeline
8.2.3 Using a z-Buffer for Hidden Surfaces
8.2.4 Per-vertex Shading
8.2.5 Per-fragment Shading
8.2.6 Texture Mapping
8.3 Simple Antialiasing
10.1 Diffuse Shading
10.1.1 Lambertian Shading Model
10.1.2 Ambient Shading
10.1.3 Vertex-Based Diffuse Shading
10.1.3 surface normals at vertices
10.2 Phong Shading
10.2.1 Phong Lighting Model
10.2.1 the specular colour c_p
10.2.2 Surface Normal Vector Interpolation
10.3 Artistic Shading
10.3.1 Line Drawing
10.3.2 Cool-to-Warm Shading
11.1 Texture Mapping
11.1 the sphere's u and v
11.1 mesh flattening with little distortion
11.2 Different Texture Types
11.2 normal maps
11.2 displacement maps
11.3 Texture Sampling
11.3.1 Perspective Interpolation
11.3.2 Neighbor Interpolation
11.3.3 MIP map
11.3.3 anisotropic mipmapping
12.1 Triangle Meshes
12.1.1 Mesh Topology
12.1.1 orientation
12.2 Scene Graphs
12.3 Spatial Data Structures
12.3.1 Bounding Boxes
12.3.2 Hierarchical Bounding Boxes
12.3.2 the split that minimises the sum of volumes, by sorting
12.3.2 the split that minimises the sum of volumes, by partitioning
12.3.3 Uniform Spatial Subdivision
12.3.4 Axis-Aligned Binary Space Partitioning
13.1 Transparency and Refraction
13.1 total internal reflection
13.1 Schlick's approximation
13.2 Instancing
13.3 Constructive Solid Geometry by ray intervals
13.4 Distribution Ray Tracing
13.4.1 Antialiasing
13.4.2 Soft Shadows
13.4.3 Depth of Field
13.4.4 Glossy Reflection
13.4.5 Motion Blur
15.1 Curves
15.1 implicit curves
15.1 parametric curves
15.1 generative curves: fractals
15.1.1 Parameterizations and Reparameterizations
15.2 Curve Properties
15.2.1 Continuity
15.6 Approximating Curves
15.6.1 Bézier Curves
15.6.1 Geometric Intuition for Bézier Curves
15.6.1 The de Casteljau Algorithm
15.6.1 Bézier patches: the teapot
19.1 Colorimetry
19.1.2 Cone Responses
19.1.4 Standard Observers
19.1.5 Chromaticity Coordinates
19.2 Color Spaces
22 Implicit Modeling
23 Global Illumination
"""


class Row(NamedTuple):
    section: str
    title: str
    state: str
    test: str
    example: str


def rows() -> list[Row]:
    """The lines of the page's tables, without their heads."""
    cells = [
        [c.strip() for c in line.strip("|").split("|")] for line in PAGE.read_text("utf-8").splitlines() if line[:1] == "|"
    ]
    assert all(len(row) == len(Row._fields) for row in cells)
    return [Row(*row) for row in cells if row[0] != "section" and not set(row[0]) <= set("-")]


@cache
def tree(path: Path) -> ast.Module:
    return ast.parse(path.read_text("utf-8"))


def defines(body: list[ast.stmt], name: str) -> ast.stmt | None:
    """The statement of a module's or a class's body that binds a name, also under a condition."""
    for statement in body:
        if isinstance(statement, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
            if statement.name == name:
                return statement
        elif isinstance(statement, ast.Assign | ast.AnnAssign):
            targets = statement.targets if isinstance(statement, ast.Assign) else [statement.target]
            if any(isinstance(target, ast.Name) and target.id == name for target in targets):
                return statement
        elif isinstance(statement, ast.If | ast.Try):
            found = defines([*statement.body, *statement.orelse], name)
            if found is not None:
                return found
    return None


def exists(path: Path, names: list[str]) -> bool:
    """Whether a module defines a name, or a class in it one of its own."""
    body = tree(path).body
    for name in names:
        found = defines(body, name)
        if found is None:
            return False
        body = getattr(found, "body", [])
    return True


def find_dotted(dotted: str) -> bool:
    """Look a dotted name up: the longest path that is a module, the rest inside it."""
    parts = dotted.split(".")
    for length in range(len(parts), 0, -1):
        place = (ROOT / "src").joinpath(*parts[:length])
        for path in (place.with_suffix(".py"), place / "__init__.py"):
            if path.exists() and exists(path, parts[length:]):
                return True
    return False


def find_test(name: str) -> bool:
    path, *names = name.split("::")
    return (ROOT / path).exists() and bool(names) and exists(ROOT / path, names)


@pytest.fixture(autouse=True)
def _needs_the_page():
    if not PAGE.exists():
        pytest.skip("docs/course-map.md is not part of this installation")


def test_every_section_of_the_course_has_its_row():
    """In the order of the book, each exactly once; the page may have more rows than these."""
    on_page = [f"{row.section} {row.title}" for row in rows()]
    assert len(set(on_page)) == len(on_page)
    wanted = SECTIONS.strip().splitlines()
    assert [section for section in wanted if section not in on_page] == []
    assert [section for section in on_page if section in wanted] == wanted


def test_every_function_named_exists():
    """A state is "missing" or names in backticks, each a module, class, function or constant of limner."""
    for row in rows():
        names = re.findall(r"`([^`]+)`", row.state)
        assert row.state == "missing" or (names and re.sub(r"`[^`]+`", "", row.state).strip(", ") == ""), row
        for name in names:
            assert name.startswith("limner.") and find_dotted(name), f"{name} ({row.section} {row.title})"  # noqa: PT018


def test_every_test_named_exists():
    """What is there is proved: a row that names functions names tests, and they can be run."""
    for row in rows():
        names = re.findall(r"`([^`]+)`", row.test)
        assert names or row.state == "missing", f"no test for {row.section} {row.title}"
        for name in names:
            assert find_test(name), f"{name} ({row.section} {row.title})"


def test_every_example_named_exists():
    for row in rows():
        for name in re.findall(r"`([^`]+)`", row.example):
            assert (ROOT / name).exists(), f"{name} ({row.section} {row.title})"


def test_the_lookup_is_not_blind():
    """It finds a method and a constant, and does not find what is not there."""
    assert find_dotted("limner.scene.node.Node.walk")
    assert find_dotted("limner.scene.library.BUILTINS")
    assert find_dotted("limner.mesh.shapes.teapot")
    assert not find_dotted("limner.scene.node.Node.fly")
    assert not find_dotted("limner.scene.kettle")
    assert not find_test("tests/packaging/test_course_map.py::test_nothing")
    assert not find_test("tests/packaging/test_course_map.py")
