"""Undo and redo, from the inputs as the kernel admits them.

A step holds inputs that were sent together, or inputs of one control in quick succession, as a
dragged slider sends them. Undo sends inputs too: journals contain it and replays repeat it.
"""

from collections import OrderedDict, deque
from collections.abc import Callable
from itertools import count
from time import perf_counter
from typing import NamedTuple

import msgspec

from vrut_lite.app.setting_words import label_of, value_text
from vrut_lite.errors import UserError
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import ChooseSlot, EnableModule, Input, SetClock, SetSetting
from vrut_lite.kernel.settings import describe
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.placement import Placement
from vrut_lite.messages.scene import LoadScene
from vrut_lite.project import PROJECT_PARTS

GESTURE_S = 0.6
_MOST_STEPS = 500
_MOST_EXPECTED = 1000
# Step numbers of inputs that undo or redo sent, and of those that clear the history.
_OWN, _BEGINNING = 0, -1
_ELSEWHERE: set[type[Input]] = {SetPlace, SetClock}
Key = tuple[type[Input], str | None]
Pair = tuple[Input, Input]


class Steps(NamedTuple):
    """Titles of the steps that can be undone and redone, or empty."""

    undo: str = ""
    redo: str = ""


class _Step:
    def __init__(self, act: int):
        self.act = act
        self.last_s = 0.0
        self.pairs: dict[Key, Pair] = {}
        self._titles: dict[Key, str] = {}

    def add(self, key: Key, forth: Input, back: Input, title: str, now_s: float) -> None:
        """Add an input; a key keeps its first inverse and its last input."""
        first = self.pairs.pop(key, (forth, back))[1]
        self.pairs[key], self._titles[key] = (forth, first), title
        self.last_s = now_s

    @property
    def title(self) -> str:
        """The step's title in a menu."""
        kinds = {kind for kind, _ in self.pairs}
        if kinds == _ELSEWHERE:
            # The clock goes along, so that it shows the same hour there.
            return next(self._titles[key] for key in self.pairs if key[0] is SetPlace)
        titles = list(self._titles.values())
        return titles[0] if len(titles) == 1 else f"{len(titles)} changes"


class History:
    """The steps of a session; `expect` is called on the sending thread, all else on the kernel's.

    `changed` is called with the titles whenever they change.
    """

    def __init__(
        self, changed: Callable[[Steps], None], now_s: Callable[[], float] = perf_counter
    ) -> None:
        self._changed = changed
        self._now_s = now_s
        self._kernel: Kernel | None = None
        self._acts = count(1)
        # By identity (the input is kept so that its id stays its own), with the time of sending:
        # on a busy machine the inputs of one drag may be admitted far apart.
        self._expected: OrderedDict[int, tuple[Input, int, float]] = OrderedDict()
        self._done: deque[_Step] = deque(maxlen=_MOST_STEPS)
        self._undone: list[_Step] = []
        self._closed = True

    def expect(self, inputs: tuple[Input, ...], beginning: bool = False) -> None:
        """Note inputs as one act of the user; a `beginning` and all before it cannot be undone.

        Inputs that were not noted here are not the user's, and no undo covers them.
        """
        self._note(inputs, _BEGINNING if beginning else next(self._acts))

    def attach(self, kernel: Kernel) -> None:
        """Watch the inputs that this kernel admits."""
        self._kernel = kernel
        kernel.watch_admission(self._admitted)

    def undo(self) -> str:
        """Undo the last step; returns its title, or an empty text."""
        if not self._done:
            return ""
        step = self._done.pop()
        self._undone.append(step)
        self._send(back for _, back in reversed(step.pairs.values()))
        return step.title

    def redo(self) -> str:
        """Redo the step that was undone last; returns its title, or an empty text."""
        if not self._undone:
            return ""
        step = self._undone.pop()
        self._done.append(step)
        self._send(forth for forth, _ in step.pairs.values())
        return step.title

    def _send(self, inputs: object) -> None:
        own: tuple[Input, ...] = tuple(inputs)  # type: ignore[arg-type]
        assert self._kernel is not None
        self._closed = True
        self._note(own, _OWN)
        self._kernel.inject(*own)
        self._tell()

    def _note(self, inputs: tuple[Input, ...], act: int) -> None:
        for message in inputs:
            self._expected[id(message)] = (message, act, self._now_s())
        # Forget the oldest: inputs that merged with a later one are never admitted.
        while len(self._expected) > _MOST_EXPECTED:
            self._expected.popitem(last=False)

    def _admitted(self, message: Input) -> None:
        _, act, sent_s = self._expected.pop(id(message), (message, _OWN, 0.0))
        if act == _BEGINNING:
            self._done.clear()
            self._undone.clear()
            self._tell()
            return
        assert self._kernel is not None
        back = inverse_of(message, self._kernel) if act != _OWN else None
        if back is not None:
            self._add(message, back, act, sent_s)

    def _add(self, forth: Input, back: Input, act: int, now_s: float) -> None:
        key: Key = (type(forth), forth.key())
        last = self._done[-1] if self._done and not self._closed else None
        if last is None or not _continues(last, key, act, now_s):
            last = _Step(act)
            self._done.append(last)
        self._closed = False
        assert self._kernel is not None
        last.add(key, forth, back, title_of(forth, self._kernel), now_s)
        self._undone.clear()
        self._tell()

    def _tell(self) -> None:
        self._changed(
            Steps(
                self._done[-1].title if self._done else "",
                self._undone[-1].title if self._undone else "",
            )
        )


