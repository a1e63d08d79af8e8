"""glTF's metallic-roughness materials as BSDFs of mitsuba, by one of four models.

`layered` is the GL frame's own surface (layered.py). The others are of mitsuba's plugins. Their
metals are principled BSDFs (Burley 2012), whose Fresnel term and GGX width, roughness squared, are
glTF's own; light that bounces between facets is lost. What is no metal is in `gltf` Lambert's
surface and the reflection of a rough dielectric (index 1.5, so 4 % at normal incidence), the paint
having what the coat leaves on average; in `bare` Lambert's surface alone; in `principled` Burley's,
whose diffuse lobe sends more light back to where it came from, a fifth more from rough surfaces.
Mitsuba's `roughplastic` cannot stand for any: it loses half of the light at a roughness of 0.7.
Back sides are lit like front sides.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from path_tracer.bitmaps import bitmap
from path_tracer.body import body
from path_tracer.fronts import front_alone
from path_tracer.layered import PANE, PLUGIN, register
from path_tracer.settings import PathTracerSettings, SurfaceModel
from path_tracer.terms import mitsubas_pane, sampler_of, terms_of
from path_tracer.textures import Maps, maps_of
from vrut_lite.geometry.colour import LUMENS_PER_WATT
from vrut_lite.geometry.reflection import DIELECTRIC_F0, reflectance_table
from vrut_lite.messages.scene_content import Material, Sampler

Plugin = dict[str, Any]
# Attribute of vertices' colours, by mitsuba's rule for names.
VERTEX_COLOUR = "vertex_color"
# Burley's `specular` parameter for 4 % at normal incidence.
_DIELECTRIC_SPECULAR = 0.5
# Factor of surfaces before mitsuba blends two in halves: their mean is then the sum.
_DOUBLED = 2.0
_LEAST_ALPHA = 2e-3
_REPEATED = Sampler()
# Half a step of 8 bits: vertex colours that differ by no more are one.
_SAME_COLOUR = 0.002
# So far, of the largest channel, colours of one hue may be from shades of it.
_SAME_HUE = 0.02


def model_of(settings: PathTracerSettings, mitsuba: Any) -> SurfaceModel:
    """The model that the settings mean in the variant of mitsuba that is set."""
    if settings.surfaces != "auto":
        return settings.surfaces
    return "gltf" if mitsuba.variant().startswith("scalar") else "layered"


def matte(albedo_rgb: NDArray[np.float64]) -> Plugin:
    """Lambert's surface, seen from both sides."""
    return _both_sides({"type": "diffuse", "reflectance": _rgb(np.clip(albedo_rgb, 0.0, 1.0))})


def surface(
    mitsuba: Any,
    material: Material,
    layer: int,
    vertex_colours: NDArray | None,
    model: SurfaceModel = "gltf",
    units_per_m: float = 1.0,
) -> Plugin:
    """The BSDF of a material whose maps lie on this layer of texture coordinates.

    `vertex_colours` (V, 4) multiply the base colour; the mesh has `painted_vertices` of them as
    its attribute. `units_per_m` is the length of a metre in the tracer.
    """
    maps = maps_of(material, layer)
    if material.terms.transmits and not material.terms.is_pane and material.metallic < 1.0:
        return _cut_out(mitsuba, body(mitsuba, material, units_per_m), material, maps)
    metallic = _number_or_map(
        mitsuba, material.metallic, maps.metallic, sampler_of(material, "metallic_roughness")
    )
    if model == "layered":
        paint = _layered(mitsuba, material, maps, vertex_colours, metallic)
    elif model == "principled" or metallic == 1.0:
        paint = _burleys(mitsuba, material, maps, vertex_colours, metallic)
    else:
        painted = _coated if model == "gltf" else _bare
        paint = painted(mitsuba, material, maps, vertex_colours)
        if metallic != 0.0:
            metal = _burleys(mitsuba, material, maps, vertex_colours, 1.0)
            paint = {"type": "blendbsdf", "weight": metallic, "a": paint, "b": metal}
    # Mitsuba's maps of normals end light that passes straight on.
    if maps.normal is not None and paint["type"] != PANE:
        paint = {
            "type": "normalmap",
            "normalmap": bitmap(mitsuba, maps.normal, sampler_of(material, "normal")),
            "bsdf": paint,
        }
    if paint["type"] == PANE:
        return _cut_out(mitsuba, paint, material, maps)
    if material.terms.transmits and material.metallic < 1.0:
        return _cut_out(
            mitsuba, mitsubas_pane(mitsuba, material, maps, _both_sides(paint)), material, maps
        )
    return _cut_out(mitsuba, _both_sides(paint), material, maps)


