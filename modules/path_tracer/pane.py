"""Panes: thin walls of glass as BSDFs of mitsuba, seen from both sides.

The coat is that of `layered.py`; of the light that it lets in a share passes through, tinted by the
base colour, and paint scatters the rest. A smooth pane lets it go straight on, and light that is
sought from beyond finds its way through too (`eval_null_transmission`): the sun shines in.
"""

from typing import Any

from path_tracer.lobes import Lobes

_LEAST_SHARE = 0.1


def pane(mi: Any, layered: Any) -> Any:
    """The BSDF's class, which descends from the class of opaque surfaces."""
    import drjit

    dr: Any = drjit
    lobes = Lobes(mi)
    null, rough = +mi.BSDFFlags.Null, +mi.BSDFFlags.GlossyTransmission
    glossy, diffuse = +mi.BSDFFlags.GlossyReflection, +mi.BSDFFlags.DiffuseReflection

    class Pane(layered):
        """A surface of which a share lets light through."""

        def __init__(self, properties: Any):
            super().__init__(properties)
            self.transmission = properties.get_texture("transmission", 1.0)
            self.smooth = bool(properties.get("smooth", True))
            sides = +mi.BSDFFlags.FrontSide | +mi.BSDFFlags.BackSide
            self.through = null if self.smooth else rough
            self.m_components = [glossy | sides, diffuse | sides, self.through | sides]
            self.m_flags = glossy | diffuse | self.through | sides

        def eval_pdf(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> Any:
            return self._both(si, wo, *self._on_its_side(si, active), active)

        def eval(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> Any:
            return self.eval_pdf(ctx, si, wo, active)[0]

        def pdf(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> Any:
            return self.eval_pdf(ctx, si, wo, active)[1]

        def sample(self, ctx: Any, si: Any, sample1: Any, sample2: Any, active: Any = True) -> Any:
            return self._drawn(si, *self._on_its_side(si, active), sample1, sample2, active)

        def eval_pdf_sample(
            self, ctx: Any, si: Any, wo: Any, sample1: Any, sample2: Any, active: Any = True
        ) -> Any:
            seen, side = self._on_its_side(si, active)
            value, density = self._both(si, wo, seen, side, active)
            return value, density, *self._drawn(si, seen, side, sample1, sample2, active)

        def eval_null_transmission(self, si: Any, active: Any = True) -> Any:
            return self._on_its_side(si, active)[0].tint if self.smooth else mi.Color3f(0.0)

        def _on_its_side(self, si: Any, active: Any) -> tuple[Any, Any]:
            """Properties for the view, its side taken for the front, and that side, 1 or -1."""
            side = dr.select(mi.Frame3f.cos_theta(si.wi) < 0.0, mi.Float(-1.0), mi.Float(1.0))
            seen = self.seen(si, _turned(si.wi, side), active)
            share = self.transmission.eval_1(si, active)
            paint = seen.paint * (1.0 - share)
            glossy_share = dr.select(dr.max(paint) > 0.0, seen.glossy_share, 1.0)
            left = seen._replace(paint=paint, tint=seen.tint * share, glossy_share=glossy_share)
            return left, side

        def _share(self, seen: Any) -> Any:
            """Share of samples for transmitted light."""
            return dr.clip(mi.luminance(seen.tint), _LEAST_SHARE, 1.0 - _LEAST_SHARE)

        def _both(self, si: Any, wo: Any, seen: Any, side: Any, active: Any) -> tuple[Any, Any]:
            """Value and density of reflection and of a rough pane's transmission."""
            share, turned = self._share(seen), _turned(wo, side)
            value, density = self.value_and_density(si, turned, seen, active)
            density *= 1.0 - share
            if self.smooth:
                return value, density
            onwards = _turned(turned, mi.Float(-1.0))
            nl = dr.maximum(mi.Frame3f.cos_theta(onwards), 1e-8)
            _, facets = lobes.facets(seen.wi, onwards, seen.cosine, nl, seen.facets)
            below = mi.Frame3f.cos_theta(turned) < 0.0
            return (
                dr.select(below, seen.tint * facets, value),
                dr.select(below, share * facets, density),
            )

        def _drawn(
            self, si: Any, seen: Any, side: Any, sample1: Any, sample2: Any, active: Any
        ) -> tuple[Any, Any]:
            share = self._share(seen)
            passes = sample1 < share
            again = dr.select(passes, 0.0, (sample1 - share) / (1.0 - share))
            drawn, weight = self.sampled(si, seen, again, sample2, active)
            if self.smooth:
                onwards, kept = -seen.wi, seen.tint / share
                density = share
            else:
                mirrored = lobes.mirrored(seen.wi, seen.facets.alpha, sample2)
                nl = mi.Frame3f.cos_theta(mirrored)
                positive = dr.maximum(nl, 1e-8)
                _, density = lobes.facets(seen.wi, mirrored, seen.cosine, positive, seen.facets)
                density *= share
                onwards = _turned(mirrored, mi.Float(-1.0))
                kept = dr.select(nl > 0.0, seen.tint / share, 0.0)
            drawn.wo = _turned(dr.select(passes, onwards, drawn.wo), side)
            drawn.pdf = dr.select(passes, density, drawn.pdf * (1.0 - share))
            drawn.sampled_type = dr.select(passes, mi.UInt32(self.through), drawn.sampled_type)
            drawn.sampled_component = dr.select(passes, mi.UInt32(2), drawn.sampled_component)
            weight = dr.select(passes, kept, weight / (1.0 - share))
            return drawn, dr.select(active, weight, 0.0)

    def _turned(direction: Any, side: Any) -> Any:
        return mi.Vector3f(direction.x, direction.y, direction.z * side)

    return Pane
