"""The others in the raster benchmark: software OpenGL, by itself and through three libraries.

It is read in the peers' environments, too, which have NumPy but no limner: what either needs is imported where it is used.
"""

from __future__ import annotations

import math
import os
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
from raster_job import AMBIENT, BACKGROUND, COLOR, DIFFUSE, TOWARDS_LIGHT, UP, YFOV_DEGREES, Drawing, Job, Model, Pixels
from raster_views import camera_from_world, clip_from_camera, encoded, light_frame

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


def opengl(job: Job, model: Model) -> Drawing:
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
    projection = clip_from_camera(job)
    pixels = np.empty((job.height, job.width, 4), np.uint8)

    def draw(view: int) -> Pixels:
        drawn.use()
        drawn.clear(*BACKGROUND, 1.0)
        program["clip_from_world"].write((projection @ camera_from_world(job, view)).T.astype(np.float32).tobytes())
        mesh.render()
        if drawn is not seen:
            context.copy_framebuffer(seen, drawn)
        seen.read_into(pixels, components=4)
        return pixels[::-1]

    return Drawing(draw, max(1, samples), note=f"{context.info['GL_RENDERER']}, OpenGL {context.info['GL_VERSION']}")


def vtk(job: Job, model: Model) -> Drawing:
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


def f3d(job: Job, model: Model) -> Drawing:
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
        "model.color.rgb": encoded(np.array(color)).tolist(),
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


def pyrender(job: Job, model: Model) -> Drawing:
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
    scene.add(pyrender.DirectionalLight(color=np.ones(3), intensity=math.pi * DIFFUSE), pose=light_frame())
    lens = pyrender.PerspectiveCamera(math.radians(YFOV_DEGREES), znear=job.near, zfar=job.far)
    camera = scene.add(lens, pose=np.eye(4))
    renderer = pyrender.OffscreenRenderer(job.width, job.height)

    def draw(view: int) -> Pixels:
        scene.set_pose(camera, np.linalg.inv(camera_from_world(job, view)))
        pixels: Pixels = renderer.render(scene)[0]
        return pixels

    return Drawing(draw, max(1, samples), note=f"pyrender {pyrender.__version__}")
