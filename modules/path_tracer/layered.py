"""The GL frame's own surface as a BSDF of mitsuba: metal, or paint under a coat that keeps energy.

GGX with height-correlated Smith shadowing (Heitz 2014) and Schlick's Fresnel term, and what bounces
between facets (Turquin 2019); what the coat does not reflect reaches the paint below it (Kelemen
and Szirmay-Kalos 2001). The coat's shares are `geometry.reflection.reflectance_table`, looked up as
mesh.frag looks them up. Mitsuba's plugins have none of the four: their Smith terms are products,
their Fresnel terms exact, and rough surfaces lose what bounces.

One text serves all variants: drjit's functions take numbers in scalar ones and arrays in llvm.
"""

from typing import Any, NamedTuple

import numpy as np

from path_tracer.pane import pane
from vrut_lite.geometry.reflection import DIELECTRIC_F0, reflectance_table
from vrut_lite.geometry.sheen import sheen_table

PLUGIN, PANE = "vrut_lite_layered", "vrut_lite_pane"
# As in mesh.frag: the sun's own radius blurs a mirror image about so much.
_SMALLEST_ALPHA = 0.005
_SMALLEST_COSINE, _SMALLEST_DENSITY = 1e-4, 1e-20
# What is darker than 2 % at normal incidence reflects less at grazing angles too.
_GRAZING_SLOPE = 50.0
_COAT_F90 = min(1.0, _GRAZING_SLOPE * DIELECTRIC_F0)
# Of the samples, for the coat as for the paint: neither's light is left to few that weigh much.
_LEAST_SHARE = 0.1
# Of the samples, for a second coat.
_CLEARCOAT_SAMPLES = 0.25
_registered: set[str] = set()


class _Seen(NamedTuple):
    """What of a surface the view alone decides; `paint` is without the light's way in.

    `more` is the factor for bounces between facets, `glossy_share` that of samples for the coat,
    `peak` and `edge` its reflectance at normal incidence and at grazing angles. `tint` is what of
    the light passes through, where some does.
    """

    wi: Any
    cosine: Any
    roughness: Any
    alpha: Any
    f0: Any
    f90: Any
    more: Any
    paint: Any
    glossy_share: Any
    peak: Any
    edge: Any
    tint: Any


def register(mitsuba: Any) -> None:
    """Make the plugin known to the variant of mitsuba that is set.

    Its textures: `base_color`; `tint`, a factor of it that may be missing; `roughness`; `metallic`;
    `f0` and `f90`, the coat's reflectance at normal incidence and at grazing angles; `clearcoat`,
    the share under a second coat of `clearcoat_roughness`; colour and roughness of a `sheen`; and
    `anisotropy`. `PANE` is the same surface from both
    sides, of which the share `transmission` lets light through, straight on if it is `smooth`.
    """
    variant = mitsuba.variant()
    if variant not in _registered:
        layered = _layered(mitsuba)
        mitsuba.register_bsdf(PLUGIN, layered)
        mitsuba.register_bsdf(PANE, pane(mitsuba, layered))
        _registered.add(variant)


def _coat(a: Any, b: Any, f0: Any = DIELECTRIC_F0, f90: Any = _COAT_F90) -> Any:
    """Share of the light that the coat of a dielectric reflects, all bounces."""
    return (f0 * a + f90 * b) * (1.0 + f0 * (1.0 / (a + b) - 1.0))


def _mean_coat(mean: Any, f0: Any, f90: Any) -> Any:
    """The same over all directions, in proportion to the table's `mean`, as mesh.frag has it."""
    more = (f0 - DIELECTRIC_F0 * f90) * (1.0 - mean) / (1.0 - DIELECTRIC_F0)
    return mean * f90 + more


