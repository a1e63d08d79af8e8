"""The clouds: layers, each with its form."""

from itertools import pairwise
from typing import Literal

import msgspec

from vrut_lite import checks
from vrut_lite.array import Array
from vrut_lite.errors import UserError
from vrut_lite.kernel.messages import Derived
from vrut_lite.messages.limits import LARGEST_EDGE, LARGEST_VOLUME

_LARGEST_M = 1e10
_ROUNDING_M = 1e-3
_MOST_EXTINCTION_PER_M = 1e3
# A frame marches through each.
MOST_LAYERS = 4
Particles = Literal["droplets", "ice"]
PARTICLES: tuple[Particles, ...] = ("droplets", "ice")


class CloudForm(msgspec.Struct, frozen=True, kw_only=True):
    """How weather and noise become clouds; `clouds.model.cloud_density` says in formulas.

    Attributes:
        weather_periods_m: periods of the two copies of the weather map.
        second_share: share of the second copy in their sum.
        shape_period_m, detail_period_m: periods of the volumes of noise.
        stretch: factor by which the noise is longer along its own x axis: fibres.
        lean: shift of the noise along its x axis, m per metre of height: falling streaks.
        growth: weather above the threshold over which a cloud grows to its full height.
        least_height: height of the smallest cloud, as a share of the layer's thickness.
        side_fade: weather above the threshold over which a cloud's side fades in.
        anvil: width of an anvil beyond the clouds below, in `side_fade`; 0 without one.
        base_fade, top_fade: shares of a cloud's height over which its base and its top fade.
        fraying: weight of the detail.
        sharpness: sharpness of edges, where the noise crosses the envelope.
    """

    weather_periods_m: tuple[float, float] = (37_000.0, 23_300.0)
    second_share: float = 0.35
    shape_period_m: float = 5_300.0
    detail_period_m: float = 830.0
    stretch: float = 1.0
    lean: float = 0.0
    growth: float = 0.42
    least_height: float = 0.22
    side_fade: float = 0.16
    anvil: float = 0.0
    base_fade: float = 0.05
    top_fade: float = 0.75
    fraying: float = 0.32
    sharpness: float = 5.0

    def check(self) -> None:
        """Lengths and shares that divide.

        Raises:
            UserError: a value is out of range.
        """
        checks.numbers(self, "weather_periods_m", 2)
        if min(self.weather_periods_m) < 1.0:
            checks.refuse(self, "weather_periods_m", "be 1 m at least")
        for name in ("shape_period_m", "detail_period_m"):
            checks.number(self, name, 1.0, _LARGEST_M)
        for name in ("growth", "side_fade", "base_fade", "top_fade", "sharpness", "stretch"):
            checks.number(self, name, 1e-3, 1e3)
        for name in ("second_share", "least_height", "fraying"):
            checks.number(self, name, 0.0, 1.0)
        checks.number(self, "anvil", 0.0, 1e3)
        checks.number(self, "lean", -1e3, 1e3)


class CloudLayer(msgspec.Struct, frozen=True, kw_only=True):
    """One layer of clouds between two altitudes; `clouds.model.cloud_density` defines its
    density.

    Altitudes count from world y = 0, azimuths as the world's.

    Attributes:
        extinction_per_m: extinction at full density; for ice, without the share that keeps its
            direction (`ice_crystals` in cloud_transport.py).
        coverage: share of the sky's zenith that is cloud, 0 to 1.
        threshold: there is cloud where `weather` exceeds it.
        column_density: mean over clouds of density times share of the thickness.
        particles: its scatterers.
        form: its shape parameters.
        drift_m: shift of the pattern by the wind, along world x and z.
        weather: (n, n) uint16, the map of cloud places; periodic.
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
    weather: Array
    shape: Array
    detail: Array
    particles: Particles = "droplets"
    form: CloudForm = CloudForm()

    @property
    def top_m(self) -> float:
        """Altitude of the highest tops."""
        return self.base_m + self.thickness_m

    @property
    def optical_depth(self) -> float:
        """Mean optical depth of its clouds from base to top."""
        return self.extinction_per_m * self.thickness_m * self.column_density

    def check(self) -> None:
        """A layer with some thickness, and maps that a GPU can hold.

        Raises:
            UserError: a field is invalid.
        """
        checks.number(self, "base_m", -_LARGEST_M, _LARGEST_M)
        checks.number(self, "thickness_m", 1e-3, _LARGEST_M)
        checks.number(self, "extinction_per_m", 0.0, _MOST_EXTINCTION_PER_M)
        checks.number(self, "coverage", 0.0, 1.0)
        checks.number(self, "threshold")
        checks.number(self, "column_density", 0.0)
        checks.numbers(self, "drift_m", 2)
        map_edge, volume_edge = -LARGEST_EDGE, -LARGEST_VOLUME
        checks.array(self, "weather", (map_edge,) * 2, ("<u2",))
        checks.array(self, "shape", (volume_edge,) * 3, ("|u1",))
        checks.array(self, "detail", (volume_edge,) * 3, ("|u1",))
        checks.choice(self, "particles", PARTICLES)
        checks.instance(self, "form", CloudForm)
        self.form.check()


class CloudsChanged(Derived, frozen=True, kw_only=True):
    """The clouds: layers from low to high, none where there are no clouds."""

    layers: tuple[CloudLayer, ...]
    source: str

    def check(self) -> None:
        """Check the layers, and that each begins above the one below it."""
        checks.text(self, "source")
        checks.instance(self, "layers", tuple)
        if len(self.layers) > MOST_LAYERS:
            checks.refuse(self, "layers", f"be {MOST_LAYERS} at most")
        for layer in self.layers:
            if not isinstance(layer, CloudLayer):
                checks.refuse(self, "layers", "be of CloudLayer")
            layer.check()
        for low, high in pairwise(self.layers):
            if high.base_m < low.top_m - _ROUNDING_M:
                raise UserError(
                    f"layers of CloudsChanged must not overlap: one ends at {low.top_m:g} m, the "
                    f"next begins at {high.base_m:g} m"
                )
