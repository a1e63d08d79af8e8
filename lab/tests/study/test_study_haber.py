"""Haber's cells: paths through layers, light from cell to cell, what the quirk does."""

import numpy as np
import pytest

from vrut_lite.atmosphere.aerosol import cornette_shanks_factor, cornette_shanks_phase
from vrut_lite_lab.study.framework.atmosphere import STUDY
from vrut_lite_lab.study.framework.directions import directions
from vrut_lite_lab.study.framework.errors import relative_error
from vrut_lite_lab.study.models.bruneton import Bruneton
from vrut_lite_lab.study.models.haber import Haber
from vrut_lite_lab.study.models.haber_cells import HALF, STEP_RAD, cell_azimuths, make_cells
from vrut_lite_lab.study.models.haber_kernels import from_aerosol, layered_paths, ring_paths
from vrut_lite_lab.study.models.haber_transfer import FEW, transfer_through

GROUND_M = STUDY.ground_radius_m
LAYERS = make_cells(STUDY).layers


def paths(start, end):
    return layered_paths(
        np.array([start], dtype=float),
        np.array([end], dtype=float),
        LAYERS.bounds_m,
        LAYERS.density,
    )[:, 0]


def test_layers_hold_the_air():
    """Straight up, molecules below 35 km to 0.2 %; aerosol, which thins out in a layer, to 4 %."""
    molecules, aerosol = paths([0.0, 0.0, GROUND_M], [0.0, 0.0, LAYERS.bounds_m[-1]])
    assert molecules == pytest.approx(8000.0 * -np.expm1(-35.0 / 8.0), rel=2e-3)
    assert aerosol == pytest.approx(1200.0, rel=0.04)


def test_paths_are_the_same_both_ways_and_add():
    """Through a lowest point between them, and split there."""
    low = np.array([0.0, 0.0, GROUND_M + 500.0])
    left, right = low - np.array([2e5, 0.0, 0.0]), low + np.array([3e5, 1e4, 0.0])
    np.testing.assert_allclose(paths(left, right), paths(right, left), rtol=1e-12)
    middle = 0.3 * left + 0.7 * right
    whole = paths(left, middle) + paths(middle, right)
    np.testing.assert_allclose(paths(left, right), whole, rtol=1e-9)


def test_the_ground_stands_in_the_way():
    """200 km to either side 1 km up are out of each other's sight."""
    height = GROUND_M + 1000.0
    turn = 2e5 / GROUND_M
    side = height * np.sin(turn), height * np.cos(turn)
    assert np.isinf(paths([-side[0], 0.0, side[1]], [side[0], 0.0, side[1]])[0])


@pytest.mark.long
def test_light_between_rings_by_harmonics_is_the_sum_over_cells():
    """Sources are even in azimuth about the sun; the sum goes cell by cell; float32."""
    transfer = transfer_through(STUDY)
    cells, active = transfer.cells, transfer.cells.active
    random = np.random.default_rng(7)
    power = random.random((FEW.size, active.size, HALF))
    target, azimuth = 40, 11
    centre = cells.centres[active]
    everywhere = np.concatenate([centre, centre * [1.0, -1.0, 1.0]], axis=1).reshape(-1, 3)
    both = np.concatenate([power, power], axis=2).reshape(FEW.size, -1)
    here = centre[target, azimuth]
    squared = ((everywhere - here) ** 2).sum(axis=-1)
    clear = transfer.transmittance(np.broadcast_to(here, everywhere.shape).copy(), everywhere)
    passed = np.divide(clear[:, FEW].T, squared, out=np.zeros_like(both), where=squared > 0.0)
    expected = (both * passed).sum(axis=1) / (4.0 * np.pi)
    found = transfer.from_everywhere(power)[:, target, azimuth]
    np.testing.assert_allclose(found, expected, rtol=1e-4)


def test_light_of_aerosol_follows_its_phase_function():
    """Between three rings, against cell by cell; float32."""
    across, up = np.array([5e3, 2e4, 6e4]), GROUND_M + np.array([1e3, 3e3, 8e3])
    turn = np.arange(HALF + 1) * STEP_RAD
    between = ring_paths(across, up, turn, LAYERS.bounds_m, LAYERS.density)
    power = np.random.default_rng(8).random((3, 1, HALF))
    around = np.concatenate([power, power[..., ::-1], power], axis=-1)
    extinction, sun, azimuth = np.array([[1e-5], [2e-5]]), np.array([0.6, 0.8]), cell_azimuths()
    factor = tuple(map(np.float32, (cornette_shanks_factor(0.7), 0.3**2, 1.4)))
    found = from_aerosol(
        across, up, np.arange(3), around.astype(np.float32), between,
        extinction.astype(np.float32), (sun[0], sun[1]), factor,
        np.cos(azimuth).astype(np.float32), np.sin(azimuth).astype(np.float32),
    )  # fmt: skip
    whole = (np.arange(2 * HALF) + 0.5) * STEP_RAD
    place = np.stack(
        [*np.multiply.outer([np.cos(whole), np.sin(whole)], across), np.tile(up, (72, 1))], axis=-1
    )
    here = place[11, 2]
    way = place - here
    squared = (way**2).sum(axis=-1)
    squared[11, 2] = np.inf
    nu = (way[..., 0] * sun[0] + way[..., 2] * sun[1]) / np.sqrt(squared)
    path = layered_paths(
        np.broadcast_to(here, (216, 3)).copy(),
        place.reshape(-1, 3),
        LAYERS.bounds_m,
        LAYERS.density,
    )
    clear = np.exp(-(extinction.T @ path)).reshape(72, 3)
    arriving = around[:, 0, :72].T * clear * cornette_shanks_phase(nu, 0.7) / squared
    np.testing.assert_allclose(found[2, 0, 11], arriving.sum(), rtol=1e-5)


@pytest.mark.long
def test_sky_is_near_that_of_all_light():
    """Even scattering by molecules, cells, no ground: 15 % rms of 360 to 720 nm, sun at 40 deg."""
    zenith, azimuth = directions()
    cells, truth = (model.sky_radiance(0.7, zenith, azimuth) for model in (Haber(), Bruneton()))
    assert np.sqrt(np.mean(relative_error(cells, truth) ** 2)) < 0.15


@pytest.mark.long
def test_two_faults_of_the_published_program_almost_cancel():
    """Fifty over 4 pi in the place of four: the light between cells by a tenth, the sky less."""
    zenith, azimuth = directions()
    right, published = (Haber(q).sky_radiance(0.7, zenith, azimuth) for q in (False, True))
    assert 1.0 < published.sum() / right.sum() < 1.05
