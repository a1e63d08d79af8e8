"""Jobs of a window go after its pictures."""

import os
import sys
import threading
from concurrent.futures import ThreadPoolExecutor

import pytest

from vrut_lite.app.engine.window_jobs import WindowJobs
from vrut_lite.kernel.job import Job
from vrut_lite.kernel.trace import Trace


def job_of(work, name="job"):
    return Job(("module", name), work, (), Trace())


def test_held_jobs_begin_when_they_are_let_go_or_waited_for():
    """What is done meanwhile goes first; those that are cancelled meanwhile never run."""
    jobs, ran, finished = WindowJobs(), [], []
    dropped = job_of(lambda: ran.append("dropped"), "dropped")
    with jobs.held():
        jobs.start(job_of(lambda: ran.append("first")), lambda job, result: finished.append(job))
        jobs.start(dropped, lambda job, result: finished.append(job))
        dropped.control.cancel()
        assert ran == []
    jobs.wait()
    assert ran == ["first"]
    with jobs.held():
        jobs.start(job_of(lambda: ran.append("second")), lambda job, result: finished.append(job))
        jobs.wait()
        assert ran == ["first", "second"]
    assert len(finished) == 2
    jobs.close()


def test_a_job_that_a_revision_awaits_begins_at_once_and_is_no_nicer():
    """Its picture needs it: it would wait for a picture that waits for it."""
    jobs, found, done = WindowJobs(), [], threading.Event()
    job = Job(("module", "hour"), lambda: found.append(niceness()), (), Trace(), "awaited", 1)
    with jobs.held():
        jobs.start(job, lambda job, result: done.set())
        assert done.wait(60)
    if sys.platform == "linux":
        assert found == [niceness()]
    jobs.close()


@pytest.mark.skipif(sys.platform != "linux", reason="threads have no niceness of their own")
def test_jobs_have_a_lower_priority_with_the_threads_that_they_start():
    """The thread that starts them keeps its own."""
    jobs, found, before = WindowJobs(), [], niceness()

    def work():
        with ThreadPoolExecutor(1) as pool:
            found.extend([niceness(), pool.submit(niceness).result()])

    jobs.start(job_of(work), lambda job, result: None)
    jobs.wait()
    assert found == [before + 5, before + 5]
    assert niceness() == before
    jobs.close()


def niceness():
    return os.getpriority(os.PRIO_PROCESS, threading.get_native_id())
