"""Settings of the module, and their atmosphere."""

from dataclasses import replace
from functools import lru_cache
from typing import Annotated, ClassVar, Literal

import msgspec
import numpy as np

from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.atmosphere_numbers import MiePhaseForm
from bruneton_sky.presets import earth_spectral, earth_standard, preset
from bruneton_sky.raised_ground import raise_ground
from bruneton_sky.solver import MOST_ORDERS
from vrut_lite.atmosphere.aerosol import (
    ANGSTROM_EXPONENT,
    LEAST_TURBIDITY,
    MOST_TURBIDITY,
    optical_depth_of_turbidity,
    turbidity_of_optical_depth,
)
from vrut_lite.atmosphere.aerosols.droplets import droplets_phase
from vrut_lite.atmosphere.clear_air import OZONE_DU
from vrut_lite.atmosphere.exponential_layers import ExponentialLayers
from vrut_lite.atmosphere.gases import ozone_absorption
from vrut_lite.atmosphere.ground_reflectance import GREY, GroundReflectance
from vrut_lite.geometry.colour import SKYLIGHT_NM, colour_table
from vrut_lite.kernel.settings import setting
from vrut_lite.messages.haze import DEFAULT_HAZE, AerosolType, SetHaze
from vrut_lite.sky.device_choice import DeviceSetting
from vrut_lite.sky.effective_defaults import Preset

PresetName = Literal[
    "earth", "earth-clear", "earth-hazy", "earth-2008", "earth-twilight", "mars-like"
]
# Where haze is measured, and red, which ozone absorbs.
_OPEN_NM = (550.0, 600.0)
SCALE_HEIGHT_SOURCE = "Bruneton and Neyret 2008, section 2"
PHASE_SOURCE = "Cornette and Shanks 1992; Henyey and Greenstein 1941"


