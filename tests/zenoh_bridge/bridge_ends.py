"""Both ends of a bridge, for the tests."""

import json
import os
import socket
import subprocess
import sys
import threading
import time
from pathlib import Path

from bridged_sky import enabling
from kernel_thread import KernelThread
from zenoh_bridge.module import NAME, ZenohBridge

from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import ChooseSlot, Demand, Fault
from vrut_lite.messages.sky import AmbientChanged, BackgroundChanged
from vrut_lite.messages.sun import KeyLightChanged, SunMoved

PRODUCTS = (SunMoved, BackgroundChanged, KeyLightChanged, AmbientChanged)
TIMEOUT_S = 20.0
_REPO = Path(__file__).parents[2]


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def until(condition, what):
    """Wait for a condition that depends on another thread or process."""
    end = time.monotonic() + TIMEOUT_S
    while not (found := condition()):
        assert time.monotonic() < end, f"waited {TIMEOUT_S} s in vain: {what}"
        time.sleep(0.005)
    return found


def demands(size, consumer="viewer", kinds=PRODUCTS):
    return [Demand(consumer=consumer, message=kind.__name__, size=size) for kind in kinds]


class SkyProcess:
    """A process that computes a sky (bridged_sky.py), and its output."""

    def __init__(self, port):
        self.said = []
        self._process = subprocess.Popen(
            [sys.executable, Path(__file__).with_name("bridged_sky.py"), str(port)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            env={**os.environ, "PYTHONPATH": f"{_REPO / 'modules'}{os.pathsep}{_REPO / 'tests'}"},
        )
        threading.Thread(target=self._read, daemon=True).start()

    def _read(self):
        for line in self._process.stdout:
            self.said.append(json.loads(line))

    def last(self, field):
        return next((entry[field] for entry in reversed(self.said) if field in entry), None)

    def set_hour(self, hour):
        self._process.stdin.write(f"{hour}\n")
        self._process.stdin.flush()

    def kill(self):
        """Kill it with SIGKILL."""
        self._process.kill()
        self._process.wait()

    def end(self):
        """Let it end by itself; returns the exit code."""
        self._process.stdin.close()
        return self._process.wait(TIMEOUT_S)


class BridgedKernel:
    """A kernel on its own thread whose bridge holds sun and sky, and the messages it posts."""

    def __init__(self, modules=()):
        self.kernel = Kernel()
        self.faults = []
        for module in modules:
            self.kernel.add_module(module)
        self.kernel.add_module(ZenohBridge, inject=self.kernel.inject)
        self.kernel.tap(self._note)
        self._thread = KernelThread(self.kernel, on_error=self.faults.append)
        self._thread.start()

    def _note(self, message, sender):
        if isinstance(message, Fault):
            self.faults.append(message)

    @property
    def bridge(self):
        return self.kernel.seats[NAME].module

    def inject(self, *messages):
        for message in messages:
            self.kernel.inject(message)

    def open(self, mode, port):
        self.inject(*enabling(mode, port))

    def hold_slots(self):
        self.inject(ChooseSlot(slot="sun", module=NAME), ChooseSlot(slot="sky", module=NAME))

    def demand(self, size, **who_and_what):
        self.inject(*demands(size, **who_and_what))

    def cube_digest(self):
        background = self.kernel.last(BackgroundChanged)
        return background and background.cube.digest

    def close(self):
        self._thread.stop()
        bridge = self.bridge
        if bridge is not None and bridge._connection is not None:
            bridge._connection.close_now()
        self.kernel.close()
