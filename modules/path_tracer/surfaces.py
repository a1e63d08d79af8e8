"""glTF's metallic-roughness materials as BSDFs of mitsuba.

Metals are principled BSDFs (Burley 2012), whose Fresnel term and GGX width, roughness squared,
are glTF's own. What is no metal is Lambert's surface and the reflection of a rough dielectric
(index 1.5, so 4 % at normal incidence), as glTF and the GL frame have it; the paint has what the
coat leaves on average. The principled BSDF can stand for these too: its diffuse lobe sends more
light back to where it came from, a fifth more from rough surfaces. Mitsuba's `roughplastic`
cannot: it loses half of the light at a roughness of 0.7. Back sides are lit like front sides.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from path_tracer.textures import Maps, maps_of
from vrut_lite.geometry.colour import LUMENS_PER_WATT
from vrut_lite.render.reflection import reflectance_table
from vrut_lite.scene.materials import SurfaceMaterial

Plugin = dict[str, Any]
# Of a vertex's colour, as mitsuba wants attributes named.
VERTEX_COLOUR = "vertex_color"
# As `specular` and as an index of refraction, both 4 % at normal incidence.
_DIELECTRIC_SPECULAR, _DIELECTRIC_INDEX = 0.5, 1.5
# mitsuba blends surfaces, and does not add them: a mean of two doubled ones is their sum.
_DOUBLED = 2.0
_LEAST_ALPHA = 2e-3


def matte(albedo_rgb: NDArray[np.float64]) -> Plugin:
    """Lambert's surface, seen from both sides."""
    return _both_sides({"type": "diffuse", "reflectance": _rgb(np.clip(albedo_rgb, 0.0, 1.0))})


def surface(
    mitsuba: Any,
    material: SurfaceMaterial,
    layer: int,
    vertex_colours: NDArray | None,
    principled: bool = False,
) -> Plugin:
    """The BSDF of a material whose maps lie on this layer of texture coordinates.

    `vertex_colours` (V, 4) multiply the base colour; where a map does too, by their mean.
    `principled`: also for what is no metal.
    """
    maps = maps_of(material, layer)
    metallic = _number_or_map(mitsuba, material.metallicFactor, maps.metallic)
    paint = {
        "type": "principled",
        "base_color": _base_colour(mitsuba, material, maps, vertex_colours),
        "roughness": _number_or_map(mitsuba, material.roughnessFactor, maps.roughness),
        "metallic": metallic,
        "specular": _DIELECTRIC_SPECULAR,
    }
    if not principled and metallic != 1.0:
        coated = _coated(mitsuba, material, maps, vertex_colours)
        metal = {**paint, "metallic": 1.0}
        both = {"type": "blendbsdf", "weight": metallic, "a": coated, "b": metal}
        paint = coated if metallic == 0.0 else both
    if maps.normal is not None:
        paint = {"type": "normalmap", "normalmap": _bitmap(mitsuba, maps.normal), "bsdf": paint}
    return _cut_out(mitsuba, _both_sides(paint), material, maps)


def emission(mitsuba: Any, material: SurfaceMaterial, layer: int, repeats: bool) -> Plugin | None:
    """The emitter of a glowing material, or None.

    glTF gives cd m^-2. A map that `repeats` glows by its mean: mitsuba finds a glowing texel's
    place from its coordinates, which must be one.
    """
    glow = np.asarray(material.emissiveFactor, dtype=float)
    if not np.any(glow > 0.0):
        return None
    texels = maps_of(material, layer).emission
    if texels is not None and repeats:
        glow, texels = texels.mean(axis=(0, 1)), None
    if texels is None:
        return {"type": "area", "radiance": _rgb(glow / LUMENS_PER_WATT)}
    return {"type": "area", "radiance": _bitmap(mitsuba, texels / np.float32(LUMENS_PER_WATT))}


def _coated(
    mitsuba: Any, material: SurfaceMaterial, maps: Maps, vertex_colours: NDArray | None
) -> Plugin:
    """Lambert's surface under a coat that reflects and lets through the rest."""
    rough = maps.roughness
    roughness = float(material.roughnessFactor if rough is None else rough.mean())
    table = reflectance_table()
    reflected = np.interp(roughness, np.linspace(0.0, 1.0, len(table)), table[:, 0, 2])
    left = _DOUBLED * (1.0 - float(reflected))
    squared = None if rough is None else np.maximum(rough * rough, np.float32(_LEAST_ALPHA))
    coat = {
        "type": "roughconductor",
        "distribution": "ggx",
        "alpha": _number_or_map(mitsuba, max(roughness**2, _LEAST_ALPHA), squared),
        "eta": _DIELECTRIC_INDEX,
        "k": 0.0,
        "specular_reflectance": _bitmap(mitsuba, np.full((1, 1, 3), _DOUBLED, np.float32)),
    }
    colour = _base_colour(mitsuba, material, maps, vertex_colours, left)
    diffuse = {"type": "diffuse", "reflectance": colour}
    return {"type": "blendbsdf", "weight": 0.5, "paint": diffuse, "reflection": coat}


def _base_colour(
    mitsuba: Any,
    material: SurfaceMaterial,
    maps: Maps,
    vertex_colours: NDArray | None,
    scale: float = 1.0,
) -> Plugin:
    """The base colour times a scale; as a bitmap, which may exceed 1."""
    if maps.base_colour is not None:
        tint = 1.0 if vertex_colours is None else vertex_colours[:, :3].mean(axis=0)
        return _bitmap(mitsuba, np.asarray(maps.base_colour * tint * scale, np.float32))
    if vertex_colours is not None:
        return {"type": "mesh_attribute", "name": VERTEX_COLOUR, "scale": scale}
    colour = scale * np.asarray(material.baseColorFactor[:3], dtype=np.float32)
    return _bitmap(mitsuba, colour[None, None])


def _cut_out(mitsuba: Any, inner: Plugin, material: SurfaceMaterial, maps: Maps) -> Plugin:
    """The surface with its holes: what is blended lets through what it does not cover."""
    if material.alphaMode == "OPAQUE":
        return inner
    if maps.opacity is not None:
        return {"type": "mask", "opacity": _bitmap(mitsuba, maps.opacity), "bsdf": inner}
    alpha = float(material.baseColorFactor[3])
    if material.alphaMode == "MASK":
        alpha = float(alpha >= material.alphaCutoff)
    return inner if alpha >= 1.0 else {"type": "mask", "opacity": alpha, "bsdf": inner}


def _both_sides(inner: Plugin) -> Plugin:
    return {"type": "twosided", "bsdf": inner}


def _rgb(values: NDArray[np.float64]) -> Plugin:
    return {"type": "rgb", "value": [float(value) for value in values]}


def _number_or_map(mitsuba: Any, number: float, texels: NDArray | None) -> Any:
    return float(number) if texels is None else _bitmap(mitsuba, texels)


def _bitmap(mitsuba: Any, texels: NDArray[np.float32]) -> Plugin:
    bitmap = mitsuba.Bitmap(np.ascontiguousarray(texels))
    return {"type": "bitmap", "bitmap": bitmap, "raw": True}