class BrunetonSkySettings(msgspec.Struct, frozen=True):
    """Settings of the Bruneton sky; an unset value is the preset's."""

    # Snow and sand reflect much (Oke 1987, table 1.1).
    presets: ClassVar[dict[str, Preset]] = {
        "Clear": Preset("a blue sky after a front: depth 0.10", {"turbidity": 2.0}),
        "Hazy": Preset("a white summer sky, pale hills: depth 0.50", {"turbidity": 6.0}),
        "Maritime": Preset(
            "salt above a coast, a glow about the sun: depth 0.10",
            {"turbidity": 2.0, "aerosol": "maritime-clean", "albedo": 0.06},
        ),
        "Urban": Preset(
            "soot above a city, a grey-brown sky: depth 0.50",
            {"turbidity": 6.0, "aerosol": "urban", "albedo": 0.15},
        ),
        "Desert": Preset(
            "mineral dust above sand, a wide aureole: depth 0.40",
            {"turbidity": 5.0, "aerosol": "desert", "albedo": 0.35},
        ),
        "Alpine": Preset(
            "thin clean air above snow: depth 0.05",
            {"turbidity": 1.5, "aerosol": "continental-clean", "albedo": 0.6},
        ),
        "Fog": Preset("a morning in fog, 300 m of visibility", {"fog_visibility_m": 300.0}),
        "Mars": Preset("dust of Mars: a butterscotch sky", {"preset": "mars-like"}),
    }
    preset: Annotated[
        PresetName,
        setting(
            "The atmosphere to start from; earth has the place's haze, the others their own",
            source="Bruneton and Neyret 2008; Bruneton 2017",
        ),
    ] = "earth"
    turbidity: Annotated[
        float | None,
        setting(
            "Haze of this sky alone, on Preetham's scale, 3 is AOD 0.20; unless set, the preset's",
            LEAST_TURBIDITY,
            MOST_TURBIDITY,
            source="Preetham, Shirley and Smits 1999, appendix A.1",
        ),
    ] = None
    aerosol: Annotated[
        AerosolType | None,
        setting(
            "What the haze of this sky alone is made of; unless set, as at the place, or as a "
            "preset other than earth has it",
            source="Hess, Koepke and Schult 1998",
        ),
    ] = None
    albedo: Annotated[
        float | None,
        setting(
            "Part of the light that a grey ground of this sky alone reflects; unless set, the "
            "place's ground, or that of a preset other than earth",
            0,
            1,
        ),
    ] = None
    ozone_du: Annotated[
        float | None,
        setting(
            "Ozone above the ground",
            0,
            1000,
            unit="DU",
            source="Serdyuchenko et al. 2011, at 233 K",
        ),
    ] = None
    rayleigh_factor: Annotated[
        float,
        setting(
            "Molecules, as a multiple of the preset's",
            0,
            20,
            source="Galaj and Wojciechowski 2019, equation 4",
            label="Density of air",
        ),
    ] = 1.0
    rayleigh_scale_height_m: Annotated[
        float | None,
        setting(
            "Height of the molecules, in one exponential",
            500,
            50_000,
            unit="m",
            source=SCALE_HEIGHT_SOURCE,
            label="Height of air",
        ),
    ] = None
    mie_scale_height_m: Annotated[
        float | None,
        setting(
            "Height of the haze, in one layer",
            100,
            50_000,
            unit="m",
            source=SCALE_HEIGHT_SOURCE,
            label="Height of haze",
        ),
    ] = None
    mie_albedo: Annotated[
        float | None, setting("Part of its light that haze scatters", 0, 1, label="Haze scatters")
    ] = None
    mie_g: Annotated[
        float | None,
        setting(
            "How far haze scatters forward: one lobe in place of the type's phase function",
            -0.95,
            0.95,
            source=PHASE_SOURCE,
            label="Haze, forward",
        ),
    ] = None
    mie_phase: Annotated[
        MiePhaseForm | None,
        setting(
            "Phase function of the haze: one lobe in place of the type's",
            source=PHASE_SOURCE,
            label="Haze, phase function",
            choice_labels={
                "cornette-shanks": "Cornette and Shanks",
                "henyey-greenstein": "Henyey and Greenstein",
            },
        ),
    ] = None
    fog_visibility_m: Annotated[
        float | None,
        setting(
            "How far one sees through fog on the ground; unless set, there is no fog",
            50,
            20_000,
            unit="m",
            source="Koschmieder 1924, at a contrast of 2 %",
            choice_labels={"none": "no fog"},
        ),
    ] = None
    fog_height_m: Annotated[
        float, setting("Height over which fog thins by a factor e", 5, 1000, unit="m")
    ] = 100.0
    ground_radius_m: Annotated[
        float | None, setting("Radius of the planet", 1e5, 1e8, unit="m")
    ] = None
    top_altitude_m: Annotated[
        float | None, setting("Where the air ends", 20_000, 500_000, unit="m")
    ] = None
    orders: Annotated[
        int,
        setting(
            "Times that light is scattered at most",
            1,
            40,
            source="Bruneton and Neyret 2008, section 2",
            label="Scattering orders",
        ),
    ] = MOST_ORDERS
    cube_device: Annotated[
        DeviceSetting,
        setting(
            "What computes the sky's cube map and air: auto, by a trial of the renderer; the CPU; "
            "or the GPU where there is one",
            label="Computed on",
        ),
    ] = "auto"

    def left_open(self, haze: SetHaze) -> dict[str, object]:
        """Effective values of the unset settings, by name; unset fog is no fog."""
        return _left_open(self, haze)


