"""Run time of each rule against its error: CPU nanoseconds per ray, three wavelengths."""

import time
from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np
from bruneton_sky.atmosphere import Atmosphere

from vrut_lite_lab.study.rules.against_truth import (
    NODES,
    SAMPLES,
    Samples,
    all_rules,
    radiance_by,
    truth,
)
from vrut_lite_lab.study.rules.airs import SeaLevelRays, rays_to

_ROUNDS, _LEAST_S = 3, 0.02


class RunTime(NamedTuple):
    """One rule with one number of samples, on one device."""

    device: str
    sun_zenith_deg: float
    rule: str
    samples: Samples
    ns_per_ray: float
    rms: float


def cpu_run_times(
    air: Atmosphere,
    sun_zenith_deg: float,
    samples: tuple[tuple[int, int], ...] = SAMPLES,
    nodes: tuple[int, ...] = NODES,
) -> Iterator[RunTime]:
    """Compiled, float64, one thread, toward the 81 directions."""
    rays = rays_to(sun_zenith_deg)
    right = truth(air, rays)
    for rule, taken in all_rules(samples, nodes):
        rms = float(np.sqrt(((radiance_by(air, rays, rule, taken) / right - 1.0) ** 2).mean()))
        spent = least_s(_repeated(air, rays, rule, taken))
        yield RunTime("CPU", sun_zenith_deg, rule, taken, 1e9 * spent / rays.mu.size, rms)


def least_s(work: Callable[[], object]) -> float:
    """The least CPU time of the process for one call, of at least three rounds."""
    calls, spent = 1, 0.0
    while True:
        start = time.process_time()
        for _ in range(calls):
            work()
        spent = time.process_time() - start
        if spent >= _LEAST_S:
            break
        calls *= 2
    rounds = [spent]
    for _ in range(_ROUNDS - 1):
        start = time.process_time()
        for _ in range(calls):
            work()
        rounds.append(time.process_time() - start)
    return min(rounds) / calls


def _repeated(
    air: Atmosphere, rays: SeaLevelRays, rule: str, samples: Samples
) -> Callable[[], object]:
    return lambda: radiance_by(air, rays, rule, samples)
