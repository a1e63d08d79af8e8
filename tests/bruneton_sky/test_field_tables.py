"""Tables of a solved sky go with it: each haze has another sky, of 60 MiB with its tables."""

import gc
import weakref
from datetime import UTC, datetime

import numpy as np
import pytest
from bruneton_sky import solver_job
from bruneton_sky.field_tables import table_of_field
from bruneton_sky.settings import BrunetonSkySettings, atmosphere_of
from bruneton_sky.sky_view import table
from bruneton_sky.sky_view.table_on_card import table_on_card
from bruneton_sky.solved_sky import SolvedSky
from bruneton_sky.solver import SourceField

from vrut_lite.daylight_kernel import daylight_kernel, demand_light
from vrut_lite.kernel.messages import ChooseSlot, SetClock
from vrut_lite.messages.haze import SetHaze
from vrut_lite.messages.place import SetPlace

AIR = atmosphere_of(BrunetonSkySettings(turbidity=3.0))


def fields_alive():
    gc.collect()
    return sum(type(thing) is SourceField for thing in gc.get_objects())


@pytest.fixture(autouse=True)
def _solves_anew(monkeypatch):
    """Tests of a process share solved airs, which would keep each of them."""
    monkeypatch.setattr(solver_job, "solve", getattr(solver_job.solve, "solves", solver_job.solve))


def test_a_sky_is_freed_with_all_tables_that_were_made_of_it():
    """Radiance, its polarisation, sky and ground as cube maps, and what a card gets."""
    sky = SolvedSky(field=solver_job.solve_air(AIR, 2))
    sky.radiance(0.0, np.array([0.5]), np.array([0.6]), np.array([0.9]))
    sky.stokes(0.0, np.array([0.5]), np.array([0.6]), np.array([0.9]))
    sky.cube_map(16)
    for altitude_m in (0.0, 1e5):
        table_on_card(sky.field, altitude_m, np.array([0.0, 0.6, 0.8]))
    field = weakref.ref(sky.field)
    del sky
    gc.collect()
    assert field() is None


@pytest.mark.parametrize("altitude_m", [1.5, 9000.0, 5e5], ids=["ground", "flight", "space"])
def test_the_matter_along_rays_is_summed_once_for_all_suns(altitude_m, monkeypatch):
    """It follows from air and eye, and takes two fifths of a table's time; by day and in twilight
    rays have other bins. The light is that of a sky that has met no sun before."""
    summed = []
    fill = table.fill_row_bins
    monkeypatch.setattr(table, "fill_row_bins", lambda *rays: (summed.append(rays), fill(*rays)))
    field = solver_job.solve_air(AIR, 2)
    suns = [np.array([0.0, sine, np.sqrt(1.0 - sine * sine)]) for sine in (0.7, 0.6, 0.5)]
    views = [table.sky_view(field, altitude_m, sun) for sun in suns]
    once = len(summed)
    table.sky_view(field, altitude_m, np.array([0.0, 0.01, np.sqrt(1.0 - 1e-4)]))
    assert len(summed) == (once if altitude_m > AIR.top_altitude_m else 2 * once)
    fresh = table.sky_view(solver_job.solve_air(AIR, 2), altitude_m, suns[-1])
    np.testing.assert_array_equal(views[-1].nodes, fresh.nodes)


def test_a_table_is_made_once_and_only_the_last_few_of_a_field_stay():
    """A table takes tens of milliseconds, and each altitude of an eye has another."""
    made = []

    @table_of_field
    def known(field, altitude_m):
        made.append(altitude_m)
        return altitude_m

    field = solver_job.solve_air(AIR, 2)
    assert [known(field, m) for m in (0.0, 0.0, 1.0, 2.0, 3.0)] == [0.0, 0.0, 1.0, 2.0, 3.0]
    assert made == [0.0, 1.0, 2.0, 3.0]
    known(field, 4.0)
    known(field, 0.0)
    assert made == [0.0, 1.0, 2.0, 3.0, 4.0, 0.0]


def test_a_session_of_many_hazes_keeps_two_skies():
    """The present one, and the one before until the next light: by the real kernel."""
    kernel, _ = daylight_kernel()
    demand_light(kernel, "test", 16)
    for message in (
        ChooseSlot(slot="sky", module="bruneton_sky"),
        SetPlace(latitude_deg=50.0, longitude_deg=14.4),
        SetClock(instant=datetime(2026, 6, 21, 10, tzinfo=UTC)),
    ):
        kernel.inject(message)
    before = fields_alive()
    for depth in (0.05, 0.1, 0.2, 0.3):
        kernel.inject(SetHaze(optical_depth_550=depth))
        kernel.pump_until_idle()
    assert 1 <= fields_alive() - before <= 2
    kernel.close()
