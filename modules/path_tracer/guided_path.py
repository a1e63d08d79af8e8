"""A path tracer whose paths look for light where a table has seen it: an integrator of mitsuba.

At each surface a direction is drawn either by the BSDF or from the table, and weighed by the
density of both (one-sample multiple importance sampling, Veach 1997), so that the mean is that
of the BSDF alone. Emitters are sampled as in mitsuba's `path`; where `passes`, light comes through
what lets it straight on, as in `volpath`. In llvm only: scalar variants call Python for each ray.
"""

from typing import Any, NamedTuple

from path_tracer.direction_table import DirectionTable
from path_tracer.plugins import register

PLUGIN = "vrut_lite_guided_path"
# Surfaces that a ray to an emitter passes at most.
_MOST_PASSED = 64


class Vertex(NamedTuple):
    """A surface that `GuidedScattering` met at the end of a ray, and the next ray.

    `emitted` is the radiance towards the ray's origin, weighed by `emitted_weight` against emitter
    sampling; `direct` the reflected radiance of sampled emitters; `weight` the factor of the
    radiance along the next ray, of density `pdf` unless `is_delta`. `place` is where emitters were
    last sampled, `is_null`: the ray goes straight on.
    """

    interaction: Any
    facing: Any
    emitted: Any
    emitted_weight: Any
    direct: Any
    weight: Any
    ray: Any
    place: Any
    pdf: Any
    is_delta: Any
    is_null: Any
    eta: Any


class GuidedScattering:
    """One step of a path. `table` None: by the BSDF alone."""

    def __init__(self, mi: Any, scene: Any, table: DirectionTable | None, passes: bool):
        import drjit

        self._dr: Any = drjit
        self._mi, self._scene, self._table, self._passes = mi, scene, table, passes

    def step(
        self, sampler: Any, ray: Any, place: Any, pdf: Any, is_delta: Any, goes_on: Any, active: Any
    ) -> Vertex:
        """Follow a ray from `place`, where it was drawn with density `pdf`.

        `goes_on`: whether a path may scatter at the surface that it meets.
        """
        dr, mi, scene = self._dr, self._mi, self._scene
        context = mi.BSDFContext()
        si = scene.ray_intersect(ray, mi.RayFlags.All, False, active)
        to_emitter = mi.DirectionSample3f(scene, si, place)
        other = scene.pdf_emitter_direction(place, to_emitter, active & ~is_delta)
        emitted = dr.select(active, si.emitter(scene).eval(si, active), 0.0)
        emitted_weight = dr.select(is_delta, 1.0, _power(dr, pdf, other))

        going = active & si.is_valid() & goes_on
        bsdf = si.bsdf(ray)
        smooth = going & mi.has_flag(bsdf.flags(), mi.BSDFFlags.Smooth)
        facing = dr.select(dr.dot(si.n, ray.d) > 0.0, -si.n, si.n)
        row, share = mi.UInt32(0), mi.Float(0.0)
        if self._table is not None:
            row = self._table.row(si.p, facing, smooth)
            share = dr.select(smooth, self._table.share(row), 0.0)

        # Sampled emitters.
        drawn, radiance = scene.sample_emitter_direction(
            si, sampler.next_2d(smooth), not self._passes, smooth
        )
        lit = smooth & (drawn.pdf > 0.0)
        if self._passes:
            radiance *= self._transmittance(si, drawn, lit)
        value, density = bsdf.eval_pdf(context, si, si.to_local(drawn.d), lit)
        density = self._mixed(row, share, drawn.d, density, lit)
        weight = dr.select(drawn.delta, 1.0, _power(dr, drawn.pdf, density))
        direct = dr.select(lit, value * radiance * weight, 0.0)

        # The next direction.
        first, second = sampler.next_1d(going), sampler.next_2d(going)
        guided = first < share
        first = dr.select(guided, first / share, (first - share) / (1.0 - share))
        sample, sample_weight = bsdf.sample(context, si, first, second, going & ~guided)
        onwards = si.to_world(sample.wo)
        next_delta = ~guided & mi.has_flag(sample.sampled_type, mi.BSDFFlags.Delta)
        sample_weight /= 1.0 - share
        if self._table is not None:
            onwards = dr.select(guided, self._table.draw(row, first, second, guided), onwards)
            mixes = going & (share > 0.0) & ~next_delta
            value, density = bsdf.eval_pdf(context, si, si.to_local(onwards), mixes)
            density = self._mixed(row, share, onwards, density, mixes)
            sample_weight = dr.select(
                mixes, dr.select(density > 0.0, value / density, 0.0), sample_weight
            )
            sample.pdf = dr.select(mixes, density, sample.pdf)
        is_null = (
            self._passes & going & next_delta & mi.has_flag(sample.sampled_type, mi.BSDFFlags.Null)
        )
        return Vertex(
            interaction=si,
            facing=facing,
            emitted=emitted,
            emitted_weight=emitted_weight,
            direct=direct,
            weight=dr.select(going, sample_weight, 0.0),
            ray=si.spawn_ray(onwards),
            place=dr.select(is_null, place, mi.Interaction3f(si)),
            pdf=dr.select(is_null, pdf, sample.pdf),
            is_delta=dr.select(is_null, is_delta, next_delta),
            is_null=is_null,
            eta=dr.select(guided, 1.0, sample.eta),
        )

    def _mixed(self, row: Any, share: Any, direction: Any, density: Any, active: Any) -> Any:
        """Density of the next direction by BSDF and table."""
        if self._table is None:
            return density
        return self._dr.lerp(density, self._table.density(row, direction, active), share)

    def _transmittance(self, si: Any, drawn: Any, active: Any) -> Any:
        """Part of an emitter's light that comes straight through the surfaces before it."""
        dr, mi = self._dr, self._mi
        start = si.spawn_ray_to(drawn.p)

        def goes_on(ray: Any, left: Any, passing: Any, count: Any) -> Any:
            return passing

        def past_one(ray: Any, left: Any, passing: Any, count: Any) -> Any:
            met = self._scene.ray_intersect(ray, mi.RayFlags.All, False, passing)
            stopped = passing & met.is_valid()
            left = dr.select(stopped, left * met.bsdf().eval_null_transmission(met, stopped), left)
            onwards = met.spawn_ray_to(drawn.p)
            passing = stopped & (dr.max(left) > 0.0) & (count < _MOST_PASSED)
            # A surface that is passed at the last count stops the light.
            left = dr.select(stopped & (count >= _MOST_PASSED), 0.0, left)
            return dr.select(passing, onwards, ray), left, passing, count + 1

        state = (mi.Ray3f(start), mi.Color3f(1.0), mi.Bool(active), mi.UInt32(0))
        return dr.while_loop(state, goes_on, past_one)[1]


