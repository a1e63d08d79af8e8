"""A module's seat at the kernel, and the link that its instance speaks through.

The seat outlives the instance; the link ends with it.
"""

from collections.abc import Callable
from typing import Any, Literal, NamedTuple, TypeVar

import msgspec

from vrut_lite.errors import UserError
from vrut_lite.kernel.job import Work
from vrut_lite.kernel.job_scheduler import JobScheduler
from vrut_lite.kernel.messages import Demand, Derived, Encoding, Fault, Message
from vrut_lite.kernel.module import Manifest, Module, Role
from vrut_lite.kernel.work_counters import WorkCounters

M = TypeVar("M", bound=Message)
State = Literal["running", "disabled", "suspended"]


POSTS_PER_TRANSACTION = 10_000
# A chain of jobs, each started by the one before, would never let a command end.
JOBS_IN_A_CHAIN = 10_000


class KernelServices(NamedTuple):
    """The kernel's functions that module links call."""

    put: Callable[[Message, str], None]
    suspend: Callable[["LoadedModule", str, BaseException], None]
    wanted: Callable[[type[Message]], Demand | None]
    last: Callable[[type[Message]], Any]
    holder: Callable[[str], str]
    jobs: JobScheduler
    # Links that posted in this transaction, and that started jobs after this input.
    posters: list["ModuleContext"]
    job_starters: list["ModuleContext"]


class ModuleContext:
    """See `vrut_lite.kernel.module.Link`; once `alive` is false, the instance is not heard."""

    def __init__(self, kernel: KernelServices, seat: "LoadedModule"):
        self.alive = True
        self.name = seat.name
        self.posts = 0
        self.jobs = 0
        self._storm: RuntimeError | None = None
        self.seat = seat
        self._kernel = kernel
        self._put = kernel.put

    def post(self, message: Derived) -> None:
        """Queue a module's message; too many suspend the module."""
        if not self.alive:
            return
        if message.guarded and not self._may_say(message):
            return
        # `counts`, inlined: this is the kernel's most frequent line.
        if 0 < self.posts < POSTS_PER_TRANSACTION:
            self.posts += 1
        elif not self.counts(message):
            return
        self._put(message, self.name)

    def _may_say(self, message: Derived) -> bool:
        """Whether the slot allows a message.

        Raises:
            ValueError: the message fails its check; this counts as a fault.
        """
        try:
            message.check()
        except UserError as error:
            raise ValueError(str(error)) from None
        if message.slot is not None and not self.holds(message.slot):
            self.seat.counters.skip(f"post {type(message).__name__} without slot")
            return False
        return True

    def counts(self, message: Message) -> bool:
        """Count the posts of this transaction; too many end the instance."""
        if not self.posts:
            self._kernel.posters.append(self)
        elif self.posts >= POSTS_PER_TRANSACTION:
            storm = f"posted over {POSTS_PER_TRANSACTION} messages after one input"
            self._end(f"post {type(message).__name__}", storm)
            return False
        self.posts += 1
        return True

    def _end(self, where: str, storm: str) -> None:
        self.alive = False
        self._storm = RuntimeError(storm)
        # The seat calls `check_storm` for an instance that is still being made.
        if self.seat.link is self:
            self._kernel.suspend(self.seat, where, self._storm)

    def check_storm(self) -> None:
        """Raise RuntimeError if the instance was ended for posts of its constructor."""
        if self._storm is not None:
            raise self._storm

    def wanted(self, message_type: type[Message]) -> Demand | None:
        """See `Link`."""
        return self._kernel.wanted(message_type)

    def demand(
        self, message_type: type[Message], size: int | None = None, encoding: Encoding = ""
    ) -> None:
        """Ask for messages of a type; see `Link`."""
        if self.alive:
            name = message_type.__name__
            wish = Demand(consumer=self.name, message=name, size=size, encoding=encoding)
            try:
                wish.check()
            except UserError as error:
                raise ValueError(str(error)) from None
            if self.counts(wish):
                self._put(wish, self.name)

    def holds(self, slot: str) -> bool:
        """See `Link`."""
        return self._kernel.holder(slot) == self.name

    def last(self, message_type: type[M]) -> M | None:
        """See `Link`."""
        return self._kernel.last(message_type)

    def start_job(self, name: str, work: Work, *arguments: Any, role: Role = "aside") -> None:
        """See `Link`."""
        if not (isinstance(name, str) and callable(work)):
            raise TypeError("a job has a name, a text, and work that can be called")
        if not self.alive:
            return
        self.jobs += 1
        if self.jobs == 1:
            self._kernel.job_starters.append(self)
        if self.jobs > JOBS_IN_A_CHAIN:
            what = f"started over {JOBS_IN_A_CHAIN} jobs after one input"
            self._end(f"start_job {name}", what)
        else:
            self._kernel.jobs.start((self.name, name), work, arguments, role)

    def await_result(self, name: str) -> None:
        """See `Link`."""
        if self.alive:
            self._kernel.jobs.await_from_outside((self.name, name))

    def cancel_job(self, name: str) -> None:
        """See `Link`."""
        if self.alive:
            self._kernel.jobs.cancel((self.name, name))


class LoadedModule:
    """Settings, faults and state of one module; the instance comes and goes."""

    def __init__(self, module_type: type[Module], services: dict[str, Any]):
        self.module: Module | None = None
        self.link: ModuleContext | None = None
        # The instance's counts of work, or empty ones.
        self.counters = WorkCounters()
        self.state: State = "disabled"
        self.faults = 0
        self.last_fault: Fault | None = None
        self._services = services
        self.take_type(module_type, module_type.settings_type())

    def take_type(self, module_type: type[Module], settings: msgspec.Struct) -> None:
        """Use this class from the next start on."""
        self.module_type = module_type
        self.settings = settings
        self.methods: dict[type[Message], tuple[str, ...]] = {}
        for message_type, method in module_type.handlers():
            self.methods[message_type] = (*self.methods.get(message_type, ()), method)

    @property
    def manifest(self) -> Manifest:
        """The module's manifest."""
        return self.module_type.manifest

    @property
    def name(self) -> str:
        """The module's name."""
        return self.manifest.name

    @property
    def running(self) -> bool:
        """Whether the module hears messages."""
        return self.state == "running"

    def start(self, link: ModuleContext) -> None:
        """Put a fresh instance with the present settings in place of any other.

        An exception of the module's constructor passes on; the seat is then unchanged.
        """
        try:
            module = self.module_type(link, self.settings, **self._services)
            counters = _ledger_of(module)
            link.check_storm()
        except BaseException:
            link.alive = False
            raise
        self._cut()
        self.module, self.link, self.counters = module, link, counters
        self.faults = 0
        self.state = "running"

    def stop(self, state: State) -> None:
        """Drop the instance; the settings stay."""
        self._cut()
        self.module = self.link = None
        self.counters = WorkCounters()
        self.state = state

    def _cut(self) -> None:
        if self.link is not None:
            self.link.alive = False


def _ledger_of(module: Module) -> WorkCounters:
    """An instance's counts; one that never called Module's constructor has none."""
    counters = getattr(module, "counters", None)
    if not isinstance(counters, WorkCounters):
        raise TypeError("its constructor must call super().__init__(link, settings)")
    return counters
