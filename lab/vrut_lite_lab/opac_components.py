"""Make vrut_lite/atmosphere/data/opac_components.npz: OPAC's components by Mie's theory.

    MIEPYTHON_USE_JIT=1 python -m vrut_lite_lab.opac_components

Lognormal sizes and refractive indices of M. Hess, P. Koepke and I. Schult 1998, "Optical Properties
of Aerosols and Clouds", BAMS 79, 831, table 1 and its data set (after d'Almeida et al. 1991).
Water-soluble particles and sea salt grow with humidity: their refractive index is the mean of the
dry one and water's by volume. Takes a minute on one core.
"""

import json
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vrut_lite.atmosphere.aerosols.components import HUMIDITIES, HYGROSCOPIC, Particles
from vrut_lite.atmosphere.aerosols.mie import spheres_together
from vrut_lite.atmosphere.aerosols.types import OPAC_TYPES
from vrut_lite.numeric_types import FloatArray
from vrut_lite_lab.checkout import ROOT

TARGET = ROOT / "vrut_lite" / "atmosphere" / "data" / "opac_components.npz"
WAVELENGTH_NM = np.array([360.0, 400, 445, 500, 520, 550, 570, 600, 635, 700, 800])
# Radii per e-fold between which the sizes are summed.
_PER_E_FOLD = 160
_UM2_PER_CM2 = 1e8

_INDEX_NM = (350.0, 400.0, 450.0, 500.0, 550.0, 600.0, 650.0, 700.0, 750.0, 800.0)
_WATER = (1.343, 1.339, 1.337, 1.335, 1.333, 1.332, 1.331, 1.331, 1.330, 1.329)
_SOLUBLE = (1.53,) * 9 + (1.52,)
_SALT = (1.51, 1.50, 1.50, 1.50, 1.50, 1.49, 1.49, 1.49, 1.49, 1.48)
_ABSORPTION = {
    "waso": (5e-3, 5e-3, 5e-3, 5e-3, 6e-3, 6e-3, 7e-3, 7e-3, 8.5e-3, 1e-2),
    "inso": (8e-3,) * 10,
    "soot": (0.465, 0.46, 0.455, 0.45, 0.44, 0.435, 0.435, 0.43, 0.43, 0.43),
    "salt": (3.24e-7, 3e-8, 2.43e-8, 1.55e-8, 1e-8, 1.6e-8, 4.24e-8, 2e-7, 1.08e-6, 1.95e-6),
    "dust": (1.7e-2, 1.3e-2, 8.5e-3, 7.8e-3, 5.5e-3, 4.5e-3, 4.5e-3, 4e-3, 4e-3, 4e-3),
}
# Mode radius and limits in micrometres, sigma.
_DRY = {
    "inso": (0.471, 2.51, 0.005, 20.0),
    "soot": (0.0118, 2.00, 0.005, 20.0),
    "minm": (0.07, 1.95, 0.005, 20.0),
    "miam": (0.39, 2.00, 0.005, 20.0),
    "micm": (1.90, 2.15, 0.005, 30.0),
}
_WET_SIGMA = {"waso": 2.24, "ssam": 2.03, "sscm": 2.03}
# Mode radius and limits by humidity.
_WET = {
    "waso": (
        (0.0212, 0.0262, 0.0285, 0.0306, 0.0348, 0.0399),
        (0.005, 0.006, 0.0064, 0.0067, 0.0071, 0.0074),
        (20.0, 25.0, 27.4, 29.8, 30.0, 30.0),
    ),
    "ssam": (
        (0.209, 0.336, 0.378, 0.416, 0.497, 0.605),
        (0.005, 0.0077, 0.0085, 0.009, 0.0099, 0.0108),
        (20.0, 30.0, 30.0, 30.0, 30.0, 30.0),
    ),
    "sscm": (
        (1.75, 2.82, 3.17, 3.49, 4.18, 5.11),
        (0.005, 0.0077, 0.0085, 0.009, 0.0099, 0.0108),
        (30.0,) * 6,
    ),
}


def main() -> None:
    """Compute and write all components."""
    names, sizes, found = [], [], []
    for name, size in _components():
        names.append(name)
        sizes.append(size)
        found.append(_particles(name, size))
        print(name, flush=True)
    tables = {
        "phase_per_sr": [each.phase for each in found],
        "p12_per_sr": [each.p12 for each in found],
        "p33_per_sr": [each.p33 for each in found],
        "extinction_per_km": [each.extinction for each in found],
        "scattering_per_km": [each.scattering for each in found],
    }
    values: dict[str, Any] = {name: np.array(table, np.float32) for name, table in tables.items()}
    np.savez_compressed(
        TARGET,
        name=np.array(names),
        wavelength_nm=WAVELENGTH_NM,
        angle_deg=np.degrees(found[0].angle_rad),
        size_um=np.array(sizes),
        mixtures=json.dumps({name: dict(each.particles) for name, each in OPAC_TYPES.items()}),
        **values,
    )


def _components() -> Iterator[tuple[str, tuple[float, ...]]]:
    yield from _DRY.items()
    for name in HYGROSCOPIC:
        for k, humidity in enumerate(HUMIDITIES):
            radius, least, most = (column[k] for column in _WET[name])
            yield f"{name}{humidity:02.0f}", (radius, _WET_SIGMA[name], least, most)


def _particles(name: str, size: tuple[float, ...]) -> Particles:
    """One particle per cm^3; extinction and scattering in 1/km."""
    radius, sigma, least, most = size
    count = int(np.log(most / least) * _PER_E_FOLD)
    ln_r = np.linspace(np.log(least), np.log(most), count + 1)
    r, width = np.exp(0.5 * (ln_r[1:] + ln_r[:-1])), np.log(sigma)
    share = np.exp(-0.5 * (np.log(r / radius) / width) ** 2) / (np.sqrt(2.0 * np.pi) * width)
    # Particles per cm^3 over a km are 1e5 per cm^2.
    per_um2 = share * np.diff(ln_r) * 1e5 / _UM2_PER_CM2
    return spheres_together(r, per_um2, WAVELENGTH_NM, _index(name, radius))


def _index(name: str, radius_um: float) -> NDArray[np.complex128]:
    """Complex refractive index (C,) of a component whose mode radius humidity has made this."""

    def at(values: tuple[float, ...]) -> FloatArray:
        return np.interp(WAVELENGTH_NM, _INDEX_NM, values)

    if name in _DRY:
        kind = "dust" if name.startswith("mi") else name
        return np.asarray((1.75 if name == "soot" else 1.53) - 1j * at(_ABSORPTION[kind]))
    stem = name[:4]
    salt = stem != "waso"
    dry = at(_SALT if salt else _SOLUBLE) - 1j * at(_ABSORPTION["salt" if salt else stem])
    solid = (_WET[stem][0][0] / radius_um) ** 3
    return np.asarray(at(_WATER) + solid * (dry - at(_WATER)))


if __name__ == "__main__":
    main()
