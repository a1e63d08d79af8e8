"""Random pictures of both skies stay within the tolerance that chose their sizes."""

import numpy as np
import pytest
from bruneton_sky.settings import atmosphere_of
from bruneton_sky.solver_job import solve_air
from bruneton_sky.tolerance import quality_for as solved_quality
from dynamic_skylight.tolerance import quality_for
from long_parameters import mostly_long

from vrut_lite_lab.tolerance.bruneton_sky import (
    ViewedAtmosphere,
    air_errors,
    evaluated,
    random_airs,
)
from vrut_lite_lab.tolerance.dynamic_skylight import hour_error, random_hours, truth


@pytest.fixture(scope="module")
def held() -> tuple[ViewedAtmosphere, list[np.ndarray]]:
    """Air that no front was measured in, and its skies by the finer rung, each ray by itself."""
    air = random_airs(1, seed=79)[0]
    field = solve_air(atmosphere_of(air.settings), rung="finer")
    return air, [evaluated(field, air, view) for view in air.views]


@pytest.mark.long
@pytest.mark.parametrize("tolerance", [0.3, 0.1, 0.04])
def test_pictures_of_a_solved_sky_stay_within(
    held: tuple[ViewedAtmosphere, list[np.ndarray]], tolerance: float
) -> None:
    """Fifteen suns and observers, where 99 of 100 are promised, plus the 1 % by which the finer
    rung itself may be off; docs/tolerance.md has the long run against converged skies."""
    air, truth = held
    errors = air_errors(air, truth, solved_quality(tolerance))
    assert max(errors) <= tolerance + 0.01, errors


@pytest.mark.long
def test_a_draft_would_not_do(held: tuple[ViewedAtmosphere, list[np.ndarray]]) -> None:
    """The promise is not kept by just any rung: what serves 100 % is beyond 2 %."""
    air, truth = held
    assert max(air_errors(air, truth, solved_quality(1.0))) > 0.02


@pytest.mark.parametrize("tolerance", mostly_long([0.3, 0.1, 0.03, 0.01, 0.003], (0.01).__eq__))
def test_pictures_of_hosek_and_wilkies_sky_stay_within(tolerance):
    """Hours that no front was measured with, each shown with its sun astray within the step:
    all of a dozen, where 99 of 100 are promised (docs/tolerance.md has the long run)."""
    for hour in random_hours(6, seed=77):
        assert hour_error(hour, truth(hour), quality_for(tolerance)) <= tolerance, hour


@pytest.mark.long
def test_a_coarse_choice_would_not_do():
    """The promise is not kept by just any size: what serves 100 % is beyond 0.3 %."""
    hours = random_hours(6, seed=77)
    errors = [hour_error(hour, truth(hour), quality_for(1.0)) for hour in hours]
    assert max(errors) > 0.003
