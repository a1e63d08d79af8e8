"""The panel of the sky's polarisation: it is computed while the panel is seen.

The window imports it by the entry point `vrut_lite.panels`; nothing else here imports Qt.
"""

from functools import partial

import numpy as np
from PySide6.QtGui import QHideEvent, QShowEvent
from PySide6.QtWidgets import QLabel, QWidget

from bruneton_sky.polarisation_picture import SIZE_PX, PolarisationPicture, polarisation_picture
from vrut_lite.array import Array
from vrut_lite.kernel.messages import Demand
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.sky import BackgroundChanged, SkyPolarisationChanged
from vrut_lite.messages.sky_light import SkyLightChanged
from vrut_lite.messages.sun import SunMoved
from vrut_lite.panel_kit import FittedPicture, Legend, Session, faint_label, panel_column
from vrut_lite.quantities import COMPUTING, degrees_text, percent_text

_CONSUMER = "polarisation panel"
_UNKNOWN = (
    "This sky does not know how its light is polarised here. Clear sky (atmosphere) does, up to "
    "20 km."
)
_LEGEND = (
    "Degree of polarisation of the sky without sun. Bars lie along the vibration and are as long "
    "as the degree; rings mark neutral points, a disc the sun or moon. You look up: north is at "
    "the top, east on the left."
)


class PolarisationPanel(QWidget):
    """A fisheye of the degree of polarisation; the picture is made off Qt's thread."""

    title = "Polarisation"

    def __init__(self, session: Session):
        super().__init__()
        self._session = session
        self.shown: PolarisationPicture | None = None
        self._light: SkyLightChanged | None = None
        self._drawing = False
        self.facts = QLabel(COMPUTING)
        self.facts.setWordWrap(True)
        self.view = FittedPicture("polarisation of the sky", (SIZE_PX, SIZE_PX))
        self.legend = Legend()
        self.meaning = faint_label(_LEGEND, wraps=True)
        column = panel_column(self)
        for part in (self.facts, self.view, self.legend, self.meaning):
            column.addWidget(part, 1 if part is self.view else 0)
        column.addStretch()
        session.listen(SkyLightChanged, self._hear)

    def showEvent(self, event: QShowEvent) -> None:
        """Ask for the polarisation, and show it if it is there already."""
        self._demand(None)
        self._draw()

    def hideEvent(self, event: QHideEvent) -> None:
        """Take the demand back."""
        if not self._session.has_ended:
            self._demand(0)

    def _demand(self, size: int | None) -> None:
        """The radiance is asked for as an array: a texture cannot be read back."""
        polarised, light = SkyPolarisationChanged.__name__, BackgroundChanged.__name__
        self._session.send(
            Demand(consumer=_CONSUMER, message=polarised, size=size),
            Demand(consumer=_CONSUMER, message=light, size=size, encoding="float16"),
        )

    def _hear(self, light: SkyLightChanged) -> None:
        self._light = light
        self._draw()

    def _draw(self) -> None:
        """Draw the latest light; while a picture is drawn, the next one waits."""
        light = self._light
        if light is None or light.polarisation is None or self._drawing or not self.isVisible():
            return
        if light.polarisation.cube is None:
            self._show(light, None)
        elif isinstance(light.background.cube, Array):
            self._drawing = True
            place, sun = self._session.last(SetPlace), self._session.last(SunMoved)
            assert sun is not None
            north_rad = 0.0 if place is None else place.north_offset_rad
            self._session.look_up(
                lambda _: polarisation_picture(light, sun, north_rad),
                partial(self._show, light),
                self._fail,
            )

    def _fail(self, line: str) -> None:
        self._drawing = False
        self._session.problem.emit(line)

    def _show(self, light: SkyLightChanged, picture: PolarisationPicture | None) -> None:
        self._drawing, self.shown = False, picture
        known = picture is not None
        for part in (self.view, self.legend, self.meaning):
            part.setVisible(known)
        if picture is None:
            self.facts.setText(_UNKNOWN)
        else:
            self.view.show_pixels(picture.pixels)
            self.legend.show_values(
                [percent_text(share * picture.largest) for share in (0.0, 0.5, 1.0)]
            )
            self.facts.setText(_facts(picture))
        if light is not self._light:
            self._draw()


def _facts(picture: PolarisationPicture) -> str:
    places = ("above the sun", "below the sun", "above the point opposite the sun")
    points = [
        f"{name.capitalize()} {degrees_text(distance)} {place}"
        for name, distance, place in zip(
            picture.neutral._fields, picture.neutral, places, strict=True
        )
        if np.isfinite(distance)
    ]
    neutral = "; ".join(points) or "none above the horizon"
    return f"Zenith {percent_text(picture.zenith)}. Neutral points: {neutral}."
