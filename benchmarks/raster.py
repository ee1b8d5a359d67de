"""Pictures a second: limner's raster renderer beside software OpenGL.

    python benchmarks/raster.py Duck.glb stanford-bunny.obj --dense 1000000 \\
        --opengl PYTHON --vtk PYTHON --f3d PYTHON --pyrender PYTHON [--quick] [--pictures FOLDER]

A camera goes round a model; every picture ends as uint8 in a NumPy array. All renderers get the same vertices, triangles and texels,
the same eyes, one directional light and one constant ambient light, no shadows, no environment; back faces are culled. Each runs in a
process of its own, kept to as many cores as there are threads to measure; all processes of a row are started and warmed first, then
measured in turns, A B C C B A A B C: a machine's speed drifts, and drifts for all alike. A turn's figure is the median of its
pictures, a row's is the best of its turns. One picture of each is compared with limner's: a renderer that draws something else, or
nothing, would be fast.

How to set up the peers stands in peers.md, and what each of them does otherwise.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import platform
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack
from dataclasses import asdict, dataclass, replace
from importlib import import_module
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

# This file also runs in the peers' environments, which have NumPy but no limner: what either needs is imported where it is used.

Pixels = NDArray[Any]
Vector = tuple[float, float, float]

N_VIEWS = 60
STRIDE = 37  # coprime to N_VIEWS: also the first few views look from all around
WARM_FRAMES = 4
LEAST_FRAMES = 3
YFOV_DEGREES = 40.0
ELEVATION_DEGREES = 20.0
BACKGROUND: Vector = (0.0, 0.0, 1.0)  # zeros and ones: the same in every encoding
COLOR: Vector = (0.8, 0.8, 0.8)
AMBIENT = 0.25
DIFFUSE = 0.75
TOWARDS_LIGHT: Vector = (0.48, 0.6, 0.64)
UP: Vector = (0.0, 1.0, 0.0)
PEERS = ("opengl", "vtk", "f3d", "pyrender")
# Who can only shade as glTF has it is compared with limner's picture of that.
LIKENESS = {"f3d": "limner glTF", "pyrender": "limner glTF"}
# limner's own ways beside its main one; "limner 4": with the samples that the peers have at most.
VARIANTS = ("limner 4", "limner glTF", "limner image", "limner pose", "limner still")


@dataclass(frozen=True)
class Job:
    """What one process draws.

    Parameters
    ----------
    renderer : str
        A key of `_RENDERERS`.
    model : str
        Folder of a model that `_write_model` made.
    width, height, samples, threads : int
    eyes : list of N_VIEWS points
    target : point
    near, far : float
        Positive distances of the clipping planes.
    """

    renderer: str
    model: str
    width: int
    height: int
    samples: int
    threads: int
    eyes: list[Vector]
    target: Vector
    near: float
    far: float


class Model(NamedTuple):
    """Vertices that share one index, as graphics cards have them.

    Parameters
    ----------
    positions, normals : (n, 3) float32
    uvs : (n, 2) float32
        v up; zeros where there is no texture.
    triangles : (m, 3) int32
    texels : (height, width, 4) uint8
        sRGB, row 0 at the bottom; (0, 0, 4): no texture, the surface is `COLOR`.
    """

    positions: NDArray[np.float32]
    normals: NDArray[np.float32]
    uvs: NDArray[np.float32]
    triangles: NDArray[np.int32]
    texels: NDArray[np.uint8]


class Drawing(NamedTuple):
    """A renderer that stands ready.

    Parameters
    ----------
    draw : callable
        Takes the number of a view; returns (height, width, 3 or 4), row 0 on top.
    samples : int
        Of a pixel, as the renderer counts them.
    linear : bool
        Whether what it draws is linear light, not sRGB.
    note : str
        What draws: the version, the device.
    """

    draw: Callable[[int], Pixels]
    samples: int
    linear: bool = False
    note: str = ""


# --- the renderers ---------------------------------------------------------------------------------------------------------------


def _limner(job: Job, model: Model) -> Drawing:
    """Matte, straight to uint8."""
    renderer, cameras = _limner_renderer(job, model)
    return Drawing(lambda view: renderer.render(cameras(view), output="uint8"), job.samples)


def _limner_4(job: Job, model: Model) -> Drawing:
    return _limner(replace(job, samples=min(4, job.samples)), model)


def _limner_gltf(job: Job, model: Model) -> Drawing:
    """The material that a glTF file has, with its highlight: what f3d and pyrender always compute."""
    renderer, cameras = _limner_renderer(job, model, metallic_roughness=True)
    return Drawing(lambda view: renderer.render(cameras(view), output="uint8"), job.samples)


def _limner_image(job: Job, model: Model) -> Drawing:
    """An Image of float32, as `limner.render` returns it."""
    renderer, cameras = _limner_renderer(job, model)
    return Drawing(lambda view: renderer.render(cameras(view)).pixels, job.samples, linear=True)


def _limner_still(job: Job, model: Model) -> Drawing:
    """The same camera again and again."""
    renderer, cameras = _limner_renderer(job, model)
    still = cameras(0)
    return Drawing(lambda view: renderer.render(still, output="uint8"), job.samples)


def _limner_pose(job: Job, model: Model) -> Drawing:
    """The model turns before a camera that stands still: another scene for each picture."""
    from dataclasses import replace as changed

    from limner.linear import transform

    renderer, cameras = _limner_renderer(job, model)
    scene, still = renderer.scene, cameras(0)
    posed, *rest = scene.root.children

    def draw(view: int) -> Pixels:
        turn = transform.rotate_about(job.target, UP, -2.0 * math.pi * view / N_VIEWS)
        children = (changed(posed, parent_from_node=turn), *rest)
        renderer.scene = scene.replace(root=changed(scene.root, children=children))
        return renderer.render(still, output="uint8")

    return Drawing(draw, job.samples)


def _limner_renderer(job: Job, model: Model, *, metallic_roughness: bool = False) -> tuple[Any, Callable[[int], Any]]:
    """A Renderer, and what makes its camera of a view's number."""
    import limner
    from limner.scene.light import AmbientLight, DirectionalLight
    from limner.scene.material import Lambert, Material, MetallicRoughness
    from limner.scene.node import Node
    from limner.scene.shape import Shape
    from limner.scene.texture import Texels, Texture

    texture = Texture(Texels(model.texels)) if model.texels.size else None
    color = (1.0, 1.0, 1.0) if texture else COLOR
    material: Material = Lambert(color, texture, double_sided=False)
    if metallic_roughness:
        material = MetallicRoughness(color, metallic=0.0, roughness=1.0, base_color_texture=texture)
    mesh = limner.Mesh(model.positions, model.triangles, normals=model.normals, uvs=model.uvs if texture else None)
    sun = Node("sun", _light_frame(), lights=(DirectionalLight(intensity=math.pi * DIFFUSE),))
    sky = Node("sky", lights=(AmbientLight(intensity=AMBIENT),))
    scene = limner.Scene(Node(children=(Node("model", shapes=(Shape(mesh, (material,)),)), sun, sky)), background=BACKGROUND)
    renderer = limner.Renderer(scene, width=job.width, height=job.height, samples=job.samples, threads=job.threads)

    def camera(view: int) -> Any:
        return limner.Camera.look_at(job.eyes[view], job.target, UP, yfov_degrees=YFOV_DEGREES, near=job.near, far=job.far)

    return renderer, camera


