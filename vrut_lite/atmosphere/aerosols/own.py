"""A user's aerosol in a few numbers, as messages and project files carry it."""

from functools import lru_cache

import msgspec
import numpy as np

from vrut_lite.atmosphere.aerosol import SCALE_HEIGHT_M
from vrut_lite.atmosphere.aerosols.optics import AerosolOptics, optics_of_aerosol
from vrut_lite.atmosphere.aerosols.phase_table import PhaseTable
from vrut_lite.numeric_types import FloatArray

# Reference optical depth at 550 nm; `SetHaze` has the actual one.
_ANY_DEPTH = 1.0


class OwnAerosol(msgspec.Struct, frozen=True, forbid_unknown_fields=True, omit_defaults=True):
    """Aerosol by Angstrom's exponent, single scattering albedo, and a phase function.

    The phase function is `phase`, values above 0 at `angle_deg` from 0 to 180, in any unit; without
    values it is Cornette and Shanks' lobe of `asymmetry`. `p12` and `p33` of the scattering matrix,
    at the same angles and in the same unit, say how it polarises (P12 < 0 where light vibrates
    across the scattering plane); without them light keeps its polarisation and gets none.
    """

    angstrom_exponent: float = 1.3
    albedo: float = 0.95
    asymmetry: float = 0.63
    scale_height_m: float = SCALE_HEIGHT_M
    angle_deg: tuple[float, ...] = ()
    phase: tuple[float, ...] = ()
    p12: tuple[float, ...] = ()
    p33: tuple[float, ...] = ()

    @property
    def optics(self) -> AerosolOptics:
        """Optical properties at the reference depth.

        Raises:
            ValueError: a number is out of range; the sentence names it.
        """
        return _optics(self)


@lru_cache(maxsize=8)
def _optics(own: OwnAerosol) -> AerosolOptics:
    phase: PhaseTable | float = own.asymmetry
    if own.angle_deg or own.phase:
        phase = PhaseTable.of_angles(np.radians(own.angle_deg), own.phase, _ratios(own))
    return optics_of_aerosol(
        _ANY_DEPTH, own.albedo, phase, own.angstrom_exponent, own.scale_height_m
    )


def _ratios(own: OwnAerosol) -> FloatArray | None:
    """P12 / P11 and P33 / P11 (2, 1, angles)."""
    if not (own.p12 or own.p33):
        return None
    if not len(own.p12) == len(own.p33) == len(own.phase):
        raise ValueError("p12 and p33 of an own aerosol need one value for each of phase")
    return np.array([[own.p12], [own.p33]]) / np.array(own.phase)
