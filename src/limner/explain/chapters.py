"""Which kernels a story tells of, what it calls them, and what of them it shows: one table.

The story follows the kernels' own calls. A kernel that has a chapter here becomes a step; one that has none is folded: what it calls is
told in its place. So a kernel that is renamed or added costs its line, never the story; and what evaluates, samples or weighs in a room
of shading is told of even where no line here knows it, by the last rows of the table.
"""

from __future__ import annotations

from fnmatch import fnmatchcase
from typing import NamedTuple

__all__ = ["CHAPTERS", "Chapter", "chapter_of"]


class Chapter(NamedTuple):
    """How a kernel is told of.

    Attributes
    ----------
    kernel : str
        ``room.module.function``, where * stands for anything.
    title : str
        Words, with {names} of arguments; empty: what the kernel's docstring says.
    shows : tuple of str
        Arguments to show, those that are numbers, vectors or rows of tables.
    is_leaf : bool
        Whether what it calls is left out.
    is_hidden : bool
        Whether it is left out with all it calls.
    is_folded : bool
        Whether it is left out, and what it calls is told in its place.
    """

    kernel: str
    title: str = ""
    shows: tuple[str, ...] = ()
    is_leaf: bool = False
    is_hidden: bool = False
    is_folded: bool = False


CHAPTERS = (
    # Seeing
    Chapter("shading.analytic.view_ray", "the ray through raster point ({x}, {y})", ("x", "y"), is_leaf=True),
    Chapter("raytrace.lens.lens_ray", "the ray through a point of the lens", ("x", "y", "u", "v"), is_leaf=True),
    Chapter("accel.walk.first_hit", "what the ray meets first", ("o", "d", "t_min", "t_max"), is_leaf=True),
    Chapter("accel.walk.nearest", "what the shadow ray meets", ("o", "d", "t_min", "t_max"), is_leaf=True),
    Chapter("accel.walk.occluded", "whether anything is in the way", ("o", "d", "t_min", "t_max"), is_leaf=True),
    Chapter("raytrace.start.*", is_hidden=True),
    Chapter("kernel.sampler.*", is_hidden=True),
    Chapter("shading.visible.is_analytic", is_hidden=True),
    Chapter("shading.visible._seen_from_behind", is_hidden=True),
    # The surface
    Chapter("shading.visible.visible_point", "the point that raster point ({x}, {y}) sees", ("instance_id", "triangle", "x", "y")),
    Chapter("visibility.hit.first_hit_point", "the point that the eye's ray meets", ("hit", "x", "y")),
    Chapter("visibility.hit.lens_hit_point", "the point that the lens' ray meets", ("hit",)),
    Chapter("visibility.hit.hit_point", "the point that the ray meets", ("hit", "o", "d")),
    Chapter("shading.surface.barycentrics_at", "barycentric weights, perspective-correct", ("x", "y", "v0", "v1", "v2"), is_leaf=True),
    Chapter("shading.surface.barycentrics_of_hit", "barycentric weights of the hit", ("u", "v"), is_leaf=True),
    Chapter("shading.surface.surface_at", "the corners' values, interpolated", ("instance", "triangle"), is_leaf=True),
    Chapter("shading.surface.flip_to_front", "normals turned to the viewer's side", ("wo",), is_leaf=True),
    Chapter("shading.visible.direction_to_eye", "direction to the eye", ("p",), is_leaf=True),
    # Matter
    Chapter("shading.bsdf.resolve", "what {material} is at this point", ("material",)),
    Chapter("shading.bsdf.shading_normal", "shading normal", ("material",)),
    Chapter("shading.bsdf.seen_in_mirrors", "the shading normal as mirrors can use it", (), is_leaf=True),
    Chapter("shading.bsdf.eval_bsdf", "what the surface returns of irradiance", ("wo", "wi")),
    Chapter("shading.bsdf.alpha_at", "the material's coverage", ("material",)),
    Chapter("shading.bsdf.tint_at", "what the surface colours light with", ("material",)),
    Chapter("shading.texture.sample_texture", "{texture} looked up", ("texture",)),
    Chapter("shading.texture.sample_place", "{texture} looked up at ({u}, {v})", ("texture",)),
    Chapter("shading.texture.place_in", "where in the texture", ("texture",), is_leaf=True),
    Chapter("shading.texture.level_of_detail", "mipmap level", ("dudx", "dvdx", "dudy", "dvdy"), is_leaf=True),
    Chapter("shading.texture._trilinear", "between two mipmap levels", ("lod", "s", "t")),
    Chapter("shading.texture._in_two_levels", "between two mipmap levels", ("level", "b", "s", "t")),
    Chapter("shading.texture._bilinear", "four texels of level {level}", ("level", "s", "t")),
    Chapter("shading.texture._in_level", "four texels of level {level}", ("level", "s", "t")),
    Chapter("shading.texture._four_places", "which four, and their weights", ("s", "t", "w", "h"), is_leaf=True),
    Chapter("shading.texture._nearest", "the nearest texel", ("s", "t"), is_leaf=True),
    Chapter("shading.texture._texel", "a texel", ("place",), is_leaf=True),
    Chapter("shading.texture._deep_texel", "a texel", ("place",), is_leaf=True),
    Chapter("shading.texture._anisotropic", "several probes along the footprint", ("u", "v"), is_leaf=True),
    Chapter("shading.texture._fold", is_hidden=True),
    Chapter("shading.texture._neighbour", is_hidden=True),
    Chapter("shading.texture._decoded", is_hidden=True),
    Chapter("shading.texture.*"),
    Chapter("shading.analytic.*", is_hidden=True),
    Chapter("shading.exact.*", "the point on the exact shape", (), is_leaf=True),
    Chapter("shading.surface.*", is_hidden=True),
    # Light
    Chapter("shading.lights.illuminate", "what arrives from {light}, if nothing hides it", ("light", "p"), is_leaf=True),
    Chapter("shading.area_lights.sample_light", "a point of {light}", ("light", "p", "u", "v"), is_leaf=True),
    Chapter("shading.area_lights.has_area", is_hidden=True),
    Chapter("shading.lights.lit_radiance", "what the surface returns of one light", ("wo", "light")),
    Chapter("shading.lights.ambient_radiance", "ambient light", (), is_leaf=True),
    Chapter("shading.lights.ambient_level", "ambient light", (), is_leaf=True),
    Chapter("shading.sky.ambient_from_sky", "light from all around the sky", ("wo",), is_leaf=True),
    Chapter("shading.sky.sky_radiance", "the sky in this direction", ("d",), is_leaf=True),
    Chapter("shading.sky.sample_sky", "a direction of the sky", ("u", "v"), is_leaf=True),
    Chapter("shading.light_tree.*", is_hidden=True),
    Chapter("shading.emitters.sample_emitter", "a point of a surface that shines", ("p", "choice", "u", "v"), is_leaf=True),
    Chapter("visibility.shadow.transmittance", "how much of it gets here", ("wi", "distance")),
    Chapter("raster.shadow.*"),
    # Transport
    Chapter("shading.dielectric.meet_interface", "reflected and refracted (Fresnel, Snell)", ("n", "d", "n_i", "n_t")),
    Chapter("shading.dielectric.reflectance", "how much is reflected", ("cos_i", "cos_t", "n_i", "n_t")),
    Chapter("shading.sample.sample_bsdf", "a direction drawn by how the surface scatters", ("wo", "choice", "u", "w")),
    Chapter("shading.medium.passed", "what the medium lets through", ("inside", "distance"), is_leaf=True),
    Chapter("shading.medium.*", is_hidden=True),
    Chapter("raytrace.*balance", "the balance heuristic's weight (MIS)", ("a", "b"), is_leaf=True),
    Chapter("raytrace.*.chance_weight", "the weight of a light that was met by chance", ("pdf",)),
    Chapter("raytrace.*._push", "a ray that is to be followed", ("o", "d", "throughput"), is_leaf=True),
    Chapter("raytrace.*._direct", "light that comes straight from lights, shining surfaces and the sky"),
    Chapter("raytrace.*.from_lights", "light that comes straight from the lights"),
    Chapter("raytrace.*.emitters_asked", "light that comes straight from surfaces that shine"),
    Chapter("raytrace.*.sky_asked", "light that comes straight from the sky"),
    Chapter("raytrace.*._with_lights", "light from every light that is not hidden"),
    Chapter("raytrace.*._local_radiance", "light that this surface returns itself"),
    Chapter("raytrace.*._emitters_radiance", "light from surfaces that shine"),
    Chapter("raytrace.*._behind", "what lies behind everything"),
    Chapter("raytrace.*._shown", "what the surface gives off itself", (), is_leaf=True),
    Chapter("raytrace.*._lit_share", "how much of the light falls on the shadow catcher"),
    Chapter("raytrace.whitted.radiance", "a tree of rays"),
    Chapter("raytrace.path.path_radiance", "a path"),
    # The pipeline
    Chapter("raster.clip.clip_polygon", "clipped against five planes: how many vertices are left", ("near",), is_leaf=True),
    Chapter("raster.assemble._emit", "a triangle on the subpixel grid", ("x0", "y0", "x1", "y1", "x2", "y2"), is_leaf=True),
    Chapter("raster.fill.fill_opaque", "which triangle does each sample see?"),
    Chapter("raster.fill.fill_transparent", "the next layer of what is half transparent"),
    Chapter("raster.fragment.shade_fragments", "the colours of what is seen"),
    Chapter("raster.fragment._shade", "light meets matter"),
    Chapter("raster.fragment._shade_eight", "a fragment", ("instance_id", "triangle", "x", "y")),
    Chapter("raster.fragment._gouraud", "the three vertices shaded, their colours interpolated"),
    Chapter("raster.fragment._behind", "what lies behind everything"),
    Chapter("raster.tile._add_backdrop", "the background, with the weight of the samples that see it"),
    Chapter("raster.tile._add", "added to the film", ("r", "g", "b", "alpha"), is_leaf=True),
    Chapter("raster.tile._blend_layer", "a layer put behind those before it", (), is_leaf=True),
    # What is not known by name
    Chapter("shading.*.eval_*"),
    Chapter("shading.*.sample_*"),
    Chapter("shading.*.pdf_*"),
    Chapter("shading.*._*", is_folded=True),
    Chapter("shading.*"),
)
"""The first line that fits a kernel counts."""


def chapter_of(name: str) -> Chapter | None:
    """The chapter of the kernel ``limner.module.function``; None: it is folded."""
    short = name.removeprefix("limner.")
    found = next((chapter for chapter in CHAPTERS if fnmatchcase(short, chapter.kernel)), None)
    return None if found is None or found.is_folded else found