def emission(mitsuba: Any, material: Material, layer: int, repeats: bool) -> Plugin | None:
    """The emitter of a glowing material, or None.

    glTF gives cd m^-2. A map that `repeats` glows by its mean: mitsuba finds a glowing texel's
    place from its coordinates, which must be one.
    """
    glow = np.asarray(material.emission_rgb, dtype=float)
    if not np.any(glow > 0.0):
        return None
    texels = maps_of(material, layer).emission
    if texels is not None and repeats:
        glow, texels = texels.mean(axis=(0, 1)), None
    if texels is None:
        return {"type": "area", "radiance": _rgb(glow / LUMENS_PER_WATT)}
    return {
        "type": "area",
        "radiance": bitmap(
            mitsuba, texels / np.float32(LUMENS_PER_WATT), sampler_of(material, "emission")
        ),
    }


def painted_vertices(
    material: Material, layer: int, vertex_colours: NDArray, model: SurfaceModel = "gltf"
) -> NDArray[np.float32]:
    """The mesh's attribute for `surface` from vertices' colours (V, 4): colours (V, 3) or weights.

    Under a map, colours of one hue are weights (V, 1). To colours of many hues it lends its mean
    hue; where it has many itself, no channel of the product goes beyond 1.
    """
    if model == "layered":
        return np.asarray(vertex_colours[:, :3], np.float32)
    texels = maps_of(material, layer).base_colour
    if texels is None:
        return np.asarray(vertex_colours[:, :3] * material.base_colour_rgba[:3], np.float32)
    shades = _shades_of_one_hue(vertex_colours)
    if shades is not None:
        return shades[0]
    colours = vertex_colours[:, :3] * _brightness_and_hue(texels)[1]
    return np.minimum(colours, 1.0).astype(np.float32)


def colours_vary(vertex_colours: NDArray) -> bool:
    """Whether colours (V, 4) of a mesh's vertices are more than one."""
    return bool(np.any(np.ptp(vertex_colours[:, :3], axis=0) > _SAME_COLOUR))


def _layered(
    mitsuba: Any,
    material: Material,
    maps: Maps,
    vertex_colours: NDArray | None,
    metallic: Any,
) -> Plugin:
    """The GL frame's own surface: vertices' colours multiply the base colour, map or not."""
    register(mitsuba)
    tint = np.ones(3) if vertex_colours is None else vertex_colours[0, :3]
    varies = vertex_colours is not None and colours_vary(vertex_colours)
    texels = maps.base_colour
    if texels is None:
        texels = np.asarray(material.base_colour_rgba[:3], np.float32)[None, None]
    base_sampler = sampler_of(material, "base_colour")
    colour = texels if varies else np.asarray(texels * tint, np.float32)
    made = {
        "type": PLUGIN,
        "base_color": bitmap(mitsuba, colour, base_sampler),
        "roughness": _number_or_map(
            mitsuba, material.roughness, maps.roughness, sampler_of(material, "metallic_roughness")
        ),
        "metallic": metallic,
        **terms_of(mitsuba, material, maps),
    }
    return {**made, "tint": {"type": "mesh_attribute", "name": VERTEX_COLOUR}} if varies else made


def _burleys(
    mitsuba: Any,
    material: Material,
    maps: Maps,
    vertex_colours: NDArray | None,
    metallic: Any,
) -> Plugin:
    """The principled BSDF."""

    def burleys(colour: Plugin) -> Plugin:
        return {
            "type": "principled",
            "base_color": colour,
            "roughness": _number_or_map(
                mitsuba,
                material.roughness,
                maps.roughness,
                sampler_of(material, "metallic_roughness"),
            ),
            "metallic": metallic,
            "specular": _DIELECTRIC_SPECULAR,
        }

    return _coloured(mitsuba, material, maps, vertex_colours, burleys)


def _coated(mitsuba: Any, material: Material, maps: Maps, vertex_colours: NDArray | None) -> Plugin:
    """Lambert's surface under a coat that reflects and lets through the rest."""
    rough = maps.roughness
    roughness = float(material.roughness if rough is None else rough.mean())
    table = reflectance_table()
    reflected = np.interp(roughness, np.linspace(0.0, 1.0, len(table)), table[:, 0, 2])
    f0 = float(np.clip(material.terms.f0_rgb.max(), 1e-6, 0.99))
    # In proportion, as mesh.frag has it.
    reflected += (f0 - DIELECTRIC_F0) * (1.0 - reflected) / (1.0 - DIELECTRIC_F0)
    left = _DOUBLED * (1.0 - float(reflected))
    squared = None if rough is None else np.maximum(rough * rough, np.float32(_LEAST_ALPHA))
    coat = {
        "type": "roughconductor",
        "distribution": "ggx",
        "alpha": _number_or_map(
            mitsuba,
            max(roughness**2, _LEAST_ALPHA),
            squared,
            sampler_of(material, "metallic_roughness"),
        ),
        "eta": (1.0 + f0**0.5) / (1.0 - f0**0.5),
        "k": 0.0,
        "specular_reflectance": bitmap(mitsuba, np.full((1, 1, 3), _DOUBLED, np.float32)),
    }
    paint = _bare(mitsuba, material, maps, vertex_colours, left)
    return {"type": "blendbsdf", "weight": 0.5, "paint": paint, "reflection": coat}


