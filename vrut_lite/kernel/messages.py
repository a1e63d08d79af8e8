"""Messages between modules and host: typed, frozen, with units in the names.

An input comes from outside (a person, the clock, a file, a finished job) and opens a
transaction. A derived message is a consequence, posted by a handler inside one.

`check` ensures the types and ranges that listeners rely on: inputs are checked when admitted,
derived messages when posted. These are the kernel's own types; the layers above add theirs.
"""

from datetime import datetime
from typing import Any, ClassVar, Literal, Self, get_args

import msgspec

from vrut_lite import checks
from vrut_lite.errors import UserError

# In order of precedence: a consumer of float32 cannot use float16, the reverse works.
Encoding = Literal["", "u8", "float16", "float32"]
# The largest cube and the largest picture that the command line offers.
LARGEST_DEMAND = 4096


class Message(msgspec.Struct, frozen=True, kw_only=True):
    """Base of all messages."""

    def key(self) -> str | None:
        """Distinguishes messages of one type: of equal keys the latest wins.

        None: every message is delivered.
        """
        return ""

    def check(self) -> None:
        """Check every field: listeners rely on types and ranges.

        Takes microseconds; `check_arrays` checks the content of arrays.

        Raises:
            UserError: a field is invalid; the sentence names it.
        """

    def check_arrays(self) -> None:
        """Check the content of the arrays of a message that passes `check`.

        Raises:
            UserError: the content of an array is invalid.
        """


class Input(Message, frozen=True, kw_only=True):
    """A fact from outside; each opens one transaction."""

    # Name of a sequence whose order matters: an input merges only with its last one.
    timeline: ClassVar[str | None] = None
    # Whether it begins a revision. One that does not may overtake waiting inputs that do.
    revises: ClassVar[bool] = True
    # Whether it belongs to a kernel's set-up, which a recording repeats, beside the kernel's own.
    sets_up: ClassVar[bool] = False
    # Whether no later input overtakes it.
    is_barrier: ClassVar[bool] = False
    # Whether another process sent it: its faults are posted, but no command fails for them.
    by_stranger: ClassVar[bool] = False

    def merged(self, older: Self) -> Self:
        """The input that replaces this one and a waiting older one of its key."""
        return self


class Derived(Message, frozen=True, kw_only=True):
    """A consequence, posted by a handler; those of a slot only by the slot's holder."""

    slot: ClassVar[str | None] = None
    # Whether a post must check the slot first.
    guarded: ClassVar[bool] = False

    def __init_subclass__(cls) -> None:
        """Set `guarded` once per class, so that a post need not find it out."""
        super().__init_subclass__()
        cls.guarded = cls.slot is not None or cls.check is not Message.check


class SetSetting(Input, frozen=True, kw_only=True):
    """Give one setting of one module a new value."""

    module: str
    name: str
    value: Any

    def key(self) -> str:
        """One pending value per setting."""
        return f"{self.module}.{self.name}"

    def check(self) -> None:
        """A plain value; the setting itself decides whether it takes it."""
        checks.text(self, "module", "name")
        if not isinstance(self.value, bool | int | float | str | None):
            raise UserError(
                "SetSetting: a setting's value is a number, a text, true, false or null"
            )


class EnableModule(Input, frozen=True, kw_only=True):
    """Switch a module on or off."""

    module: str
    enabled: bool = True

    def key(self) -> str:
        """One pending state per module."""
        return self.module

    def check(self) -> None:
        """A module by name, on or off."""
        checks.text(self, "module")
        checks.flag(self, "enabled")


class _ModuleCommand(Input, frozen=True, kw_only=True):
    """A command to one module, by name; every single one counts."""

    module: str

    def key(self) -> None:
        """Never merged."""

    def check(self) -> None:
        """A module by name."""
        checks.text(self, "module")


class RestartModule(_ModuleCommand, frozen=True, kw_only=True):
    """Restart a module with its present settings, also after it was suspended."""


class ReloadModule(_ModuleCommand, frozen=True, kw_only=True):
    """Import a module's package afresh; settings and snapshot pass to the new version."""


class ChooseSlot(Input, frozen=True, kw_only=True):
    """Let a module hold a slot."""

    slot: str
    module: str

    def key(self) -> str:
        """One pending choice per slot."""
        return self.slot

    def check(self) -> None:
        """Slot and module by name."""
        checks.text(self, "slot", "module")


