"""The light under the pointer, and clicks on surfaces as messages for the modules."""

from PySide6.QtCore import QObject, Signal

from vrut_lite.app.engine.engine import Shown
from vrut_lite.app.engine.session import Session
from vrut_lite.app.engine.stage import Stage
from vrut_lite.app.widgets import make_timer
from vrut_lite.messages.picture import PictureClicked
from vrut_lite.numeric_types import vector
from vrut_lite.pictures.picture import PictureOnCard
from vrut_lite.quantities import luminance_text, lux_text
from vrut_lite.render.light_meter import Illuminance

# Seconds of rest of the pointer before lux is measured.
_STILL_MS = 120


class LightProbe(QObject):
    """`text` holds the picture's luminance and the surface's lux; `changed` emits a new text."""

    changed = Signal()

    def __init__(self, session: Session, parent: QObject | None = None):
        super().__init__(parent)
        self._session = session
        self._at: tuple[float, float] | None = None
        self._luminance = ""
        self._illuminance = ""
        self._asked = False
        self._measuring = make_timer(self, _STILL_MS, self._ask, once=True)
        session.picture_shown.connect(self._read)

    @property
    def text(self) -> str:
        """cd/m2, and lux on the surface; empty without a pointer."""
        parts = [self._luminance, self._illuminance] if self._at is not None else []
        # A picture of illuminance has said the first figure already.
        if self._luminance and self._illuminance.startswith(self._luminance):
            parts = parts[1:]
        return "   ".join(part for part in parts if part)

    def point_at(self, x: float, y: float) -> None:
        """Set the pointer, in shares of the picture's width and height."""
        self._at = (min(max(x, 0.0), 0.9999), min(max(y, 0.0), 0.9999))
        self._illuminance = ""
        if self._session.shown is not None:
            self._read(self._session.shown)
        self._measuring.start()

    def leave(self) -> None:
        """Remove the pointer."""
        self._at = None
        self._measuring.stop()
        self.changed.emit()

    def click(self) -> None:
        """Send `PictureClicked` for the surface under the pointer, if a module demands it."""
        at, shown = self._at, self._session.shown
        if at is None or shown is None:
            return
        height, width = shown.picture.display.shape[:2]
        radiance_rgb = shown.picture.radiance[int(at[1] * height), int(at[0] * width)]

        def send(stage: Stage) -> None:
            width, height = stage.state.size_px
            if stage.kernel.wanted(PictureClicked) is None:
                return
            hit = stage.surface_at_pixel(int(at[0] * width), int(at[1] * height))
            if hit is not None:
                stage.kernel.inject(
                    PictureClicked(
                        position_m=vector(hit.point_m),
                        normal=vector(hit.normal),
                        material=hit.material,
                        radiance_rgb=vector(radiance_rgb),
                    )
                )

        self._session.ask(send)

    def _read(self, shown: Shown) -> None:
        if self._at is None:
            return
        height, width = shown.picture.display.shape[:2]
        x, y = int(self._at[0] * width), int(self._at[1] * height)
        values = shown.picture.values
        if isinstance(shown.picture, PictureOnCard):
            # The window does not wait for the card: the finished picture has the figure.
            self._luminance = ""
        elif values is None:
            self._luminance = luminance_text(shown.picture.luminance_cd_m2(x, y))
        else:
            self._luminance = values.said_at(x, y)
        if shown.still:
            self._measuring.start()
        self.changed.emit()

    def _ask(self) -> None:
        """Measure the surface's illuminance; one question at a time."""
        if self._at is None or self._asked:
            return
        self._asked = True
        at = self._at

        def measure(stage: Stage) -> Illuminance | None:
            width, height = stage.state.size_px
            return stage.light_at_pixel(int(at[0] * width), int(at[1] * height))

        self._session.ask(
            measure, lambda light: self._take(at, light), lambda _: self._take(at, None)
        )

    def _take(self, at: tuple[float, float], light: Illuminance | None) -> None:
        self._asked = False
        if at != self._at:
            self._measuring.start()
            return
        self._illuminance = "" if light is None else illuminance_text(light)
        self.changed.emit()


def illuminance_text(light: Illuminance) -> str:
    """Lux, and how much of it comes from the sun, the sky and lamps where several shine."""
    parts = {"sun": light.sun_lux, "sky": light.sky_lux, "lamps": light.lamp_lux}
    shown = [f"{name} {lux_text(lux)}" for name, lux in parts.items() if lux > 0.0]
    if light.sun_lux <= 0.0 and light.lamp_lux <= 0.0:
        return lux_text(light.lux)
    return f"{lux_text(light.lux)} ({' + '.join(shown)})"