_VERTEX_SHADER = """
#version 330
uniform mat4 clip_from_world;
in vec3 position; in vec3 normal; in vec2 uv;
out vec3 n; out vec2 st;
void main() { gl_Position = clip_from_world * vec4(position, 1.0); n = normal; st = uv; }
"""

_FRAGMENT_SHADER = """
#version 330
uniform sampler2D texels;
uniform vec3 color, towards_light;
uniform float ambient, diffuse;
in vec3 n; in vec2 st;
out vec4 encoded;
void main() {
    vec3 c = KD * (ambient + diffuse * max(dot(normalize(n), towards_light), 0.0));
    encoded = vec4(mix(12.92 * c, 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, step(0.0031308, c)), 1.0);
}
"""


def _opengl(job: Job, model: Model) -> Drawing:
    """OpenGL itself, with the least program that draws the same: one call to draw, one to read."""
    moderngl = import_module("moderngl")
    context = moderngl.create_context(standalone=True, backend="egl", require=330)
    samples = min(job.samples, context.max_samples) if job.samples > 1 else 0
    size = job.width, job.height
    seen = context.simple_framebuffer(size, components=4)
    drawn = seen
    if samples:
        colors = context.renderbuffer(size, 4, samples=samples)
        drawn = context.framebuffer(colors, context.depth_renderbuffer(size, samples=samples))
    textured = model.texels.size > 0
    program = context.program(_VERTEX_SHADER, _FRAGMENT_SHADER.replace("KD", "texture(texels, st).rgb" if textured else "color"))
    program["towards_light"], program["ambient"], program["diffuse"] = TOWARDS_LIGHT, AMBIENT, DIFFUSE
    if textured:
        srgb8_alpha8 = 0x8C43
        texels = np.ascontiguousarray(model.texels)
        texture = context.texture(texels.shape[1::-1], 4, texels.tobytes(), internal_format=srgb8_alpha8)
        texture.build_mipmaps()
        texture.filter = moderngl.LINEAR_MIPMAP_LINEAR, moderngl.LINEAR
        texture.use(0)
    else:
        program["color"] = COLOR
    parts = {"position": (model.positions, "3f"), "normal": (model.normals, "3f"), "uv": (model.uvs, "2f")}
    used = {name: part for name, part in parts.items() if name in program}  # what the picture does not need is compiled away
    vertices = context.buffer(np.hstack([array for array, _ in used.values()]).tobytes())
    layout = " ".join(kind for _, kind in used.values())
    mesh = context.vertex_array(program, [(vertices, layout, *used)], context.buffer(model.triangles.tobytes()))
    context.enable(moderngl.DEPTH_TEST | moderngl.CULL_FACE)
    projection = _projection(job)
    pixels = np.empty((job.height, job.width, 4), np.uint8)

    def draw(view: int) -> Pixels:
        drawn.use()
        drawn.clear(*BACKGROUND, 1.0)
        program["clip_from_world"].write((projection @ _camera_from_world(job, view)).T.astype(np.float32).tobytes())
        mesh.render()
        if drawn is not seen:
            context.copy_framebuffer(seen, drawn)
        seen.read_into(pixels, components=4)
        return pixels[::-1]

    return Drawing(draw, max(1, samples), note=f"{context.info['GL_RENDERER']}, OpenGL {context.info['GL_VERSION']}")


