"""Two skies compared in the background while someone looks, the latest wish first."""

from concurrent.futures import ThreadPoolExecutor
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QObject, Qt, Signal

from vrut_lite.app.hand_over import HandOver
from vrut_lite.app.roster import ModuleInfo, Roster
from vrut_lite.app.session import Session
from vrut_lite.app.twin_skies import (
    Settings,
    SkyWish,
    TwinSkies,
    TwoSkies,
    luminance_ratios,
    meridian_luminance,
)
from vrut_lite.daylight.place import SetPlace
from vrut_lite.daylight.sky import SpectrumSeen
from vrut_lite.errors import UserError
from vrut_lite.geometry.panorama import fisheye_directions, sample_sky
from vrut_lite.kernel.messages import ClockMoved, SetClock, SettingChanged, SlotChanged
from vrut_lite.kernel.settings import SettingSpec
from vrut_lite.numeric_types import Vector
from vrut_lite.pictures.display import display_picture
from vrut_lite.pictures.exposure import automatic_ev100

SLOT = "sky"
DISC_SIZE = 192
ANGLES_DEG = np.linspace(-90.0, 90.0, 181)


class Compared(NamedTuple):
    """What is shown of two skies: fisheyes (size, size, 3) exposed alike, and numbers.

    `meridian_cd_m2` holds (2, n) at `ANGLES_DEG`; `ratios` are those of `luminance_ratios`.
    """

    two: TwoSkies
    discs: tuple[NDArray[np.uint8], NDArray[np.uint8]]
    ev100: float
    meridian_cd_m2: NDArray[np.float64]
    ratios: tuple[float, float, float]


class Spectra(NamedTuple):
    """What two skies tell of a world direction; None of one that tells nothing."""

    direction: Vector
    seen: list[SpectrumSeen | None]


