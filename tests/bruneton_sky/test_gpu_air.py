"""The light of a volume of air: what the GPU makes of it against what the CPU does."""

from dataclasses import replace

import numpy as np
import pytest
from bruneton_sky import Atmosphere
from bruneton_sky.air_volume import AirSizes, air_volume
from bruneton_sky.air_volume.gpu import air_volume_job
from bruneton_sky.settings import BrunetonSkySettings, atmosphere_of
from bruneton_sky.solver import SolverSizes, SourceField, solve

from vrut_lite.geometry.colour import SKYLIGHT_NM, solar_irradiance
from vrut_lite.sky.air_volume import light_of

COARSE = SolverSizes(
    altitude=8, mu_s=24, direction_mu=8, direction_azimuth=8, degree=4, source_mu=8,
    source_azimuth=6, steps=12, node_bins=6, single_bins=12, multiple_bins=6,
)  # fmt: skip
# No work group divides them.
SIZES = AirSizes(slices=9, rows_above=10, rows_below=7, columns=13)
# The CPU rounds to half precision, by 2^-11 at most.
OF_VALUE = 1e-3
NOON, LOW, SET = 65.0, 4.0, -4.0


def air_of(**settings) -> Atmosphere:
    return atmosphere_of(BrunetonSkySettings(**settings))


@pytest.fixture(scope="module")
def fields(other_planet) -> dict[str, SourceField]:
    """Coarsely solved airs: any numbers will do. One scatters by molecules alone, another by
    aerosol alone: then a table of the solver's is empty."""
    sun = tuple(solar_irradiance(SKYLIGHT_NM))
    airs = {
        "haze": air_of(),
        "fog under the stratosphere": air_of(fog_visibility_m=800.0),
        "fog": air_of(fog_visibility_m=800.0, mie_phase="henyey-greenstein"),
        "molecules": replace(air_of(preset="earth-clear"), mie_scattering=(0.0,) * 4),
        "aerosol": replace(air_of(), rayleigh_scattering=(0.0,) * 4),
        "another planet": replace(
            other_planet,
            wavelength_nm=SKYLIGHT_NM,
            solar_irradiance=sun,
            rayleigh_depolarisation=0.3,
        ),
    }
    return {name: solve(air, 3, COARSE) for name, air in airs.items()}


def sun_at(elevation_deg):
    """In no axis's plane."""
    elevation = np.radians(elevation_deg)
    level = np.cos(elevation) * np.array([np.cos(0.7), np.sin(0.7)])
    return np.array([level[0], np.sin(elevation), level[1]])


def both(compute, field, altitude_m, sun_deg, reach_m=1e5):
    """Light (3, slices, rows, columns, 3) by the GPU and by the CPU."""
    where = (field, altitude_m, sun_at(sun_deg), reach_m)
    job, volume = air_volume_job(*where, "test", "air", SIZES, read_back=True)
    expected = air_volume(*where, SIZES)
    assert volume.extinction == expected.extinction
    light = light_of(expected).astype(float) * expected.radiance_scale
    return compute(job).reshape(light.shape) * volume.radiance_scale, light


def assert_same(gpu, cpu):
    """Within 1e-3 of each value, of which much less than the brightest has fewer digits: 1e-6."""
    assert cpu.max() > 0.0
    assert np.all(np.abs(gpu - cpu) <= OF_VALUE * cpu + 1e-6 * cpu.max())


@pytest.mark.gl
@pytest.mark.parametrize("sun_deg", [NOON, LOW, SET])
@pytest.mark.parametrize("altitude_m", [0.0, 3000.0, 4e5])
@pytest.mark.parametrize("air", ["haze", "fog", "another planet"])
def test_gpu_and_cpu_agree(compute, fields, air, altitude_m, sun_deg):
    """From the ground, in the air and from above it, by day, at sunset and in twilight."""
    reach_m = 1e5 if altitude_m < 1e5 else 3e6
    assert_same(*both(compute, fields[air], altitude_m, sun_deg, reach_m))


@pytest.mark.gl
@pytest.mark.parametrize("air", ["molecules", "aerosol"])
def test_gpu_accepts_empty_tables(compute, fields, air):
    """Where a substance is missing its table is empty, which no buffer may be."""
    gpu, cpu = both(compute, fields[air], 1000.0, NOON)
    assert_same(gpu, cpu)
    assert gpu[2 if air == "molecules" else 1].max() == 0.0


@pytest.mark.gl
def test_a_sun_in_the_zenith_and_a_reach_of_metres(compute, fields):
    """The sun has no azimuth, and slices are centimetres long."""
    assert_same(*both(compute, fields["haze"], 2.0, 90.0, 3.0))


def test_field_and_matter_are_uploaded_once(fields):
    """Under another sun the field's tables and the matter along the rays are the same objects,
    which the GPU has already; the recipe is another, and that of equal air the same."""
    first, again, other = (
        air_volume_job(fields["haze"], 2.0, sun_at(sun), 1e5, "test", "air", SIZES)
        for sun in (NOON, NOON, LOW)
    )
    assert first[0].recipe == again[0].recipe != other[0].recipe
    assert first[1] == again[1]
    sent = [dict(job.buffers) for job, _ in (first, other)]
    kept = [binding for binding in sent[0] if sent[0][binding] is sent[1][binding]]
    assert sorted(kept) == [1, 2, 4, 5, 6, 7, 8]