class Demand(Input, frozen=True, kw_only=True):
    """A consumer wants messages of a type, in this size and format; size 0 takes it back.

    The size None and the encoding "" leave the choice to the producer. The demand of a consumer
    that is a module holds while that module runs.
    """

    revises: ClassVar[bool] = False

    consumer: str
    message: str
    size: int | None = None
    encoding: Encoding = ""

    def key(self) -> str:
        """One demand per consumer and message."""
        return f"{self.consumer}.{self.message}"

    def check(self) -> None:
        """A size and an encoding that producers know."""
        checks.text(self, "consumer", "message")
        if self.size is not None:
            checks.whole(self, "size", 0, LARGEST_DEMAND)
        if not (isinstance(self.encoding, str) and self.encoding in get_args(Encoding)):
            raise UserError(
                f"{self.consumer} wants {self.message} as {checks.shown(self.encoding)}: "
                f"it can be {', '.join(filter(None, get_args(Encoding)))}"
            )


class JobResult(Input, frozen=True, kw_only=True):
    """The end of a background or GPU job; `error` is the reason of a failure.

    Only the module that started the job hears it; an outdated result is dropped. Work that raised
    leaves its `trace`, and is posted as a `Fault` too. The result belongs to the revision in which
    its job was started.
    """

    revises: ClassVar[bool] = False

    module: str
    job: str
    value: Any = None
    error: str = ""
    trace: str = ""
    for_user: bool = False

    def key(self) -> None:
        """Every result counts."""

    def check(self) -> None:
        """Module, job and texts; the value may be anything."""
        checks.text(self, "module", "job", "error", "trace")
        checks.flag(self, "for_user")


class SetClock(Input, frozen=True, kw_only=True):
    """The host's clock stands at this aware instant; modules listen to `ClockMoved`."""

    timeline: ClassVar[str | None] = "clock"

    instant: datetime

    def check(self) -> None:
        """A time with a time zone that UTC can name."""
        checks.instant(self, "instant")


class SetClockRate(Input, frozen=True, kw_only=True):
    """Speed of the host's clock: its seconds per second of `Tick`; 0 pauses."""

    timeline: ClassVar[str | None] = "clock"

    rate: float

    def check(self) -> None:
        """A number."""
        if not checks.is_finite(self.rate):
            raise UserError(
                f"the clock's rate must be a finite number, not {checks.shown(self.rate)}"
            )


class Tick(Input, frozen=True, kw_only=True):
    """Time that has passed outside."""

    timeline: ClassVar[str | None] = "clock"

    elapsed_s: float

    def merged(self, older: Self) -> Self:
        """The sum of both times: a slow kernel loses frames, never time."""
        return type(self)(elapsed_s=self.elapsed_s + older.elapsed_s)

    def check(self) -> None:
        """Time never goes back."""
        if not (checks.is_finite(self.elapsed_s) and self.elapsed_s >= 0):
            raise UserError(f"a tick must be of 0 s or more, not {checks.shown(self.elapsed_s)}")


class SlotChanged(Derived, frozen=True, kw_only=True):
    """Another module holds the slot now; empty when none can."""

    name: str
    holder: str

    def key(self) -> str:
        """One holder per slot."""
        return self.name


class SettingChanged(Derived, frozen=True, kw_only=True):
    """A module's setting has a new, valid value."""

    module: str
    name: str
    value: Any

    def key(self) -> str:
        """One value per setting."""
        return f"{self.module}.{self.name}"


class Fault(Derived, frozen=True, kw_only=True):
    """A module failed; the others went on. `for_user`: the error is a sentence for people."""

    module: str
    where: str
    error: str
    trace: str = ""
    suspended: bool = False
    for_user: bool = False

    def key(self) -> None:
        """Every fault is delivered."""

    def check(self) -> None:
        """Texts."""
        checks.text(self, "module", "where", "error", "trace")
        checks.flag(self, "suspended", "for_user")


class ClockMoved(Derived, frozen=True, kw_only=True):
    """The host's clock stands at this instant, in UTC, whether it was set or it ticked."""

    instant: datetime

    def check(self) -> None:
        """A time with a time zone."""
        checks.instant(self, "instant")


# Every type above that a journal may hold.
KERNEL_MESSAGES: tuple[type[Message], ...] = (
    SetSetting,
    EnableModule,
    RestartModule,
    ReloadModule,
    ChooseSlot,
    Demand,
    JobResult,
    SetClock,
    SetClockRate,
    Tick,
    SlotChanged,
    SettingChanged,
    Fault,
    ClockMoved,
)