class SkyComparison(QObject):
    """Signals: `compared` (a `Compared`), then `spectra_seen` (a `Spectra`), which takes longer;
    `refused` (a line), `shared_changed` (name, value).

    Nothing is done while nobody looks. `shared` are the settings that both skies have by one
    name: what is compared is set alike, by hand or as the window's own sky was set last.
    """

    compared = Signal(object)
    spectra_seen = Signal(object)
    shared_changed = Signal(str, float)
    refused = Signal(str)
    _done = Signal(object, object)

    def __init__(self, session: Session, parent: QObject | None = None):
        super().__init__(parent)
        self.shared: dict[str, float] = {}
        self._session = session
        self._modules: tuple[str, str] | None = None
        self._sun = ""
        self._own: dict[tuple[str, str], object] = {}
        self._direction: Vector = (0.0, 1.0, 0.0)
        self._active = False
        # Of the latest wish and direction, and of the sky that was looked at last.
        self._asked: tuple[SkyWish, Vector] | None = None
        self._looked: SkyWish | None = None
        self._twin: TwinSkies | None = None
        self._thread: ThreadPoolExecutor | None = None
        self._tell = HandOver(self._done.emit)
        self._done.connect(self._take, Qt.ConnectionType.QueuedConnection)
        session.ready.connect(self._know)
        session.listen(SlotChanged, self._slot_changed)
        session.listen(SettingChanged, self._setting_changed)
        session.listen(SetPlace, lambda _: self._look())
        session.listen(ClockMoved, lambda _: self._look())
        session.closing.connect(self.close)

    def set_active(self, active: bool) -> None:
        """Whether someone looks."""
        self._active = active
        self._look()

    def choose(self, left: ModuleInfo, right: ModuleInfo) -> list[SettingSpec]:
        """Compare these modules' skies; what is set alike for both."""
        self._modules = (left.name, right.name)
        specs = shared_settings(left, right)
        self.shared = {spec.name: self._value_of(spec, left, right) for spec in specs}
        self._look()
        return specs

    def share(self, name: str, value: float) -> None:
        """Let every sky have this value."""
        self.shared[name] = value
        self._look()

    def look_along(self, direction: Vector) -> None:
        """Ask for the spectra of a direction."""
        self._direction = direction
        self._look()

    def close(self) -> None:
        """Compare no more."""
        self._active, self._asked = False, None
        self._tell.close()
        thread, self._thread = self._thread, None
        if thread is not None:
            thread.submit(self._close_twin)
            thread.shutdown(wait=False)

    def _close_twin(self) -> None:
        if self._twin is not None:
            self._twin.close()

    def _know(self, roster: Roster) -> None:
        self._sun = roster.holders.get("sun", "")
        self._own = {
            (info.name, name): value
            for info in roster.modules.values()
            for name, value in info.values.items()
        }

    def _value_of(self, spec: SettingSpec, *modules: ModuleInfo) -> float:
        """What one of the modules has in the window, or the default."""
        known = (self._own.get((module.name, spec.name)) for module in modules)
        value = next((v for v in known if v is not None), spec.default)
        return float(value) if isinstance(value, (int, float)) else float(spec.at_least or 0.0)

    def _slot_changed(self, message: SlotChanged) -> None:
        if message.name == "sun":
            self._sun = message.holder
            self._look()

    def _setting_changed(self, message: SettingChanged) -> None:
        self._own[message.module, message.name] = message.value
        ours = message.name in self.shared and message.module in (self._modules or ())
        if ours and message.value is not None:
            self.shared[message.name] = float(message.value)
            self.shared_changed.emit(message.name, self.shared[message.name])
        self._look()

    def _look(self) -> None:
        place, clock = self._session.last(SetPlace), self._session.last(ClockMoved)
        if not self._active or self._modules is None or place is None or clock is None:
            return
        settings = Settings(dict(self._own), dict(self.shared))
        now = SetClock(instant=clock.instant)
        asked = (SkyWish(self._modules, self._sun, place, now, settings), self._direction)
        if asked == self._asked:
            return
        self._asked = asked
        if self._thread is None:
            self._thread = ThreadPoolExecutor(1, "vrut-lite comparison")
        self._thread.submit(self._compare, asked)

    def _compare(self, asked: tuple[SkyWish, Vector]) -> None:
        """On the thread of its own: the skies, then the spectra, unless something else is asked."""
        if asked is not self._asked:
            return
        wish, direction = asked
        twin = self._opened()
        try:
            if wish != self._looked:
                self._looked = None
                self._tell(asked, compared(twin.look(wish)))
                self._looked = wish
            if asked is self._asked:
                self._tell(asked, Spectra(direction, twin.spectra(wish, direction)))
        except UserError as error:
            self._tell(asked, str(error))
        except Exception as error:
            line = f"the skies cannot be compared: {type(error).__name__}: {error}"
            self._tell(asked, line)

    def _opened(self) -> TwinSkies:
        if self._twin is None:
            self._twin = TwinSkies()
        return self._twin

    def _take(self, asked: object, answer: object) -> None:
        if isinstance(answer, Compared):
            self.compared.emit(answer)
        elif isinstance(answer, Spectra):
            self.spectra_seen.emit(answer)
        elif asked is self._asked:
            self.refused.emit(str(answer))


def compared(two: TwoSkies) -> Compared:
    """Pictures and numbers of two skies."""
    directions, inside = fisheye_directions(DISC_SIZE, two.wish.place.north_offset_rad)
    discs = [sample_sky(look.cube, directions) * inside[..., None] for look in two.looks]
    ev100 = automatic_ev100(discs[0][inside])
    left, right = (display_picture(disc, ev100).astype(np.uint8) for disc in discs)
    meridian = [meridian_luminance(look.cube, two.sun, ANGLES_DEG) for look in two.looks]
    return Compared(two, (left, right), ev100, np.array(meridian), luminance_ratios(two))


def shared_settings(left: ModuleInfo, right: ModuleInfo) -> list[SettingSpec]:
    """Numbers that two modules have by one name, as the one describes them that has a default."""
    both = [
        (spec, right.specs[name])
        for name, spec in left.specs.items()
        if name in right.specs and spec.type is float and right.specs[name].type is float
    ]
    return [next((s for s in pair if s.default is not None), pair[0]) for pair in both]


def comparable(roster: Roster) -> list[ModuleInfo]:
    """The modules with a sky that have a setting in common with another's."""
    skies = roster.providers(SLOT)
    return [
        module
        for module in skies
        if any(shared_settings(module, other) for other in skies if other is not module)
    ]