def _left_open(settings: BrunetonSkySettings, haze: SetHaze) -> dict[str, object]:
    """Values of the air that the settings make, for the unset ones.

    Albedo and g of tabulated aerosol are means, which a setting replaces.
    """
    plain = msgspec.structs.replace(settings, fog_visibility_m=None)
    air = atmosphere_at(_OPEN_NM, plain, 0.0, haze)
    one = air.in_one_layer(air.mie_scale_height_m)
    extinction, scattering = np.asarray(one.mie_extinction), np.asarray(one.mie_scattering)
    turbidity = turbidity_of_optical_depth(float(air.aerosol_depth()[0]))
    return {
        "turbidity": min(max(turbidity, LEAST_TURBIDITY), MOST_TURBIDITY),
        "aerosol": haze.aerosol,
        "ozone_du": OZONE_DU if any(air.absorption_extinction) else 0.0,
        "rayleigh_scale_height_m": air.column_m,
        "mie_scale_height_m": _mean_height_m(air),
        "mie_albedo": float(np.mean(scattering / np.maximum(extinction, 1e-30))),
        "mie_g": air.mie_g,
        **({} if air.mie_table is not None else {"mie_phase": air.mie_phase}),
        **({} if settings.preset == "earth" else {"albedo": float(np.mean(air.ground_albedo))}),
        "ground_radius_m": air.ground_radius_m,
        "top_altitude_m": air.top_altitude_m,
    }


def haze_of_air(settings: BrunetonSkySettings, haze: SetHaze) -> SetHaze:
    """The place's haze, changed by the settings; the default for presets that do not follow it, so
    that equal airs compare equal."""
    if settings.preset != "earth":
        return DEFAULT_HAZE
    own: dict[str, object] = {}
    if settings.turbidity is not None:
        own["optical_depth_550"] = float(optical_depth_of_turbidity(settings.turbidity))
    if settings.aerosol is not None:
        own |= {"aerosol": settings.aerosol, "own": None}
    return msgspec.structs.replace(haze, **own)


def ground_of_air(settings: BrunetonSkySettings, ground: GroundReflectance) -> GroundReflectance:
    """The place's ground, or the settings' own; grey for presets that bring theirs, so that equal
    airs compare equal."""
    if settings.albedo is not None:
        return GroundReflectance.grey(settings.albedo)
    return ground if settings.preset == "earth" else GREY


def atmosphere_of(
    settings: BrunetonSkySettings,
    ground_altitude_m: float = 0.0,
    haze: SetHaze = DEFAULT_HAZE,
    ground: GroundReflectance = GREY,
) -> Atmosphere:
    """The atmosphere of the settings above a ground at an altitude, as its sky is solved.

    It has the four wavelengths of which the colour of skylight is made. Other scale heights
    leave the amount of matter above each square metre, up to the air's top, as it was.
    """
    return _atmosphere(settings, ground_altitude_m, haze, ground, SKYLIGHT_NM)


def spectral_atmosphere_of(
    settings: BrunetonSkySettings,
    ground_altitude_m: float = 0.0,
    haze: SetHaze = DEFAULT_HAZE,
    ground: GroundReflectance = GREY,
) -> Atmosphere:
    """The same atmosphere each 5 nm from 360 to 830, for sunlight, which costs next to nothing."""
    return _atmosphere(settings, ground_altitude_m, haze, ground, tuple(colour_table()[:, 0]))


def atmosphere_at(
    wavelength_nm: tuple[float, ...],
    settings: BrunetonSkySettings,
    ground_altitude_m: float,
    haze: SetHaze,
    ground: GroundReflectance = GREY,
) -> Atmosphere:
    """The same atmosphere at given wavelengths, in nm."""
    return _atmosphere(settings, ground_altitude_m, haze, ground, wavelength_nm)


@lru_cache(maxsize=8)
def _atmosphere(
    settings: BrunetonSkySettings,
    ground_altitude_m: float,
    haze: SetHaze,
    ground: GroundReflectance,
    wavelength_nm: tuple[float, ...],
) -> Atmosphere:
    air = _preset(settings, haze_of_air(settings, haze), wavelength_nm)
    if settings.preset == "earth" or settings.albedo is not None:
        below = ground_of_air(settings, ground)
        air = replace(air, ground_albedo=tuple(below.at(wavelength_nm)))
    for change in (_with_planet, _with_aerosol, _with_gases):
        air = change(air, settings)
    return _with_fog(raise_ground(air, ground_altitude_m), settings)


