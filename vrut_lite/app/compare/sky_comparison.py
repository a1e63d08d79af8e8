"""Two skies compared in the background, while the panel is seen."""

from functools import partial
from typing import NamedTuple

import msgspec
import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QObject, Signal

from vrut_lite.app.compare.two_skies import (
    SkyWish,
    TwoSkies,
    look_at_skies,
    luminance_ratios,
    meridian_luminance,
    spectra_along,
)
from vrut_lite.app.engine.module_catalogue import ModuleCatalogue, ModuleInfo
from vrut_lite.app.engine.preview_kernel import PreviewKernel
from vrut_lite.app.engine.session import Session
from vrut_lite.atmosphere.aerosol import LEAST_TURBIDITY, optical_depth_of_turbidity
from vrut_lite.errors import UserError
from vrut_lite.foreign_errors import sentence_of
from vrut_lite.geometry.panorama import fisheye_directions, sample_sky
from vrut_lite.kernel.messages import ClockMoved, SetClock, SettingChanged, SlotChanged
from vrut_lite.kernel.settings import SettingSpec
from vrut_lite.messages.ground import OWN_ALBEDOS, SetGround, ground_of
from vrut_lite.messages.haze import DEFAULT_HAZE, OWN_HAZE, SetHaze
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.scene import SceneOpened
from vrut_lite.messages.sky import SpectrumSeen
from vrut_lite.numeric_types import Vector
from vrut_lite.pictures.display import display_picture
from vrut_lite.pictures.exposure import automatic_ev100

SLOT = "sky"
HAZE = "haze"
DISC_SIZE = 192
ANGLES_DEG = np.linspace(-90.0, 90.0, 181)


class ComparedSkies(NamedTuple):
    """Two skies as shown: fisheyes (size, size, 3) at one exposure, and numbers.

    `meridian_cd_m2` holds (2, n) at `ANGLES_DEG`; `ratios` are those of `luminance_ratios`.
    """

    two: TwoSkies
    discs: tuple[NDArray[np.uint8], NDArray[np.uint8]]
    ev100: float
    meridian_cd_m2: NDArray[np.float64]
    ratios: tuple[float, float, float]


class Spectra(NamedTuple):
    """Spectra of two skies in a world direction; None of a sky without one."""

    direction: Vector
    seen: list[SpectrumSeen | None]


