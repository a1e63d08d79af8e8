"""The haze of the place; every sky follows it unless its settings override it.

A sky may have a setting `turbidity`: unset, it follows the host's haze, a
number on Preetham's scale is that sky's own.
"""

from dataclasses import replace
from functools import lru_cache
from typing import Literal, get_args

from vrut_lite import checks
from vrut_lite.atmosphere.aerosol import (
    ASYMMETRY,
    MOST_TURBIDITY,
    SINGLE_SCATTERING_ALBEDO,
    optical_depth_of_turbidity,
    turbidity_of_optical_depth,
)
from vrut_lite.atmosphere.aerosols import AerosolOptics, optics_of_aerosol, type_optics
from vrut_lite.atmosphere.aerosols.optics import AerosolLayer
from vrut_lite.atmosphere.aerosols.own import OwnAerosol
from vrut_lite.atmosphere.aerosols.stratosphere import (
    BACKGROUND_DEPTH_550,
    PEAK_M,
    stratosphere,
)
from vrut_lite.atmosphere.aerosols.types import MOST_HUMIDITY, USUAL_HUMIDITY
from vrut_lite.atmosphere.clear_air import CITY_NITROGEN_DIOXIDE_DU, NITROGEN_DIOXIDE_DU
from vrut_lite.atmosphere.haze_layer import HAZE_NM, HazeLayer
from vrut_lite.errors import UserError
from vrut_lite.kernel.messages import Input
from vrut_lite.messages.tolerance import Remembers

OWN_HAZE = "turbidity"
# The types of OPAC, and "one-lobe": one phase function at all wavelengths, Cornette and Shanks',
# with the albedo, asymmetry and scale height of Bruneton's 2017 demonstration.
ONE_LOBE = "one-lobe"
AerosolType = Literal[
    "continental-clean",
    "continental-average",
    "continental-polluted",
    "urban",
    "maritime-clean",
    "maritime-polluted",
    "maritime-tropical",
    "desert",
    "arctic",
    "one-lobe",
]
AEROSOL_TYPES: tuple[str, ...] = get_args(AerosolType)
# A dust storm has more, but no sky here reaches beyond turbidity 10.
MOST_OPTICAL_DEPTH = float(optical_depth_of_turbidity(MOST_TURBIDITY))
# Turbidity 3 is a depth of 0.20: over land MODIS measured 0.19 in the mean of years (Remer et al.
# 2008, "Global aerosol climatology from the MODIS satellite sensors").
DEFAULT_TURBIDITY = 3.0
# Upper bound of the column (DU): ten times that above large cities.
MOST_NITROGEN_DIOXIDE_DU = 20.0
DEFAULT_AEROSOL: AerosolType = "continental-average"
# Twice that of Pinatubo's first months.
MOST_STRATOSPHERE_DEPTH = 0.3
# Peaks of layers that volcanoes have made lie between the tropopause of the poles and 35 km.
STRATOSPHERE_PEAKS_KM = (10.0, 40.0)
SCALE_HEIGHTS_M = (100.0, 50_000.0)


