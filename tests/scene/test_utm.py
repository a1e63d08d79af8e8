"""Places of UTM's coordinates, by Snyder's series and a numeric meridian arc."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad

from vrut_lite.scene.utm import place_of_utm

EQUATOR_M, E2 = 6_378_137.0, 1.0 - (1.0 - 1.0 / 298.257223563) ** 2


def utm_of(latitude_deg: float, longitude_deg: float, middle_deg: float) -> np.ndarray:
    """Easting and northing (m) without the false ones: Snyder (1987, USGS Professional Paper 1395),
    equations 8-9 to 8-15; the arc (3-21) as an integral."""
    phi = np.radians(latitude_deg)
    second = E2 / (1.0 - E2)
    arc = quad(lambda p: (1.0 - E2) / (1.0 - E2 * np.sin(p) ** 2) ** 1.5, 0.0, phi, epsabs=1e-12)
    normal = EQUATOR_M / np.sqrt(1.0 - E2 * np.sin(phi) ** 2)
    t, c = np.tan(phi) ** 2, second * np.cos(phi) ** 2
    a = np.radians(longitude_deg - middle_deg) * np.cos(phi)
    x = a + (1 - t + c) * a**3 / 6 + (5 - 18 * t + t**2 + 72 * c - 58 * second) * a**5 / 120
    y = a**2 / 2 + (5 - t + 9 * c + 4 * c**2) * a**4 / 24
    y += (61 - 58 * t + t**2 + 600 * c - 330 * second) * a**6 / 720
    return 0.9996 * np.array([normal * x, EQUATOR_M * arc[0] + normal * np.tan(phi) * y])


@given(st.floats(-80.0, 84.0), st.floats(-3.0, 3.0), st.integers(1, 60))
def test_a_place_and_the_azimuth_of_its_grid_are_those_of_another_series(
    latitude_deg: float, east_deg: float, zone: int
) -> None:
    """To 1e-7 degrees, a centimetre, and the grid's azimuth to 1e-6 of a step to the north."""
    middle = 6.0 * zone - 183.0
    easting, northing = utm_of(latitude_deg, middle + east_deg, middle)
    south = bool(northing < 0.0)
    found = place_of_utm(easting + 5e5, northing + (1e7 if south else 0.0), zone, south)
    assert found.latitude_deg == pytest.approx(latitude_deg, abs=1e-7)
    assert (found.longitude_deg - middle - east_deg + 180.0) % 360.0 - 180.0 == pytest.approx(
        0.0, abs=1e-6
    )
    step = utm_of(latitude_deg + 1e-3, middle + east_deg, middle)
    step -= utm_of(latitude_deg - 1e-3, middle + east_deg, middle)
    assert found.convergence_rad == pytest.approx(-np.arctan2(*step), abs=1e-6)


@pytest.mark.parametrize(
    ("easting", "northing", "zone"),
    [(7.3e8, 9e6, 60), (5e5, -1.0, 32), (np.nan, 5e6, 32), (5e5, 5e6, 61)],
)
def test_what_is_outside_a_zone_is_no_place(easting: float, northing: float, zone: int) -> None:
    """Also coordinates in millimetres, which a wrong unit makes of metres."""
    with pytest.raises(ValueError, match="outside the zone"):
        place_of_utm(easting, northing, zone, south=True)
