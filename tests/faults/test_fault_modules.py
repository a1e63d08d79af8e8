"""Modules that hang or panic: the command ends with one line that names them."""

import signal

import pytest
from fault_stage import SMALL_SKY, is_one_line, outcome, start, wait_for

HOSTILE = """
import time
from pathlib import Path
from vrut_lite.kernel.messages import ClockMoved
from vrut_lite.kernel.module import Manifest, Module, handles

class Panic(BaseException):
    def __str__(self):
        raise self

def work():
    raise Panic

class Hostile(Module):
    manifest = Manifest(name="hostile", title="Hostile", version="1")

    @handles(ClockMoved)
    def on_clock(self, message):
        {deed}
"""


def with_module(folder, deed):
    """The environment of a command that finds a module with this code."""
    (folder / "zz_hostile.py").write_text(HOSTILE.replace("{deed}", deed))
    return {"VRUT_LITE_MODULES": str(folder)}


def test_a_handler_that_never_returns_is_named_when_it_is_ended(tmp_path):
    """When the user ends the command, the line names the handler that was running."""
    begun = tmp_path / "begun"
    deed = f"Path({str(begun)!r}).touch()\n        while True: time.sleep(0.01)"
    process = start(*SMALL_SKY, "-o", tmp_path / "sky.png", environment=with_module(tmp_path, deed))
    wait_for(begun.exists, process)
    process.send_signal(signal.SIGINT)
    returned, _, complaints = outcome(process)
    assert returned == 130
    assert is_one_line(complaints) == "vrut-lite: interrupted in on_clock of the module hostile"


@pytest.mark.long
def test_a_panic_in_a_job_ends_the_command_in_one_line(tmp_path):
    """The command neither hangs nor shows a traceback."""
    deed = "self.link.start_job('work', work)"
    process = start(*SMALL_SKY, "-o", tmp_path / "sky.png", environment=with_module(tmp_path, deed))
    returned, _, complaints = outcome(process)
    assert returned == 1
    assert "module hostile failed in" in is_one_line(complaints)
    assert "Panic: (its text cannot be made)" in complaints