def _layered(mi: Any) -> Any:
    """The BSDF's class, which must descend from the variant's own."""
    import drjit

    dr: Any = drjit
    table = np.asarray(reflectance_table())
    last = table.shape[0] - 1
    glossy, diffuse = +mi.BSDFFlags.GlossyReflection, +mi.BSDFFlags.DiffuseReflection

    class Layered(mi.BSDF):
        """A metallic-roughness surface; black from behind."""

        def __init__(self, properties: Any):
            super().__init__(properties)
            self.base_color = properties.get_texture("base_color", 1.0)
            self.tint = properties.get_texture("tint") if "tint" in properties else None
            self.roughness = properties.get_texture("roughness", 1.0)
            self.metallic = properties.get_texture("metallic", 0.0)
            self.f0 = properties.get_texture("f0", DIELECTRIC_F0)
            self.f90 = properties.get_texture("f90", _COAT_F90)
            self.clearcoat = (
                properties.get_texture("clearcoat") if "clearcoat" in properties else None
            )
            self.clearcoat_roughness = float(properties.get("clearcoat_roughness", 0.0))
            self.sheen = mi.Color3f(properties.get("sheen", mi.ScalarColor3f(0.0)))
            self.sheen_roughness = float(properties.get("sheen_roughness", 0.0))
            self.has_sheen = "sheen" in properties
            self.anisotropy = float(properties.get("anisotropy", 0.0))
            turn = float(properties.get("anisotropy_rad", 0.0))
            self.cosine, self.sine = float(np.cos(turn)), float(np.sin(turn))
            self.sheen_table = mi.Texture2f(mi.TensorXf(np.asarray(sheen_table())[..., None]))
            self.table = mi.Texture2f(mi.TensorXf(table))
            front = +mi.BSDFFlags.FrontSide
            self.m_components = [glossy | front, diffuse | front]
            self.m_flags = glossy | diffuse | front

        def eval(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> Any:
            return self.eval_pdf(ctx, si, wo, active)[0]

        def pdf(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> Any:
            return self.eval_pdf(ctx, si, wo, active)[1]

        def eval_pdf(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> Any:
            return self.value_and_density(si, wo, self.seen(si, si.wi, active), active)

        def sample(self, ctx: Any, si: Any, sample1: Any, sample2: Any, active: Any = True) -> Any:
            return self.sampled(si, self.seen(si, si.wi, active), sample1, sample2, active)

        def eval_pdf_sample(
            self, ctx: Any, si: Any, wo: Any, sample1: Any, sample2: Any, active: Any = True
        ) -> Any:
            seen = self.seen(si, si.wi, active)
            value, density = self.value_and_density(si, wo, seen, active)
            return value, density, *self.sampled(si, seen, sample1, sample2, active)

        def eval_diffuse_reflectance(self, si: Any, active: Any = True) -> Any:
            # What guides a denoiser: of metals their colour too.
            return self._colour(si, active)

        def _colour(self, si: Any, active: Any) -> Any:
            base = self.base_color.eval(si, active)
            return base if self.tint is None else base * self.tint.eval(si, active)

        def _shares(self, mu: Any, roughness: Any) -> Any:
            """Of a uniform white sky, and a dielectric's mean: `reflectance_table`."""
            at = mi.Point2f(dr.sqrt(dr.clip(mu, 0.0, 1.0)), roughness) * last + 0.5
            return self.table.eval(at / (last + 1.0))

        def seen(self, si: Any, wi: Any, active: Any) -> _Seen:
            """The surface as seen from `wi` above it."""
            base = self._colour(si, active)
            roughness = dr.clip(self.roughness.eval_1(si, active), 0.0, 1.0)
            metallic = self.metallic.eval_1(si, active)
            cosine = dr.maximum(mi.Frame3f.cos_theta(wi), _SMALLEST_COSINE)
            a, b, mean = self._shares(cosine, roughness)
            coat_f0, edge = self.f0.eval(si, active), self.f90.eval_1(si, active)
            peak = dr.max(coat_f0)
            f0 = coat_f0 + (base - coat_f0) * metallic
            f90 = dr.clip(_GRAZING_SLOPE * dr.max(f0), 0.0, 1.0)
            f90 = dr.lerp(edge, f90, metallic)
            more = 1.0 + f0 * (1.0 / (a + b) - 1.0)
            below = base * (1.0 - metallic) * (1.0 - _coat(a, b, peak, edge))
            if self.has_sheen:
                # Fibres take their light from all that is below them.
                at = mi.Point2f(dr.sqrt(cosine), self.sheen_roughness) * last + 0.5
                taken = dr.max(self.sheen) * self.sheen_table.eval(at / (last + 1.0))[0]
                more, below = more * (1.0 - taken), below * (1.0 - taken)
            reflected = mi.luminance((f0 * a + f90 * b) * more)
            share = reflected / dr.maximum(reflected + mi.luminance(below), _SMALLEST_DENSITY)
            share = dr.clip(share, _LEAST_SHARE, 1.0 - _LEAST_SHARE)
            return _Seen(
                wi=wi,
                cosine=cosine,
                roughness=roughness,
                alpha=dr.maximum(roughness * roughness, _SMALLEST_ALPHA),
                f0=f0,
                f90=f90,
                more=more,
                paint=below * dr.inv_pi / dr.maximum(1.0 - _mean_coat(mean, peak, edge), 1e-3),
                glossy_share=dr.select(dr.max(below) > 0.0, share, 1.0),
                peak=peak,
                edge=edge,
                tint=below,
            )

        def value_and_density(self, si: Any, wo: Any, seen: _Seen, active: Any) -> Any:
            """The BRDF times the light's cosine, and the density of `sampled`."""
            nl, nv = mi.Frame3f.cos_theta(wo), seen.cosine
            above = (mi.Frame3f.cos_theta(seen.wi) > 0.0) & (nl > 0.0)
            nl = dr.maximum(nl, _SMALLEST_COSINE**2)
            if self.anisotropy > 0.0:
                lobe, facets = self._stretched_lobe(wo, nl, seen)
            else:
                lobe, facets = self._lobe(seen.wi, wo, nv, nl, seen.alpha, seen.f0, seen.f90)
            a, b, _ = self._shares(nl, seen.roughness)
            value = (seen.more * lobe + seen.paint * (1.0 - _coat(a, b, seen.peak, seen.edge))) * nl
            density = dr.lerp(nl * dr.inv_pi, facets, seen.glossy_share)
            if self.has_sheen:
                value += self._fibres(wo, nl, seen)
            if self.clearcoat is not None:
                second = self.clearcoat.eval_1(si, active)
                value, density = self._under_clearcoat(second, wo, seen, nl, value, density)
            return dr.select(above, value, 0.0), dr.select(above, density, 0.0)

        def _lobe(
            self, wi: Any, wo: Any, nv: Any, nl: Any, alpha: Any, f0: Any, f90: Any
        ) -> tuple[Any, Any]:
            """The facets' reflection, one bounce, and the density of their mirror directions."""
            half = dr.normalize(wi + wo)
            vh = dr.clip(dr.dot(wi, half), 0.0, 1.0)
            a2 = alpha * alpha
            # (n.h)^2 (alpha^2 - 1) + 1 without cancellation.
            spread = half.x * half.x + half.y * half.y + half.z * half.z * a2
            distribution = a2 / (dr.pi * spread * spread)
            root_v = dr.sqrt(nv * nv * (1.0 - a2) + a2)
            root_l = dr.sqrt(nl * nl * (1.0 - a2) + a2)
            visibility = 0.5 / (nl * root_v + nv * root_l)
            fresnel = f0 + (f90 - f0) * (1.0 - vh) ** 5
            # Of visible facets: G1 D / (4 n.v).
            return fresnel * (distribution * visibility), 0.5 * distribution / (nv + root_v)

        def _stretched_lobe(self, wo: Any, nl: Any, seen: _Seen) -> tuple[Any, Any]:
            """The same with two widths: KHR_materials_anisotropy."""
            along, across = self._widths(seen.alpha)
            view, out = self._in_axes(seen.wi), self._in_axes(wo)
            half = dr.normalize(view + out)
            vh = dr.clip(dr.dot(view, half), 0.0, 1.0)
            spread = (half.x / along) ** 2 + (half.y / across) ** 2 + half.z * half.z
            distribution = 1.0 / (dr.pi * along * across * spread * spread)
            root_v = dr.norm(mi.Vector3f(along * view.x, across * view.y, seen.cosine))
            root_l = dr.norm(mi.Vector3f(along * out.x, across * out.y, nl))
            visibility = 0.5 / (nl * root_v + seen.cosine * root_l)
            fresnel = seen.f0 + (seen.f90 - seen.f0) * (1.0 - vh) ** 5
            facets = 0.5 * distribution / (seen.cosine + root_v)
            return fresnel * (distribution * visibility), facets

        def _widths(self, alpha: Any) -> tuple[Any, Any]:
            return dr.lerp(alpha, 1.0, self.anisotropy**2), alpha

        def _in_axes(self, v: Any, back: float = 1.0) -> Any:
            """A direction in the axes of the facets, or `back` (-1) from them."""
            c, s = self.cosine, back * self.sine
            return mi.Vector3f(c * v.x + s * v.y, c * v.y - s * v.x, v.z)

        def _fibres(self, wo: Any, nl: Any, seen: _Seen) -> Any:
            """KHR_materials_sheen, as mesh.frag has it, times the light's cosine."""
            half = dr.normalize(seen.wi + wo)
            inverse = 1.0 / max(self.sheen_roughness**2, 1e-3)
            sine2 = dr.maximum(half.x * half.x + half.y * half.y, 1e-12)
            distribution = (2.0 + inverse) * sine2 ** (0.5 * inverse) * (0.5 * dr.inv_pi)
            return self.sheen * (distribution * nl / (4.0 * (nl + seen.cosine - nl * seen.cosine)))

        def _under_clearcoat(
            self, share: Any, wo: Any, seen: _Seen, nl: Any, below: Any, density: Any
        ) -> tuple[Any, Any]:
            """A second coat above what reflects `below`, coupled as mesh.frag couples them."""
            roughness = self.clearcoat_roughness
            alpha = max(roughness * roughness, _SMALLEST_ALPHA)
            a, b, mean = self._shares(seen.cosine, roughness)
            out_again = 1.0 - share * _coat(a, b)
            a_l, b_l, _ = self._shares(nl, roughness)
            in_before = (1.0 - share * _coat(a_l, b_l)) / (1.0 - share * mean)
            lobe, facets = self._lobe(seen.wi, wo, seen.cosine, nl, alpha, DIELECTRIC_F0, _COAT_F90)
            more = 1.0 + DIELECTRIC_F0 * (1.0 / (a + b) - 1.0)
            value = below * out_again * in_before + share * more * lobe * nl
            return value, dr.lerp(density, facets, _CLEARCOAT_SAMPLES)

        def sampled(self, si: Any, seen: _Seen, sample1: Any, sample2: Any, active: Any) -> Any:
            """A direction by visible facets or by the cosine, and its weight."""
            alpha, share = seen.alpha, seen.glossy_share
            if self.clearcoat is not None:
                above = sample1 < _CLEARCOAT_SAMPLES
                left = (sample1 - _CLEARCOAT_SAMPLES) / (1.0 - _CLEARCOAT_SAMPLES)
                roughness = self.clearcoat_roughness
                alpha = dr.select(above, max(roughness * roughness, _SMALLEST_ALPHA), alpha)
                share = dr.select(above, 2.0, share)
                sample1 = dr.select(above, 0.0, left)
            is_glossy = sample1 < share
            facets = mi.MicrofacetDistribution(mi.MicrofacetType.GGX, alpha, True)
            normal = facets.sample(seen.wi, sample2)[0]
            if self.anisotropy > 0.0:
                stretched = mi.MicrofacetDistribution(
                    mi.MicrofacetType.GGX, *self._widths(seen.alpha), True
                )
                turned = stretched.sample(self._in_axes(seen.wi), sample2)[0]
                turned = self._in_axes(turned, -1.0)
                # Not those of a second coat.
                normal = dr.select(alpha == seen.alpha, turned, normal)
            mirrored = mi.reflect(seen.wi, normal)
            scattered = mi.warp.square_to_cosine_hemisphere(sample2)
            drawn = dr.zeros(mi.BSDFSample3f)
            drawn.wo = dr.select(is_glossy, mirrored, scattered)
            value, density = self.value_and_density(si, drawn.wo, seen, active)
            drawn.pdf = density
            drawn.eta = 1.0
            drawn.sampled_type = dr.select(is_glossy, mi.UInt32(glossy), mi.UInt32(diffuse))
            drawn.sampled_component = dr.select(is_glossy, mi.UInt32(0), mi.UInt32(1))
            weight = value / dr.maximum(density, _SMALLEST_DENSITY)
            return drawn, dr.select(active & (density > 0.0), weight, 0.0)

        def traverse(self, callback: Any) -> None:
            for name in ("base_color", "roughness", "metallic"):
                callback.put(name, getattr(self, name), mi.ParamFlags.Differentiable)

    return Layered
