"""A process that computes a sky and shares it; the tests start it as a program.

    python bridged_sky.py PORT

Standard input: an hour of the day in UTC a line, as a number. Standard output: JSON lines, the
digest of each background as {"cube": ...}, each merged demand for it as {"size": ...}, and
each state of the bridge as {"state": ...}.
"""

import json
import sys
import threading
from datetime import UTC, datetime, timedelta

from dynamic_skylight.module import DynamicSkyLight
from kernel_thread import KernelThread
from zenoh_bridge.inputs import BridgeState
from zenoh_bridge.module import ZenohBridge

from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import Demand, SetClock, SetSetting
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.sky import BackgroundChanged

MIDNIGHT = datetime(2026, 6, 21, tzinfo=UTC)
PRAGUE = SetPlace(latitude_deg=50.0755, longitude_deg=14.4378)


def clock(hour):
    return SetClock(instant=MIDNIGHT + timedelta(hours=hour))


def enabling(mode, port):
    """The inputs that make a bridge open."""
    values = {"mode": mode, "endpoint": f"tcp/127.0.0.1:{port}", "enabled": True}
    return [SetSetting(module="zenoh_bridge", name=k, value=v) for k, v in values.items()]


def main(port):
    kernel = Kernel()
    kernel.add_module(DynamicSkyLight)
    kernel.add_module(ZenohBridge, inject=kernel.inject)

    def tell(message, sender):
        match message:
            case BackgroundChanged():
                print(json.dumps({"cube": message.cube.digest}), flush=True)
            case Demand(message="BackgroundChanged"):
                merged = kernel.wanted(BackgroundChanged)
                print(json.dumps({"size": merged.size if merged else 0}), flush=True)
            case BridgeState():
                print(json.dumps({"state": message.sentence}), flush=True)

    kernel.tap(tell)
    thread = KernelThread(kernel, on_error=lambda error: sys.exit(str(error)))
    thread.start()
    for message in (PRAGUE, clock(10), *enabling("listen", port)):
        kernel.inject(message)
    for line in sys.stdin:
        kernel.inject(clock(float(line)))
    thread.stop()
    kernel.close()
    # Only daemon threads remain.
    assert all(t.daemon for t in threading.enumerate() if t is not threading.main_thread())


if __name__ == "__main__":
    main(int(sys.argv[1]))
