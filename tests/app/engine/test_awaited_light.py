"""A finished picture waits for the light of its scene and of its hour, and for nothing else."""

from types import SimpleNamespace

import pytest

from vrut_lite.app.engine.awaited_light import AwaitedLight
from vrut_lite.app.engine.window_jobs import WindowJobs
from vrut_lite.daylight.light_map import SLOT
from vrut_lite.kernel.job_desk import JobDesk
from vrut_lite.kernel.messages import JobResult


class NeverDone(WindowJobs):
    """Starts jobs that others end."""

    def start(self, job, finish):
        with self.held():
            super().start(job, finish)
            self.job, self.finish = self._held.pop()


@pytest.fixture
def runner():
    return NeverDone()


@pytest.fixture
def kernel(runner):
    holders = {SLOT: "holder"}
    return SimpleNamespace(
        jobs=JobDesk(runner, lambda result: None, None),
        runner=runner,
        slots=SimpleNamespace(holder=lambda slot: holders.get(slot, "")),
        holders=holders,
    )


def state(scene, light=None):
    return SimpleNamespace(scene=scene, surface_light=light)


def test_a_picture_waits_while_the_holder_of_the_light_map_works(kernel, runner):
    """Not for others' jobs, nor after the job's end."""
    light, scene = AwaitedLight(), object()
    kernel.jobs.start(("other", "job"), lambda: None, ())
    assert not light.is_awaited(kernel, state(scene), 0.0, 0.0)
    kernel.jobs.start(("holder", "layout"), lambda: None, ())
    assert light.is_awaited(kernel, state(scene), 0.1, 0.0)
    runner.finish(runner.job, result := JobResult(module="holder", job="layout"))
    assert kernel.jobs.admit(result)
    assert not light.is_awaited(kernel, state(scene), 0.3, 0.0)


def test_what_an_input_started_is_waited_for_and_other_work_is_not(kernel):
    """Half a second from when the picture was due; rays are traced for seconds."""
    light, lit = AwaitedLight(), state(object(), light=object())
    kernel.jobs.start(("holder", "rays"), lambda: None, ())
    light.note_input(kernel)
    assert not light.is_awaited(kernel, lit, 10.0, 10.0)
    kernel.jobs.start(("sky", "solve"), lambda: None, ())
    assert light.is_awaited(kernel, lit, 10.4, 10.0)
    assert not light.is_awaited(kernel, lit, 10.6, 10.0)
    light.note_input(kernel)
    assert not light.is_awaited(kernel, lit, 10.6, 10.4)
    kernel.jobs.start(("holder", "hour"), lambda: None, ())
    assert light.is_awaited(kernel, lit, 10.6, 10.4)


def test_patience_ends_and_begins_anew_with_another_scene(kernel):
    """Five seconds from the first question on; and where no module holds the slot, none."""
    light, scene = AwaitedLight(), object()
    kernel.jobs.start(("holder", "layout"), lambda: None, ())
    assert light.is_awaited(kernel, state(scene), 100.0, 0.0)
    assert light.is_awaited(kernel, state(scene), 104.9, 0.0)
    assert not light.is_awaited(kernel, state(scene), 105.0, 0.0)
    assert light.is_awaited(kernel, state(object()), 106.0, 0.0)
    kernel.holders.clear()
    assert not light.is_awaited(kernel, state(scene), 107.0, 0.0)
