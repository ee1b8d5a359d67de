"""The promise of the first page: no GPU, no display, no system graphics library. Tested by what the process maps."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

_RENDER = """
import sys
import numpy as np
import limner

corners = np.array([[-1, -1, 0], [1, -1, 0], [0, 1, 0]], dtype=np.float32)
mesh = limner.Mesh(corners, np.array([[0, 1, 2]], dtype=np.int32))
ball = limner.Shape(limner.Sphere(0.5), limner.BlinnPhong(specular=(1, 1, 1)))
scene = limner.Scene(limner.Node("world", shapes=(limner.Shape(mesh), ball)))
image = limner.render(scene, width=16, height=16, renderer=sys.argv[1], aovs=("depth",))
for name in ("a.png", "a.exr", "a.jpg"):
    image.save(name)
assert image.pixels.std() > 0.0
print(open("/proc/self/maps").read())
"""

# what the peers need and a bare container lacks, and what tells of a compiler or a thread runtime taken from the system
_FORBIDDEN = re.compile(
    r"lib(GL|EGL|GLX|GLES|OpenGL|OSMesa|gbm|drm|glapi|X11|xcb|wayland|vulkan|OpenCL|cuda|nvidia|LLVM|gomp|iomp|tbb)[^/]*\.so",
    re.IGNORECASE,
)


def _shared_objects(maps: str) -> set[str]:
    paths = (line.split(maxsplit=5)[-1] for line in maps.splitlines() if line.count("/"))
    return {path for path in paths if re.search(r"\.so(\.|$)", path)}


@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc/self/maps")
@pytest.mark.parametrize("renderer", ["raster", "ray"])
def test_rendering_maps_no_graphics_library(tmp_path: Path, renderer: str) -> None:
    """Two shapes, rendered and saved in three formats, map Python, its packages and the C runtime: nothing that draws.

    Libraries that a wheel brings along, inside site-packages, are no system libraries.
    """
    environment = {name: value for name, value in os.environ.items() if name != "DISPLAY"}
    done = subprocess.run(
        [sys.executable, "-W", "ignore", "-c", _RENDER, renderer],
        cwd=tmp_path, env=environment, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    mapped = _shared_objects(done.stdout)
    assert any("libc" in path for path in mapped)  # the maps were read
    found = {path for path in mapped if _FORBIDDEN.search(path.rpartition("/")[2]) and "site-packages" not in path}
    assert not found


def test_the_pattern_knows_what_it_forbids() -> None:
    """The check itself would see the libraries that it is about, and lets pass what every process maps."""
    draws = ["libGL.so.1", "libGLX_mesa.so.0", "libEGL.so.1", "libOSMesa.so.8", "libX11.so.6", "libvulkan.so.1"]
    compiles = ["libLLVM-15.so.1", "libgomp.so.1", "libtbb.so.12", "libOpenCL.so.1"]
    assert all(_FORBIDDEN.search(name) for name in draws + compiles)
    runtime = ["libc.so.6", "libm.so.6", "libz.so.1", "libstdc++.so.6", "libgcc_s.so.1"]
    assert not any(_FORBIDDEN.search(name) for name in runtime)
