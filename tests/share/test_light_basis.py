"""Light maps as sums of few basis maps, against the maps themselves in double precision."""

import numpy as np
import pytest
from share.light_basis import light_basis
from share.light_maps import LightMaps


def maps(values=900, places=60, rank=6, lamps=True, seed=3):
    """Light of a low rank whose texels differ by a factor of a thousand; some have none."""
    random = np.random.default_rng(seed)
    parts = random.gamma(1.0, size=(rank, values))
    changes = random.gamma(1.0, size=(places, rank, 3))
    bright = 10.0 ** random.uniform(-3.0, 0.0, values)
    by_sun = np.einsum("srk,rt->stk", changes, parts) * bright[:, None]
    by_sun[:, ::50] = 0.0
    glow = 1e-6 * by_sun[3]
    own = 7.0 * by_sun[5] if lamps else np.zeros((values, 3))
    return LightMaps(
        by_sun.astype(np.float32),
        np.ones((places, 3)),
        glow.astype(np.float32),
        own.astype(np.float32),
        np.ones(values, np.float32),
    )


@pytest.fixture(scope="module")
def light():
    return maps()


@pytest.fixture(scope="module")
def basis(light):
    return light_basis(light, 12)


def relative(found, true):
    lit = true > 0.0
    return np.abs(found[lit] / true[lit] - 1.0)


def test_light_of_a_low_rank_is_kept_in_bright_and_dark_texels(light, basis):
    """Steps leave errors of about a percent of each texel's own light, also of the darkest."""
    for place in range(0, 60, 7):
        error = relative(basis.light(basis.sun[place]), light.by_sun[place].astype(float))
        assert np.sqrt(np.mean(error**2)) < 0.02
        assert error.max() < 0.2


def test_night_and_lamps_are_kept_though_they_differ_by_a_million(light, basis):
    for found, true in ((basis.glow, light.by_glow), (basis.lamps, light.by_lamps)):
        assert np.sqrt(np.mean(relative(basis.light(found), true.astype(float)) ** 2)) < 0.02


def test_texels_without_light_stay_dark(light, basis):
    found = basis.light(basis.sun[0])
    assert np.all(found[::50] == 0.0)
    assert np.all(np.isfinite(found))
    assert np.all(found >= 0.0)


def test_more_terms_leave_less(light):
    """As truncated singular vectors of each cluster do."""
    few, many = (light_basis(light, terms) for terms in (4, 8))
    left = [np.square(one.light(one.sun[9]) - light.by_sun[9]).sum() for one in (few, many)]
    assert left[1] < 0.1 * left[0]


def test_coefficients_are_finite_where_terms_have_nothing_to_say():
    """A cluster of one kind of light needs one term; the others must not blow up."""
    light = maps(rank=1, values=300)
    basis = light_basis(light, 8)
    assert np.all(np.isfinite(basis.sun))
    assert np.abs(basis.sun).max() < 1e4 * light.by_sun.max()


def test_a_scene_without_lamps_has_no_light_of_theirs():
    basis = light_basis(maps(lamps=False), 4)
    assert not np.any(basis.light(basis.lamps))


def wall(edge=96, places=80):
    """An even wall (edge, edge) over which a bright patch moves in a circle."""
    y, x = np.mgrid[:edge, :edge] / edge
    turn = np.linspace(0.0, 2.0 * np.pi, places, endpoint=False)[:, None, None]
    away = np.square(x - 0.5 - 0.35 * np.cos(turn)) + np.square(y - 0.5 - 0.35 * np.sin(turn))
    light = (0.2 + (1.0 + away / 0.02) ** -1.5).reshape(places, -1, 1) * [1.0, 0.9, 0.8]
    none = np.zeros((edge * edge, 3), np.float32)
    share = np.ones((places, edge * edge), np.float16)
    return LightMaps(light.astype(np.float32), np.ones((places, 3)), none, none, share)


def test_no_border_shows_between_clusters():
    """Errors of neighbours differ by 0.1 % rms across a border, little more than within."""
    light = wall()
    basis = light_basis(light, 8)
    cluster = basis.cluster.reshape(96, 96).astype(int)
    across, within = [], []
    for place in range(0, 80, 7):
        found, true = basis.light(basis.sun[place]), light.by_sun[place]
        off = (found / true - 1.0)[:, 1].reshape(96, 96)
        for axis in (0, 1):
            is_border = np.diff(cluster, axis=axis) != 0
            across.append(np.diff(off, axis=axis)[is_border])
            within.append(np.diff(off, axis=axis)[~is_border])
    across, within = (np.sqrt(np.mean(np.concatenate(one) ** 2)) for one in (across, within))
    assert across < 0.0015
    assert across < 1.5 * within


def test_a_step_is_the_same_for_all_terms_of_a_cluster(light, basis):
    """Strong terms have many steps and weak ones few: their rms falls from term to term."""
    spread = basis.spread()
    crowded = np.bincount(basis.cluster, minlength=len(spread)) > 20
    assert 500 < np.median(spread[crowded, 0]) < 3000
    assert np.all(spread[crowded, 11] < 0.05 * spread[crowded, 0])
    assert np.all(np.diff(spread[crowded], axis=1) < 0.5)


def test_terms_come_in_fours(light):
    """The page sums four at a time."""
    assert len(light_basis(light, 5).terms) == 8
