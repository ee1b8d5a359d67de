"""A skinned or morphed scene in another pose: what a changed frame costs, against a scene that is new.

    python benchmarks/pose.py MODEL [MODEL …] [--renderer ray] [--width 320] [--height 240] [--pairs 9]

Two ways to the same pictures, in turns, A B B A A B …, in one process: a Renderer that is shown another time (`Renderer.show`), and one
that is made anew for it. CPU seconds, medians; every pair's pictures are compared bit by bit. Then the parts of a changed frame, each by
itself: bending the meshes, flattening, the tree over them built anew, and beside it the same tree with its boxes fitted to the new
vertices (`RayCaster.refit`). The renderers do not fit boxes: where two triangles are met at the very same t, which one is seen would
depend on the pose that the tree was made for, and a picture on those before it. The last column tells of how many rays that is so.
"""

from __future__ import annotations

import argparse
import statistics
import time
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pairs import LEAST_PAIRS

import limner
from limner.accel import bvh
from limner.linear.transform import transform_points
from limner.mesh.mesh import Mesh
from limner.scene.camera import Camera
from limner.scene.framing import with_defaults
from limner.scene.pose import animation_of, at
from limner.scene.scene import Scene
from limner.tables.build import Built, flatten
from limner.tables.camera import camera_record


def seconds(work: Callable[[], Any]) -> tuple[float, Any]:
    """CPU time of one call, and what came of it."""
    started = time.process_time()
    made = work()
    return time.process_time() - started, made


def frames(scene: Scene, times: NDArray[np.float64], options: dict[str, Any]) -> tuple[float, float]:
    """Median seconds of a frame by a Renderer that is shown another time, and by a new one."""
    again, anew = [], []
    with limner.Renderer(scene, time=float(times[0]), **options) as renderer:
        renderer.render()

        def shown(moment: float) -> limner.Image:
            renderer.show(time=moment)
            return renderer.render()

        for k, moment in enumerate(times[1:].tolist()):
            ways: list[Callable[[], limner.Image]] = [
                lambda moment=moment: shown(moment), lambda moment=moment: limner.render(scene, time=moment, **options),  # type: ignore[misc]
            ]
            order = (0, 1) if k % 2 == 0 else (1, 0)
            found = {way: seconds(ways[way]) for way in order}
            if not np.array_equal(found[0][1].pixels, found[1][1].pixels):
                raise SystemExit(f"the picture of time {moment:g} depends on those before it")
            again.append(found[0][0])
            anew.append(found[1][0])
    return statistics.median(again), statistics.median(anew)


def parts(scene: Scene, times: NDArray[np.float64], width: int, height: int) -> tuple[list[float], float]:
    """Median seconds of posing, flattening, building the tree and fitting it; and the share of rays that see another triangle."""
    camera = with_defaults(scene, width / height)[0].camera
    assert camera is not None
    built: Built | None = None
    caster: limner.RayCaster | None = None
    taken: list[list[float]] = []
    differing: list[float] = []
    for moment in times.tolist():
        posing, posed = seconds(lambda moment=moment: at(scene, moment))  # type: ignore[misc]
        flattening, built = seconds(lambda posed=posed, built=built: flatten(posed, camera, width, height, built, tessellate=False))  # type: ignore[misc]
        building, _ = seconds(lambda built=built: bvh.build(built.tables))  # type: ignore[misc]
        vertices, triangles = _soup(posed)
        if caster is None:
            caster = limner.RayCaster(vertices, triangles)
            continue
        fitting, _ = seconds(lambda caster=caster, vertices=vertices: caster.refit(vertices))  # type: ignore[misc]
        taken.append([posing, flattening, building, fitting])
        rays = _pixel_rays(camera, width, height)
        fitted, fresh = (one.intersect(*rays, threads=1) for one in (caster, limner.RayCaster(vertices, triangles)))
        differing.append(float(np.mean(fitted.triangle != fresh.triangle)))
    return [statistics.median(column) for column in zip(*taken, strict=True)], max(differing)


def _soup(scene: Scene) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """All triangles of a scene in the world."""
    vertices, triangles, first = [], [], 0
    for placed, shape in scene.shapes():
        if isinstance(shape.geometry, Mesh):
            vertices.append(transform_points(placed.world_from_object, shape.geometry.positions))
            triangles.append(shape.geometry.triangles.astype(np.int64) + first)
            first += len(vertices[-1])
    return np.concatenate(vertices), np.concatenate(triangles)


def _pixel_rays(camera: Camera, width: int, height: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Where the eye is, and (n, 3) the directions through the pixels' centres."""
    row = camera_record(camera, width, height, 1e-3, np.inf)[0]
    i, j = np.meshgrid(np.arange(width), np.arange(height))
    directions = row["corner"] + i[..., None] * row["dx"] + j[..., None] * row["dy"].astype(np.float64)
    return row["position"].astype(np.float64), directions.reshape(-1, 3)


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("models", nargs="+", type=Path, metavar="MODEL")
    parser.add_argument("--renderer", choices=["raster", "ray", "path"], default="ray")
    parser.add_argument("--width", type=int, default=320)
    parser.add_argument("--height", type=int, default=240)
    parser.add_argument("--pairs", type=int, default=LEAST_PAIRS)
    options = parser.parse_args()
    warnings.simplefilter("ignore", limner.LimnerWarning)
    chosen = {"width": options.width, "height": options.height, "renderer": options.renderer, "samples": 1, "threads": 1}
    print("ms of CPU           shown     anew  ratio |    pose flatten    tree  fitted  other hits")
    for path in options.models:
        scene = limner.load(path)
        animation = animation_of(scene)
        if animation is None:
            raise SystemExit(f"{path} has no animation")
        times = np.linspace(animation.start, animation.end, options.pairs + 1)
        limner.render(scene, time=float(times[0]), **chosen)  # compiles
        again, anew = frames(scene, times, chosen)
        spent, differing = parts(scene, times, options.width, options.height)
        told = " ".join(f"{1e3 * value:7.1f}" for value in spent)
        print(f"{path.stem:16} {1e3 * again:8.1f} {1e3 * anew:8.1f} {again / anew:6.2f} | {told} {100 * differing:9.3f} %")


if __name__ == "__main__":
    main()
