"""The clouds."""

import msgspec

from vrut_lite import checks
from vrut_lite.array import Array
from vrut_lite.daylight.limits import LARGEST_EDGE, LARGEST_VOLUME
from vrut_lite.kernel.messages import Derived

_LARGEST_M = 1e10
_MOST_EXTINCTION_PER_M = 1e3


class CloudLayer(msgspec.Struct, frozen=True, kw_only=True):
    """One layer of clouds between two altitudes; `vrut_lite.daylight.cloud_density` defines its
    density.

    Altitudes count from world y = 0, azimuths as the world's.

    Attributes:
        extinction_per_m: of a cloud's full density.
        coverage: share of the sky's zenith that is cloud, 0 to 1.
        threshold: there is cloud where `weather` exceeds it.
        column_density: mean over clouds of density times share of the thickness.
        drift_m: how far the wind has carried the pattern, along world x and z.
        phase: two lobes of Henyey and Greenstein: g forward, g backward, share of the first.
        weather: (n, n) uint16, where clouds stand; periodic.
        shape: (n, n, n) uint8 (y, z, x), their billows; periodic.
        detail: (n, n, n) uint8 (y, z, x), noise at their edges; periodic.
    """

    base_m: float
    thickness_m: float
    extinction_per_m: float
    coverage: float
    threshold: float
    column_density: float
    drift_m: tuple[float, float]
    phase: tuple[float, float, float]
    weather: Array
    shape: Array
    detail: Array

    def check(self) -> None:
        """A layer with some thickness, and maps that a GPU can hold.

        Raises:
            UserError: it is none.
        """
        checks.number(self, "base_m", -_LARGEST_M, _LARGEST_M)
        checks.number(self, "thickness_m", 1e-3, _LARGEST_M)
        checks.number(self, "extinction_per_m", 0.0, _MOST_EXTINCTION_PER_M)
        checks.number(self, "coverage", 0.0, 1.0)
        checks.number(self, "threshold")
        checks.number(self, "column_density", 0.0)
        checks.numbers(self, "drift_m", 2)
        checks.numbers(self, "phase", 3)
        map_edge, volume_edge = -LARGEST_EDGE, -LARGEST_VOLUME
        checks.array(self, "weather", (map_edge,) * 2, ("<u2",))
        checks.array(self, "shape", (volume_edge,) * 3, ("|u1",))
        checks.array(self, "detail", (volume_edge,) * 3, ("|u1",))


class CloudsChanged(Derived, frozen=True, kw_only=True):
    """The clouds; no layer where there are none."""

    layer: CloudLayer | None
    source: str

    def check(self) -> None:
        """Check the layer."""
        checks.text(self, "source")
        if self.layer is not None:
            checks.instance(self, "layer", CloudLayer)
            self.layer.check()
