"""Workers that make pictures: processes of this machine, or a Dask cluster."""

import os
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from multiprocessing import active_children, get_context, parent_process
from multiprocessing.context import SpawnContext
from threading import Thread
from typing import Any

import click

from vrut_lite.errors import ModuleFailed, UserError
from vrut_lite.studio.dask_workers import LOCAL, dask_workers
from vrut_lite.studio.interrupts_blocked import ignore_interrupts, interrupts_blocked
from vrut_lite.studio.number_types import WholeRange


def worker_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add --jobs and --dask."""
    for option in (
        click.option("--dask", metavar=f"ADDRESS|{LOCAL}", help="Many pictures on a Dask cluster, "
                     "whose workers have vrut_lite and see the same files, or on one of this "
                     "machine."),
        click.option("--jobs", type=WholeRange(1, 256), default=1, show_default=True,
                     help="Many pictures in so many processes, each with its own GL."),
    ):  # fmt: skip
        command = option(command)
    return command


@contextmanager
def workers_of(jobs: int, dask: str | None, pictures: int) -> Iterator[Executor | None]:
    """An executor for this number of pictures; None for this process itself.

    Raises:
        UserError: Dask is not installed, or no scheduler answers.
    """
    if dask is not None:
        with dask_workers(dask, jobs) as executor:
            yield executor
    elif min(jobs, pictures) > 1:
        with _processes(min(jobs, pictures)) as executor:
            yield executor
    else:
        yield None


def spawn_context() -> SpawnContext:
    """The way to start processes: a fork of one with OpenGL or threads is unsafe.

    Raises:
        UserError: they cannot share memory with it.
    """
    context = get_context("spawn")
    try:
        context.Lock()
    except OSError as error:
        raise UserError(
            "pictures cannot be made by other processes: they share memory, which cannot be had "
            f"({error.strerror}); on Linux make /dev/shm writable, or leave --jobs at 1"
        ) from None
    return context


@contextmanager
def _processes(count: int) -> Iterator[Executor]:
    executor = _UninterruptedPool(
        count, mp_context=spawn_context(), initializer=_end_with_the_parent
    )
    others = set(active_children())
    try:
        yield executor
    except BaseException as error:
        # Their pictures would not be written.
        for process in set(active_children()) - others:
            process.terminate()
        if isinstance(error, BrokenProcessPool):
            raise ModuleFailed(
                "a process that makes pictures was ended from outside, perhaps for want of "
                "memory: try with fewer --jobs"
            ) from error
        raise
    finally:
        executor.shutdown(cancel_futures=True)


def _end_with_the_parent() -> None:
    """Let a worker process end with its parent, which may be killed, and not by Ctrl-C."""
    ignore_interrupts()
    parent = parent_process()
    assert parent is not None

    def watch() -> None:
        parent.join()
        os._exit(1)

    Thread(target=watch, name="parent-watch", daemon=True).start()


class _UninterruptedPool(ProcessPoolExecutor):
    """Processes that ignore Ctrl-C; the parent handles it."""

    def submit(self, *arguments: Any, **named: Any) -> Any:
        with interrupts_blocked():
            return super().submit(*arguments, **named)
