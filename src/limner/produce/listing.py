"""What a data set says about itself: `cameras.json` for who reconstructs, `annotations.json` for who trains.

Every camera stands in `cameras.json` three times over, since everyone needs it in other words: K and world_to_camera as OpenCV has
them, camera_to_world as OpenGL, Blender and NeRF have it. `annotations.json` is COCO's format with masks as uncompressed run lengths.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..scene.camera import Camera, PerspectiveCamera
from .folder import json_bytes
from .masks import Region, regions

__all__ = ["FORMAT", "SeenIds", "coco_annotations", "head", "view"]

FORMAT = "limner dataset 1"
_CONVENTIONS = {
    "K": "pixels; the centre of the first pixel is (0, 0); orthographic: pixels per metre, no division by depth",
    "world_to_camera": "4x4, OpenCV: x right, y down, z forward",
    "camera_to_world": "4x4, OpenGL: x right, y up, looking along -z",
    "depth": "along the gaze, metres; inf: nothing",
}


class SeenIds(NamedTuple):
    """One view as annotations need it.

    Attributes
    ----------
    number : int
        From 1; COCO's tools take 0 for nothing.
    file_name : str
    instances : (height, width) int32
    categories : (height, width) int32
        Instance or material ids; -1: nothing.
    """

    number: int
    file_name: str
    instances: NDArray[np.int32]
    categories: NDArray[np.int32]


def view(camera: Camera, index: int, width: int, height: int, files: Mapping[str, str]) -> dict[str, Any]:
    """A line of `cameras.json`."""
    matrix, world_to_camera = camera.to_opencv(width, height)
    return {
        "index": index,
        "name": camera.name,
        "model": "pinhole" if isinstance(camera, PerspectiveCamera) else "orthographic",
        "width": width,
        "height": height,
        "K": matrix.tolist(),
        "world_to_camera": world_to_camera.tolist(),
        "camera_to_world": camera.to_opengl().tolist(),
        "files": dict(files),
    }


def head(recipe: Mapping[str, Any], id_names: Mapping[str, Sequence[str]], views: Sequence[Any]) -> dict[str, Any]:
    """What `cameras.json` says of all views; `plan` is one number for everything that a resumed data set must share."""
    names = {channel_name: list(known) for channel_name, known in id_names.items()}
    plan = hashlib.sha256(json_bytes({"recipe": recipe, "views": views, "id_names": names})).hexdigest()
    return {
        "format": FORMAT,
        "conventions": _CONVENTIONS,
        "recipe": dict(recipe),
        "n_planned": len(views),
        "plan": plan,
        "id_names": names,
    }


def coco_annotations(by: str, names: Sequence[str], seen: Iterable[SeenIds]) -> dict[str, Any]:
    """The content of `annotations.json`.

    Parameters
    ----------
    by : "instance" | "material"
        One annotation for every instance that is seen; or one for every material on every instance.
    names : sequence of str
        Of the ids of that kind; each name is a category.
    seen : iterable of SeenIds

    **Source**: COCO's data format (cocodataset.org/#format-data): object detection, with "counts" as a list.
    """
    category_ids = {name: place + 1 for place, name in enumerate(dict.fromkeys(names))}
    images: list[dict[str, Any]] = []
    found: list[dict[str, Any]] = []
    for number, file_name, instances, categories in seen:
        height, width = instances.shape
        images.append({"id": number, "file_name": file_name, "width": width, "height": height})
        for instance, category, region in _parts(instances, categories, by):
            found.append(
                {
                    "id": len(found) + 1,
                    "image_id": number,
                    "category_id": category_ids[names[category]],
                    "instance_id": instance,
                    "bbox": list(region.bbox),
                    "area": region.area,
                    "iscrowd": 0,
                    "segmentation": {"size": [height, width], "counts": list(region.counts)},
                }
            )
    told = [{"id": number, "name": name, "supercategory": by} for name, number in category_ids.items()]
    return {"images": images, "categories": told, "annotations": found}


def _parts(instances: NDArray[np.int32], categories: NDArray[np.int32], by: str) -> Iterator[tuple[int, int, Region]]:
    """What is annotated: instance, category, pixels; ascending."""
    if by == "instance":
        for region in regions(instances):
            yield region.id, region.id, region
        return
    n = int(categories.max(initial=0)) + 1
    pairs = np.where((instances >= 0) & (categories >= 0), instances.astype(np.int64) * n + categories, -1)
    for region in regions(pairs):
        yield region.id // n, region.id % n, region
