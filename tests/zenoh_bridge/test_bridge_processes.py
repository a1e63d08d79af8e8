"""Two processes connected by the bridge, on loopback, over real sessions."""

import pytest
from bridge_ends import BridgedKernel, SkyProcess, free_port, until

from vrut_lite.messages.sky import AmbientChanged
from vrut_lite.messages.sun import KeyLightChanged, SunMoved

pytest.importorskip("zenoh", reason="eclipse-zenoh is not installed (the extra 'bridge')")


def test_two_processes_show_the_same_background_through_a_kill():
    """One process computes what the other shows, equal by digest, in the size demanded there.

    The sky's process is killed and started anew: the other end gets the new sky, without
    anyone touching it.
    """
    port = free_port()
    here = BridgedKernel()
    there = SkyProcess(port)
    try:
        here.open("connect", port)
        here.hold_slots()
        here.demand(16)
        until(lambda: here.cube_digest() and here.cube_digest() == there.last("cube"), "a sky")
        assert there.last("size") == 16
        for kind in (SunMoved, KeyLightChanged, AmbientChanged):
            until(lambda kind=kind: here.kernel.last(kind), kind.__name__)

        there.set_hour(15)
        morning = here.cube_digest()
        until(lambda: here.cube_digest() == there.last("cube") != morning, "the afternoon")

        here.demand(32)
        until(lambda: there.last("size") == 32, "the larger demand there")
        until(lambda: here.cube_digest() == there.last("cube"), "the larger sky")

        there.kill()
        there = SkyProcess(port)
        until(lambda: there.last("cube"), "a sky in the new process, wanted from here")
        until(lambda: here.cube_digest() == there.last("cube"), "the new process's sky here")
        assert there.last("size") == 32

        here.demand(0)
        until(lambda: there.last("size") == 0, "the demand taken back")
        # A process that is killed takes along arrays of frames that are under way.
        assert all("nobody had the array" in fault.error for fault in here.faults)
        assert there.end() == 0
    finally:
        there.kill()
        here.close()