class SetHaze(Input, frozen=True, kw_only=True):
    """Amount and type of the aerosol above the place, and its nitrogen dioxide.

    `optical_depth_550` is vertical, at 550 nm, of all aerosol; turbidity is an alias on Preetham's
    scale, 3 is 0.20 (`turbidity_of_optical_depth`). `humidity_percent` is that of the lower air, in
    which particles of a type of OPAC grow. `own` takes the type's place. `scale_height_m` is that
    of the lower layer; unset it is the type's. `nitrogen_dioxide_du` is the column of the brown gas
    of exhaust, in Dobson units; unset it is 1 above a city (type urban), 0.2 elsewhere.

    `stratosphere_depth_550` is the stratosphere's part of the depth, at most all of it, about an
    altitude of `stratosphere_peak_km`: 0.005 as background, more after an eruption. One lobe is one
    layer, without it.
    """

    optical_depth_550: float
    aerosol: AerosolType = DEFAULT_AEROSOL
    humidity_percent: float = USUAL_HUMIDITY
    own: OwnAerosol | None = None
    nitrogen_dioxide_du: float | None = None
    scale_height_m: float | None = None
    stratosphere_depth_550: float = BACKGROUND_DEPTH_550
    stratosphere_peak_km: float = 0.001 * PEAK_M

    @property
    def one_lobe(self) -> bool:
        """Whether the aerosol is the closed form."""
        return self.own is None and self.aerosol == ONE_LOBE

    @property
    def nitrogen_dioxide(self) -> float:
        """Effective column of nitrogen dioxide in Dobson units."""
        if self.nitrogen_dioxide_du is not None:
            return self.nitrogen_dioxide_du
        urban = self.own is None and self.aerosol == "urban"
        return CITY_NITROGEN_DIOXIDE_DU if urban else NITROGEN_DIOXIDE_DU

    @property
    def turbidity(self) -> float:
        """Turbidity of the optical depth on Preetham's scale."""
        return turbidity_of_optical_depth(self.optical_depth_550)

    @property
    def optics(self) -> AerosolOptics:
        """Optical properties of the troposphere's aerosol at its reference depth."""
        if self.own is not None:
            optics = self.own.optics
        elif self.one_lobe:
            optics = _one_lobe()
        else:
            optics = type_optics(self.aerosol, self.humidity_percent)
        if self.scale_height_m is None:
            return optics
        low, aloft = optics.layers
        low = replace(low, height_m=self.scale_height_m)
        return replace(optics, height_m=self.scale_height_m, layers=(low, aloft))

    @property
    def stratosphere(self) -> AerosolLayer | None:
        """The stratosphere's aerosol, if there is any."""
        depth = min(self.stratosphere_depth_550, self.optical_depth_550)
        if depth == 0.0 or self.one_lobe:
            return None
        return stratosphere(depth, 1000.0 * self.stratosphere_peak_km)

    @property
    def troposphere_depth_550(self) -> float:
        """Vertical optical depth at 550 nm of the aerosol below the stratosphere."""
        if self.one_lobe:
            return self.optical_depth_550
        return max(self.optical_depth_550 - self.stratosphere_depth_550, 0.0)

    @property
    def troposphere_layers(self) -> tuple[AerosolLayer, ...]:
        """The lower layer and that of the free troposphere, at the actual depth."""
        optics = self.optics
        share = self.troposphere_depth_550 / optics.optical_depth_550
        return tuple(
            replace(layer, optical_depth=share * layer.optical_depth) for layer in optics.layers
        )

    @property
    def aerosol_layers(self) -> tuple[AerosolLayer, ...]:
        """Layers of the aerosol between the ground and the sun, at the actual depth."""
        high = self.stratosphere
        return self.troposphere_layers if high is None else (*self.troposphere_layers, high)

    @property
    def layers(self) -> tuple[HazeLayer, ...]:
        """The same layers as messages carry them."""
        layers = []
        for layer in self.aerosol_layers:
            red, green, blue = layer.depth_at(HAZE_NM).tolist()
            layers.append(HazeLayer(layer.height_m, (red, green, blue), layer.peak_m))
        return tuple(layers)

    def check(self) -> None:
        """A depth that every sky can show, of a known type."""
        checks.number(self, "optical_depth_550", 0.0, MOST_OPTICAL_DEPTH, of="haze")
        checks.choice(self, "aerosol", AEROSOL_TYPES, of="haze")
        checks.number(self, "humidity_percent", 0.0, MOST_HUMIDITY, of="haze")
        if self.nitrogen_dioxide_du is not None:
            checks.number(self, "nitrogen_dioxide_du", 0.0, MOST_NITROGEN_DIOXIDE_DU, of="haze")
        if self.scale_height_m is not None:
            checks.number(self, "scale_height_m", *SCALE_HEIGHTS_M, of="haze")
        checks.number(self, "stratosphere_depth_550", 0.0, MOST_STRATOSPHERE_DEPTH, of="haze")
        checks.number(self, "stratosphere_peak_km", *STRATOSPHERE_PEAKS_KM, of="haze")
        if self.own is not None:
            checks.instance(self, "own", OwnAerosol)
            try:
                self.own.optics  # noqa: B018 (raises where a number is out of range)
            except (TypeError, ValueError) as error:
                raise UserError(f"own aerosol of haze: {error}") from error


@lru_cache(maxsize=1)
def _one_lobe() -> AerosolOptics:
    depth = float(optical_depth_of_turbidity(DEFAULT_TURBIDITY))
    return optics_of_aerosol(depth, SINGLE_SCATTERING_ALBEDO, ASYMMETRY)


# The default.
DEFAULT_HAZE = SetHaze(optical_depth_550=float(optical_depth_of_turbidity(DEFAULT_TURBIDITY)))


def haze_of(kernel: Remembers) -> SetHaze:
    """The haze that was set last."""
    return kernel.last(SetHaze) or DEFAULT_HAZE
