"""The GL frame's own surface as a BSDF of mitsuba: metal, or paint under a coat that keeps energy.

To the lobes of lobes.py comes what bounces between facets (Turquin 2019); what the coat does not
reflect reaches the paint below it (Kelemen and Szirmay-Kalos 2001). Mitsuba's plugins have none of
this: their Smith terms are products, their Fresnel terms exact, and rough surfaces lose what
bounces.
"""

from typing import Any, NamedTuple

from path_tracer import plugins
from path_tracer.coats import COAT_F90, GRAZING_SLOPE, Film, Shares, coat, mean_coat
from path_tracer.lobes import Facets, Lobes, Stretch
from path_tracer.pane import pane
from vrut_lite.geometry.reflection import DIELECTRIC_F0

PLUGIN, PANE = "vrut_lite_layered", "vrut_lite_pane"
# Least alpha, as in mesh.frag: the sun's radius blurs a mirror image about as much.
_SMALLEST_ALPHA = 0.005
_SMALLEST_COSINE, _SMALLEST_DENSITY = 1e-4, 1e-20
# Least share of samples for the coat, and for the paint: few samples would have large weights.
_LEAST_SHARE = 0.1
# Share of samples for a second coat.
_CLEARCOAT_SAMPLES = 0.25


class _Seen(NamedTuple):
    """Properties of a surface that depend on the view alone; `paint` excludes the light's way in.

    `more` is the factor for bounces between facets, `glossy_share` the share of samples for the
    coat, `peak` and `edge` its reflectance at normal incidence and at grazing angles. `tint` is the
    transmittance, if light passes.
    """

    wi: Any
    cosine: Any
    roughness: Any
    facets: Facets
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
    the share under a second coat of `clearcoat_roughness`; colour and roughness of a `sheen`;
    `anisotropy`; and `iridescence`, the share under a film of `film_ior`, of which `film_thickness`
    says where it lies between `film_least_nm` and `film_most_nm`. `PANE` is the same surface from
    both sides, of which the share `transmission` lets light through, straight on if it is `smooth`.
    """
    plugins.register(mitsuba, PLUGIN, "bsdf", _layered)
    plugins.register(mitsuba, PANE, "bsdf", lambda mi: pane(mi, _layered(mi)))


def _layered(mi: Any) -> Any:
    """The BSDF's class, which must descend from the variant's own."""
    import drjit

    dr: Any = drjit
    shares, lobes = Shares(mi), Lobes(mi)
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
            self.f90 = properties.get_texture("f90", COAT_F90)
            self.clearcoat = (
                properties.get_texture("clearcoat") if "clearcoat" in properties else None
            )
            self.clearcoat_roughness = float(properties.get("clearcoat_roughness", 0.0))
            self.sheen = mi.Color3f(properties.get("sheen", mi.ScalarColor3f(0.0)))
            self.sheen_roughness = float(properties.get("sheen_roughness", 0.0))
            self.has_sheen = "sheen" in properties
            self.stretch = None
            if "anisotropy" in properties:
                turn_rad = float(properties.get("anisotropy_rad", 0.0))
                self.stretch = Stretch(float(properties["anisotropy"]), turn_rad)
            self.film = None
            if "iridescence" in properties:
                names = ("film_ior", "film_least_nm", "film_most_nm")
                self.film = Film(mi, *(float(properties[name]) for name in names))
                self.iridescence = properties.get_texture("iridescence")
                self.film_thickness = properties.get_texture("film_thickness", 1.0)
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
            # Guide of a denoiser: it includes the colour of metals.
            return self._colour(si, active)

        def _colour(self, si: Any, active: Any) -> Any:
            base = self.base_color.eval(si, active)
            return base if self.tint is None else base * self.tint.eval(si, active)

        def _filmed(self, si: Any, f0: Any, cosine: Any, active: Any) -> Any:
            if self.film is None:
                return f0
            share = self.iridescence.eval_1(si, active)
            return self.film.over(f0, cosine, share, self.film_thickness.eval_1(si, active))

        def seen(self, si: Any, wi: Any, active: Any) -> _Seen:
            """The surface as seen from `wi` above it."""
            base = self._colour(si, active)
            roughness = dr.clip(self.roughness.eval_1(si, active), 0.0, 1.0)
            metallic = self.metallic.eval_1(si, active)
            cosine = dr.maximum(mi.Frame3f.cos_theta(wi), _SMALLEST_COSINE)
            a, b, mean = shares.facets(cosine, roughness)
            coat_f0, edge = self.f0.eval(si, active), self.f90.eval_1(si, active)
            f0 = coat_f0 + (base - coat_f0) * metallic
            f90 = dr.clip(GRAZING_SLOPE * dr.max(f0), 0.0, 1.0)
            f90 = dr.lerp(edge, f90, metallic)
            f0 = self._filmed(si, f0, cosine, active)
            peak = dr.max(self._filmed(si, coat_f0, cosine, active))
            more = 1.0 + f0 * (1.0 / (a + b) - 1.0)
            below = base * (1.0 - metallic) * (1.0 - coat(a, b, peak, edge))
            if self.has_sheen:
                # Fibres take their light from all that is below them.
                taken = dr.max(self.sheen) * shares.fibres(cosine, self.sheen_roughness)
                more, below = more * (1.0 - taken), below * (1.0 - taken)
            reflected = mi.luminance((f0 * a + f90 * b) * more)
            share = reflected / dr.maximum(reflected + mi.luminance(below), _SMALLEST_DENSITY)
            share = dr.clip(share, _LEAST_SHARE, 1.0 - _LEAST_SHARE)
            return _Seen(
                wi=wi,
                cosine=cosine,
                roughness=roughness,
                facets=Facets(dr.maximum(roughness * roughness, _SMALLEST_ALPHA), f0, f90),
                more=more,
                paint=below * dr.inv_pi / dr.maximum(1.0 - mean_coat(mean, peak, edge), 1e-3),
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
            if self.stretch is not None:
                lobe, facets = lobes.stretched(seen.wi, wo, nv, nl, seen.facets, self.stretch)
            else:
                lobe, facets = lobes.facets(seen.wi, wo, nv, nl, seen.facets)
            a, b, _ = shares.facets(nl, seen.roughness)
            value = (seen.more * lobe + seen.paint * (1.0 - coat(a, b, seen.peak, seen.edge))) * nl
            density = dr.lerp(nl * dr.inv_pi, facets, seen.glossy_share)
            if self.has_sheen:
                value += self.sheen * lobes.fibres(seen.wi, wo, nv, nl, self.sheen_roughness)
            if self.clearcoat is not None:
                second = self.clearcoat.eval_1(si, active)
                value, density = self._under_clearcoat(second, wo, seen, nl, value, density)
            return dr.select(above, value, 0.0), dr.select(above, density, 0.0)

        def _under_clearcoat(
            self, share: Any, wo: Any, seen: _Seen, nl: Any, below: Any, density: Any
        ) -> tuple[Any, Any]:
            """A second coat above what reflects `below`, coupled as mesh.frag couples them."""
            roughness = self.clearcoat_roughness
            alpha = max(roughness * roughness, _SMALLEST_ALPHA)
            a, b, mean = shares.facets(seen.cosine, roughness)
            out_again = 1.0 - share * coat(a, b)
            a_l, b_l, _ = shares.facets(nl, roughness)
            in_before = (1.0 - share * coat(a_l, b_l)) / (1.0 - share * mean)
            of = Facets(alpha, DIELECTRIC_F0, COAT_F90)
            lobe, facets = lobes.facets(seen.wi, wo, seen.cosine, nl, of)
            more = 1.0 + DIELECTRIC_F0 * (1.0 / (a + b) - 1.0)
            value = below * out_again * in_before + share * more * lobe * nl
            return value, dr.lerp(density, facets, _CLEARCOAT_SAMPLES)

        def sampled(self, si: Any, seen: _Seen, sample1: Any, sample2: Any, active: Any) -> Any:
            """A direction by visible facets or by the cosine, and its weight."""
            alpha, share = seen.facets.alpha, seen.glossy_share
            if self.clearcoat is not None:
                above = sample1 < _CLEARCOAT_SAMPLES
                left = (sample1 - _CLEARCOAT_SAMPLES) / (1.0 - _CLEARCOAT_SAMPLES)
                roughness = self.clearcoat_roughness
                alpha = dr.select(above, max(roughness * roughness, _SMALLEST_ALPHA), alpha)
                share = dr.select(above, 2.0, share)
                sample1 = dr.select(above, 0.0, left)
            is_glossy = sample1 < share
            mirrored = lobes.mirrored(seen.wi, alpha, sample2)
            if self.stretch is not None:
                own = seen.facets.alpha
                stretched = lobes.mirrored_by_stretched(seen.wi, own, self.stretch, sample2)
                # Not those of a second coat.
                mirrored = dr.select(alpha == own, stretched, mirrored)
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
