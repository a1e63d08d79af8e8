"""How finely the multiple-scattering solver divides altitudes, directions and rays."""

from dataclasses import dataclass, fields
from typing import Self

from vrut_lite.arguments import as_count

# From this order on light varies less, and is less.
HIGHER = 4
# And from this one on it comes from the source function, not from the sun.
LATER = 3
_MOST = 4096
# Molecules scatter by cos(2 phi), which fewer than three azimuths would mistake.
_LEAST = {
    "direction_azimuth": 3,
    "later_azimuth": 3,
    "higher_azimuth": 3,
    "polarised_azimuth": 3,
    "polarised_orders": 0,
}


@dataclass(frozen=True, kw_only=True)
class SolverSizes:
    """Nodes and bins of the solver.

    The defaults suit clear air; `solve` takes `real_time_sizes` of its air.

    Attributes:
        altitude, mu_s: nodes of the source function, by altitude and by sun zenith angle; haze
            and fog add two thirds to the altitudes, for their own layer.
        direction_mu, direction_azimuth: directions at each node, over all zenith angles (half
            of them below the horizon) and over half a turn of azimuth.
        later_azimuth: azimuths for the light of orders two and up, which varies less; no more than
            `direction_azimuth` are used.
        higher_azimuth: of orders four and up, where these do with fewer.
        degree: of the spherical harmonics in which light is scattered.
        source_mu, source_azimuth: directions in which the source function is tabulated.
        steps: fine steps along a ray, which are merged into bins; in fog twice as many.
        polarised_orders: how often scattered light carries its polarisation into the next
            scattering, at most: None for all orders that are computed, 0 for scalar transfer.
        polarised_mu, polarised_azimuth: directions of Q and U at each node, and one more than the
            degree of their harmonics.
        node_bins: bins of a ray between nodes, at most: of one through all of the air.
        higher_bins: of such a ray for the light of orders three and up.
        polarised_bins: of such a ray for Q and U, no more than for radiance.
        single_bins, multiple_bins: bins of a table's ray, for light scattered once and more.
        irradiance_mu, irradiance_azimuth: directions over which irradiance is summed.

    Raises:
        ValueError: a size is too small to interpolate in or above 4096, or bins outnumber steps.
    """

    altitude: int = 24
    mu_s: int = 48
    direction_mu: int = 32
    direction_azimuth: int = 16
    later_azimuth: int = 8
    higher_azimuth: int | None = None
    higher_bins: int | None = None
    degree: int = 16
    source_mu: int = 32
    source_azimuth: int = 12
    steps: int = 48
    node_bins: int = 12
    single_bins: int = 24
    multiple_bins: int = 12
    irradiance_mu: int = 16
    irradiance_azimuth: int = 12
    polarised_orders: int | None = None
    polarised_mu: int = 12
    polarised_azimuth: int = 6
    polarised_bins: int = 8

    def __post_init__(self) -> None:
        for field in fields(self):
            size = getattr(self, field.name)
            least = _LEAST.get(field.name, 2)
            if size is not None or field.default is not None:
                as_count(f"{field.name} of the solver", size, least, _MOST)
        for name in ("direction_mu", "polarised_mu"):
            if getattr(self, name) % 2:
                raise ValueError(f"{name} of the solver must be even: half looks down")
        bins = self.node_bins, self.higher_bins or 0, self.single_bins, self.multiple_bins
        if max(bins) > self.steps:
            raise ValueError("steps of the solver must not be fewer than its bins")

    def azimuths_of(self, order: int) -> int:
        """Azimuths for the light of an order of three and up."""
        later = self.later_azimuth if order < HIGHER else self.higher_azimuth or self.later_azimuth
        return min(later, self.direction_azimuth)

    def polarises(self, scattered: int) -> bool:
        """Whether light that was scattered so often carries its polarisation on."""
        return self.polarised_orders is None or scattered <= self.polarised_orders

    def bins_of(self, order: int) -> int:
        """Bins of a ray between nodes for the light of an order of two and up."""
        return self.node_bins if order < LATER else self.higher_bins or self.node_bins

    @classmethod
    def in_clear_air(cls) -> Self:
        """For a picture of clear air: fewer directions and higher orders change it by 0.02 % in the
        mean. The light of deep twilight needs more bins of the first orders."""
        return cls(direction_mu=24, higher_azimuth=6, node_bins=18, higher_bins=8)

    @classmethod
    def in_fog(cls) -> Self:
        """For fog, where light comes from nearby and is scattered forward: more bins, and more
        directions of the source function. Fog adds further steps and altitudes."""
        return cls(source_mu=64, source_azimuth=24, node_bins=24, single_bins=48, multiple_bins=24)

    @classmethod
    def in_haze(cls) -> Self:
        """For haze, where light changes within a few hundred metres and a bright lobe surrounds the
        sun: more steps, bins, suns and directions of the source function. Haze adds two thirds to
        its few altitudes."""
        return cls(
            altitude=12,
            mu_s=72,
            direction_mu=24,
            direction_azimuth=12,
            later_azimuth=10,
            higher_azimuth=8,
            source_mu=64,
            source_azimuth=16,
            steps=72,
            node_bins=20,
            higher_bins=14,
            multiple_bins=18,
        )

    @classmethod
    def converged(cls) -> Self:
        """Sizes at which the discretisation error vanishes; takes seconds, not milliseconds."""
        return cls(
            altitude=48,
            mu_s=128,
            direction_mu=64,
            direction_azimuth=32,
            later_azimuth=32,
            degree=32,
            source_mu=96,
            source_azimuth=32,
            steps=256,
            node_bins=40,
            single_bins=128,
            multiple_bins=64,
            irradiance_mu=48,
            irradiance_azimuth=32,
            polarised_mu=32,
            polarised_azimuth=12,
            polarised_bins=40,
        )
