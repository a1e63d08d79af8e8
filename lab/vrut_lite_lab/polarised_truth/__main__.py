"""Compare a solved sky with polarised light traced and solved by independent programs.

    python -m vrut_lite_lab.polarised_truth [--quick] [--shared-optics] [--sasktran] [--out FOLDER]

Luminance and blue (linear sRGB's B, nearly all of it from 445 nm) of `bruneton_sky.solve` under six
suns, in three airs, for three observers. Both come from the four wavelengths of the product's
colour matrix; that matrix's own error is not in them.

By default the truth's optics are independent of the product's, so that the errors are those of
optics and transfer together. The product's solver in the truth's air shows the share of optics
without the noise of paths. `--shared-optics` gives the truth the product's own optics: what is left
is the error of transfer.

Numbers are relative errors over rays: root mean square, largest, and the standard error of the
truth, which the root mean square includes.

On one core --quick takes a minute of CPU time; all suns and observers take 80, with sasktran2, to
which only suns above the horizon are shown, 160 minutes and 5 GB of memory.
"""

import argparse
import time
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
from bruneton_sky import Atmosphere, solve

from vrut_lite.geometry.colour import luminance, skylight_matrix
from vrut_lite.numeric_types import FloatArray
from vrut_lite_lab.monte_carlo import monte_carlo_stokes
from vrut_lite_lab.polarised_truth.airs import HAZES, independent_air, product_air
from vrut_lite_lab.polarised_truth.by_sasktran import sasktran_stokes
from vrut_lite_lab.polarised_truth.views import ALTITUDES_M, Rays, rays_of, solved_radiance

SUN_ZENITHS_DEG = (0.0, 30.0, 60.0, 80.0, 87.0, 93.0)
_WHOLE, _QUICK = (24, 16_384), (12, 8192)
_QUICK_SUNS_DEG = (30.0, 80.0, 87.0)
# Times as many paths under a low sun, whose light few of them find.
_MORE_PATHS = {87.0: 4, 93.0: 32}
# Share of the brightest ray's luminance below which rays are left out: the planet's night side.
_DARK = 0.01


class RelativeErrors(NamedTuple):
    """Relative errors of luminance and blue (2,): rms, largest, and the truth's standard error."""

    rms: FloatArray
    worst: FloatArray
    noise: FloatArray


class ComparedSky(NamedTuple):
    """One row of the page: errors against the truths and, without noise, those of optics alone.

    Without sasktran2 the last is None.
    """

    air: str
    observer: str
    sun_zenith_deg: float
    monte_carlo: RelativeErrors
    optics: RelativeErrors
    sasktran: RelativeErrors | None


def compare(
    name: str, *, quick: bool, shared_optics: bool, with_sasktran: bool
) -> Iterator[ComparedSky]:
    """Rows of an air, as they are found."""
    own = product_air(name)
    air = own if shared_optics else independent_air(name)
    sky, in_other_optics = solve(own), solve(air)
    count, paths = _QUICK if quick else _WHOLE
    observers = ("ground",) if quick else tuple(ALTITUDES_M)
    for observer in observers:
        for sun in _QUICK_SUNS_DEG if quick else SUN_ZENITHS_DEG:
            rays = rays_of(observer, sun, count)
            shown, changed = (
                _luminance_and_blue(solved_radiance(each, rays)) for each in (sky, in_other_optics)
            )
            no_noise = np.zeros_like(shown)
            by_paths = _traced(air, rays, paths * (1 if quick else _MORE_PATHS.get(sun, 1)))
            mean, noise = by_paths.mean(axis=0), by_paths.std(axis=0, ddof=1)
            noise /= np.sqrt(len(by_paths)) * mean
            lit = mean[:, 0] > _DARK * mean[:, 0].max()
            other = None
            if with_sasktran and sun < 90.0:
                solved = [sasktran_stokes(air, rays, c)[:, 0] for c in range(shown.shape[-1] + 2)]
                truth = _luminance_and_blue(np.stack(solved, axis=1))
                other = _errors((shown / truth - 1.0)[lit], no_noise[lit])
            yield ComparedSky(
                name, observer, sun,
                _errors((shown / mean - 1.0)[lit], noise[lit]),
                _errors((shown / changed - 1.0)[lit], no_noise[lit]),
                other,
            )  # fmt: skip


