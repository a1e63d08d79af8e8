"""The panel of the light map: how far its bake is, what it costs, and the map in false colours.

The window imports it by the entry point `vrut_lite.panels`; nothing else here imports Qt.
"""

from functools import partial
from typing import NamedTuple

from PySide6.QtGui import QShowEvent
from PySide6.QtWidgets import QLabel, QProgressBar, QWidget

from light_transport.drawing.mapped_scene import FewerRaysLight
from light_transport.false_colours import (
    FalseColours,
    density_picture,
    error_picture,
    light_picture,
)
from light_transport.messages import NAME, BakeGrown
from light_transport.module import HOUR, LAYOUT, RAYS
from vrut_lite.messages.light_map import LightMapLaid, SurfaceLightChanged
from vrut_lite.messages.scene import SceneOpened
from vrut_lite.panel_kit import (
    Chooser,
    FittedPicture,
    Legend,
    Session,
    Stage,
    faint_label,
    panel_column,
)
from vrut_lite.quantities import lux_text, percent_text, with_unit

_NOTHING = "No light map yet: the scene is lit by the open sky."
_LIGHT, _SIZE, _ERROR = "Light", "Texel size", "Error"
# Meaning of each picture, and the format of its values.
_MEANINGS = {
    _LIGHT: ("illuminance without the sun's or moon's own", lux_text),
    _SIZE: ("edge of the texels", lambda edge_m: with_unit(edge_m, "m")),
    _ERROR: ("noise that the rays leave, of the light there", percent_text),
}


class ShownLightMap(NamedTuple):
    """A picture of the map, the seconds that the jobs behind it took, and the last two lights of
    one hour, by many rays and by fewer."""

    picture: FalseColours | None
    bake_s: float
    hour_s: float
    pair: tuple[SurfaceLightChanged, SurfaceLightChanged] | None = None


class LightMapPanel(QWidget):
    """Shows the latest map while it is visible; the pictures are made off Qt's thread."""

    title = "Light map"
    keys = "B"
    advanced = True

    def __init__(self, session: Session):
        super().__init__()
        self._session = session
        self.shown: ShownLightMap | None = None
        self._grown: BakeGrown | None = None
        self._light: SurfaceLightChanged | None = None
        # The latest light that more rays made of the same hour, and that of fewer.
        self._pair: tuple[SurfaceLightChanged, SurfaceLightChanged] | None = None
        self.progress = QProgressBar()
        self.progress.setFormat("%p %")
        self.facts = QLabel(_NOTHING)
        self.facts.setWordWrap(True)
        self.kind = Chooser()
        self.kind.addItems([_LIGHT, _SIZE, _ERROR])
        self.kind.setAccessibleName("what the picture of the light map shows")
        self.kind.currentIndexChanged.connect(self._renew)
        self.view = FittedPicture("light map", (320, 320), smooth=False)
        self.legend = Legend()
        self.meaning = faint_label("", wraps=True)
        column = panel_column(self)
        for part in (self.progress, self.facts, self.kind, self.view, self.legend, self.meaning):
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
        # The first rays are traced before their layout is posted.
        if self._grown is not None and self._grown.layout_key != message.layout_key:
            self._grown = None
        self._light = self._pair = None
        self._renew()

    def _was_lit(self, message: SurfaceLightChanged) -> None:
        self._light = message
        self._renew()

    def _renew(self) -> None:
        if self.isVisible():
            question = partial(_shown, self.kind.currentText(), self._light, self._pair)
            self._session.ask(question, self._show)

    def _show(self, shown: ShownLightMap) -> None:
        self.shown, self._pair = shown, shown.pair
        grown, light, picture = self._grown, self._light, shown.picture
        self.progress.setRange(0, grown.rays_wanted if grown is not None else 1)
        self.progress.setValue(grown.rays if grown is not None else 0)
        self.view.show_pixels(None if picture is None else picture.pixels)
        self._explain(picture)
        if grown is None or light is None:
            self.facts.setText(_NOTHING)
            return
        megabytes = (grown.table_bytes + light.texels.values.nbytes) / 1e6
        self.facts.setText(
            f"{grown.texels:,} texels, {grown.rays:,} of {grown.rays_wanted:,} rays each, "
            f"{megabytes:,.0f} MB; bake {shown.bake_s:.1f} s, hour {1e3 * shown.hour_s:,.0f} ms"
        )

    def _explain(self, picture: FalseColours | None) -> None:
        meaning, said = _MEANINGS[self.kind.currentText()]
        if picture is None or not picture.high:
            self.legend.show_values([])
            self.meaning.setText("nothing to show yet")
            return
        middle = (picture.low * picture.high) ** 0.5
        self.legend.show_values([said(value) for value in (picture.low, middle, picture.high)])
        self.meaning.setText(meaning)


def _shown(
    kind: str,
    light: SurfaceLightChanged | None,
    pair: tuple[SurfaceLightChanged, SurfaceLightChanged] | None,
    stage: Stage,
) -> ShownLightMap:
    """On the engine's thread; the scene's state knows two lights of one hour, if any does."""
    kernel, state = stage.kernel, stage.state
    present, fewer = state.shown(SurfaceLightChanged), state.shown(FewerRaysLight)
    if present is not None and fewer is not None:
        pair = present, fewer.light
    laid, scene = kernel.last(LightMapLaid), kernel.last(SceneOpened)
    picture = None
    if kind == _LIGHT and light is not None:
        picture = light_picture(light)
    elif kind == _SIZE and laid is not None and scene is not None:
        if laid.content_key == scene.content_key:
            picture = density_picture(laid, scene)
    elif kind == _ERROR and pair is not None:
        picture = error_picture(*pair)
    return ShownLightMap(picture, *_seconds(stage), pair)


def _seconds(stage: Stage) -> tuple[float, float]:
    """Wall time of the bake since its layout began, and of its latest hour, from the trace."""
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