def _bare(
    mitsuba: Any,
    material: Material,
    maps: Maps,
    vertex_colours: NDArray | None,
    scale: float = 1.0,
) -> Plugin:
    """Lambert's surface of the base colour times a scale."""

    def diffuse(colour: Plugin) -> Plugin:
        return {"type": "diffuse", "reflectance": colour}

    return _coloured(mitsuba, material, maps, vertex_colours, diffuse, scale)


def _coloured(
    mitsuba: Any,
    material: Material,
    maps: Maps,
    vertex_colours: NDArray | None,
    bsdf_of: Callable[[Plugin], Plugin],
    scale: float = 1.0,
) -> Plugin:
    """The BSDF of the base colour times a scale, which it is an affine function of.

    Colours are bitmaps, for these may exceed 1. No texture of mitsuba multiplies a map and
    vertex colours: one is the colour, and the other weighs between it and black. Vertices of one
    hue weigh the map, which is exact; else the map's brightness weighs the vertices' colours.
    """
    sampler = sampler_of(material, "base_colour")
    if vertex_colours is None or not colours_vary(vertex_colours):
        tint = 1.0 if vertex_colours is None else vertex_colours[0, :3]
        texels = maps.base_colour
        if texels is None:
            texels = np.asarray(material.base_colour_rgba[:3], np.float32)[None, None]
        tinted = np.asarray(texels * tint * scale, np.float32)
        return bsdf_of(bitmap(mitsuba, tinted, sampler))
    colour: Plugin = {"type": "mesh_attribute", "name": VERTEX_COLOUR, "scale": scale}
    if maps.base_colour is None:
        return bsdf_of(colour)
    shades = _shades_of_one_hue(vertex_colours)
    if shades is None:
        weight = bitmap(mitsuba, _brightness_and_hue(maps.base_colour)[0], sampler)
    else:
        weight = {"type": "mesh_attribute", "name": VERTEX_COLOUR}
        colour = bitmap(mitsuba, maps.base_colour * shades[1] * np.float32(scale), sampler)
    black = bsdf_of(_rgb(np.zeros(3)))
    return {"type": "blendbsdf", "weight": weight, "black": black, "painted": bsdf_of(colour)}


def _shades_of_one_hue(
    vertex_colours: NDArray,
) -> tuple[NDArray[np.float32], NDArray[np.float32]] | None:
    """Weights (V, 1) and the colour (3,), up to 1, whose shades these are; None of many hues."""
    colours = np.asarray(vertex_colours[:, :3], np.float32)
    weights, colour = _brightness_and_hue(colours)
    if np.abs(colours - weights * colour).max() > _SAME_HUE * colours.max():
        return None
    return weights, np.minimum(colour, np.float32(1.0))


def _brightness_and_hue(
    colours: NDArray[np.float32],
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Weights (..., 1) up to 1 and a colour (3,): their product is colours (..., 3) of one hue."""
    brightness = colours.mean(axis=-1, keepdims=True)
    peak, mean = float(brightness.max()), float(brightness.mean())
    if peak <= 0.0:
        return brightness, np.zeros(3, np.float32)
    hue = colours.reshape(-1, 3).mean(axis=0, dtype=np.float64) * (peak / mean)
    return brightness / np.float32(peak), hue.astype(np.float32)


def _cut_out(mitsuba: Any, inner: Plugin, material: Material, maps: Maps) -> Plugin:
    """The surface with its holes; a blended one transmits 1 - alpha."""
    if material.alpha_mode == "OPAQUE":
        return inner
    alpha = float(material.base_colour_rgba[3])
    if material.alpha_mode == "MASK":
        alpha = float(alpha >= material.alpha_cutoff)
    opacity: Any = alpha
    if maps.opacity is not None:
        opacity = bitmap(mitsuba, maps.opacity, sampler_of(material, "base_colour"))
    elif alpha >= 1.0:
        return inner
    made = {"type": "mask", "opacity": opacity, "bsdf": inner}
    # In scalar variants Python is called for each ray.
    if material.double_sided or mitsuba.variant().startswith("scalar"):
        return made
    return front_alone(mitsuba, made)


def _both_sides(inner: Plugin) -> Plugin:
    return {"type": "twosided", "bsdf": inner}


def _rgb(values: NDArray[np.float64]) -> Plugin:
    return {"type": "rgb", "value": [float(value) for value in values]}


def _number_or_map(
    mitsuba: Any, number: float, texels: NDArray | None, sampler: Sampler = _REPEATED
) -> Any:
    return float(number) if texels is None else bitmap(mitsuba, texels, sampler)
