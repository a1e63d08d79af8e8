"""Run time of a look-up in the 4-D tables, and of computing the same light directly."""

from collections.abc import Iterator

import numpy as np
from bruneton_sky import precompute
from bruneton_sky.single_scattering_kernels import fast_scattered_without_phase

from vrut_lite_lab.study.rules.against_truth import radiance_by
from vrut_lite_lab.study.rules.airs import rays_to, rgb_airs
from vrut_lite_lab.study.rules.run_times import least_s


def report() -> Iterator[str]:
    """Lines of text; the second call of a compiled function is what counts."""
    air, rays = rgb_airs()["evaluation"], rays_to(60.0)
    count = rays.mu.size
    tables = precompute(air, 4)
    sine = np.sqrt(1.0 - rays.mu**2)
    view = np.stack([sine, np.zeros(count), rays.mu], axis=-1)
    sun = np.array([np.sqrt(1.0 - rays.mu_s**2), 0.0, rays.mu_s])
    viewer = np.array([0.0, 0.0, air.ground_radius_m])
    # Many at once, so that the cost is that of the look-ups and not of the call.
    many = np.repeat(view, 100, axis=0)
    spent = {
        "4-D table, four orders": least_s(lambda: tables.sky_radiance(viewer, many, sun)) / 100,
        "single scattering, 8 nodes": least_s(lambda: radiance_by(air, rays, "", 8)),
        "the same without phase functions": least_s(
            lambda: fast_scattered_without_phase(air, 0.0, rays.mu, rays.mu_s, rays.nu, 8)
        ),
    }
    for what, seconds in spent.items():
        yield f"CPU, a ray at three wavelengths, {what}: {1e9 * seconds / count:,.0f} ns"