def _traced(air: Atmosphere, rays: Rays, paths: int) -> FloatArray:
    """Luminance and blue (batches, n, 2) along rays, by the vector Monte Carlo."""
    light, _, _ = monte_carlo_stokes(
        air, rays.altitude_m, rays.mu, rays.mu_s, rays.nu, paths=paths, ground_seen=True
    )
    return _luminance_and_blue(light.batches.sum(axis=2))


def _luminance_and_blue(radiance: FloatArray) -> FloatArray:
    """(..., 2) of radiance (..., 4) at SKYLIGHT_NM."""
    rgb = radiance @ skylight_matrix()
    return np.stack([luminance(rgb), rgb[..., 2]], axis=-1)


def _errors(relative: FloatArray, noise: FloatArray) -> RelativeErrors:
    return RelativeErrors(
        np.sqrt(np.mean(relative**2, axis=0)),
        np.abs(relative).max(axis=0),
        np.sqrt(np.mean(noise**2, axis=0)),
    )


def page(rows: list[ComparedSky]) -> str:
    """A table in Markdown: a line for each air and observer, a column for each sun.

    Errors in percent: rms of luminance, its noise, and rms of blue; in brackets luminance and blue
    by optics alone.
    """
    suns = sorted({row.sun_zenith_deg for row in rows})
    lines = [
        f"| air | observer | {' | '.join(f'{sun:.0f}°' for sun in suns)} |",
        f"|---|---|{'---:|' * len(suns)}",
    ]
    for air, observer in dict.fromkeys((row.air, row.observer) for row in rows):
        cells = [
            f"{_percent(row.monte_carlo.rms[0])}/{_percent(row.monte_carlo.noise[0])}/"
            f"{_percent(row.monte_carlo.rms[1])} "
            f"({'/'.join(map(_percent, row.optics.rms))})"
            for row in rows
            if (row.air, row.observer) == (air, observer)
        ]
        lines.append(f"| {air} | {observer} | {' | '.join(cells)} |")
    return "\n".join(lines) + "\n"


def _line(row: ComparedSky) -> str:
    """A sky's errors in percent: rms, largest and noise of luminance and blue."""
    parts = [f"{row.air:8} {row.observer:7} {row.sun_zenith_deg:3.0f}°"]
    truths = (
        ("Monte Carlo", row.monte_carlo), ("optics alone", row.optics), ("sasktran2", row.sasktran)
    )  # fmt: skip
    for truth, errors in truths:
        if errors is not None:
            values = [
                "/".join(map(_percent, each))
                for each in np.transpose([errors.rms, errors.worst, errors.noise])
            ]
            parts.append(f"{truth}: luminance {values[0]}, blue {values[1]}")
    return "  ".join(parts)


def _percent(share: float) -> str:
    return f"{100 * share:.2f}"


def main() -> None:
    """Print rows as they are found; write the page."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="three suns seen from the ground")
    parser.add_argument("--shared-optics", action="store_true", help="errors of transfer alone")
    parser.add_argument("--sasktran", action="store_true", help="compare with sasktran2 as well")
    parser.add_argument("--out", type=Path, help="folder of the page polarised_truth.md")
    chosen = parser.parse_args()
    begun, rows = time.process_time(), []
    for name in HAZES:
        for row in compare(
            name,
            quick=chosen.quick,
            shared_optics=chosen.shared_optics,
            with_sasktran=chosen.sasktran,
        ):
            rows.append(row)
            print(_line(row), flush=True)
    print(f"{(time.process_time() - begun) / 60.0:.1f} minutes of CPU time")
    if chosen.out:
        chosen.out.mkdir(parents=True, exist_ok=True)
        (chosen.out / "polarised_truth.md").write_text(page(rows), encoding="utf-8")


if __name__ == "__main__":
    main()
