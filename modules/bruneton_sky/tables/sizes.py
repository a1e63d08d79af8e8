"""Numbers of nodes of the precomputed tables."""

from dataclasses import dataclass, fields

from bruneton_sky.atmosphere import Atmosphere
from vrut_lite.arguments import as_count


@dataclass(frozen=True, kw_only=True)
class TableSizes:
    """Nodes along each axis; the defaults are the published ones (Bruneton and Neyret 2008).

    Attributes:
        transmittance_altitude, transmittance_mu: of the transmittance T, 64 x 256.
        irradiance_altitude, irradiance_mu_s: of the ground's irradiance E, 16 x 64.
        altitude, mu, nu, mu_s: of the scattering S, 32 x 128 x 8 x 32.

    Raises:
        ValueError: an axis has fewer than two nodes, one of the sun's fewer than four (cubics are
            laid through them), or mu an odd number or fewer than four.
    """

    transmittance_altitude: int = 64
    transmittance_mu: int = 256
    irradiance_altitude: int = 16
    irradiance_mu_s: int = 64
    altitude: int = 32
    mu: int = 128
    nu: int = 8
    mu_s: int = 32

    def __post_init__(self) -> None:
        for field in fields(self):
            least = 4 if field.name.endswith("mu_s") else 2
            as_count(f"{field.name} of the tables", getattr(self, field.name), least, 2**31)
        if self.mu % 2 or self.mu < 4:
            raise ValueError("mu of the tables must be even and at least 4: half sees the ground")

    @property
    def scattering_shape(self) -> tuple[int, int, int, int]:
        """Axes altitude, mu, nu, mu_s."""
        return self.altitude, self.mu, self.nu, self.mu_s


def table_shapes(atmosphere: Atmosphere, sizes: TableSizes) -> dict[str, tuple[int, ...]]:
    """The shapes of the four arrays by name."""
    count = len(atmosphere.wavelength_nm)
    scattering = (*sizes.scattering_shape, count)
    return {
        "transmittance": (sizes.transmittance_altitude, sizes.transmittance_mu, count),
        "irradiance": (sizes.irradiance_altitude, sizes.irradiance_mu_s, count),
        "scattering": scattering,
        "single_mie": scattering,
    }


def refuse_untabled(atmosphere: Atmosphere) -> None:
    """Refuse an atmosphere with fog, whose layer lies between a table's two lowest altitudes, and
    one that the published method cannot hold.

    Raises:
        ValueError: the atmosphere is such a one.
    """
    refuse_unpublished(atmosphere)
    if atmosphere.foggy:
        raise ValueError(
            "tables of 32 altitudes from the ground to space cannot hold ground fog: "
            "use bruneton_sky.solve, or leave the fog out"
        )


def refuse_unpublished(atmosphere: Atmosphere) -> None:
    """Refuse light of a tabulated phase function, aerosol in the stratosphere, molecules that
    depolarise or thin otherwise than exponentially, and absorbers besides ozone: the published
    method has none of them.

    Raises:
        ValueError: the atmosphere has one of these.
    """
    if atmosphere.mie_table is not None:
        raise ValueError(
            "the published tables scatter by phase functions in closed form: "
            "use bruneton_sky.solve for an aerosol with a phase table"
        )
    if atmosphere.has_stratosphere:
        raise ValueError(
            "the published tables know aerosol that thins out exponentially: use "
            "bruneton_sky.solve for aerosol in the stratosphere"
        )
    if len(atmosphere.molecule_layers.base_m) > 1 or not atmosphere.has_published_molecules:
        raise ValueError(
            "the published tables know molecules of one exponential that do not depolarise, and "
            "no gas besides ozone: use bruneton_sky.solve for the real Earth's air"
        )