def _vtk(job: Job, model: Model) -> Drawing:
    """Its usual Phong shading, without highlight; textures decoded, the picture left linear, which is one step less than the others."""
    vtk, numpy_support = import_module("vtk"), import_module("vtk.util.numpy_support")
    window, scene = vtk.vtkRenderWindow(), vtk.vtkRenderer()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(job.samples if job.samples > 1 else 0)
    window.SetSize(job.width, job.height)
    window.AddRenderer(scene)
    window.SwapBuffersOff()  # nobody looks at the window: samples are resolved once, for reading
    scene.SetBackground(*BACKGROUND)
    scene.AutomaticLightCreationOff()
    light = vtk.vtkLight()
    light.SetLightTypeToSceneLight()
    light.PositionalOff()
    light.SetPosition(*TOWARDS_LIGHT)
    light.SetFocalPoint(0.0, 0.0, 0.0)
    scene.AddLight(light)

    data = vtk.vtkPolyData()
    points, cells = vtk.vtkPoints(), vtk.vtkCellArray()
    points.SetData(numpy_support.numpy_to_vtk(model.positions))
    cells.SetData(3, numpy_support.numpy_to_vtk(model.triangles.ravel()))
    data.SetPoints(points)
    data.SetPolys(cells)
    data.GetPointData().SetNormals(numpy_support.numpy_to_vtk(model.normals))
    mapper, actor = vtk.vtkPolyDataMapper(), vtk.vtkActor()
    mapper.SetInputData(data)
    mapper.StaticOn()
    actor.SetMapper(mapper)
    surface = actor.GetProperty()
    surface.SetInterpolationToPhong()
    surface.BackfaceCullingOn()
    surface.SetColor(*COLOR)
    surface.SetAmbient(AMBIENT)
    surface.SetDiffuse(DIFFUSE)
    surface.SetSpecular(0.0)
    if model.texels.size:
        surface.SetColor(1.0, 1.0, 1.0)
        data.GetPointData().SetTCoords(numpy_support.numpy_to_vtk(model.uvs))
        picture = vtk.vtkImageData()
        picture.SetDimensions(model.texels.shape[1], model.texels.shape[0], 1)
        picture.GetPointData().SetScalars(numpy_support.numpy_to_vtk(model.texels.reshape(-1, 4)[:, :3].copy()))
        texture = vtk.vtkTexture()
        texture.SetInputData(picture)
        texture.UseSRGBColorSpaceOn()
        texture.InterpolateOn()
        texture.MipmapOn()
        actor.SetTexture(texture)
    scene.AddActor(actor)

    camera = scene.GetActiveCamera()
    camera.SetViewUp(*UP)
    camera.SetViewAngle(YFOV_DEGREES)
    camera.SetFocalPoint(*job.target)
    camera.SetClippingRange(job.near, job.far)
    pixels = vtk.vtkUnsignedCharArray()

    def draw(view: int) -> Pixels:
        camera.SetPosition(*job.eyes[view])
        window.Render()
        window.GetRGBACharPixelData(0, 0, job.width - 1, job.height - 1, 0, pixels)
        return numpy_support.vtk_to_numpy(pixels).reshape(job.height, job.width, 4)[::-1]

    draw(0)
    note = f"VTK {vtk.vtkVersion.GetVTKVersion()}, {window.GetClassName()}"
    return Drawing(draw, max(1, window.GetMultiSamples()), linear=True, note=note)


