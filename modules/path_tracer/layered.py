"""The GL frame's own surface as a BSDF of mitsuba: paint under a coat that keeps energy, or metal.

GGX with height-correlated Smith shadowing (Heitz 2014) and Schlick's Fresnel term, plus what bounces
between facets (Turquin 2019); what the coat does not reflect reaches the paint below it (Kelemen
and Szirmay-Kalos 2001). The shares of the coat are `geometry.reflection.reflectance_table`, looked
up as `mesh.frag` looks them up. Mitsuba has none of the three: its Smith terms are products, its
Fresnel terms exact, and its rough surfaces lose what bounces.

One text serves all variants: drjit's functions take numbers in scalar ones and arrays in llvm.
"""

from functools import lru_cache
from typing import Any

import numpy as np

from vrut_lite.geometry.reflection import DIELECTRIC_F0, reflectance_table

PLUGIN = "vrut_lite_layered"
# As in mesh.frag: the sun's own radius blurs a mirror image about so much.
_SMALLEST_ALPHA = 0.005
_SMALLEST_COSINE = 1e-4
# Of samples, kept for either lobe, so that no light is found by too few.
_LEAST_SHARE = 0.1
# What is darker than 2 % at normal incidence reflects less at grazing angles too.
_GRAZING_SLOPE = 50.0


