"""The module `clouds`: no work without clouds, drift by the clock, replays."""

from datetime import UTC, datetime, timedelta

import numpy as np
import pytest
from clouds import module as clouds_module
from clouds.module import Clouds, drift_m
from clouds.settings import CloudSettings

from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import Demand, SetClock, SetSetting
from vrut_lite.messages.clouds import CloudsChanged
from vrut_lite.messages.place import SetPlace
from vrut_lite.recording.journal_reader import Journal
from vrut_lite.recording.recorder import Recorder
from vrut_lite.recording.replay import Replay

NOON = datetime(2026, 6, 21, 11, tzinfo=UTC)
WANTED = Demand(consumer="test", message="CloudsChanged")


def coverage_of(value):
    return SetSetting(module="clouds", name="coverage", value=value)


@pytest.fixture
def kernel():
    kernel = Kernel()
    kernel.add_module(Clouds)
    yield kernel
    kernel.close()


@pytest.fixture
def heard(kernel):
    """All `CloudsChanged` messages."""
    said = []
    kernel.tap(lambda message, _: said.append(message) if type(message) is CloudsChanged else None)
    return said


def tell(kernel, *inputs):
    for message in inputs:
        kernel.inject(message)
        kernel.pump_until_idle()


def counters(kernel):
    return kernel.seats["clouds"].module.counters


def test_without_coverage_nothing_is_made(kernel, heard, monkeypatch):
    """There is no message by default, no job and no import of compiled noise."""
    monkeypatch.setattr(clouds_module, "make_layers", None)
    tell(kernel, WANTED, SetClock(instant=NOON), SetClock(instant=NOON + timedelta(hours=1)))
    assert heard == []
    assert not counters(kernel).done
    assert counters(kernel).skipped["clouds: no coverage"] >= 3


def test_without_demand_nothing_is_made(kernel, heard):
    """Without demand no layer is made."""
    tell(kernel, SetClock(instant=NOON), coverage_of(0.5))
    assert heard == []
    assert not counters(kernel).done
    tell(kernel, WANTED)
    assert heard[-1].layers[0].coverage == 0.5


def test_switching_off_removes_the_clouds_once(kernel, heard):
    """A posted layer is withdrawn exactly once."""
    tell(kernel, WANTED, SetClock(instant=NOON), coverage_of(0.3), coverage_of(0.0))
    assert [len(message.layers) for message in heard] == [1, 0]
    tell(kernel, SetClock(instant=NOON + timedelta(hours=1)))
    assert len(heard) == 2


@pytest.mark.parametrize(("azimuth_deg", "towards"), [(270.0, (1, 0)), (0.0, (0, 1))])
def test_the_wind_moves_the_pattern(kernel, heard, azimuth_deg, towards):
    """Speed times time: 10 m/s from the west for a minute are 600 m east (+x), from north +z."""
    tell(
        kernel,
        WANTED,
        SetSetting(module="clouds", name="wind_speed_m_s", value=10.0),
        SetSetting(module="clouds", name="wind_azimuth_deg", value=azimuth_deg),
        SetClock(instant=NOON),
        coverage_of(0.3),
        SetClock(instant=NOON + timedelta(minutes=1)),
    )
    before, after = heard[-2].layers[0], heard[-1].layers[0]
    moved = np.subtract(after.drift_m, before.drift_m)
    np.testing.assert_allclose(moved, 600.0 * np.array(towards), atol=1e-3)
    assert after.shape is before.shape, "the wind makes no new noise"
    assert counters(kernel).done["layers"] == 1


def test_a_turned_world_turns_the_wind():
    """With -z pointing east of north by 90 degrees, wind from the west blows ahead, along -z."""
    settings = CloudSettings(coverage=0.5, wind_speed_m_s=5.0, wind_azimuth_deg=270.0)
    np.testing.assert_allclose(
        drift_m(settings.layers[0], 2.0, np.pi / 2), (0.0, -10.0), atol=1e-12
    )


def test_a_drift_below_half_a_metre_is_not_posted(kernel, heard):
    """A drift below the noise's resolution, 0.04 s at 8 m/s, is not posted."""
    tell(kernel, WANTED, SetClock(instant=NOON), coverage_of(0.3))
    tell(kernel, SetClock(instant=NOON + timedelta(milliseconds=40)))
    assert len(heard) == 1
    assert counters(kernel).skipped["clouds: unchanged"] == 1


def test_a_recorded_session_replays(tmp_path):
    """After changes of settings, clock and place the clouds are equal to the byte."""
    path = tmp_path / "clouds.mcap"
    turned = SetPlace(latitude_deg=50.0, longitude_deg=14.0, north_offset_rad=0.3)
    kernel = Kernel()
    kernel.add_module(Clouds)
    with path.open("wb") as stream:
        recorder = Recorder(kernel, stream)
        tell(kernel, WANTED, SetClock(instant=NOON), coverage_of(0.4), coverage_of(0.5), turned)
        tell(kernel, SetClock(instant=NOON + timedelta(minutes=5)), coverage_of(0.0))
        recorder.close()
    kernel.close()
    outcome = Replay(Journal(path), [Clouds]).run()
    assert outcome.difference is None
    assert outcome.messages > 5
    assert path.stat().st_size < 32_000
