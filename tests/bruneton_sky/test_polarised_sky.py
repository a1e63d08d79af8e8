"""The cube of Q and U that the Bruneton sky posts."""

import numpy as np
import pytest
from bruneton_sky.module import BrunetonSky
from bruneton_sky.polarised_sky import polarised_cube
from bruneton_sky.settings import BrunetonSkySettings, atmosphere_of
from bruneton_sky.solved_sky import SolvedSky
from bruneton_sky.solver_job import solve_air
from moon_on_bus import FULL_MOON, PlaceMoon, SkyUnderMoon

from vrut_lite.geometry.colour import luminance, rgb_from_spectrum
from vrut_lite.geometry.cube_map import texel_directions
from vrut_lite.geometry.polarisation import map_axis, turned, vertical_axis
from vrut_lite.messages.sky import SkyPolarisationChanged
from vrut_lite.numeric_types import Float32Array
from vrut_lite.testing.sky_on_bus import SkyOnBus

AIR = atmosphere_of(BrunetonSkySettings())
SIZE = 32


def sun_at(elevation_deg: float, azimuth_deg: float) -> tuple[float, float, float]:
    """Direction in world axes."""
    e, a = np.radians([elevation_deg, azimuth_deg])
    x, y, z = np.cos(e) * np.sin(a), np.sin(e), -np.cos(e) * np.cos(a)
    return float(x), float(y), float(z)


@pytest.mark.parametrize(
    ("elevation_deg", "azimuth_deg", "height_m"),
    [(60, 30, 0), (3, 200, 0), (0, 77, 0), (-4, 10, 0), (90, 0, 0), (20, 120, 2000)],
)
def test_the_cube_has_the_light_of_single_rays(
    elevation_deg: float, azimuth_deg: float, height_m: float
) -> None:
    """Q and U of each texel are those of `SolvedSky.stokes`, on the stated side of the sun, to
    0.8 % of the luminance (1.5 % aloft): the grid of rays is fine enough, also where the sky
    changes fastest."""
    field, sun = solve_air(AIR), sun_at(elevation_deg, azimuth_deg)
    above = texel_directions(SIZE)[..., 1] > 0.0
    d = texel_directions(SIZE)[above]
    cube = polarised_cube(field, height_m, sun, SIZE)[:, above]
    q, u = turned(*cube, d, map_axis(d), vertical_axis(d))
    nu = np.clip(d @ np.array(sun), -1.0, 1.0)
    stokes = np.moveaxis(SolvedSky(field=field).stokes(height_m, d[:, 1], sun[1], nu), -1, 0)
    exact = luminance(rgb_from_spectrum(stokes, AIR.wavelength_nm))
    exact[2] *= np.where(sun[0] * d[:, 2] >= sun[2] * d[:, 0], 1.0, -1.0)
    missed = np.hypot(luminance(q) - exact[1], luminance(u) - exact[2])
    assert np.all(missed <= (15e-3 if height_m else 8e-3) * exact[0])


def test_a_draft_is_polarised_nearly_as_the_sky() -> None:
    """While settings change a draft is shown: its Q and U are within 4 % of the largest."""
    sun = sun_at(30.0, 100.0)
    draft, usual = (
        polarised_cube(solve_air(AIR, rung=rung), 0.0, sun, 8) for rung in ("draft", "usual")
    )
    assert np.abs(draft - usual).max() <= 0.04 * np.hypot(*usual).max()


def cube_of(sky: SkyOnBus) -> Float32Array:
    """Q and U that were posted last."""
    posted = sky.last(SkyPolarisationChanged)
    assert posted.cube is not None
    return posted.cube.values.astype(np.float32) * np.float32(posted.radiance_scale)


def test_it_is_made_only_on_demand_and_when_the_sky_changes() -> None:
    """26 ms of rays would be wasted where no polariser or reflection needs them."""
    sky = SkyOnBus(BrunetonSky)
    sky.sun(30.0)
    assert sky.taken() == []
    assert sky.counters.skipped["SkyPolarisationChanged unwanted"] > 0
    sky.want(SkyPolarisationChanged, size=8)
    sky.sun(30.001)
    assert sky.kinds_taken() == [SkyPolarisationChanged]
    sky.sun(40.0)
    assert sky.kinds_taken() == [SkyPolarisationChanged]


def test_the_sky_turns_with_the_sun() -> None:
    """A quarter turn of the sun turns the vibration too: the axes are the world's."""
    field = solve_air(AIR)
    north, east = (polarised_cube(field, 0.0, sun_at(25.0, a), SIZE) for a in (0.0, 90.0))
    d = texel_directions(SIZE)
    sides = []
    for cube, face in ((north, 5), (east, 0)):
        of = d[face]
        q, u = turned(cube[0, face], cube[1, face], of, map_axis(of), vertical_axis(of))
        sides.append(np.stack([q, u]))
    assert sides[1] == pytest.approx(sides[0], abs=1e-5 * float(np.abs(sides[0]).max()))


def test_moonlight_is_polarised() -> None:
    """A moon in the sun's place makes the sun's Q and U, times moonlight over sunlight."""
    sky = SkyUnderMoon(BrunetonSky, 0.1)
    sky.want(SkyPolarisationChanged, size=8)
    sky.tell(PlaceMoon(glow=1e-6))
    sky.sun(40.0, 90.0)
    by_day = cube_of(sky)
    sky.tell(PlaceMoon(elevation_deg=40.0, azimuth_deg=90.0, glow=1e-6))
    sky.sun(-30.0, 0.0)
    largest = float(np.abs(by_day).max())
    assert cube_of(sky) / FULL_MOON == pytest.approx(by_day, abs=2e-3 * largest)
