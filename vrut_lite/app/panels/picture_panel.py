"""Exposure, tone map and white balance."""

from typing import Any, get_args

import msgspec
from PySide6.QtWidgets import QCheckBox, QPushButton, QWidget

from vrut_lite.app.engine.engine import Shown
from vrut_lite.app.engine.session import Session
from vrut_lite.app.panels.number_field import NumberField
from vrut_lite.app.widgets import Chooser, aligned_form, faint_label
from vrut_lite.messages.picture import HIGHEST_K, LOWEST_K, NightLook, SetExposure, ToneMap
from vrut_lite.quantities import COMPUTING

_TONE_TITLES = {
    "agx": "AgX, like film",
    "exponential": "1 \N{MINUS SIGN} exp(\N{MINUS SIGN}kL), as in papers",
    "none": "none, cut off at white",
}
_NIGHT_TITLES = {"eye": "as the eye sees", "exposure": "as a long exposure"}
_LOWEST_EV, _HIGHEST_EV = -11.0, 24.0


class PicturePanel(QWidget):
    """Edits `SetExposure`; all fields are sent together.

    A lock is manual exposure, which starts at the value of the shown picture.
    """

    def __init__(self, session: Session):
        super().__init__()
        self._session = session
        self._wish = SetExposure()
        self.lock = QCheckBox("locked")
        self.meter = QPushButton("Meter now")
        self.ev100 = NumberField(_LOWEST_EV, _HIGHEST_EV, "EV", decimals=2)
        self.compensation_ev = NumberField(-5.0, 5.0, "EV", decimals=2)
        self.tone_map = Chooser()
        for name in get_args(ToneMap):
            self.tone_map.addItem(_TONE_TITLES[name], name)
        self.night_look = Chooser()
        for name in get_args(NightLook):
            self.night_look.addItem(_NIGHT_TITLES[name], name)
        self.glare = NumberField(0.0, 1.0, decimals=2)
        self.white_temperature_k = NumberField(LOWEST_K, HIGHEST_K, "K", whole=True)
        self.white_duv = NumberField(-0.05, 0.05, decimals=4)
        self.metered = faint_label(f"exposure: {COMPUTING}", wraps=True)
        self.reset = QPushButton("Reset")
        self._lay_out()
        self._connect()
        session.listen(SetExposure, self._show)
        session.picture_shown.connect(self._show_metered)

    def _lay_out(self) -> None:
        form = aligned_form(self)
        form.setContentsMargins(10, 10, 10, 10)
        for title, part, tip in (
            ("Exposure", self.lock, "Keep EV100 (L). Unlocked, a new scene, hour or view sets "
             "it; playing time and settings do not"),
            ("EV100", self.ev100, "Fixed exposure value at ISO 100 (ISO 12232, saturation based)"),
            ("Compensation", self.compensation_ev, "Brighter by so many stops"),
            ("Tone map", self.tone_map, "AgX (Sobotka 2022), 1 - exp(-kL) (Bruneton and Neyret "
             "2008), or none"),
            ("Night", self.night_look, "Dark, without colour and detail (Ward Larson 1997), or "
             "brighter, in its colours"),
            ("Glare", self.glare, "Light that an eye scatters around what is bright, 1 all of it "
             "(CIE 146:2002); in finished pictures"),
            ("White", self.white_temperature_k, "Daylight of this colour temperature is shown "
             "white (CIE 15, Bradford)"),
            ("Green or pink", self.white_duv, "Of the white: greener above 0, pinker below (Duv in "
             "CIE 1960 u, v)"),
        ):  # fmt: skip
            part.setToolTip(tip)
            part.setAccessibleName(title)
            form.addRow(title, part)
        self.meter.setToolTip("Meter the picture that is shown (M)")
        form.addRow("", self.metered)
        form.addRow("", self.meter)
        form.addRow("", self.reset)

    def _connect(self) -> None:
        self.lock.clicked.connect(self.set_locked)
        self.meter.clicked.connect(self._session.meter_exposure)
        self.tone_map.activated.connect(lambda _: self._send(tone_map=self.tone_map.currentData()))
        self.night_look.activated.connect(
            lambda _: self._send(night_look=self.night_look.currentData())
        )
        for name in ("ev100", "compensation_ev", "glare", "white_temperature_k", "white_duv"):
            field: NumberField = getattr(self, name)
            field.edited.connect(lambda value, name=name: self._send(**{name: value}))
        self.reset.clicked.connect(lambda: self._session.send(SetExposure()))

    def set_locked(self, locked: bool) -> None:
        """Fix the exposure at the shown picture's, or make it automatic again."""
        shown = self._session.shown
        if locked and shown is not None:
            ev100 = shown.picture.ev100 + self._wish.compensation_ev
            self._send(mode="manual", ev100=round(ev100, 2))
        else:
            self._send(mode="manual" if locked else "auto")

    def _send(self, **changes: Any) -> None:
        self._wish = msgspec.structs.replace(self._wish, **changes)
        self._session.send(self._wish)

    def _show(self, wish: SetExposure) -> None:
        self._wish = wish
        locked = wish.mode == "manual"
        self.lock.setChecked(locked)
        self.meter.setEnabled(not locked)
        self.ev100.setEnabled(locked)
        self.tone_map.setCurrentIndex(self.tone_map.findData(wish.tone_map))
        self.night_look.setCurrentIndex(self.night_look.findData(wish.night_look))
        for name in ("ev100", "compensation_ev", "glare", "white_temperature_k", "white_duv"):
            getattr(self, name).show_value(getattr(wish, name))

    def _show_metered(self, shown: Shown) -> None:
        ev100 = shown.picture.ev100 + self._wish.compensation_ev
        held = ", held" if shown.held else ""
        self.metered.setText(f"picture exposed for EV100 {ev100:.2f}{held}")
        if self._wish.mode == "auto":
            self.ev100.show_value(ev100)