def guided_path(
    mitsuba: Any, table: DirectionTable, passes: bool, max_depth: int, roulette_depth: int
) -> Any:
    """The integrator; `max_depth` as mitsuba's, -1 for any."""
    register(mitsuba, PLUGIN, "integrator", _guided_path)
    made = mitsuba.load_dict({"type": PLUGIN})
    made.table, made.passes = table, passes
    made.max_depth = 2**31 if max_depth < 0 else max_depth
    made.roulette_depth = roulette_depth
    return made


def _power(dr: Any, a: Any, b: Any) -> Any:
    """The power heuristic's weight of density a beside b."""
    a, b = dr.square(a), dr.square(b)
    return dr.select(a > 0.0, a / (a + b), 0.0)


def _guided_path(mi: Any) -> Any:
    import drjit

    dr: Any = drjit

    class GuidedPath(mi.SamplingIntegrator):
        """Attributes are set by `guided_path`."""

        table: DirectionTable
        passes: bool
        max_depth: int
        roulette_depth: int

        def sample(
            self, scene: Any, sampler: Any, ray: Any, medium: Any = None, active: Any = True
        ) -> Any:
            scattering = GuidedScattering(mi, scene, self.table, self.passes)

            def goes_on(going: Any, *rest: Any) -> Any:
                return going

            def bounce(
                going: Any, sampler: Any, ray: Any, place: Any, pdf: Any, is_delta: Any,
                depth: Any, weight: Any, eta: Any, total: Any, valid: Any,
            ) -> Any:  # fmt: skip
                may_scatter = depth + 1 < self.max_depth
                v = scattering.step(sampler, ray, place, pdf, is_delta, may_scatter, going)
                total += weight * (v.emitted * v.emitted_weight + v.direct)
                valid |= v.interaction.is_valid()
                weight *= v.weight
                eta *= v.eta
                depth = dr.select(v.is_null, depth, depth + 1)
                going &= v.interaction.is_valid() & may_scatter & (dr.max(weight) > 0.0)
                kept = dr.minimum(dr.max(weight) * dr.square(eta), 0.95)
                plays = depth >= self.roulette_depth
                lives = sampler.next_1d(going) < kept
                weight = dr.select(plays, weight / kept, weight)
                going &= ~plays | lives
                return (
                    going,
                    sampler,
                    v.ray,
                    v.place,
                    v.pdf,
                    v.is_delta,
                    depth,
                    weight,
                    eta,
                    total,
                    valid,
                )

            start = (
                mi.Bool(active), sampler, mi.Ray3f(ray), dr.zeros(mi.Interaction3f), mi.Float(1.0),
                mi.Bool(True), mi.UInt32(0), mi.Color3f(1.0), mi.Float(1.0), mi.Color3f(0.0),
                mi.Bool(False),
            )  # fmt: skip
            end = dr.while_loop(start, goes_on, bounce)
            return end[-2], end[-1], []

    return GuidedPath