@lru_cache(maxsize=4)
def register(variant: str) -> None:
    """Make the plugin known to the variant of mitsuba that is set.

    Its textures are `base_color`, `tint` (a factor of it, left out: 1), `roughness`, `metallic`.
    """
    import drjit as dr
    import mitsuba as mi

    table = np.asarray(reflectance_table())
    last = table.shape[0] - 1

    class Layered(mi.BSDF):
        """A metallic-roughness surface, one-sided: black from behind."""

        def __init__(self, properties: Any):
            super().__init__(properties)
            self.base_color = properties.get_texture("base_color", 1.0)
            self.tint = (
                properties.get_texture("tint") if properties.has_property("tint") else None
            )
            self.roughness = properties.get_texture("roughness", 1.0)
            self.metallic = properties.get_texture("metallic", 0.0)
            self.table = mi.Texture2f(mi.TensorXf(table))
            glossy = mi.BSDFFlags.GlossyReflection | mi.BSDFFlags.FrontSide
            diffuse = mi.BSDFFlags.DiffuseReflection | mi.BSDFFlags.FrontSide
            self.m_components = [int(glossy), int(diffuse)]
            self.m_flags = int(glossy) | int(diffuse)

        def traverse(self, callback: Any) -> None:
            callback.put("base_color", self.base_color, mi.ParamFlags.Differentiable)
            callback.put("roughness", self.roughness, mi.ParamFlags.Differentiable)
            callback.put("metallic", self.metallic, mi.ParamFlags.Differentiable)

        def _shares(self, mu: Any, roughness: Any) -> Any:
            u = dr.sqrt(dr.clip(mu, 0.0, 1.0))
            at = (mi.Point2f(u, roughness) * last + 0.5) / (last + 1.0)
            return self.table.eval(at)

        def _material(self, si: Any, active: Any) -> Any:
            base = self.base_color.eval(si, active)
            if self.tint is not None:
                base = base * self.tint.eval(si, active)
            roughness = dr.clip(self.roughness.eval_1(si, active), 0.0, 1.0)
            metallic = self.metallic.eval_1(si, active)
            return base, roughness, metallic

        def _seen(self, si: Any, active: Any) -> Any:
            """What depends on the view alone."""
            base, roughness, metallic = self._material(si, active)
            nv = dr.maximum(mi.Frame3f.cos_theta(si.wi), _SMALLEST_COSINE)
            a, b, mean = self._shares(nv, roughness)
            f0 = DIELECTRIC_F0 + (base - DIELECTRIC_F0) * metallic
            f90 = _grazing(dr.clip, dr.max(f0))
            more = 1.0 + f0 * (1.0 / (a + b) - 1.0)
            paint = base * (1.0 - metallic) * (1.0 - _coat(a, b)) * dr.inv_pi / (1.0 - mean)
            alpha = dr.maximum(roughness * roughness, _SMALLEST_ALPHA)
            glossy = mi.luminance((f0 * a + f90 * b) * more)
            matt = mi.luminance(paint) * dr.pi * (1.0 - mean)
            share = glossy / dr.maximum(glossy + matt, 1e-9)
            least = dr.select(matt > 0.0, _LEAST_SHARE, 1.0)
            share = dr.maximum(dr.select(matt > 0.0, dr.minimum(share, 1.0 - least), 1.0), least)
            return roughness, nv, f0, f90, more, paint, alpha, share

        def _value_and_density(self, si: Any, wo: Any, seen: Any) -> Any:
            roughness, nv, f0, f90, more, paint, alpha, share = seen
            nl = mi.Frame3f.cos_theta(wo)
            above = (mi.Frame3f.cos_theta(si.wi) > 0.0) & (nl > 0.0)
            nl = dr.maximum(nl, 1e-6)
            half = dr.normalize(si.wi + wo)
            nh = mi.Frame3f.cos_theta(half)
            vh = dr.clip(dr.dot(si.wi, half), 0.0, 1.0)
            a2 = alpha * alpha
            d = (half.x * half.x + half.y * half.y) + nh * nh * a2
            distribution = a2 / (dr.pi * d * d)
            root_v = dr.sqrt(nv * nv * (1.0 - a2) + a2)
            root_l = dr.sqrt(nl * nl * (1.0 - a2) + a2)
            visibility = 0.5 / (nl * root_v + nv * root_l)
            fresnel = f0 + (f90 - f0) * (1.0 - vh) ** 5
            a, b, _ = self._shares(nl, roughness)
            value = more * fresnel * (distribution * visibility) + paint * (1.0 - _coat(a, b))
            # Density of visible facets' mirror directions: G1 D / (4 n.v).
            glossy = distribution * 0.5 / (nv + root_v)
            density = share * glossy + (1.0 - share) * nl * dr.inv_pi
            return (
                dr.select(above, value * nl, 0.0),
                dr.select(above, density, 0.0),
            )

        def eval(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> Any:
            return self.eval_pdf(ctx, si, wo, active)[0]

        def pdf(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> Any:
            return self.eval_pdf(ctx, si, wo, active)[1]

        def eval_pdf(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> Any:
            return self._value_and_density(si, wo, self._seen(si, active))

        def sample(self, ctx: Any, si: Any, sample1: Any, sample2: Any, active: Any = True) -> Any:
            seen = self._seen(si, active)
            return self._sampled(si, seen, sample1, sample2, active)

        def eval_pdf_sample(
            self, ctx: Any, si: Any, wo: Any, sample1: Any, sample2: Any, active: Any = True
        ) -> Any:
            seen = self._seen(si, active)
            value, density = self._value_and_density(si, wo, seen)
            return value, density, *self._sampled(si, seen, sample1, sample2, active)

        def _sampled(self, si: Any, seen: Any, sample1: Any, sample2: Any, active: Any) -> Any:
            alpha, share = seen[6], seen[7]
            facets = mi.MicrofacetDistribution(mi.MicrofacetType.GGX, alpha, True)
            glossy = sample1 < share
            half, _ = facets.sample(si.wi, sample2)
            wo = dr.select(
                glossy, mi.reflect(si.wi, half), mi.warp.square_to_cosine_hemisphere(sample2)
            )
            value, density = self._value_and_density(si, wo, seen)
            drawn = dr.zeros(mi.BSDFSample3f)
            drawn.wo = wo
            drawn.pdf = density
            drawn.eta = 1.0
            drawn.sampled_type = dr.select(
                glossy, mi.UInt32(+mi.BSDFFlags.GlossyReflection), mi.UInt32(+mi.BSDFFlags.DiffuseReflection)
            )
            drawn.sampled_component = dr.select(glossy, mi.UInt32(0), mi.UInt32(1))
            found = active & (density > 0.0)
            return drawn, dr.select(found, value / dr.maximum(density, 1e-20), 0.0)

        def eval_diffuse_reflectance(self, si: Any, active: Any = True) -> Any:
            # What a denoiser is guided by: of metals their colour.
            return self._material(si, active)[0]

    def _grazing(clip: Any, largest: Any) -> Any:
        return clip(_GRAZING_SLOPE * largest, 0.0, 1.0)

    f90_of_dielectric = min(1.0, _GRAZING_SLOPE * DIELECTRIC_F0)

    def _coat(a: Any, b: Any) -> Any:
        """Share of the light that the coat of a dielectric reflects, all bounces."""
        once = DIELECTRIC_F0 * a + f90_of_dielectric * b
        return once * (1.0 + DIELECTRIC_F0 * (1.0 / (a + b) - 1.0))

    mi.register_bsdf(PLUGIN, Layered)