def _f3d(job: Job, model: Model) -> Drawing:
    """Physically based shading, which it always computes; the ambient light is given to it as emission."""
    if job.samples > 1:
        raise SystemExit("it has no multisampling")
    f3d = import_module("f3d")
    f3d.Log.set_verbose_level(f3d.Log.VerboseLevel.QUIET)
    f3d.Engine.autoload_plugins()
    engine = f3d.Engine.create_egl()
    engine.window.size = job.width, job.height
    # It shows emission only where there is a texture of it.
    texture = str(Path(job.model) / "texture.png")
    color = (1.0, 1.0, 1.0) if model.texels.size else COLOR
    options: dict[str, Any] = {
        "render.background.color": list(BACKGROUND),
        "render.backface_type": "hidden",
        "model.material.roughness": 1.0,
        "model.material.metallic": 0.0,
        "model.color.rgb": _encoded(np.array(color)).tolist(),
        "model.emissive.factor": [AMBIENT * c for c in color],
        "model.emissive.texture": texture,
    }
    if model.texels.size:
        options["model.color.texture"] = texture
    engine.options.update(options)
    flat = {
        "points": model.positions,
        "normals": model.normals,
        "texture_coordinates": model.uvs,
        "face_indices": model.triangles.astype(np.uint32),
    }
    sides = np.full(len(model.triangles), 3, np.uint32).tolist()
    engine.scene.add(f3d.Mesh(face_sides=sides, **{name: array.ravel().tolist() for name, array in flat.items()}))
    engine.scene.remove_all_lights()
    away = tuple(-x for x in TOWARDS_LIGHT)
    engine.scene.add_light(f3d.LightState(f3d.LightType.SCENE_LIGHT, direction=away, intensity=math.pi * DIFFUSE))
    camera = engine.window.camera
    camera.view_angle = YFOV_DEGREES

    def draw(view: int) -> Pixels:
        # Each of these moves the others, up last of all.
        camera.position, camera.focal_point, camera.view_up = job.eyes[view], job.target, UP
        image = engine.window.render_to_image()
        return np.frombuffer(image.content, np.uint8).reshape(job.height, job.width, -1)[::-1]

    return Drawing(draw, 1, note=f"f3d {f3d.Engine.get_lib_info().version}")


def _pyrender(job: Job, model: Model) -> Drawing:
    """Physically based shading, which it always computes; it reads the depths of every picture too."""
    os.environ["PYOPENGL_PLATFORM"] = "egl"
    pyrender = import_module("pyrender")
    inside: Any = import_module("pyrender.renderer")
    store = inside.glRenderbufferStorageMultisample
    samples = min(4, job.samples) if job.samples > 1 else 0
    # It asks for 4 samples in any case.
    inside.glRenderbufferStorageMultisample = lambda target, _, *others: store(target, samples, *others)
    scene = pyrender.Scene(ambient_light=[AMBIENT] * 3, bg_color=[*BACKGROUND, 1.0])
    material = pyrender.MetallicRoughnessMaterial(metallicFactor=0.0, roughnessFactor=1.0, baseColorFactor=[*COLOR, 1.0])
    if model.texels.size:
        top_down = np.ascontiguousarray(model.texels[::-1, :, :3])
        material.baseColorFactor = np.ones(4)
        material.baseColorTexture = pyrender.Texture(source=top_down, source_channels="RGB")
    uvs = model.uvs if model.texels.size else None
    part = pyrender.Primitive(model.positions, model.normals, texcoord_0=uvs, indices=model.triangles, material=material)
    scene.add(pyrender.Mesh([part]))
    scene.add(pyrender.DirectionalLight(color=np.ones(3), intensity=math.pi * DIFFUSE), pose=_light_frame())
    lens = pyrender.PerspectiveCamera(math.radians(YFOV_DEGREES), znear=job.near, zfar=job.far)
    camera = scene.add(lens, pose=np.eye(4))
    renderer = pyrender.OffscreenRenderer(job.width, job.height)

    def draw(view: int) -> Pixels:
        scene.set_pose(camera, np.linalg.inv(_camera_from_world(job, view)))
        pixels: Pixels = renderer.render(scene)[0]
        return pixels

    return Drawing(draw, max(1, samples), note=f"pyrender {pyrender.__version__}")


