"""Workers that make pictures: processes of this machine, or a Dask cluster."""

import logging
import os
import signal
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import ExitStack, contextmanager
from multiprocessing import active_children, get_context, parent_process
from multiprocessing.context import SpawnContext
from threading import Thread
from typing import Any

import click

from vrut_lite.errors import ModuleFailed, UserError
from vrut_lite.studio.number_types import WholeRange

LOCAL = "local"
_ANSWER_S = 10


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
        with _dask(dask, jobs) as executor:
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
            "pictures cannot be made by other processes: they share memory in /dev/shm, which "
            f"cannot be written ({error.strerror}); make it writable, or leave --jobs at 1"
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
    """Let a worker process end with its parent, which may be killed."""
    parent = parent_process()
    assert parent is not None

    def watch() -> None:
        parent.join()
        os._exit(1)

    Thread(target=watch, name="parent-watch", daemon=True).start()


class _UninterruptedPool(ProcessPoolExecutor):
    """Processes that ignore Ctrl-C; the parent handles it."""

    def submit(self, *arguments: Any, **named: Any) -> Any:
        with _interrupts_blocked():
            return super().submit(*arguments, **named)


@contextmanager
def _interrupts_blocked() -> Iterator[None]:
    """Block Ctrl-C in threads and processes that start meanwhile; it comes here afterwards."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextmanager
def _dask(address: str, jobs: int) -> Iterator[Executor]:
    try:
        from distributed import Client, LocalCluster
    except ImportError:
        raise UserError(
            "--dask needs the package distributed: pip install 'vrut-lite[dask]'"
        ) from None
    with ExitStack() as stack:
        if address == LOCAL:
            with _interrupts_blocked():
                cluster: Any = LocalCluster(
                    n_workers=jobs if jobs > 1 else os.cpu_count() or 1,
                    threads_per_worker=1,
                    dashboard_address=None,
                    silence_logs=logging.CRITICAL,
                )
            stack.enter_context(cluster)
        else:
            _check_answers(address)
            cluster = address
        client = stack.enter_context(Client(cluster, timeout=_ANSWER_S, set_as_default=False))
        if address == LOCAL:
            client.run(_ignore_interrupts)
        yield client.get_executor(pure=False, retries=0)


def _ignore_interrupts() -> None:
    """Let a local worker ignore Ctrl-C, which the terminal sends to it too."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)


def _check_answers(address: str) -> None:
    """Raise UserError unless a scheduler answers; a client would retry much longer."""
    import asyncio

    from distributed.comm import connect

    async def visit() -> None:
        (await connect(address, timeout=_ANSWER_S)).abort()

    try:
        asyncio.run(visit())
    except (OSError, ValueError) as error:
        raise UserError(
            f"no Dask scheduler answers at {address} ({error}): name it as tcp://HOST:8786, or "
            f"'{LOCAL}'"
        ) from None