class SkyComparison(QObject):
    """Signals: `compared` (a `ComparedSkies`), then `spectra_seen` (a `Spectra`), which takes
    longer; `refused` (a line), `shared_changed` (name, value).

    Works only while it is active. `haze` is that of both skies, whatever their presets; `shared`
    are the other settings that both have by one name. Both get the same value, typed here or last
    set for the window's own sky; a new haze is emitted as `HAZE`.
    """

    compared = Signal(object)
    spectra_seen = Signal(object)
    shared_changed = Signal(str, float)
    refused = Signal(str)

    def __init__(self, session: Session, parent: QObject | None = None):
        super().__init__(parent)
        self.shared: dict[str, float] = {}
        self.haze = DEFAULT_HAZE
        self._session = session
        self._modules: tuple[str, str] | None = None
        self._direction: Vector = (0.0, 1.0, 0.0)
        self._active = False
        # The latest request and direction, and the request of the latest skies.
        self._asked: tuple[SkyWish, Vector] | None = None
        self._made: SkyWish | None = None
        session.listen(SettingChanged, self._setting_changed)
        session.listen(SetHaze, self._follow_haze)
        session.listen(SetGround, lambda _: self._ground_changed())
        session.listen(SceneOpened, lambda _: self._ground_changed())
        for kind in (SlotChanged, SetPlace, ClockMoved):
            session.listen(kind, lambda _: self._look())
        session.closing.connect(self.close)

    def set_active(self, active: bool) -> None:
        """Whether the panel is visible."""
        self._active = active
        self._look()

    def choose(self, left: ModuleInfo, right: ModuleInfo) -> list[SettingSpec]:
        """Compare these modules' skies; returns the settings that both have."""
        self._modules = (left.name, right.name)
        specs = shared_settings(left, right)
        self.shared = {spec.name: self._value_of(spec, left, right) for spec in specs}
        own = (module.values.get(OWN_HAZE) for module in (left, right))
        said = (self._haze(turbidity) for turbidity in own if isinstance(turbidity, float))
        self.haze = next(said, self._set)
        self._look()
        return specs

    def share(self, name: str, value: float) -> None:
        """Set a setting of both skies, or their haze by its optical depth."""
        if name == HAZE:
            self.haze = msgspec.structs.replace(self.haze, optical_depth_550=value)
        else:
            self.shared[name] = value
        self._look()

    def look_along(self, direction: Vector) -> None:
        """Ask for the spectra of a direction."""
        self._direction = direction
        self._look()

    def close(self) -> None:
        """Stop comparing."""
        self._active, self._asked = False, None

    @property
    def _set(self) -> SetHaze:
        """The window's haze."""
        return self._session.last(SetHaze) or DEFAULT_HAZE

    def _haze(self, turbidity: float) -> SetHaze:
        """The window's haze, of this turbidity."""
        depth = float(optical_depth_of_turbidity(turbidity))
        return msgspec.structs.replace(self._set, optical_depth_550=depth)

    def _follow_haze(self, haze: SetHaze) -> None:
        self.haze = haze
        self.shared_changed.emit(HAZE, haze.optical_depth_550)
        self._look()

    def _setting_changed(self, message: SettingChanged) -> None:
        ours = message.module in (self._modules or ())
        if ours and message.name == OWN_HAZE:
            self._follow_haze(self._set if message.value is None else self._haze(message.value))
            return
        if ours and message.name in self.shared:
            value = message.value
            if value is None:
                module = self._session.catalogue.modules[message.module]
                value = self._left_open(module).get(message.name)
            if value is not None:
                self.shared[message.name] = float(value)
                self.shared_changed.emit(message.name, self.shared[message.name])
        self._look()

    def _value_of(self, spec: SettingSpec, *modules: ModuleInfo) -> float:
        """The value of a setting in the window, or what it stands for."""
        open_values = (self._left_open(module).get(spec.name) for module in modules)
        known = (*(module.values[spec.name] for module in modules), *open_values, spec.default)
        value = next((v for v in known if v is not None), None)
        return float(value) if isinstance(value, (int, float)) else float(spec.at_least or 0.0)

    def _left_open(self, module: ModuleInfo) -> dict[str, object]:
        return module.left_open(self._set, ground_of(self._session))

    def _ground_changed(self) -> None:
        """Skies whose settings leave the albedo open have that of another ground."""
        if self._modules is not None:
            modules = self._session.catalogue.modules
            left, right = (modules[name] for name in self._modules)
            for spec in shared_settings(left, right):
                if spec.name in OWN_ALBEDOS:
                    self.shared[spec.name] = self._value_of(spec, left, right)
                    self.shared_changed.emit(spec.name, self.shared[spec.name])
        self._look()

    def _look(self) -> None:
        place, clock = self._session.last(SetPlace), self._session.last(ClockMoved)
        if not self._active or self._modules is None or place is None or clock is None:
            return
        catalogue = self._session.catalogue
        # As a number, since a preset's own haze would differ.
        alike = {**self.shared, OWN_HAZE: max(self.haze.turbidity, LEAST_TURBIDITY)}
        settings = {key: alike.get(key[1], value) for key, value in catalogue.settings_of().items()}
        wish = SkyWish(
            modules=self._modules,
            sun=catalogue.holders.get("sun", ""),
            place=place,
            clock=SetClock(instant=clock.instant),
            haze=self.haze,
            settings=settings,
            shared=dict(self.shared),
        )
        asked = (wish, self._direction)
        if asked != self._asked:
            self._asked = asked
            for question in (self._compare, self._see_spectra):
                self._session.look_up(
                    partial(question, asked), self._take, partial(self._refuse, asked)
                )

    def _compare(
        self, asked: tuple[SkyWish, Vector], second: PreviewKernel
    ) -> ComparedSkies | None:
        """On the second kernel's thread: both skies, unless they exist or others were requested."""
        wish, _ = asked
        if asked is not self._asked or wish == self._made:
            return None
        self._made = None
        try:
            answer = compared(look_at_skies(second, wish))
        except UserError:
            raise
        except Exception as error:
            raise UserError(f"the skies cannot be compared: {sentence_of(error)}") from error
        self._made = wish
        return answer

    def _see_spectra(self, asked: tuple[SkyWish, Vector], second: PreviewKernel) -> Spectra | None:
        """On the same thread: the spectra of the latest skies."""
        wish, direction = asked
        if asked is not self._asked or wish != self._made:
            return None
        return Spectra(direction, spectra_along(second, wish, direction))

    def _take(self, answer: ComparedSkies | Spectra | None) -> None:
        if isinstance(answer, ComparedSkies):
            self.compared.emit(answer)
        elif answer is not None:
            self.spectra_seen.emit(answer)

    def _refuse(self, asked: tuple[SkyWish, Vector], line: str) -> None:
        if asked is self._asked:
            self.refused.emit(line)


def compared(two: TwoSkies) -> ComparedSkies:
    """Pictures and numbers of two skies."""
    directions, inside = fisheye_directions(DISC_SIZE, two.wish.place.north_offset_rad)
    discs = [sample_sky(look.cube, directions) * inside[..., None] for look in two.looks]
    ev100 = automatic_ev100(discs[0][inside])
    left, right = (display_picture(disc, ev100).astype(np.uint8) for disc in discs)
    meridian = [meridian_luminance(look.cube, two.sun, ANGLES_DEG) for look in two.looks]
    return ComparedSkies(two, (left, right), ev100, np.array(meridian), luminance_ratios(two))


def shared_settings(left: ModuleInfo, right: ModuleInfo) -> list[SettingSpec]:
    """Numeric settings that two modules have by the same name, but for the haze; described by one
    with a default."""
    return [spec for spec in _alike(left, right) if spec.name != OWN_HAZE]


def _alike(left: ModuleInfo, right: ModuleInfo) -> list[SettingSpec]:
    both = [
        (spec, right.specs[name])
        for name, spec in left.specs.items()
        if name in right.specs and spec.type is float and right.specs[name].type is float
    ]
    return [next((s for s in pair if s.default is not None), pair[0]) for pair in both]


def comparable(catalogue: ModuleCatalogue) -> list[ModuleInfo]:
    """The modules with a sky that share a setting with another sky."""
    skies = catalogue.providers(SLOT)
    return [
        module
        for module in skies
        if any(_alike(module, other) for other in skies if other is not module)
    ]