_RENDERERS: dict[str, Callable[[Job, Model], Drawing]] = {
    "limner": _limner,
    "limner 4": _limner_4,
    "limner glTF": _limner_gltf,
    "limner image": _limner_image,
    "limner pose": _limner_pose,
    "limner still": _limner_still,
    "opengl": _opengl,
    "vtk": _vtk,
    "f3d": _f3d,
    "pyrender": _pyrender,
}


def _camera_from_world(job: Job, view: int) -> NDArray[Any]:
    return np.linalg.inv(_frame(np.array(job.eyes[view]), np.array(job.target)))


def _frame(eye: NDArray[Any], target: NDArray[Any]) -> NDArray[Any]:
    """(4, 4): world from what looks along its -z, +y up."""
    w = (eye - target) / np.linalg.norm(eye - target)
    u = np.cross(UP, w)
    u /= np.linalg.norm(u)
    return np.vstack([np.column_stack([u, np.cross(w, u), w, eye]), [0.0, 0.0, 0.0, 1.0]])


def _light_frame() -> NDArray[Any]:
    return _frame(np.array(TOWARDS_LIGHT), np.zeros(3))


def _projection(job: Job) -> NDArray[Any]:
    """(4, 4): OpenGL's clip space from the camera."""
    y = 1.0 / math.tan(math.radians(YFOV_DEGREES) / 2.0)
    near, far = job.near, job.far
    depth = [0.0, 0.0, -(far + near) / (far - near), -2.0 * far * near / (far - near)]
    return np.array([[y * job.height / job.width, 0.0, 0.0, 0.0], [0.0, y, 0.0, 0.0], depth, [0.0, 0.0, -1.0, 0.0]])


def _encoded(linear: NDArray[Any]) -> NDArray[Any]:
    """(..., 3 or 4): sRGB of linear light; alpha as it is."""
    values = np.clip(linear, 0.0, 1.0)
    rgb = values[..., :3]
    values[..., :3] = np.where(rgb <= 0.0031308, 12.92 * rgb, 1.055 * np.maximum(rgb, 0.0031308) ** (1.0 / 2.4) - 0.055)
    return values


# --- a process that draws --------------------------------------------------------------------------------------------------------


def _serve(words: str) -> None:
    """Draw what a job says; then answer each line on standard input with one on standard output."""
    # Libraries print what they like where they like; the answers keep the true standard output to themselves.
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)
    job = Job(**json.loads(words))
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, sorted(os.sched_getaffinity(0))[: job.threads])
    with np.load(Path(job.model) / "model.npz") as arrays:
        model = Model(**arrays)
    drawing = _RENDERERS[job.renderer](job, model)
    for view in range(WARM_FRAMES):
        drawing.draw(view)
    print(json.dumps({"samples": drawing.samples, "note": drawing.note}), file=answers, flush=True)
    for line in sys.stdin:
        asked = json.loads(line)
        if "budget" in asked:
            answer = _measured(drawing, asked["budget"])
        else:
            np.save(asked["picture"], _picture(drawing))
            answer = {}
        print(json.dumps(answer), file=answers, flush=True)


def _measured(drawing: Drawing, budget: float) -> dict[str, Any]:
    """Draw views until `budget` seconds are over, at least a few and at most all."""
    seconds: list[float] = []
    processor = time.process_time()
    started = time.perf_counter()
    while len(seconds) < N_VIEWS and (len(seconds) < LEAST_FRAMES or time.perf_counter() - started < budget):
        before = time.perf_counter()
        drawing.draw(STRIDE * len(seconds) % N_VIEWS)
        seconds.append(time.perf_counter() - before)
    cores = (time.process_time() - processor) / (time.perf_counter() - started)
    return {"median": statistics.median(seconds), "frames": len(seconds), "cores": cores}


def _picture(drawing: Drawing) -> NDArray[np.uint8]:
    """(height, width, 3) uint8 of the first view, sRGB."""
    pixels = np.array(drawing.draw(0))[..., :3]
    if drawing.linear:
        pixels = np.rint(255.0 * _encoded(pixels / 255.0 if pixels.dtype == np.uint8 else pixels)).astype(np.uint8)
    return pixels


# --- a process that measures them ------------------------------------------------------------------------------------------------


class Turn(NamedTuple):
    """One turn of one renderer: seconds of its median picture, and processor time over wall time."""

    median: float
    cores: float


@dataclass(frozen=True)
class Row:
    """What came out for one renderer.

    Parameters
    ----------
    coverage : float
        Part of the picture that is not background.
    mean : tuple of three floats
        Mean colour of those pixels, sRGB, 0 to 255.
    difference : float
        Mean absolute difference from limner's picture (`LIKENESS`), over what either covers, in 255ths.
    """

    name: str
    samples: int
    turns: tuple[Turn, ...]
    coverage: float
    mean: Vector
    difference: float

    @property
    def best(self) -> Turn:
        """The turn in which it was fastest."""
        return min(self.turns)