def _preset(
    settings: BrunetonSkySettings, haze: SetHaze, wavelength_nm: tuple[float, ...]
) -> Atmosphere:
    if settings.preset != "earth":
        air = preset(settings.preset, wavelength_nm)
        if settings.turbidity is None:
            return air
        depth = float(optical_depth_of_turbidity(settings.turbidity))
        return air.with_aerosol(depth, ANGSTROM_EXPONENT)
    if haze.one_lobe:
        # The published air. One lobe needs no table: its closed form is exact.
        published = earth_spectral(wavelength_nm)
        if haze.scale_height_m is not None:
            published = replace(published, mie_scale_height_m=haze.scale_height_m)
        return published.with_aerosol(haze.optical_depth_550, ANGSTROM_EXPONENT)
    air = earth_standard(wavelength_nm, haze.nitrogen_dioxide)
    air = air.with_optics(haze.optics, haze.troposphere_depth_550)
    high = haze.stratosphere
    return air if high is None else air.with_stratosphere(high)


def _with_fog(air: Atmosphere, settings: BrunetonSkySettings) -> Atmosphere:
    """Fog starts at the local ground, however high that is."""
    if settings.fog_visibility_m is None:
        return air
    droplets = droplets_phase(air.wavelength_nm)
    return air.with_fog(settings.fog_visibility_m, settings.fog_height_m, droplets)


def _with_planet(air: Atmosphere, settings: BrunetonSkySettings) -> Atmosphere:
    changes = {
        name: value
        for name in ("ground_radius_m", "top_altitude_m")
        if (value := getattr(settings, name)) is not None
    }
    return replace(air, **changes)


def _with_aerosol(air: Atmosphere, settings: BrunetonSkySettings) -> Atmosphere:
    if settings.mie_scale_height_m is not None:
        air = air.in_one_layer(settings.mie_scale_height_m)
    albedo = settings.mie_albedo
    if albedo is not None:
        air = replace(
            air,
            mie_scattering=tuple(albedo * np.asarray(air.mie_extinction)),
            aloft_scattering=tuple(albedo * np.asarray(air.aloft_extinction)),
        )
    one_lobe = settings.mie_g is not None or settings.mie_phase
    return replace(
        air,
        mie_g=air.mie_g if settings.mie_g is None else settings.mie_g,
        mie_phase=settings.mie_phase or air.mie_phase,
        mie_table=None if one_lobe else air.mie_table,
        aloft_table=None if one_lobe else air.aloft_table,
    )


def _mean_height_m(air: Atmosphere) -> float:
    """Aerosol above a square metre over its extinction at altitude 0."""
    low, aloft = air.mie_extinction[0], air.aloft_extinction[0]
    if low + aloft == 0.0:
        return air.mie_scale_height_m
    return (low * air.mie_scale_height_m + aloft * air.aloft_scale_height_m) / (low + aloft)


def _with_gases(air: Atmosphere, settings: BrunetonSkySettings) -> Atmosphere:
    factor, height_m = settings.rayleigh_factor, settings.rayleigh_scale_height_m
    if height_m is not None:
        top_m = air.top_altitude_m
        even = ExponentialLayers.of(height_m)
        factor *= air.molecule_layers.column_m(top_m) / even.column_m(top_m)
        air = replace(
            air,
            rayleigh_scale_height_m=height_m,
            rayleigh_above_m=(0.0,),
            rayleigh_above_scale_height_m=(height_m,),
        )
    air = replace(
        air,
        rayleigh_scattering=tuple(np.asarray(air.rayleigh_scattering) * factor),
        gas_absorption=tuple(np.asarray(air.gas_absorption) * factor),
        refractivity=air.refractivity * factor,
    )
    if settings.ozone_du is None:
        return air
    earth = Atmosphere.earth()
    layer_m = float(np.trapezoid(earth.absorber_density, earth.absorber_altitude_m))
    absorption = ozone_absorption(air.wavelength_nm, settings.ozone_du, layer_m)
    return replace(
        air,
        absorption_extinction=tuple(absorption),
        absorber_altitude_m=earth.absorber_altitude_m,
        absorber_density=earth.absorber_density,
    )