def _continues(step: _Step, key: Key, act: int, now_s: float) -> bool:
    return step.act == act or (set(step.pairs) == {key} and now_s - step.last_s < GESTURE_S)


def title_of(message: Input, kernel: Kernel) -> str:
    """The title of a step with this input, which the kernel accepts."""
    match message:
        case SetSetting():
            settings = kernel.check_module(message.module).settings
            spec = describe(type(settings))[message.name]
            value = kernel.check_setting(message.module, message.name, message.value)
            return f"{label_of(spec)} {value_text(spec, value)}"
        case ChooseSlot():
            slot = message.slot.replace("_", " ")
            return f"{slot} by {kernel.check_module(message.module).manifest.title}"
        case EnableModule():
            title = kernel.check_module(message.module).manifest.title
            return f"{title} {'on' if message.enabled else 'off'}"
        case LoadScene():
            return "axis and unit of the scene"
    part = PROJECT_PARTS.get(type(message))
    return part.title.format(message) if part and part.title else type(message).__name__


def inverse_of(message: Input, kernel: Kernel) -> Input | None:
    """The input that restores the present state; called before the kernel acts on the message.

    None for an input that changes nothing, that will be refused, or of a kind without undo:
    views, scenes but for their axis and unit, and inputs that the user does not make.
    """
    try:
        message.check()
        back = _inverse(message, kernel)
        return None if back is None or back == _as_kept(message, kernel) else back
    except UserError:
        return None


def _inverse(message: Input, kernel: Kernel) -> Input | None:
    match message:
        case SetSetting():
            value = getattr(kernel.check_module(message.module).settings, message.name, None)
            return SetSetting(module=message.module, name=message.name, value=value)
        case ChooseSlot():
            kernel.check_holder(message.slot, message.module)
            holder = kernel.slots.holder(message.slot)
            able = holder and kernel.seats[message.module].running
            return ChooseSlot(slot=message.slot, module=holder) if able else None
        case EnableModule():
            running = kernel.check_module(message.module).running
            return EnableModule(module=message.module, enabled=running)
        case LoadScene():
            return _placed_otherwise(message, kernel)
    part = PROJECT_PARTS.get(type(message))
    return part.present(kernel) if part and part.title else None


def _placed_otherwise(message: LoadScene, kernel: Kernel) -> Input | None:
    """The open scene as it stands, if the message opens it again with an axis or a unit."""
    present = PROJECT_PARTS[LoadScene].present(kernel)
    if not isinstance(present, LoadScene) or message.placement == Placement():
        return None
    same = msgspec.structs.replace(message, placement=present.placement) == present
    return present if same else None


def _as_kept(message: Input, kernel: Kernel) -> Input:
    """The message with its value as the setting converts it."""
    if isinstance(message, SetSetting):
        value = kernel.check_setting(message.module, message.name, message.value)
        return SetSetting(module=message.module, name=message.name, value=value)
    return message