class Child:
    """A process that has a job and waits to be asked."""

    def __init__(self, python: str, job: Job) -> None:
        self.name = job.renderer
        environment = {**os.environ, "LP_NUM_THREADS": str(job.threads), "OMP_NUM_THREADS": str(job.threads), "PYTHONWARNINGS": "ignore"}
        self._said = tempfile.TemporaryFile("w+", errors="replace")  # noqa: SIM115 - lives as long as the process
        self._process = subprocess.Popen(
            [python, __file__, "--serve", json.dumps(asdict(job))], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=self._said,
            text=True, env=environment,
        )  # fmt: skip
        self.samples, self.note = 0, ""

    def wait_until_ready(self) -> None:
        """Wait for the first pictures; raise RuntimeError with what it said if there are none."""
        ready = self._answer()
        self.samples, self.note = ready["samples"], ready["note"]

    def measure(self, budget: float) -> Turn:
        """Let it draw for `budget` seconds."""
        answer = self._ask({"budget": budget})
        return Turn(answer["median"], answer["cores"])

    def picture(self, path: Path) -> NDArray[np.uint8]:
        """(height, width, 3) uint8: its picture of the first view."""
        self._ask({"picture": str(path)})
        return np.load(path)

    def __enter__(self) -> Child:
        return self

    def __exit__(self, *_: object) -> None:
        assert self._process.stdin is not None
        self._process.stdin.close()
        try:
            self._process.wait(10.0)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        self._said.close()

    def _ask(self, question: dict[str, Any]) -> dict[str, Any]:
        assert self._process.stdin is not None
        print(json.dumps(question), file=self._process.stdin, flush=True)
        return self._answer()

    def _answer(self) -> dict[str, Any]:
        assert self._process.stdout is not None
        line = self._process.stdout.readline()
        if not line:
            self._said.seek(0)
            said = self._said.read().strip().splitlines()
            raise RuntimeError(said[-1][:300] if said else f"ended with {self._process.wait()}")
        answer: dict[str, Any] = json.loads(line)
        return answer


def main() -> None:
    """Measure and print."""
    if sys.argv[1:2] == ["--serve"]:
        _serve(sys.argv[2])
        return
    asked = _options()
    pythons = {"limner": sys.executable}
    pythons |= {name: python for name in PEERS if (python := getattr(asked, name))}
    pythons |= dict.fromkeys(asked.variants, sys.executable)
    budget, rounds = (0.5, 1) if asked.quick else (1.5, 3)
    print(f"{platform.system()} {platform.machine()}, {os.cpu_count()} cores, Python {platform.python_version()}")
    print(f"not there (no Python given): {', '.join(name for name in PEERS if name not in pythons) or 'none'}")
    summary: list[str] = []
    with tempfile.TemporaryDirectory() as folder:
        for name, model in _models(asked.models, asked.dense):
            home = Path(folder) / name
            _write_model(home, model)
            for width, height in asked.sizes:
                for samples in asked.samples:
                    for threads in asked.threads:
                        job = _job(home, model, width, height, samples, threads)
                        title = f"{name}, {len(model.triangles)} triangles, {width} x {height}, {samples} sample(s), {threads} thread(s)"
                        print(f"\n{title}", flush=True)
                        rows = _compared(job, pythons, budget, rounds, asked.pictures)
                        _print_rows(rows)
                        summary.append(f"{title:79} {_ratio(rows)}")
    print("\nlimner to the fastest peer, pictures a second")
    print("\n".join(summary))


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("models", nargs="+", type=Path, metavar="MODEL", help="what limner can load; the first mesh of it is drawn")
    parser.add_argument("--dense", type=int, default=0, metavar="N", help="draw the last model again, split until it has N triangles")
    for name in PEERS:
        parser.add_argument(f"--{name}", metavar="PYTHON", help=f"the Python of an environment for {name}; without it, it is left out")
    parser.add_argument("--sizes", nargs="+", type=_size, default=[(512, 512), (1920, 1080)], metavar="WxH")
    parser.add_argument("--samples", nargs="+", type=int, default=[1, 8], help="of a pixel; Mesa draws 4 for 8")
    parser.add_argument("--threads", nargs="+", type=int, default=[2, 1])
    parser.add_argument("--variants", nargs="*", choices=VARIANTS, default=list(VARIANTS), help="other ways of limner's beside it")
    parser.add_argument("--quick", action="store_true", help="one short turn each")
    parser.add_argument("--pictures", type=Path, metavar="FOLDER", help="keep a picture of each renderer")
    asked = parser.parse_args()
    for name in PEERS:
        python = getattr(asked, name)
        if python and not shutil.which(python):
            parser.error(f"--{name}: there is no Python at {python}")
    return asked


