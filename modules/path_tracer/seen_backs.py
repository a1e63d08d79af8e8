"""Single-sided surfaces from behind: the eye looks through them, light does not.

The frame leaves out their backs and lets them cast shadows from both sides. Here rays from the eye
go on behind a back until they meet a front; all that follows is another integrator's. It is called
for each ray in scalar variants, and stands in llvm alone.
"""

from typing import Any

PLUGIN, BACK = "vrut_lite_seen_backs", "back_"
# A ray passes at most so many backs.
_MOST = 16
_registered: set[str] = set()


def register(mitsuba: Any) -> None:
    """Make the plugin known to the variant of mitsuba that is set.

    Its children: the integrator `inner`, and the one-sided BSDFs under names of `BACK`.
    """
    variant = mitsuba.variant()
    if variant not in _registered:
        mitsuba.register_integrator(PLUGIN, _seen_backs(mitsuba))
        _registered.add(variant)


def _seen_backs(mi: Any) -> Any:
    import drjit

    dr: Any = drjit

    class SeenBacks(mi.SamplingIntegrator):
        """Moves the rays of the eye past the backs of what is single-sided."""

        def __init__(self, properties: Any):
            super().__init__(properties)
            self.inner = properties["inner"]
            names = [name for name in properties.property_names() if name.startswith(BACK)]
            self.one_sided = [properties[name] for name in names]

        def sample(
            self, scene: Any, sampler: Any, ray: Any, medium: Any = None, active: Any = True
        ) -> Any:
            def goes_on(place: Any, passing: Any, count: Any) -> Any:
                return passing

            def past_one_back(place: Any, passing: Any, count: Any) -> tuple[Any, Any, Any]:
                onwards = mi.Ray3f(ray)
                onwards.o = place
                si = scene.ray_intersect(onwards, mi.RayFlags.Minimal, False, passing)
                behind = passing & si.is_valid() & (dr.dot(si.n, ray.d) > 0.0)
                behind &= self._is_one_sided(si)
                place = dr.select(behind, si.spawn_ray(ray.d).o, place)
                return place, behind & (count < _MOST), count + 1

            start = (mi.Point3f(ray.o), mi.Bool(active), mi.UInt32(0))
            place, _, _ = dr.while_loop(start, goes_on, past_one_back)
            ray.o = place
            return self.inner.sample(scene, sampler, ray, medium, active)

        def _is_one_sided(self, si: Any) -> Any:
            bsdf = si.bsdf()
            result = mi.Bool(False)
            for one in self.one_sided:
                result |= bsdf == mi.BSDFPtr(one)
            return result

    return SeenBacks
