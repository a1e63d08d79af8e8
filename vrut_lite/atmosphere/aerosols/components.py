"""Optical properties of OPAC's components per particle (Hess, Koepke and Schult 1998).

The data were computed by Mie's theory (data/NOTICE.opac_components). Names: waso water-soluble,
inso insoluble, soot; ssam and sscm sea salt, fine and coarse; minm, miam and micm mineral dust,
fine, accumulated and coarse. Humidity makes waso and sea salt grow.
"""

from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

import numpy as np

from vrut_lite.numeric_types import FloatArray

_FILE = Path(__file__).parents[1] / "data" / "opac_components.npz"
HUMIDITIES = (0.0, 50.0, 70.0, 80.0, 90.0, 95.0)
HYGROSCOPIC = ("waso", "ssam", "sscm")
COMPONENTS = (*HYGROSCOPIC, "inso", "soot", "minm", "miam", "micm")


class Particles(NamedTuple):
    """Optical properties of particles at `wavelength_nm` (C,), for one particle per cm^3.

    `extinction`, `scattering` (C,) in 1/km; at `angle_rad` (angles,), in sr^-1, `phase`, `p12` and
    `p33` (C, angles): P11, P12 and P33 of the scattering matrix.
    """

    wavelength_nm: FloatArray
    angle_rad: FloatArray
    extinction: FloatArray
    scattering: FloatArray
    phase: FloatArray
    p12: FloatArray
    p33: FloatArray

    def times(self, count: float) -> "Particles":
        """The optical properties of `count` times as many particles."""
        return self._replace(extinction=self.extinction * count, scattering=self.scattering * count)

    def with_others(self, others: "Particles") -> "Particles":
        """The sum of both; scattering matrices are averaged with scattering as the weight."""
        scattering = self.scattering + others.scattering
        own = np.divide(
            self.scattering, scattering, out=np.ones_like(scattering), where=scattering > 0.0
        )[:, None]
        return self._replace(
            extinction=self.extinction + others.extinction,
            scattering=scattering,
            phase=own * self.phase + (1.0 - own) * others.phase,
            p12=own * self.p12 + (1.0 - own) * others.p12,
            p33=own * self.p33 + (1.0 - own) * others.p33,
        )


def component(name: str, humidity_percent: float = 80.0) -> Particles:
    """Particles of a component at a relative humidity, linear between the tabulated ones.

    Raises:
        ValueError: there is no such component.
    """
    if name not in COMPONENTS:
        raise ValueError(f"no component {name!r}; there are {', '.join(COMPONENTS)}")
    if name not in HYGROSCOPIC:
        return _tabulated(name)
    above = int(np.searchsorted(HUMIDITIES, humidity_percent))
    if above == 0 or above == len(HUMIDITIES):
        return _tabulated(f"{name}{HUMIDITIES[max(above - 1, 0)]:02.0f}")
    dry, wet = HUMIDITIES[above - 1], HUMIDITIES[above]
    share = (humidity_percent - dry) / (wet - dry)
    drier, wetter = (_tabulated(f"{name}{humidity:02.0f}") for humidity in (dry, wet))
    return drier.times(1.0 - share).with_others(wetter.times(share))


def _tabulated(name: str) -> Particles:
    names, tables = _tables()
    k = names.index(name)
    return tables._replace(
        extinction=tables.extinction[k],
        scattering=tables.scattering[k],
        phase=tables.phase[k],
        p12=tables.p12[k],
        p33=tables.p33[k],
    )


@lru_cache(maxsize=1)
def _tables() -> tuple[list[str], Particles]:
    """Names of the rows, and all rows."""
    with np.load(_FILE) as data:
        return [str(name) for name in data["name"]], Particles(
            data["wavelength_nm"],
            np.radians(data["angle_deg"]),
            data["extinction_per_km"].astype(float),
            data["scattering_per_km"].astype(float),
            data["phase_per_sr"].astype(float),
            data["p12_per_sr"].astype(float),
            data["p33_per_sr"].astype(float),
        )