def _size(words: str) -> tuple[int, int]:
    width, height = (int(word) for word in words.split("x"))
    return width, height


def _compared(job: Job, pythons: dict[str, str], budget: float, rounds: int, pictures: Path | None) -> list[Row]:
    """Start all, then measure them in turns; who cannot start is told and left out."""
    turns: dict[str, list[Turn]] = {}
    with ExitStack() as stack:
        children = []
        for name, python in pythons.items():
            if name == "limner 4" and job.samples <= 4:
                continue
            child = stack.enter_context(Child(python, replace(job, renderer=name)))
            try:
                child.wait_until_ready()
            except RuntimeError as reason:
                if name == "limner":
                    raise SystemExit(f"limner does not draw: {reason}") from None
                print(f"  {name}: not there ({reason})")
                continue
            children.append(child)
        for turn in range(rounds):
            for child in children[:: 1 if turn % 2 == 0 else -1]:
                turns.setdefault(child.name, []).append(child.measure(budget))
        seen = {child.name: child.picture(Path(job.model) / "picture.npy") for child in children}
    if pictures:
        _keep(pictures, job, seen)
    notes = dict.fromkeys(child.note for child in children if child.note)
    print(f"  ({'; '.join(notes)})" if notes else "  (no peers)")
    return [_row(child, tuple(turns[child.name]), seen) for child in children]


def _row(child: Child, turns: tuple[Turn, ...], seen: dict[str, NDArray[np.uint8]]) -> Row:
    picture, ours = seen[child.name], seen.get(LIKENESS.get(child.name, "limner"), seen["limner"])
    covered = _covered(picture)
    either = covered | _covered(ours)
    differences = np.abs(picture.astype(np.int16) - ours)[either]
    red, green, blue = picture[covered].mean(axis=0).tolist() if covered.any() else (0.0, 0.0, 0.0)
    return Row(child.name, child.samples, turns, float(covered.mean()), (red, green, blue), float(differences.mean()))


def _covered(picture: NDArray[np.uint8]) -> NDArray[np.bool_]:
    return (picture != np.array([255.0 * c for c in BACKGROUND])).any(axis=-1)


def _keep(folder: Path, job: Job, seen: dict[str, NDArray[np.uint8]]) -> None:
    from limner.image.png import png_bytes

    folder.mkdir(parents=True, exist_ok=True)
    for name, picture in seen.items():
        stem = f"{Path(job.model).name}-{job.width}x{job.height}-{job.samples}-{name.replace(' ', '-')}"
        (folder / f"{stem}.png").write_bytes(png_bytes(np.dstack([picture, np.full(picture.shape[:2], 255, np.uint8)])))


def _print_rows(rows: list[Row]) -> None:
    print("  renderer      samples  pictures/s      ms  (turns)                 cores  covered  mean colour      difference")
    for row in rows:
        best = row.best
        turns = " ".join(f"{1e3 * turn.median:.1f}" for turn in row.turns)
        mean = " ".join(f"{value:3.0f}" for value in row.mean)
        print(
            f"  {row.name:13} {row.samples:7} {1.0 / best.median:11.1f} {1e3 * best.median:7.1f}  ({turns:21})  {best.cores:5.2f}"
            f"  {100.0 * row.coverage:6.2f}%  {mean:11}      {row.difference:6.2f}"
        )
    print(f"  limner to the fastest peer: {_ratio(rows)}", flush=True)


def _ratio(rows: list[Row]) -> str:
    """How many times as many pictures as the fastest peer; with the peer's own number of samples too, if it is another."""
    by_name = {row.name: row for row in rows}
    peers = [row for row in rows if row.name in PEERS]
    if not peers or "limner" not in by_name:
        return "no peers"
    fastest = min(peers, key=lambda row: row.best)
    found = f"{fastest.best.median / by_name['limner'].best.median:.2f} ({fastest.name})"
    if "limner 4" in by_name:
        found += f", {fastest.best.median / by_name['limner 4'].best.median:.2f} with 4 samples both"
    return found


# --- the models ------------------------------------------------------------------------------------------------------------------


def _models(paths: Sequence[Path], dense: int) -> Iterator[tuple[str, Model]]:
    for path in paths:
        model = _load(path)
        yield path.stem, model
    if dense:
        while len(model.triangles) < dense:
            model = _split(model)
        yield f"{path.stem}-dense", model


