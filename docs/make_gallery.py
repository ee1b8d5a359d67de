"""Make the gallery: run examples, keep their pictures small, and write the page that shows them.

    python docs/make_gallery.py                   every example, and the page (half an hour on two cores)
    python docs/make_gallery.py glass whitted     these pictures anew, and the page
    python docs/make_gallery.py --page            the page alone

The words are the examples' own: the first paragraph of a docstring is the headline, the rest stands below the picture. A picture is a JPEG,
at most 800 pixels wide, a drawing a PNG of 64 colours; clips stay as they were written.
"""

from __future__ import annotations

import ast
import runpy
import sys
import tempfile
from pathlib import Path

from PIL import Image

ROOT = Path(__file__).resolve().parents[1]
EXAMPLES, PICTURES, PAGE = ROOT / "examples", ROOT / "docs" / "images" / "gallery", ROOT / "docs" / "gallery.md"
WIDEST = 800

GROUPS: dict[str, tuple[str, ...]] = {
    "People's work": (
        "product_shot", "material_chart", "materials_layers", "shadow_catcher", "turntable", "animation_clip", "contact_sheet",
        "drawing_sheet", "exploded", "point_cloud", "training_data", "thumbnail_folder", "trimesh_interop", "layers", "denoising",
        "scene_file", "usd_scene", "renderers", "wires",
    ),
    "Why does it look like that?": ("explain_pixel", "explain_doctor", "pipeline_stages"),
    "Pictures, samples and colour": (
        "raster_sampling", "raster_halftone", "antialiasing", "color_charts", "color_lights", "views_and_exposure",
        "camera_pictures", "color_spaces",
    ),
    "Ray tracing": ("whitted", "lights", "solids", "glass", "distribution", "instances", "ray_batches"),
    "Light from everywhere": ("cornell", "caustic", "furnace", "noise_budget"),
    "Transformations and views": ("transforms_sheet", "viewing_spaces", "viewing_projections", "curve_camera", "car"),
    "The graphics pipeline": ("painter", "shading_frequency", "draw_lines", "draw_shapes"),
    "Shading and drawing": ("highlights", "drawing_styles", "wireframes"),
    "Textures": (
        "texture_filters", "texture_projections", "unwrap", "procedural_textures", "bump_maps", "normal_maps", "displacement", "cube_map",
    ),
    "Meshes, trees and curves": (
        "mesh_primitives", "subdivision", "repair", "curvature", "accelerators", "curve_drawings", "curve_surfaces", "distance_fields",
    ),
}  # fmt: skip

SUFFIXES = {"turntable": ".webp", "animation_clip": ".webp"}  # what is no PNG

DRAWINGS = {"drawing_sheet", "draw_lines", "draw_shapes", "drawing_styles", "wireframes", "curve_drawings", "antialiasing"}

HEAD = """# Gallery

Each picture is made by one short script that needs nothing but limner:

```
python examples/whitted.py whitted.png            # as it stands here
python examples/whitted.py whitted.png --small    # in a second or two, to try
```

The numbers in brackets are sections of the course; the [course map](course-map.md) leads from each section to functions and tests.
[`examples/notebook.ipynb`](../examples/notebook.ipynb) shows the same in Jupyter.
"""


def told(name: str) -> tuple[str, str]:
    """The headline of an example, and what else its docstring says."""
    paragraphs = (ast.get_docstring(ast.parse((EXAMPLES / f"{name}.py").read_text(encoding="utf-8"))) or "").split("\n\n")
    rest = [text for text in paragraphs[1:] if not text.lstrip().startswith("python examples/")]
    return " ".join(paragraphs[0].split()), "\n\n".join(" ".join(text.split()) for text in rest)


def page() -> str:
    """The gallery as Markdown."""
    parts = [HEAD]
    for group, names in GROUPS.items():
        parts.append(f"## {group}\n")
        for name in names:
            headline, rest = told(name)
            shown = next(PICTURES.glob(f"{name}.*")).name
            title, _, said = headline.partition(":")
            title = title.rstrip(".")
            said = said.strip()
            words = f"{said[:1].upper()}{said[1:]}" if said else ""
            parts.append(f"### {title}\n\n![{title}](images/gallery/{shown})\n")
            parts += [f"{text}\n" for text in (words, rest) if text]
            parts.append(f"[`examples/{name}.py`](../examples/{name}.py)\n")
    return "\n".join(parts)


def keep(made: Path, name: str) -> Path:
    """Put a picture among the others, as small as it may be."""
    for old in PICTURES.glob(f"{name}.*"):
        old.unlink()
    if made.suffix == ".webp":
        kept = PICTURES / made.name
        kept.write_bytes(made.read_bytes())
        return kept
    with Image.open(made) as opened:
        picture = opened.convert("RGB")
    picture.thumbnail((WIDEST, WIDEST), Image.Resampling.LANCZOS)
    if name in DRAWINGS:
        kept = PICTURES / f"{name}.png"
        picture.quantize(64).save(kept, optimize=True)
    else:
        kept = PICTURES / f"{name}.jpg"
        picture.save(kept, quality=86, optimize=True, progressive=True)
    return kept


def run(name: str) -> None:
    """Run an example in full size and keep its picture."""
    with tempfile.TemporaryDirectory() as folder:
        made = Path(folder) / f"{name}{SUFFIXES.get(name, '.png')}"
        sys.argv = [str(EXAMPLES / f"{name}.py"), str(made)]
        runpy.run_path(sys.argv[0], run_name="__main__")
        kept = keep(made, name)
    sys.stdout.write(f"{kept.relative_to(ROOT)}: {kept.stat().st_size // 1024} KiB\n")


def main(words: list[str]) -> None:
    """Pictures, then the page."""
    sys.path.insert(0, str(EXAMPLES))
    PICTURES.mkdir(parents=True, exist_ok=True)
    names = [name for group in GROUPS.values() for name in group]
    for name in [] if "--page" in words else words or names:
        run(name)
    PAGE.write_text(page(), encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
