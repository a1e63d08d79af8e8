"""Errors of each rule against the exact integral, by the sun's zenith angle.

A rule must be ranked against what it integrates: against a measured sky the error of the model
(25.5 mW) hides that of the quadrature (0.001 mW at 512 x 256).
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.phase import mie_phase, rayleigh_phase
from bruneton_sky.published.single_scattering import single_scattering
from bruneton_sky.single_scattering_kernels import fast_scattered_without_phase

from vrut_lite.numeric_types import FloatArray
from vrut_lite_lab.study.rules.airs import SeaLevelRays, rays_to
from vrut_lite_lab.study.rules.kernels import classical_radiance

# Nodes per segment of our rule, or intervals (view, light) of a textbook one.
Samples = int | tuple[int, int]
SUN_ZENITHS_DEG = (25.0, 60.0, 80.0, 87.0, 93.0, 96.0)
RULES = ("midpoint", "trapezoid", "simpson-trapezoid", "simpson")
SAMPLES = ((16, 8), (128, 64), (512, 256))
FINEST = SAMPLES[-1]
NODES = (4, 6, 8, 10, 12, 14, 16, 20, 24)
_TRUTH_NODES = 64


class RuleError(NamedTuple):
    """Relative errors of one rule over all rays and wavelengths."""

    air: str
    sun_zenith_deg: float
    rule: str
    samples: Samples
    rms: float
    largest: float


def all_rules(
    samples: tuple[tuple[int, int], ...], nodes: tuple[int, ...]
) -> list[tuple[str, Samples]]:
    """Every textbook rule at every number of samples, then ours at every number of nodes."""
    textbook: list[tuple[str, Samples]] = [(rule, pair) for rule in RULES for pair in samples]
    return [*textbook, *(("gauss-legendre", count) for count in nodes)]


def truth(air: Atmosphere, rays: SeaLevelRays) -> FloatArray:
    """Radiance (n, C), to 1e-9 by day and 1e-8 where light grazes the ground."""
    return single_scattering(air, 0.0, *rays, samples=_TRUTH_NODES)


def gauss_legendre_radiance(air: Atmosphere, rays: SeaLevelRays, nodes: int) -> FloatArray:
    """Radiance (n, C) by our rule, compiled."""
    parts = fast_scattered_without_phase(air, 0.0, rays.mu, rays.mu_s, rays.nu, nodes)
    cosine = rays.nu[:, None]
    return np.asarray(parts[0] * rayleigh_phase(cosine) + parts[1] * mie_phase(air, cosine))


def radiance_by(air: Atmosphere, rays: SeaLevelRays, rule: str, samples: Samples) -> FloatArray:
    """Radiance (n, C) by any rule: `gauss-legendre` with nodes, else with intervals."""
    if isinstance(samples, int):
        return gauss_legendre_radiance(air, rays, samples)
    return classical_radiance(air, rays, rule, samples)


def rule_errors(
    name: str,
    air: Atmosphere,
    sun_zenith_deg: float,
    samples: tuple[tuple[int, int], ...] = SAMPLES,
    nodes: tuple[int, ...] = NODES,
) -> Iterator[RuleError]:
    """The error of every rule at every number of samples."""
    rays = _lit_rays(air, sun_zenith_deg)
    right = truth(air, rays)
    for rule, taken in all_rules(samples, nodes):
        off = radiance_by(air, rays, rule, taken) / right - 1.0
        rms, largest = float(np.sqrt((off**2).mean())), float(np.abs(off).max())
        yield RuleError(name, sun_zenith_deg, rule, taken, rms, largest)


def _lit_rays(air: Atmosphere, sun_zenith_deg: float) -> SeaLevelRays:
    """Those of the 81 that are not wholly in the planet's shadow: there all rules give 0."""
    rays = rays_to(sun_zenith_deg)
    lit = truth(air, rays).min(axis=-1) > 0.0
    return SeaLevelRays(rays.mu[lit], rays.mu_s, rays.nu[lit])


def fewest_nodes(errors: list[RuleError], rule: str) -> RuleError | None:
    """The fewest nodes at which our rule errs no more than a textbook rule at 512 x 256.

    None where all of them err more.
    """
    (bound,) = (each.rms for each in errors if (each.rule, each.samples) == (rule, FINEST))
    ours = (each for each in errors if each.rule == "gauss-legendre")
    return next((each for each in ours if each.rms <= bound), None)
