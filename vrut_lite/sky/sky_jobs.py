"""Results that a sky module awaits: its preparation by a background job, and GPU textures."""

from collections import deque

import msgspec

from vrut_lite.kernel.messages import Derived, JobResult
from vrut_lite.kernel.module import Link, Role
from vrut_lite.kernel.work_counters import WorkCounters
from vrut_lite.messages.air import AirChanged
from vrut_lite.messages.gpu_job import GpuJob
from vrut_lite.messages.gpu_texture import GpuTexture
from vrut_lite.messages.sky import BackgroundChanged
from vrut_lite.messages.sky_light import SkyLightChanged
from vrut_lite.sky.sky_of_hour import Prepared, Work

SOLVE = "solve"
# Jobs of one name: one runs, one waits.
_RUNS_AND_WAITS = 2
Awaiting = BackgroundChanged | AirChanged | SkyLightChanged


class Preparation:
    """The background job whose result a sky needs; after a failure the result before it stays.

    The latest work replaces older work.

    Attributes:
        latest: the last result; None before the first, and for a sky without preparation.
        ready: whether light can be made.
    """

    def __init__(self, link: Link, counters: WorkCounters):
        self._link, self._counters = link, counters
        self.latest: Prepared | None = None
        self.ready = False
        self._done: Work | None = None
        # The latest requested work, and the work that is running.
        self._asked: Work | None = None
        self._started: deque[Work] = deque()
        # Whether the draft of the running work is shown.
        self._drafted = False
        self._failed: Work | None = None

    def ask(self, work: Work | None) -> None:
        """Start work, unless it is done, is running, or was the last to fail.

        Running work ends first, so that a drag shows some of the values it passes, unless its draft
        is shown already.
        """
        if work is None:
            self.ready = True
            return
        first, work = work.first, work._replace(first=None)
        if work == self._asked:
            return
        if self._drafted or work in (self._failed, self._done):
            self.drop()
        elif self._asked is not None:
            self._counters.skip("preparation overtaken by a newer one")
        if work == self._failed:
            return
        self._failed = None
        if work != self._done:
            self._asked = work
            sooner = first is not None and self.ready and first != self._done
            self._start(first if sooner and first is not None else work, "awaited")

    def _start(self, work: Work, role: Role) -> None:
        if len(self._started) == _RUNS_AND_WAITS:
            self._started.pop()
        self._started.append(work)
        self._link.start_job(SOLVE, work.function, *work.arguments, role=role)

    def drop(self) -> None:
        """Cancel the running work."""
        if self._asked is not None:
            self._counters.skip("preparation overtaken by a newer one")
            self._asked = None
            self._drafted = False
            self._started.clear()
            self._link.cancel_job(SOLVE)

    def take(self, result: JobResult) -> bool:
        """Store a job's result; whether it is new."""
        asked = self._asked
        if asked is None or not self._started:
            return False
        work = self._started.popleft()
        if result.error:
            if not self._started:
                self._failed, self._asked, self._drafted = asked, None, False
            return False
        self._done, self.latest, self.ready = work, Prepared(work.of, result.value), True
        self._counters.did("preparation")
        if work == asked:
            self._asked, self._drafted = None, False
        elif not self._started:
            self._drafted = True
            self._start(asked, "drafted")
        return True


class AwaitedTextures:
    """Messages waiting for their GPU texture, by the jobs' names and recipes."""

    def __init__(self) -> None:
        self._messages: dict[str, dict[str, Awaiting]] = {}

    def first(self, name: str, job: GpuJob | None, message: Awaiting) -> Derived:
        """The message to post now: the job that it needs, or without a job the message itself.

        A message without a job is newer than all messages waiting under the name.
        """
        waiting = self._messages.setdefault(name, {})
        if job is None:
            waiting.clear()
            return message
        waiting.pop(job.recipe, None)
        waiting[job.recipe] = message
        return job

    def awaits(self, name: str, job: GpuJob) -> bool:
        """Whether a job's texture is the next that a message under the name is shown with."""
        return next(reversed(self._messages.get(name, {})), "") == job.recipe

    def next(self, name: str, texture: GpuTexture) -> Derived | None:
        """The message that waited for a texture; None if it or a newer one was posted before."""
        waiting = self._messages.get(name, {})
        if texture.recipe not in waiting:
            return None
        while True:
            recipe = next(iter(waiting))
            message = waiting.pop(recipe)
            if recipe == texture.recipe:
                return _with(message, texture)


def _with(message: Awaiting, texture: GpuTexture) -> Derived:
    if isinstance(message, BackgroundChanged):
        return msgspec.structs.replace(message, cube=texture)
    if isinstance(message, SkyLightChanged):
        seen = msgspec.structs.replace(message.background, cube=texture)
        return msgspec.structs.replace(message, background=seen)
    volume = message.volume
    assert volume is not None
    return msgspec.structs.replace(message, volume=msgspec.structs.replace(volume, light=texture))
