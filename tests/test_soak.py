"""A day in fast motion: what stays behind after many inputs to the real modules."""

import gc
import sys

import pytest

from vrut_lite.daylight_kernel import FaultCollector, daylight_kernel, demand_light
from vrut_lite.kernel.messages import BackgroundChanged, SetClockRate, Tick
from vrut_lite.project import Project, daylight_inputs

TICKS_A_MINUTE = 3600
WARM_UP_TICKS = 200


@pytest.fixture
def kernel():
    kernel, _ = daylight_kernel()
    yield kernel
    kernel.close()


def test_play_leaves_nothing_behind(kernel, request):
    """The clock plays at 60 Hz, 24 times as fast as the sun: an hour of play is a day.

    Memory and receivers at the end as at the start (within 2,000 blocks: caches of a few
    hours' light); no fault; a quarter of a minute by default, as many as --soak-minutes says.
    """
    faults, skies = FaultCollector(kernel), []
    kernel.tap(lambda message, _: skies.append(1) if type(message) is BackgroundChanged else None)
    demand_light(kernel, "soak", 16)
    for message in [*daylight_inputs(Project(at="2026-06-21T00:00")), SetClockRate(rate=24.0)]:
        kernel.inject(message)
    kernel.pump()

    def play(ticks):
        for _ in range(ticks):
            kernel.inject(Tick(elapsed_s=1 / 60))
            kernel.pump()
        gc.collect()

    # Until the trace's ring is full, memory grows by design.
    while len(kernel.trace.deliveries) < (kernel.trace.deliveries.maxlen or 0):
        play(WARM_UP_TICKS)
    blocks = sys.getallocatedblocks()
    methods = {name: seat.methods for name, seat in kernel.seats.items()}
    skies.clear()
    play(int(request.config.getoption("--soak-minutes") * TICKS_A_MINUTE))
    assert faults.faults == []
    assert {name: seat.methods for name, seat in kernel.seats.items()} == methods
    # The tap's own list of skies is not the kernel's.
    assert sys.getallocatedblocks() - blocks < 2000
    assert skies
