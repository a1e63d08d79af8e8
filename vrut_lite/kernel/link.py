"""A module instance's side of the kernel, which the host owns and can cut."""

from typing import TYPE_CHECKING, Any, TypeVar

from vrut_lite.errors import UserError
from vrut_lite.kernel.job import Work
from vrut_lite.kernel.messages import Demand, Derived, Encoding, Message
from vrut_lite.kernel.seat import Seat

if TYPE_CHECKING:
    from vrut_lite.kernel.bus import Kernel

M = TypeVar("M", bound=Message)

POSTS_PER_TRANSACTION = 10_000
# A job that starts the next when it is done would never let a command end.
JOBS_IN_A_CHAIN = 10_000


class ModuleLink:
    """See `vrut_lite.kernel.module.Link`; once `alive` is false, the instance is not heard."""

    def __init__(self, kernel: "Kernel", seat: Seat):
        self.alive = True
        self.name = seat.name
        self.posts = 0
        self.jobs = 0
        self._storm: RuntimeError | None = None
        self.seat = seat
        self._kernel = kernel
        self._put = kernel.dispatcher.put

    def post(self, message: Derived) -> None:
        """Queue what a module says; a storm is cut by count, and its maker named."""
        if not self.alive:
            return
        if message.guarded and not self._may_say(message):
            return
        # What `counts` does, without a call: this is the kernel's hottest line.
        if 0 < self.posts < POSTS_PER_TRANSACTION:
            self.posts += 1
        elif not self.counts(message):
            return
        self._put(message, self.name)

    def _may_say(self, message: Derived) -> bool:
        """Whether the slot allows a message.

        Raises:
            ValueError: it is not what its type says; its maker's to mend, so that it counts.
        """
        try:
            message.check()
        except UserError as error:
            raise ValueError(str(error)) from None
        if message.slot is not None and not self.holds(message.slot):
            self.seat.ledger.skip(f"post {type(message).__name__} without slot")
            return False
        return True

    def counts(self, message: Message) -> bool:
        """Count what is said in this transaction; too much of it ends the instance."""
        if not self.posts:
            self._kernel.dispatcher.posters.append(self)
        elif self.posts >= POSTS_PER_TRANSACTION:
            storm = f"posted over {POSTS_PER_TRANSACTION} messages after one input"
            self._end(f"post {type(message).__name__}", storm)
            return False
        self.posts += 1
        return True

    def _end(self, where: str, storm: str) -> None:
        self.alive = False
        self._storm = RuntimeError(storm)
        # Of an instance that is still being made its seat asks `check_storm`.
        if self.seat.link is self:
            self._kernel.lifecycle.suspend(self.seat, where, self._storm)

    def check_storm(self) -> None:
        """Raise RuntimeError if the instance was ended for what it said in its constructor."""
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
        return self._kernel.slots.holder(slot) == self.name

    def last(self, message_type: type[M]) -> M | None:
        """See `Link`."""
        return self._kernel.last(message_type)

    def start_job(self, name: str, work: Work, *arguments: Any) -> None:
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
            self._kernel.jobs.start((self.name, name), work, arguments)

    def cancel_job(self, name: str) -> None:
        """See `Link`."""
        if self.alive:
            self._kernel.jobs.cancel((self.name, name))
