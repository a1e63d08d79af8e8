"""Single-sided surfaces that let light through: from behind they are not there, as glTF has it.

Rays that scatter on pass the back whole. Light that is sought straight through a surface is taken
away by both sides, as in the frame's shadows.
"""

from typing import Any

from path_tracer.bitmaps import Plugin
from path_tracer.plugins import register

PLUGIN = "vrut_lite_front"


def front_alone(mitsuba: Any, inner: Plugin) -> Plugin:
    """A cut-out or blended BSDF without its back."""
    register(mitsuba, PLUGIN, "bsdf", _front)
    return {"type": PLUGIN, "inner": inner}


def _front(mi: Any) -> Any:
    import drjit

    dr: Any = drjit

    class Front(mi.BSDF):
        """The inner BSDF from the front; nothing from behind."""

        def __init__(self, properties: Any):
            super().__init__(properties)
            self.inner = properties["inner"]
            self.m_components = [self.inner.flags(i) for i in range(self.inner.component_count())]
            self.m_flags = self.inner.flags()

        def _is_front(self, si: Any) -> Any:
            return dr.dot(si.n, si.to_world(si.wi)) > 0.0

        def sample(self, ctx: Any, si: Any, sample1: Any, sample2: Any, active: Any = True) -> Any:
            drawn, weight = self.inner.sample(ctx, si, sample1, sample2, active)
            front = self._is_front(si)
            last = mi.UInt32(self.inner.component_count() - 1)
            drawn.wo = dr.select(front, drawn.wo, -si.wi)
            drawn.pdf = dr.select(front, drawn.pdf, 1.0)
            drawn.eta = dr.select(front, drawn.eta, 1.0)
            null = mi.UInt32(+mi.BSDFFlags.Null)
            drawn.sampled_type = dr.select(front, drawn.sampled_type, null)
            drawn.sampled_component = dr.select(front, drawn.sampled_component, last)
            return drawn, dr.select(active, dr.select(front, weight, 1.0), 0.0)

        def eval(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> Any:
            return self.inner.eval(ctx, si, wo, active & self._is_front(si))

        def pdf(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> Any:
            return self.inner.pdf(ctx, si, wo, active & self._is_front(si))

        def eval_pdf(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> Any:
            return self.inner.eval_pdf(ctx, si, wo, active & self._is_front(si))

        def eval_null_transmission(self, si: Any, active: Any = True) -> Any:
            return self.inner.eval_null_transmission(si, active)

        def eval_diffuse_reflectance(self, si: Any, active: Any = True) -> Any:
            return self.inner.eval_diffuse_reflectance(si, active)

    return Front
