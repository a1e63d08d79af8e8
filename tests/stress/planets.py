"""Extreme atmospheres: other radii, scale heights, hazes and wavelengths."""

from dataclasses import replace

from bruneton_sky import Atmosphere, preset

EARTH = Atmosphere.earth()
CLEAR = replace(EARTH, absorption_extinction=0.0)


def airless() -> Atmosphere:
    """An atmosphere without scattering and absorption."""
    none = dict.fromkeys(
        ("rayleigh_scattering", "mie_scattering", "mie_extinction", "absorption_extinction"), 0.0
    )
    return replace(EARTH, **none)


# Titan, a rock with thin air, a giant, air that hardly thins with height, a film on the ground.
PLANETS = {
    "earth": EARTH,
    "earth without ozone": CLEAR,
    "hazy earth": preset("earth-hazy"),
    "mars": preset("mars-like"),
    "titan": replace(
        EARTH,
        ground_radius_m=2_575_000.0,
        top_altitude_m=600_000.0,
        rayleigh_scale_height_m=40_000.0,
        mie_scale_height_m=60_000.0,
        mie_extinction=5e-5,
        mie_scattering=4e-5,
    ),
    "rock": replace(
        CLEAR,
        ground_radius_m=10_000.0,
        top_altitude_m=2_000.0,
        rayleigh_scale_height_m=300.0,
        mie_scale_height_m=50.0,
    ),
    "giant": replace(
        CLEAR,
        ground_radius_m=7.1e7,
        top_altitude_m=400_000.0,
        rayleigh_scale_height_m=27_000.0,
        mie_scale_height_m=5000.0,
    ),
    "even air": replace(EARTH, rayleigh_scale_height_m=1e7, mie_scale_height_m=1e7),
    "film": replace(CLEAR, rayleigh_scale_height_m=0.5, mie_scale_height_m=0.1, mie_g=-0.9),
    "thick": replace(
        EARTH, mie_extinction=1e-2, mie_scattering=1e-2, mie_g=0.99, rayleigh_scattering=1e-3
    ),
    "airless": airless(),
    "fog": EARTH.with_fog(200.0, 50.0),
    "dense fog": EARTH.with_fog(5.0, 3.0),
}
# The most extreme ones, which `make test` tries.
SHORT = ("earth", "thick", "airless")