def _load(path: Path) -> Model:
    """The first mesh of a file, in the world, with the texture of its colour."""
    import limner
    from limner.linear import transform
    from limner.mesh.mesh import Mesh
    from limner.mesh.normals import vertex_normals

    shapes = limner.load(str(path)).shapes()
    found = next(((placed, shape, shape.geometry) for placed, shape in shapes if isinstance(shape.geometry, Mesh)), None)
    if found is None:
        raise SystemExit(f"{path} holds no mesh")
    placed, shape, mesh = found
    if mesh.normals is None:
        mesh = replace(mesh, normals=vertex_normals(mesh.positions, mesh.triangles))
    normals = np.asarray(mesh.normals)
    uvs = np.zeros((len(mesh.positions), 2), np.float32) if mesh.uvs is None else mesh.uvs
    indices = [mesh.triangles if given is None else given for given in (mesh.triangles, mesh.normal_triangles, mesh.uv_triangles)]
    corners, triangles = np.unique(np.stack(indices, axis=-1).reshape(-1, 3), axis=0, return_inverse=True)
    texture = getattr(shape.materials[0], "base_color_texture", getattr(shape.materials[0], "texture", None))
    return Model(
        transform.transform_points(placed.world_from_object, mesh.positions[corners[:, 0]]).astype(np.float32),
        transform.transform_normals(placed.world_from_object, normals[corners[:, 1]]).astype(np.float32),
        uvs[corners[:, 2]],
        triangles.reshape(-1, 3).astype(np.int32),
        np.zeros((0, 0, 4), np.uint8) if texture is None else np.array(texture.texels.pixels),
    )


def _split(model: Model) -> Model:
    """Every triangle in four, at the middles of its edges; each edge is split once for both its sides.

    >>> corners, uvs = np.eye(3, dtype=np.float32), np.zeros((3, 2), np.float32)
    >>> model = Model(corners, corners, uvs, np.array([[0, 1, 2]], np.int32), np.zeros((0, 0, 4), np.uint8))
    >>> [len(_split(_split(model)).positions), len(_split(_split(model)).triangles)]
    [15, 16]
    """
    ends = np.sort(model.triangles[:, [[0, 1], [1, 2], [2, 0]]].astype(np.int64), axis=2)
    n = len(model.positions)
    keys, middle = np.unique(ends[..., 0] * n + ends[..., 1], return_inverse=True)
    a, b = keys // n, keys % n
    positions, normals, uvs = (np.concatenate([x, (x[a] + x[b]) / 2.0]).astype(np.float32) for x in model[:3])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-20)
    (i, j, k), (ij, jk, ki) = model.triangles.T, (n + middle.reshape(-1, 3)).T
    parts = [(i, ij, ki), (ij, j, jk), (ki, jk, k), (ij, jk, ki)]
    # Side by side, as the triangle itself was: neighbours in the mesh stay neighbours in memory.
    triangles = np.stack([np.stack(part, axis=-1) for part in parts], axis=1).reshape(-1, 3).astype(np.int32)
    return Model(positions, normals, uvs, triangles, model.texels)


def _write_model(folder: Path, model: Model) -> None:
    """What `_serve` and f3d read."""
    from limner.image.png import png_bytes

    folder.mkdir()
    np.savez(folder / "model.npz", **model._asdict())
    texels = model.texels[::-1] if model.texels.size else np.full((1, 1, 4), 255, np.uint8)
    (folder / "texture.png").write_bytes(png_bytes(np.ascontiguousarray(texels)))


def _job(folder: Path, model: Model, width: int, height: int, samples: int, threads: int) -> Job:
    """Look from a circle at the sphere around the model, from so near that it just fills the shorter side."""
    low, high = model.positions.min(axis=0).astype(np.float64), model.positions.max(axis=0).astype(np.float64)
    target = (low + high) / 2.0
    radius = float(np.linalg.norm(model.positions - target, axis=1).max())
    tangent = math.tan(math.radians(YFOV_DEGREES) / 2.0) * min(1.0, width / height)
    distance = radius / math.sin(math.atan(tangent))
    elevation = math.radians(ELEVATION_DEGREES)
    eyes = []
    for view in range(N_VIEWS):
        azimuth = math.radians(30.0) + 2.0 * math.pi * view / N_VIEWS
        outwards = (math.sin(azimuth) * math.cos(elevation), math.sin(elevation), math.cos(azimuth) * math.cos(elevation))
        x, y, z = (target + distance * np.array(outwards)).tolist()
        eyes.append((x, y, z))
    x, y, z = target.tolist()
    return Job("limner", str(folder), width, height, samples, threads, eyes, (x, y, z), distance - 1.01 * radius, distance + 1.01 * radius)


if __name__ == "__main__":
    main()
