"""Coats and glass of materials, as means over all directions: what a triangle sends back, and how
much passes straight on.

Glass is simplified: each triangle lets a share of all rays through, whatever their colour; tinted
panes pass the luminance of their tint. Bodies let rays straight on too and absorb half at either
side.
"""

from functools import lru_cache
from itertools import product
from typing import NamedTuple

import numpy as np

from light_transport.surfaces.map_means import linear, shares, triangle_means
from vrut_lite.geometry.colour import luminance
from vrut_lite.geometry.reflection import DIELECTRIC_F0, reflectance_table
from vrut_lite.geometry.thin_film import film_table
from vrut_lite.messages.scene_content import MapName, Material, Mesh
from vrut_lite.messages.surface_terms import SurfaceTerms
from vrut_lite.numeric_types import Float32Array, FloatArray

# Least reflectance of any real surface; see grazing() in mesh.frag.
_DARKEST_F0 = 0.02


class SentBack(NamedTuple):
    """Shares of diffuse light: reflected (F, 3), of light that does not pass, and passing (F,)."""

    reflectance_rgb: Float32Array
    passing: Float32Array


def sent_back(
    mesh: Mesh, material: Material, colour: FloatArray, roughness: FloatArray, metallic: FloatArray
) -> SentBack:
    """Shares of paint (F, 3) or metal, where `metallic` (F, 1) is 1, under coats of `roughness`
    (F, 1)."""
    terms = material.terms
    f0 = terms.f0_rgb * _channel_means(mesh, material, "specular", 3)
    tint = triangle_means_of(mesh, material, "specular_colour")
    f0 = f0 if tint is None else f0 * tint
    f0 = _under_film(mesh, material, f0)
    f90 = terms.f90 * _channel_means(mesh, material, "specular", 3)
    peak = f0.max(axis=1, keepdims=True)
    coat = mean_coat(roughness, peak, f90)
    coat_rgb = coat * np.divide(f0, peak, out=np.ones_like(f0 + coat), where=peak > 0.0)
    glass = terms.transmission * _channel_means(mesh, material, "transmission", 0)
    glass = glass * (1.0 - metallic)
    paint = colour * (1.0 - coat)
    second = terms.clearcoat * _channel_means(mesh, material, "clearcoat", 0)
    second = second * mean_coat(np.array(terms.clearcoat_roughness), DIELECTRIC_F0, 1.0)
    metal = _under_film(mesh, material, np.asarray(colour, float))
    below = metallic * mean_metal(roughness, metal) + (1.0 - metallic) * (
        paint * (1.0 - glass) + coat_rgb
    )
    back = second + (1.0 - second) * below
    passing = luminance(_one_side(material, colour)) * ((1.0 - second) * glass * (1.0 - coat))[:, 0]
    reflectance = np.clip(back / np.maximum(1.0 - passing, 1e-3)[:, None], 0.0, 1.0)
    return SentBack(reflectance.astype(np.float32), passing.astype(np.float32))


def _under_film(mesh: Mesh, material: Material, f0: FloatArray) -> FloatArray:
    """Schlick's f0 (F, 3) with what a thin film makes of it, as a mean over all directions."""
    terms = material.terms
    if terms.iridescence == 0.0:
        return f0
    share = terms.iridescence * _channel_means(mesh, material, "iridescence", 0)
    thickness = _channel_means(mesh, material, "iridescence_thickness", 1)
    return f0 + (mean_film(f0, thickness, terms) - f0) * share


