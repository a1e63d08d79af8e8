"""The lobes of glossy surfaces in drjit, as mesh.frag has them: facets, stretched ones and fibres.

GGX with height-correlated Smith shadowing (Heitz 2014) and Schlick's Fresnel term. One text serves
all variants: drjit's functions take numbers in scalar ones and arrays in llvm. Directions are in
the surface's axes, its normal along z.
"""

from typing import Any, NamedTuple

import numpy as np


class Facets(NamedTuple):
    """A glossy surface: GGX's width, and its reflectance at normal incidence and at grazing."""

    alpha: Any
    f0: Any
    f90: Any


class Lobes:
    """The lobes in the variant of mitsuba that is set."""

    def __init__(self, mi: Any):
        import drjit

        self._mi, self._dr = mi, drjit

    def facets(self, wi: Any, wo: Any, nv: Any, nl: Any, of: Facets) -> tuple[Any, Any]:
        """The facets' reflection, one bounce, and the density of their mirror directions."""
        dr = self._dr
        half = dr.normalize(wi + wo)
        vh = dr.clip(dr.dot(wi, half), 0.0, 1.0)
        a2 = of.alpha * of.alpha
        # (n.h)^2 (alpha^2 - 1) + 1 without cancellation.
        spread = half.x * half.x + half.y * half.y + half.z * half.z * a2
        distribution = a2 / (dr.pi * spread * spread)
        root_v = dr.sqrt(nv * nv * (1.0 - a2) + a2)
        root_l = dr.sqrt(nl * nl * (1.0 - a2) + a2)
        visibility = 0.5 / (nl * root_v + nv * root_l)
        # Density of visible facets: G1 D / (4 n.v).
        density = 0.5 * distribution / (nv + root_v)
        return _schlick(of, vh) * (distribution * visibility), density

    def stretched(
        self, wi: Any, wo: Any, nv: Any, nl: Any, of: Facets, by: "Stretch"
    ) -> tuple[Any, Any]:
        """The same with two widths: KHR_materials_anisotropy."""
        dr, mi = self._dr, self._mi
        along, across = by.widths(dr, of.alpha)
        view, out = by.in_axes(mi, wi), by.in_axes(mi, wo)
        half = dr.normalize(view + out)
        vh = dr.clip(dr.dot(view, half), 0.0, 1.0)
        spread = (half.x / along) ** 2 + (half.y / across) ** 2 + half.z * half.z
        distribution = 1.0 / (dr.pi * along * across * spread * spread)
        root_v = dr.norm(mi.Vector3f(along * view.x, across * view.y, nv))
        root_l = dr.norm(mi.Vector3f(along * out.x, across * out.y, nl))
        visibility = 0.5 / (nl * root_v + nv * root_l)
        density = 0.5 * distribution / (nv + root_v)
        return _schlick(of, vh) * (distribution * visibility), density

    def mirrored(self, wi: Any, alpha: Any, sample: Any) -> Any:
        """A direction drawn by the density of `facets`."""
        mi = self._mi
        facets = mi.MicrofacetDistribution(mi.MicrofacetType.GGX, alpha, True)
        return mi.reflect(wi, facets.sample(wi, sample)[0])

    def mirrored_by_stretched(self, wi: Any, alpha: Any, by: "Stretch", sample: Any) -> Any:
        """A direction drawn by the density of `stretched`."""
        mi = self._mi
        widths = by.widths(self._dr, alpha)
        facets = mi.MicrofacetDistribution(mi.MicrofacetType.GGX, *widths, True)
        normal = facets.sample(by.in_axes(mi, wi), sample)[0]
        return mi.reflect(wi, by.in_axes(mi, normal, -1.0))

    def fibres(self, wi: Any, wo: Any, nv: Any, nl: Any, roughness: float) -> Any:
        """White fibres (KHR_materials_sheen), times the light's cosine."""
        dr = self._dr
        half = dr.normalize(wi + wo)
        inverse = 1.0 / max(roughness**2, 1e-3)
        sine2 = dr.maximum(half.x * half.x + half.y * half.y, 1e-12)
        distribution = (2.0 + inverse) * sine2 ** (0.5 * inverse) * (0.5 * dr.inv_pi)
        return distribution * nl / (4.0 * (nl + nv - nl * nv))


class Stretch:
    """By how much highlights are stretched, across which direction from the first coordinate."""

    def __init__(self, strength: float, angle_rad: float):
        self.strength = strength
        self._cosine, self._sine = float(np.cos(angle_rad)), float(np.sin(angle_rad))

    def widths(self, dr: Any, alpha: Any) -> tuple[Any, Any]:
        """GGX's along and across."""
        return dr.lerp(alpha, 1.0, self.strength**2), alpha

    def in_axes(self, mi: Any, v: Any, back: float = 1.0) -> Any:
        """A direction in the axes of the facets, or `back` (-1) from them."""
        c, s = self._cosine, back * self._sine
        return mi.Vector3f(c * v.x + s * v.y, c * v.y - s * v.x, v.z)


def _schlick(of: Facets, vh: Any) -> Any:
    return of.f0 + (of.f90 - of.f0) * (1.0 - vh) ** 5
