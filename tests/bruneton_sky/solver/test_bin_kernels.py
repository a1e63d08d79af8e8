"""Rays in bins: the matter of a ray is kept, however few the bins."""

from dataclasses import replace

import numpy as np
import pytest
from bruneton_sky import Atmosphere
from bruneton_sky.geometry import distance_to_ground, distance_to_top, make_ray
from bruneton_sky.optical_path import optical_depth_to_top
from bruneton_sky.solver import SolverSizes
from bruneton_sky.solver.nodes import Nodes, make_nodes
from bruneton_sky.solver.wavelength_groups import groups_of_air

SIZES = SolverSizes(altitude=6, mu_s=4, direction_mu=12, direction_azimuth=4, degree=4)


def nodes_of(atmosphere: Atmosphere, sizes: SolverSizes = SIZES) -> Nodes:
    return make_nodes(atmosphere, groups_of_air(atmosphere)[0], sizes)


def test_light_scattered_and_light_left_are_all_the_light(other_planet: Atmosphere) -> None:
    """Without absorption, what bins scatter and what passes the ray add to one, to rounding."""
    for air in (Atmosphere.earth(ozone=False), other_planet):
        none = (0.0,) * len(air.wavelength_nm)
        clear = replace(air, mie_extinction=air.mie_scattering, absorption_extinction=none)
        bins = nodes_of(clear).bins
        lanes = min(len(air.wavelength_nm), 4)
        scattered = bins.weight.sum(axis=(2, 3))[..., :lanes]
        assert scattered + bins.end[..., :lanes] == pytest.approx(1.0, abs=1e-12)


@pytest.mark.parametrize(("steps", "tolerance"), [(48, 5e-4), (512, 3e-5)])
def test_ray_passes_the_optical_depth_of_its_air(
    other_planet: Atmosphere, steps: int, tolerance: float
) -> None:
    """The steps' transmittance tends to that of the closed form; an absorber's kinks slow it."""
    for air in (Atmosphere.earth(), other_planet):
        nodes = nodes_of(air, replace(SIZES, steps=steps))
        up = ~nodes.operator.directions.downward
        mu, altitude = nodes.operator.directions.mu[:, up], nodes.altitude_m[:, None]
        exact = np.exp(-optical_depth_to_top(air, altitude, mu))
        ours = nodes.bins.end[:, up, : len(air.wavelength_nm)]
        assert ours == pytest.approx(exact, rel=0.0, abs=tolerance)


def test_bins_follow_each_other_to_the_end_of_the_ray(other_planet: Atmosphere) -> None:
    """Edges rise from zero to the ray's length, and centres lie between their edges."""
    nodes = nodes_of(other_planet)
    edge, centre, directions = nodes.bins.edge, nodes.bins.centre, nodes.operator.directions
    assert np.all(edge[..., 0] == 0.0)
    assert np.all(np.diff(edge, axis=-1) >= 0.0)
    radius, h = other_planet.ground_radius_m, nodes.altitude_m[:, None]
    top = distance_to_top(radius, other_planet.top_altitude_m, h, directions.mu)
    ground = distance_to_ground(radius, h, directions.mu)
    length = np.where(directions.downward, ground, top)
    assert edge[..., -1] == pytest.approx(length, rel=1e-9, abs=1e-6)
    assert np.all(centre[..., 0] >= edge[..., :-1] - 1e-6)
    assert np.all(centre[..., 0] <= edge[..., 1:] + 1e-6)
    hits = make_ray(radius, h, directions.mu).hits_ground()
    assert np.array_equal(hits[1:], np.broadcast_to(directions.downward, hits.shape)[1:])


def test_fewer_bins_keep_the_weights_of_more() -> None:
    """Merging more steps into a bin moves light between bins, never out of them."""
    air = Atmosphere.earth()
    few = nodes_of(air, replace(SIZES, node_bins=3)).bins.weight
    many = nodes_of(air, replace(SIZES, node_bins=40)).bins.weight
    assert few.sum(axis=2) == pytest.approx(many.sum(axis=2), rel=1e-12)


def test_rays_have_bins_by_the_air_they_cross(other_planet: Atmosphere) -> None:
    """A ray down through a tenth of the altitudes has a tenth of the bins, and more by its length,
    one up through all of them has all; what others do without is counted. The sky that so few
    make is Monte Carlo's (test_haze_against_truth, test_rays_against_truth)."""
    nodes = nodes_of(other_planet, replace(SIZES, altitude=21, node_bins=40, higher_bins=20))
    used = (nodes.bins.centre[..., 3] > 0.0).sum(axis=-1)
    length_m, crossed = nodes.bins.edge[:, 5, -1], np.linspace(0.0, 1.0, 21)
    share = crossed + length_m / (0.1 * (other_planet.ground_radius_m + nodes.altitude_m))
    assert np.all(used[1:, 5] <= np.maximum(40.0 * share[1:] + 1.0, 3.0))
    assert np.all(used[1:, 5] >= np.minimum(40.0 * crossed[1:], 36.0))
    assert used[0, -1] >= 36
    both = nodes.bins, nodes.higher_bins
    empty = [(bins.edge[..., 1:] == bins.edge[..., :-1]).sum() for bins in both]
    assert sum(empty) >= nodes.bins_left_out > 0.2 * used.size * (40 + 20)
