"""Bodies of glass: mitsuba's dielectrics, whose inside takes light away by Beer and Lambert.

A ray that meets the surface from inside has come through the body since it was last met: no medium
has to be sampled.
"""

from typing import Any

import numpy as np

from path_tracer.bitmaps import Plugin
from path_tracer.plugins import register
from vrut_lite.messages.scene_content import Material

PLUGIN = "vrut_lite_body"
# Roughness below which light passes straight on, as in the GL frame.
SMOOTH, _LEAST_IOR = 0.05, 1.0001


def body(mitsuba: Any, material: Material, units_per_m: float) -> Plugin:
    """The BSDF of a closed body; its base colour tints light through two of its sides once."""
    register(mitsuba, PLUGIN, "bsdf", _body)
    terms, roughness = material.terms, material.roughness
    tint = np.sqrt(np.clip(material.base_colour_rgba[:3], 0.0, 1.0))
    inner: Plugin = {
        "type": "dielectric",
        "int_ior": max(terms.ior, _LEAST_IOR),
        "ext_ior": 1.0,
        "specular_transmittance": {"type": "rgb", "value": [float(value) for value in tint]},
    }
    if roughness > SMOOTH:
        inner |= {"type": "roughdielectric", "distribution": "ggx", "alpha": roughness**2}
    extinction = [value / units_per_m for value in terms.extinction_per_m]
    return {
        "type": PLUGIN,
        "inner": inner,
        "extinction": mitsuba.ScalarColor3f(extinction),
    }


def _body(mi: Any) -> Any:
    import drjit

    dr: Any = drjit

    class Body(mi.BSDF):
        """The inner BSDF's scattered light, less the absorption of the way through the body."""

        def __init__(self, properties: Any):
            super().__init__(properties)
            self.inner = properties["inner"]
            self.extinction = mi.Color3f(properties["extinction"])
            self.m_components = [self.inner.flags(i) for i in range(self.inner.component_count())]
            self.m_flags = self.inner.flags()

        def _left(self, si: Any) -> Any:
            inside = mi.Frame3f.cos_theta(si.wi) < 0.0
            return dr.select(inside, dr.exp(-self.extinction * si.t), 1.0)

        def sample(self, ctx: Any, si: Any, sample1: Any, sample2: Any, active: Any = True) -> Any:
            drawn, weight = self.inner.sample(ctx, si, sample1, sample2, active)
            return drawn, weight * self._left(si)

        def eval(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> Any:
            return self.inner.eval(ctx, si, wo, active) * self._left(si)

        def pdf(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> Any:
            return self.inner.pdf(ctx, si, wo, active)

        def eval_pdf(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> Any:
            value, density = self.inner.eval_pdf(ctx, si, wo, active)
            return value * self._left(si), density

        def eval_diffuse_reflectance(self, si: Any, active: Any = True) -> Any:
            return mi.Color3f(1.0)

    return Body
