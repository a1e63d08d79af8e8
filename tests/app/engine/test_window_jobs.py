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
        assert jobs.is_busy_since(0)
        assert ran == []
    jobs.wait()
    assert ran == ["first"]
    with jobs.held():
        jobs.start(job_of(lambda: ran.append("second")), lambda job, result: finished.append(job))
        jobs.wait()
        assert ran == ["first", "second"]
    assert not jobs.is_busy_since(jobs.started)
    assert len(finished) == 2
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
