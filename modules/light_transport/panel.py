"""The panel of the light map: how far its bake is, what it costs, and the map in false colours.

The window imports it by the entry point `vrut_lite.panels`; nothing else here imports Qt.
"""

from functools import partial
from typing import NamedTuple

from PySide6.QtCore import QRect, QSize, Qt
from PySide6.QtGui import QColor, QImage, QPainter, QPaintEvent, QShowEvent
from PySide6.QtWidgets import QComboBox, QLabel, QProgressBar, QSizePolicy, QVBoxLayout, QWidget

from light_transport.false_colours import (
    FalseColours,
    density_picture,
    error_picture,
    light_picture,
)
from light_transport.messages import NAME, BakeGrown
from light_transport.module import HOUR, LAYOUT, RAYS
from vrut_lite.app import theme
from vrut_lite.app.engine.session import Session
from vrut_lite.app.engine.stage import Stage
from vrut_lite.app.widgets import faint_label, rgb_image
from vrut_lite.daylight.light_map import LightMapLaid, SurfaceLightChanged
from vrut_lite.daylight.scene import SceneOpened

_NOTHING = "No light map: the scene is lit by the open sky."
_LIGHT, _SIZE, _ERROR = "Light", "Texel size", "Error"


class Shown(NamedTuple):
    """A picture of the map, and the seconds that the jobs behind it took."""

    picture: FalseColours | None
    bake_s: float
    hour_s: float


class LightMapPanel(QWidget):
    """Shows the latest map while it is visible; the pictures are made off Qt's thread."""

    title = "Light map"
    keys = "B"

    def __init__(self, session: Session):
        super().__init__()
        self._session = session
        self.shown: Shown | None = None
        self._grown: BakeGrown | None = None
        self._light: SurfaceLightChanged | None = None
        # The light by half the rays, as soon as there is one.
        self._coarser: SurfaceLightChanged | None = None
        self.progress = QProgressBar()
        self.facts = QLabel(_NOTHING)
        self.facts.setWordWrap(True)
        self.kind = QComboBox()
        self.kind.addItems([_LIGHT, _SIZE, _ERROR])
        self.kind.setAccessibleName("what the picture of the light map shows")
        self.kind.currentIndexChanged.connect(self._renew)
        self.view = _View()
        self.scale = faint_label("", wraps=True)
        column = QVBoxLayout(self)
        column.setContentsMargins(10, 8, 8, 10)
        for part in (self.progress, self.facts, self.kind, self.view, self.scale):
            column.addWidget(part, 1 if part is self.view else 0)
        session.listen(BakeGrown, self._grew)
        session.listen(LightMapLaid, self._was_laid)
        session.listen(SurfaceLightChanged, self._was_lit)

    def showEvent(self, event: QShowEvent) -> None:
        """Show the map as it is now."""
        self._renew()

    def _grew(self, message: BakeGrown) -> None:
        self._grown = message

    def _was_laid(self, message: LightMapLaid) -> None:
        self._grown = self._light = self._coarser = None
        self._renew()

    def _was_lit(self, message: SurfaceLightChanged) -> None:
        if self._light is not None and message.rays != self._light.rays:
            self._coarser = self._light
        self._light = message
        self._renew()

    def _renew(self) -> None:
        if self.isVisible():
            question = partial(_shown, self.kind.currentText(), self._light, self._coarser)
            self._session.ask(question, self._show)

    def _show(self, shown: Shown) -> None:
        self.shown = shown
        grown, light, picture = self._grown, self._light, shown.picture
        self.progress.setRange(0, grown.rays_wanted if grown is not None else 1)
        self.progress.setValue(grown.rays if grown is not None else 0)
        self.view.show_picture(picture)
        self.scale.setText("" if picture is None else self._scale_text(picture))
        if grown is None or light is None:
            self.facts.setText(_NOTHING)
            return
        megabytes = (grown.table_bytes + light.texels.values.nbytes) / 1e6
        self.facts.setText(
            f"{grown.texels:,} texels, {grown.rays} of {grown.rays_wanted} rays each, "
            f"{megabytes:.0f} MB; bake {shown.bake_s:.1f} s, hour {1e3 * shown.hour_s:.0f} ms"
        )

    def _scale_text(self, picture: FalseColours) -> str:
        if not picture.high:
            return "nothing to show yet"
        if self.kind.currentText() == _LIGHT:
            return f"dark to bright: {picture.low:.3g} to {picture.high:.3g} lx"
        if self.kind.currentText() == _SIZE:
            return f"dark to bright: {picture.low:.3g} to {picture.high:.3g} m a texel"
        return f"dark to bright: {picture.low:.2%} to {picture.high:.2%} by twice the rays"


def _shown(
    kind: str, light: SurfaceLightChanged | None, coarser: SurfaceLightChanged | None, stage: Stage
) -> Shown:
    """On the engine's thread."""
    kernel = stage.kernel
    laid, scene = kernel.last(LightMapLaid), kernel.last(SceneOpened)
    picture = None
    if kind == _LIGHT and light is not None:
        picture = light_picture(light)
    elif kind == _SIZE and laid is not None and scene is not None:
        if laid.content_key == scene.content_key:
            picture = density_picture(laid, scene)
    elif kind == _ERROR and light is not None and coarser is not None:
        picture = error_picture(light, coarser)
    return Shown(picture, *_seconds(stage))


def _seconds(stage: Stage) -> tuple[float, float]:
    """What the bake took since its layout began, and its latest hour: wall time, by the trace."""
    bake_ns = hour_ns = 0
    for remark in stage.kernel.trace.remarks():
        if remark.kind == "job" and remark.module == NAME:
            took_ns = remark.end_ns - remark.start_ns
            if remark.text == LAYOUT:
                bake_ns = took_ns
            elif remark.text == RAYS:
                bake_ns += took_ns
            elif remark.text == HOUR:
                hour_ns = took_ns
    return bake_ns / 1e9, hour_ns / 1e9


class _View(QWidget):
    """A picture, as large as there is room, texels with sharp edges."""

    def __init__(self) -> None:
        super().__init__()
        self._image: QImage | None = None
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self.setAccessibleName("light map")

    def sizeHint(self) -> QSize:
        """A small square."""
        return QSize(320, 320)

    def show_picture(self, picture: FalseColours | None) -> None:
        """Show it, or nothing."""
        self._image = None if picture is None else rgb_image(picture.pixels)
        self.update()

    def paintEvent(self, event: QPaintEvent) -> None:
        """The picture, unstretched."""
        painter = QPainter(self)
        painter.fillRect(self.rect(), QColor(theme.BACKGROUND))
        if self._image is not None:
            size = self._image.size().scaled(self.size(), Qt.AspectRatioMode.KeepAspectRatio)
            place = QRect(0, 0, size.width(), size.height())
            place.moveCenter(self.rect().center())
            painter.drawImage(place, self._image)