def mean_film(f0: FloatArray, thickness: FloatArray, terms: SurfaceTerms) -> FloatArray:
    """Schlick's f0 (F, 3) under a film of a share (F, 1) of the way between its thicknesses.

    Directions count as much as a smooth surface sends light back into them beyond its f90.
    """
    table = film_table(terms.film_ior, terms.film_least_nm, terms.film_most_nm).astype(np.float64)
    mu = np.linspace(0.0, 1.0, table.shape[2])
    weight = mu * (1.0 - (1.0 - mu) ** 5)
    means = np.einsum("tfmc,m->tfc", table, weight / weight.sum())
    places = thickness * (len(means) - 1), np.sqrt(np.clip(f0, 0.0, 1.0)) * (means.shape[1] - 1)
    (layer, in_layer), (row, in_row) = (np.divmod(place, 1.0) for place in places)
    channel = np.arange(3)
    filmed = np.zeros(f0.shape)
    for next_layer, next_row in product((0, 1), (0, 1)):
        at = (
            np.minimum(layer.astype(int) + next_layer, len(means) - 1),
            np.minimum(row.astype(int) + next_row, means.shape[1] - 1),
        )
        weight_of = np.abs(1 - next_layer - in_layer) * np.abs(1 - next_row - in_row)
        filmed += weight_of * means[at[0], at[1], channel]
    return filmed


def mean_coat(roughness: FloatArray, f0: FloatArray | float, f90: FloatArray | float) -> FloatArray:
    """Share of diffuse light that a coat sends back, in proportion as mesh.frag has it."""
    table = reflectance_table()
    mean = np.interp(roughness, np.linspace(0.0, 1.0, len(table)), table[:, 0, 2])
    more = (np.asarray(f0) - DIELECTRIC_F0 * f90) * (1.0 - mean) / (1.0 - DIELECTRIC_F0)
    return np.asarray(mean * f90 + more)


def mean_metal(roughness: FloatArray, f0_rgb: FloatArray) -> FloatArray:
    """Share (F, 3) of diffuse light that metal of roughness (F, 1) sends back, all bounces."""
    steps = np.linspace(0.0, 1.0, len(reflectance_table()))
    constant, linear_in, square_in = (
        np.interp(roughness, steps, coefficient) for coefficient in _metal_coefficients()
    )
    # Surfaces darker than any real one do not reflect grazing light either, as in the frame.
    is_real = np.clip(f0_rgb.max(axis=1, keepdims=True) / _DARKEST_F0, 0.0, 1.0)
    return np.asarray(is_real * constant + f0_rgb * (linear_in + f0_rgb * square_in))


@lru_cache(maxsize=1)
def _metal_coefficients() -> FloatArray:
    """Means over the hemisphere (3, roughness) of metal's reflectance, by powers of its colour.

    The frame's metal, (f0 a + b)(1 + f0 (1 / (a + b) - 1)) from each direction
    (`reflection.all_bounces`), is a polynomial in f0: grazing light leaves it white.
    """
    table = reflectance_table().astype(np.float64)
    a, b = table[..., 0], table[..., 1]
    more = 1.0 / (a + b) - 1.0
    # Columns are equal steps of the root of the cosine: 2 mu dmu is 4 s^3 ds.
    steps = np.linspace(0.0, 1.0, table.shape[1])
    weight = steps**3 / np.trapezoid(steps**3, steps)
    powers = np.stack([b, a + b * more, a * more])
    return np.asarray(np.trapezoid(powers * weight, steps, axis=-1))


def triangle_means_of(mesh: Mesh, material: Material, name: MapName) -> Float32Array | None:
    """Means (F, 3) of a map's colour in linear light."""
    found = material.maps.get(name)
    return None if found is None else triangle_means(found, mesh, lambda t: linear(t[..., :3]))


def _channel_means(mesh: Mesh, material: Material, name: MapName, channel: int) -> FloatArray:
    """Means (F, 1) of a channel of a map, ones without a map."""
    found, ones = material.maps.get(name), np.ones((len(mesh.triangles), 1))
    if found is None or found.texels.shape[2] <= channel:
        return ones
    means = triangle_means(found, mesh, lambda texels: shares(texels[..., channel : channel + 1]))
    return ones if means is None else np.asarray(means, np.float64)


def _one_side(material: Material, colour: FloatArray) -> FloatArray:
    """Transmittance of one triangle of glass (F, 3): a pane's tint, or half of a body's."""
    terms = material.terms
    if terms.is_pane:
        return np.asarray(colour)
    left = np.exp(-np.asarray(terms.extinction_per_m) * terms.thickness_m)
    return np.asarray(np.sqrt(np.asarray(colour, float) * left))
