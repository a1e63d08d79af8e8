"""Surfaces that the eye's rays pass: backs of single-sided ones, and those that a section cuts off.

The frame does not draw them but lets them cast shadows. Here rays from the eye continue behind them
to the first visible surface; another integrator computes the rest of the path. Where a section
opens a body, whose inside no light reaches, its wall has the light of its outside, as in the frame:
such a ray is reversed behind the wall. Scalar variants call Python for each ray, so that backs are
passed in llvm alone; cut-off surfaces are passed in both.
"""

from typing import Any, NamedTuple

import numpy as np

from path_tracer.opened_bodies import IS_BODY
from path_tracer.plugins import register
from path_tracer.subject import Subject

PLUGIN, _BACK, _GROUND = "vrut_lite_eye_rays", "back_", "ground"
_NORMAL, _OFFSET = "cut_normal", "cut_offset"
# A ray passes at most so many surfaces: the leaves of some trees.
_MOST = 256


class Cut(NamedTuple):
    """A section plane in the tracer's units from the eye; `ground` is the BSDF that it spares."""

    normal: tuple[float, float, float]
    offset_units: float
    ground: Any


def cut_of(subject: Subject, ground: Any) -> Cut | None:
    """The section plane of a subject."""
    section = subject.state.section
    if section is None:
        return None
    from_eye_m = section.offset_m - float(np.dot(section.normal, subject.camera.eye_m))
    return Cut(section.normal, from_eye_m * subject.units_per_m, ground)


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


def past_unseen(mitsuba: Any, inner: Any, one_sided: list[Any], cut: Cut | None) -> Any:
    """An integrator that does as `inner` from where the eye's rays have passed all of that."""
    register(mitsuba, PLUGIN, "integrator", _eye_rays)
    parts: dict[str, Any] = {f"{_BACK}{n}": bsdf for n, bsdf in enumerate(one_sided)}
    if cut is not None:
        parts |= {_NORMAL: mitsuba.ScalarVector3f(cut.normal), _OFFSET: cut.offset_units}
        if cut.ground is not None:
            parts[_GROUND] = cut.ground
    return mitsuba.load_dict({"type": PLUGIN, "inner": inner, **parts})


def _is_one_of(mi: Any, si: Any, bsdfs: list[Any]) -> Any:
    result = mi.Bool(False)
    is_scalar = mi.variant().startswith("scalar")
    if is_scalar and not si.is_valid():
        # Without a mask, the BSDF of no shape is looked up at address 0.
        return result
    found = si.bsdf()
    for bsdf in bsdfs:
        result |= found == (bsdf if is_scalar else mi.BSDFPtr(bsdf))
    return result


def _eye_rays(mi: Any) -> Any:
    import drjit

    dr: Any = drjit

    class EyeRays(mi.SamplingIntegrator):
        """Moves the rays of the eye past what it does not see."""

        def __init__(self, properties: Any):
            super().__init__(properties)
            self.inner = properties["inner"]
            known = properties.keys()
            self.one_sided = [properties[name] for name in known if name.startswith(_BACK)]
            self.ground = [properties[_GROUND]] if _GROUND in known else []
            self.cut = (
                (mi.Vector3f(properties[_NORMAL]), mi.Float(properties[_OFFSET]))
                if _NORMAL in known
                else None
            )

        def _is_unseen(self, si: Any, way: Any) -> Any:
            unseen = (dr.dot(si.n, way) > 0.0) & _is_one_of(mi, si, self.one_sided)
            if self.cut is not None:
                normal, offset = self.cut
                is_spared = _is_one_of(mi, si, self.ground)
                # Python's own bool, of scalar variants, has no ~.
                unseen |= (dr.dot(normal, si.p) > offset) & (is_spared == mi.Bool(False))
            return unseen

        def _is_body(self, si: Any, asked: Any) -> Any:
            asked = asked & (_is_one_of(mi, si, self.ground) == mi.Bool(False))
            # Without a mask, the attribute of no shape is looked up at address 0.
            if mi.variant().startswith("scalar") and not asked:
                return asked
            return asked & (si.shape.eval_attribute_1(IS_BODY, si, asked) > 0.5)

        def _turn(self, scene: Any, ray: Any, place: Any, in_opening: Any) -> None:
            """Let rays begin at their places; in an opened body behind its wall, backwards."""
            ray.o = place
            si = scene.ray_intersect(mi.Ray3f(ray), mi.RayFlags.Minimal, False, in_opening)
            is_back = in_opening & si.is_valid() & (dr.dot(si.n, ray.d) > 0.0)
            inside = self._is_body(si, is_back)
            ray.o = dr.select(inside, si.spawn_ray(ray.d).o, place)
            ray.d = dr.select(inside, -ray.d, ray.d)

        def sample(
            self, scene: Any, sampler: Any, ray: Any, medium: Any = None, active: Any = True
        ) -> Any:
            def goes_on(place: Any, passing: Any, count: Any) -> Any:
                return passing

            def past_one(place: Any, passing: Any, count: Any) -> tuple[Any, Any, Any]:
                onwards = mi.Ray3f(ray)
                onwards.o = place
                si = scene.ray_intersect(onwards, mi.RayFlags.Minimal, False, passing)
                passed = passing & si.is_valid() & self._is_unseen(si, ray.d)
                place = dr.select(passed, si.spawn_ray(ray.d).o, place)
                return place, passed & (count < _MOST), count + 1

            start = (mi.Point3f(ray.o), mi.Bool(active), mi.UInt32(0))
            place, _, met = dr.while_loop(start, goes_on, past_one)
            if self.cut is not None:
                in_opening = (dr.dot(self.cut[0], ray.o) > self.cut[1]) | (met > 1)
                self._turn(scene, ray, place, active & in_opening)
            else:
                ray.o = place
            return self.inner.sample(scene, sampler, ray, medium, active)

    return EyeRays
