"""Single-sided surfaces from behind: the eye looks through them, light does not.

The frame leaves out their backs and lets them cast shadows from both sides. Here rays from the eye
go on behind a back until they meet a front; all that follows is another integrator's. In
scalar variants Python would be called for each ray: this is for llvm, and for what shows a back.
"""

from typing import Any

from path_tracer.plugins import register

PLUGIN, _BACK = "vrut_lite_seen_backs", "back_"
# A ray passes at most so many backs.
_MOST = 16


def sees(mitsuba: Any, scene: Any, one_sided: list[Any]) -> bool:
    """Whether the eye sees the back of something with one of these BSDFs, in a pixel's middle."""
    import drjit

    camera = scene.sensors()[0]
    width, height = camera.film().size()
    pixel = drjit.arange(mitsuba.UInt32, width * height)
    row = pixel // width
    column = pixel - row * width
    place = mitsuba.Point2f((column + 0.5) / width, (row + 0.5) / height)
    ray, _ = camera.sample_ray(0.0, 0.5, place, mitsuba.Point2f(0.5))
    si = scene.ray_intersect(ray, mitsuba.RayFlags.Minimal, False, True)
    behind = si.is_valid() & (drjit.dot(si.n, ray.d) > 0.0)
    return bool(drjit.any(behind & _is_one_of(mitsuba, si, one_sided)))


def past_backs(mitsuba: Any, inner: Any, one_sided: list[Any]) -> Any:
    """An integrator that does as `inner` from where the eye's rays have passed these backs."""
    register(mitsuba, PLUGIN, "integrator", _seen_backs)
    backs = {f"{_BACK}{number}": bsdf for number, bsdf in enumerate(one_sided)}
    return mitsuba.load_dict({"type": PLUGIN, "inner": inner, **backs})


def _is_one_of(mi: Any, si: Any, bsdfs: list[Any]) -> Any:
    found, result = si.bsdf(), mi.Bool(False)
    for bsdf in bsdfs:
        result |= found == mi.BSDFPtr(bsdf)
    return result


def _seen_backs(mi: Any) -> Any:
    import drjit

    dr: Any = drjit

    class SeenBacks(mi.SamplingIntegrator):
        """Moves the rays of the eye past the backs of what is single-sided."""

        def __init__(self, properties: Any):
            super().__init__(properties)
            self.inner = properties["inner"]
            known = properties.keys()
            names = [name for name in known if name.startswith(_BACK)]
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
                behind &= _is_one_of(mi, si, self.one_sided)
                place = dr.select(behind, si.spawn_ray(ray.d).o, place)
                return place, behind & (count < _MOST), count + 1

            start = (mi.Point3f(ray.o), mi.Bool(active), mi.UInt32(0))
            place, _, _ = dr.while_loop(start, goes_on, past_one_back)
            ray.o = place
            return self.inner.sample(scene, sampler, ray, medium, active)

    return SeenBacks
