"""Workers of a Dask cluster, of this machine or another.

A worker that is killed is the cluster's matter: its work begins again elsewhere. A worker whose
disk is full would fail with all that it gets, and get more than others as it fails quickly: it is
taken out of the cluster, and the others do its work.
"""

import errno
import logging
import os
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future
from contextlib import ExitStack, contextmanager, suppress
from threading import Lock
from typing import Any

import click

from vrut_lite import __version__
from vrut_lite.errors import ModuleFailed, UserError
from vrut_lite.studio.interrupts_blocked import ignore_interrupts, interrupts_blocked

LOCAL = "local"
_ANSWER_S = 10
_NO_ROOM = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
# Work that found so many full disks is given up.
_MOST_TRIES = 8


@contextmanager
def dask_workers(address: str, jobs: int) -> Iterator[Executor]:
    """An executor for a cluster: of a scheduler's address, or of this machine.

    Args:
        address: of a scheduler, or `LOCAL`.
        jobs: the workers of a cluster of this machine; with 1 as many as it has cores.

    Raises:
        UserError: Dask is not installed, or no scheduler answers.
    """
    try:
        from distributed import Client, LocalCluster
    except ImportError:
        raise UserError(
            "--dask needs the package distributed: pip install 'vrut-lite[dask]'"
        ) from None
    # A lost scheduler is reported by a sentence of ours.
    logging.getLogger("distributed.client").setLevel(logging.CRITICAL)
    with ExitStack() as stack:
        if address == LOCAL:
            with interrupts_blocked():
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
            client.run(ignore_interrupts)
        elif not _names(client):
            click.echo(
                "vrut-lite: the cluster has no workers yet; the work waits for them", err=True
            )
        executor = ClusterExecutor(client)
        try:
            yield executor
        finally:
            executor.shutdown(wait=False, cancel_futures=True)


class DiskFullError(Exception):
    """The disk of a worker is full: its name, and what could not be written."""


class ClusterExecutor(Executor):
    """Runs functions on a cluster, and once more elsewhere where a worker's disk was full."""

    def __init__(self, client: Any):
        self._client = client
        self._waiting: set[Any] = set()
        self._lock = Lock()

    def submit(self, function: Callable[..., Any], /, *arguments: Any, **named: Any) -> Any:
        """The result of a call, some time.

        Its exception is the function's, or

            UserError: the disks of all workers are full.
            ModuleFailed: workers were lost with this work again and again, or the scheduler was.
        """
        answer: Future[Any] = Future()
        self._send(answer, (function, arguments, named), 1)
        return answer

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Cancel waiting calls."""
        if cancel_futures:
            with self._lock:
                waiting, self._waiting = self._waiting, set()
            self._client.cancel(list(waiting))

    def _send(self, answer: "Future[Any]", call: tuple[Any, ...], tries: int) -> None:
        asker = __version__, os.getcwd()
        promise = self._client.submit(_done, asker, *call, pure=False, retries=0)
        with self._lock:
            self._waiting.add(promise)

        def landed(promise: Any) -> None:
            with self._lock:
                self._waiting.discard(promise)
            if answer.cancelled():
                return
            try:
                self._hand_over(promise, answer, call, tries)
            except BaseException as error:
                answer.set_exception(error)

        promise.add_done_callback(landed)

    def _hand_over(
        self, promise: Any, answer: "Future[Any]", call: tuple[Any, ...], tries: int
    ) -> None:
        from distributed import CancelledError, KilledWorker

        try:
            answer.set_result(promise.result())
        except DiskFullError as error:
            name, reason = error.args
            if tries == _MOST_TRIES or _names(self._client) in ([], [name]):
                raise UserError(
                    f"no worker of the cluster has room on its disk ({reason} on {name}): free "
                    "some there, or name another folder for temporary files in TMPDIR"
                ) from None
            # Where a cluster replaces lost workers, the new one may have room.
            self._client.retire_workers([name])
            self._send(answer, call, tries + 1)
        except KilledWorker as error:
            raise ModuleFailed(
                f"the cluster's workers were ended {error.allowed_failures + 1} times at the same "
                "work, perhaps for want of memory: give each more, or ask for less"
            ) from None
        except CancelledError:
            raise ModuleFailed(
                "the connection to the cluster's scheduler was lost: what is written stays; start "
                "the command again when the scheduler runs"
            ) from None


def _done(
    asker: tuple[str, str],
    function: Callable[..., Any],
    arguments: tuple[Any, ...],
    named: dict[str, Any],
) -> Any:
    """The result of a call on a worker, which is named if its disk is full.

    `asker`: the version and the folder of the program that asks. Paths are relative to that folder,
    if it is there.

    Raises:
        UserError: the worker has another version of vrut_lite.
    """
    from distributed import get_worker

    version, folder = asker
    if version != __version__:
        raise UserError(
            f"the worker {get_worker().address} has vrut_lite {__version__}, and this is "
            f"{version}: install one version on all"
        )
    with suppress(OSError):
        os.chdir(folder)
    try:
        return function(*arguments, **named)
    except Exception as error:
        reason = _full_disk(error)
        if reason:
            raise DiskFullError(get_worker().address, reason) from None
        raise


def _full_disk(error: BaseException | None) -> str:
    """The system's sentence on a full disk among an exception's causes; empty without one."""
    while error is not None:
        if isinstance(error, OSError) and error.errno in _NO_ROOM:
            return (error.strerror or str(error)).lower()
        error = error.__cause__ or error.__context__
    return ""


def _names(client: Any) -> list[str]:
    """Addresses of the cluster's present workers."""
    return list(client.nthreads())


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
