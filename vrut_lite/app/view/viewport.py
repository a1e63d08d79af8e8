"""The picture, and the camera in the user's hands.

Frames are drawn on the GL owner's thread and arrive as images. A `QOpenGLWidget` would draw on Qt's
thread: with a software renderer a frame takes some hundred milliseconds, during which no slider
would move. Modules' GPU jobs would then need a second, shared context. The frame is read back in
any case, for its exposure.
"""

from copy import copy
from enum import Enum
from pathlib import Path
from time import perf_counter

import numpy as np
from PySide6.QtCore import QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import (
    QColor,
    QDragEnterEvent,
    QDropEvent,
    QFocusEvent,
    QImage,
    QKeyEvent,
    QMouseEvent,
    QPainter,
    QPaintEvent,
    QResizeEvent,
    QWheelEvent,
)
from PySide6.QtWidgets import QSizePolicy, QWidget

from vrut_lite.app import theme
from vrut_lite.app.engine.engine import Shown
from vrut_lite.app.engine.session import Session
from vrut_lite.app.view.camera_rig import CameraRig, height_text
from vrut_lite.app.view.compass import Compass
from vrut_lite.app.view.light_probe import LightProbe
from vrut_lite.app.view.loading import Loading
from vrut_lite.app.view.sun_path import SunPath
from vrut_lite.app.view.surroundings import Surroundings
from vrut_lite.app.widgets import make_timer, rgb_image
from vrut_lite.daylight.camera import MoveCamera, frame_bounds, pixel_rays
from vrut_lite.daylight.picture import Resize
from vrut_lite.daylight.scene import SceneOpened
from vrut_lite.scene.scene_files import SUFFIXES

SCENE_SUFFIXES = (*SUFFIXES, ".toml")
_INVITATION = "Drop a glTF or OBJ file here, or open one with Ctrl+O"
_SETTLED_MS, _FLIGHT_MS = 60, 16
_SMALLEST_PX = 16
# A press that moves farther is a drag.
_CLICK_PX = 3
_MOST_FLIGHT_S = 0.1


class CameraMode(Enum):
    """The camera's modes, each with a hint for the mouse."""

    ORBIT = "drag to turn (among walls: to look around), right drag to shift, wheel to go nearer"
    FLY = "drag to look, W A S D to fly, Q E down and up, Shift faster, wheel for the view's angle"
    SPACE = "wheel to climb, drag to look around"


class Viewport(QWidget):
    """Signals: `scene_dropped` (a file's path), `mode_changed` (a `CameraMode`), `sky_pointed`.

    `sky_pointed` emits the world direction under the pointer, if it is above the horizon.
    """

    scene_dropped = Signal(str)
    mode_changed = Signal(object)
    sky_pointed = Signal(object)

    def __init__(self, session: Session, sun_path: SunPath, compass: Compass):
        super().__init__()
        self._session = session
        self.rig = CameraRig()
        self.mode = CameraMode.ORBIT
        self.probe = LightProbe(session, self)
        self.loading = Loading(session, self)
        self._sun_path, self._compass = sun_path, compass
        self._image: QImage | None = None
        self._sent: MoveCamera | None = None
        self._scene: SceneOpened | None = None
        self._held: set[Qt.Key] = set()
        self._surroundings: Surroundings | None = None
        # Whether this drag looks around, since the eye stands among walls.
        self._looks_around = False
        self._grip: QPointF | None = None
        self._pressed: QPointF | None = None
        self._flew_s = 0.0
        self._resized = make_timer(self, _SETTLED_MS, self._send_size, once=True)
        self._flight = make_timer(self, _FLIGHT_MS, self._fly_on)
        self.setAcceptDrops(True)
        self.setMouseTracking(True)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self.setMinimumSize(160, 120)
        self.setAttribute(Qt.WidgetAttribute.WA_OpaquePaintEvent)
        self.setAccessibleName("picture")
        session.picture_shown.connect(self._show_picture)
        session.camera_moved.connect(self._adopt)
        session.listen(SceneOpened, self._note_scene)
        sun_path.changed.connect(self.update)
        compass.changed.connect(self.update)
        self.probe.changed.connect(self.update)
        self.loading.changed.connect(self._move_loading)

    def sizeHint(self) -> QSize:
        """As large as there is room."""
        return QSize(960, 640)

    @property
    def pixels(self) -> tuple[int, int]:
        """Width and height of a full picture."""
        ratio = self.devicePixelRatioF()
        return (
            max(_SMALLEST_PX, round(self.width() * ratio)),
            max(_SMALLEST_PX, round(self.height() * ratio)),
        )

    @property
    def camera(self) -> MoveCamera:
        """The present camera."""
        return self._sent or self.rig.camera()

    def set_mode(self, mode: CameraMode) -> None:
        """Switch to another mode."""
        self.mode = mode
        self._held.clear()
        self._flight.stop()
        self.mode_changed.emit(mode)
        self.update()

    def frame_scene(self) -> None:
        """See all of the scene, from the south-west."""
        if self._scene is not None:
            width, height = self.pixels
            framed = frame_bounds(self._scene.lower_m, self._scene.upper_m, width / height)
            self.rig.adopt(framed)
            self.send_camera()

    def go_to(self, camera: MoveCamera) -> None:
        """Look as another camera does."""
        self.rig.adopt(camera)
        self.send_camera()

    def send_camera(self) -> None:
        """Send the rig's camera."""
        self._sent = self.rig.camera()
        self._session.send(self._sent)

    # --- messages ----------------------------------------------------------------------------

    def _show_picture(self, shown: Shown) -> None:
        self._image = rgb_image(shown.picture.display)
        self.update()

    def _note_scene(self, scene: SceneOpened) -> None:
        self._scene, self._surroundings = scene, None
        self._session.look_up(lambda _: (scene, Surroundings(scene)), self._take_surroundings)

    def _take_surroundings(self, found: tuple[SceneOpened, Surroundings]) -> None:
        if found[0] is self._scene:
            self._surroundings = found[1]

    def _adopt(self, camera: MoveCamera) -> None:
        """Take over the camera of a scene or a project; not the echo of our own."""
        if self._grip is not None or self._held or camera == self._sent:
            return
        self._sent = camera
        centre = None
        if self._scene is not None:
            centre = 0.5 * (np.array(self._scene.lower_m) + np.array(self._scene.upper_m))
        self.rig.adopt(camera, centre)
        self.update()

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Resize the picture when the window's size has settled."""
        self._resized.start()

    def _send_size(self) -> None:
        width, height = self.pixels
        self._session.send(Resize(width_px=width, height_px=height))

    def _move_loading(self) -> None:
        """Paint again only what moves, or all when it ends."""
        if self.loading.is_on:
            self.update(self.loading.region(QRectF(self.rect())).toAlignedRect())
        else:
            self.update()

    # --- by mouse ----------------------------------------------------------------------------

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Begin to drag, or to click."""
        self._grip = self._pressed = event.position()
        self._looks_around = self._is_enclosed()
        self.probe.leave()

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Move the camera, or read the light under the pointer."""
        if self._grip is None:
            self._point(event.position())
            self._tell_direction(event.position())
            return
        way = (event.position() - self._grip) / max(1, self.height())
        self._grip = event.position()
        shifting = event.buttons() & (Qt.MouseButton.RightButton | Qt.MouseButton.MiddleButton) or (
            event.modifiers() & Qt.KeyboardModifier.ShiftModifier
        )
        self._drag(way.x(), -way.y(), bool(shifting))

    def _point(self, spot: QPointF) -> None:
        self.probe.point_at(spot.x() / self.width(), spot.y() / self.height())

    def _tell_direction(self, spot: QPointF) -> None:
        size = (self.width(), self.height())
        x, y, z = pixel_rays(self.camera, size, int(spot.x()), int(spot.y())).tolist()
        if y > 0.0:
            self.sky_pointed.emit((x, y, z))

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """End the drag; without a drag it was a click."""
        way = event.position() - (self._pressed or event.position())
        self._grip = self._pressed = None
        if event.button() == Qt.MouseButton.LeftButton and way.manhattanLength() <= _CLICK_PX:
            self._point(event.position())
            self.probe.click()

    def leaveEvent(self, event: object) -> None:
        """Clear the read-out."""
        self.probe.leave()

    def _drag(self, right: float, up: float, shifting: bool) -> None:
        if shifting:
            self.rig.pan(right, up)
        elif self.mode is CameraMode.ORBIT and not self._looks_around:
            self._turn(right, up)
        else:
            self.rig.look_around(right, up)
        self.send_camera()

    def _is_enclosed(self) -> bool:
        around = self._surroundings
        return around is not None and around.encloses(self.rig.eye_m, self.rig.target_m)

    def _turn(self, right: float, up: float) -> None:
        """Turn around the target, along a wall where one is in the way; in a corner look around."""
        around = self._surroundings
        if around is None:
            self.rig.orbit(right, up)
            return
        for way in ((right, up), (right, 0.0), (0.0, up)):
            turned = copy(self.rig)
            turned.orbit(*way, lowest_m=around.lowest_m)
            if around.is_free(self.rig.eye_m, turned.eye_m):
                self.rig = turned
                return
        self.rig.look_around(right, up)

    def wheelEvent(self, event: QWheelEvent) -> None:
        """Move nearer, narrow the view or climb, by the mode."""
        steps = event.angleDelta().y() / 120.0
        if not steps:
            return
        if self.mode is CameraMode.ORBIT:
            self.rig.dolly(steps)
        elif self.mode is CameraMode.FLY:
            self.rig.zoom(steps)
        else:
            self.rig.climb(steps)
        self.send_camera()

    # --- by key ------------------------------------------------------------------------------

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Arrows turn; W A S D Q E fly; PageUp and PageDown climb; plus and minus go nearer."""
        key = Qt.Key(event.key())
        turns = {
            Qt.Key.Key_Left: (0.02, 0.0), Qt.Key.Key_Right: (-0.02, 0.0),
            Qt.Key.Key_Up: (0.0, -0.02), Qt.Key.Key_Down: (0.0, 0.02),
        }  # fmt: skip
        if key in turns:
            self._looks_around = self._is_enclosed()
            self._drag(*turns[key], shifting=False)
        elif key in _FLIGHT and self.mode is CameraMode.FLY:
            if not event.isAutoRepeat():
                self._hold(key)
        elif key in _CLIMBS:
            self.rig.climb(_CLIMBS[key])
            self.send_camera()
        elif key in _DOLLIES:
            self.rig.dolly(_DOLLIES[key])
            self.send_camera()
        else:
            super().keyPressEvent(event)

    def keyReleaseEvent(self, event: QKeyEvent) -> None:
        """Stop flying in that direction."""
        if not event.isAutoRepeat():
            self._held.discard(Qt.Key(event.key()))
        super().keyReleaseEvent(event)

    def focusOutEvent(self, event: QFocusEvent) -> None:
        """Forget held keys: their release would go to another widget."""
        self._held.clear()
        super().focusOutEvent(event)

    def _hold(self, key: Qt.Key) -> None:
        self._held.add(key)
        if not self._flight.isActive():
            self._flew_s = perf_counter()
            self._flight.start()

    def _fly_on(self) -> None:
        if not self._held:
            self._flight.stop()
            return
        now_s = perf_counter()
        elapsed_s = min(now_s - self._flew_s, _MOST_FLIGHT_S)
        self._flew_s = now_s
        ways = [np.array(_FLIGHT[key]) for key in self._held if key in _FLIGHT]
        speed_m_s = self._speed_m_s() * (4.0 if Qt.Key.Key_Shift in self._held else 1.0)
        self.rig.fly(*(sum(ways, np.zeros(3)) * speed_m_s * elapsed_s))
        self.send_camera()

    def _speed_m_s(self) -> float:
        """Ten seconds through the scene, whatever its size; faster at height."""
        if self._scene is None:
            return 2.0
        size_m = float(np.linalg.norm(np.subtract(self._scene.upper_m, self._scene.lower_m)))
        return max(0.1 * size_m, 0.3 * abs(float(self.rig.eye_m[1])), 0.2)

    # --- files -------------------------------------------------------------------------------

    def dragEnterEvent(self, event: QDragEnterEvent) -> None:
        """Take scenes and projects."""
        if _scene_of(event) is not None:
            event.acceptProposedAction()

    def dropEvent(self, event: QDropEvent) -> None:
        """Open the dropped file."""
        path = _scene_of(event)
        if path is not None:
            event.acceptProposedAction()
            self.scene_dropped.emit(path)

    # --- painting ----------------------------------------------------------------------------

    def paintEvent(self, event: QPaintEvent) -> None:
        """Paint the picture and its overlays."""
        painter = QPainter(self)
        if self._image is None:
            painter.fillRect(self.rect(), QColor("#101012"))
            if not self.loading.is_on:
                self._write(painter, self.rect(), Qt.AlignmentFlag.AlignCenter, _INVITATION)
            self.loading.paint(painter, QRectF(self.rect()))
            return
        painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform)
        painter.drawImage(self.rect(), self._image)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        for overlay in (self._sun_path, self._compass):
            overlay.paint(painter, QRectF(self.rect()), self.camera)
        edge = self.rect().adjusted(10, 8, -10, -8)
        corner = Qt.AlignmentFlag
        self._write(painter, edge, corner.AlignLeft | corner.AlignBottom, self.probe.text)
        if self.mode is CameraMode.SPACE or self.rig.eye_m[1] > 1000.0:
            height = height_text(float(self.rig.eye_m[1]))
            self._write(painter, edge, corner.AlignRight | corner.AlignBottom, height)
        self.loading.paint(painter, QRectF(self.rect()))

    def _write(self, painter: QPainter, place: object, where: object, text: str) -> None:
        """Write text with a shadow, legible on any picture."""
        painter.setPen(QColor(0, 0, 0, 170))
        painter.drawText(place.translated(1, 1), where, text)  # type: ignore[attr-defined,call-overload]
        painter.setPen(QColor(theme.TEXT))
        painter.drawText(place, where, text)  # type: ignore[call-overload]


# Right, up and forward.
_FLIGHT = {
    Qt.Key.Key_D: (1.0, 0.0, 0.0), Qt.Key.Key_A: (-1.0, 0.0, 0.0),
    Qt.Key.Key_E: (0.0, 1.0, 0.0), Qt.Key.Key_Q: (0.0, -1.0, 0.0),
    Qt.Key.Key_W: (0.0, 0.0, 1.0), Qt.Key.Key_S: (0.0, 0.0, -1.0),
    Qt.Key.Key_Shift: (0.0, 0.0, 0.0),
}  # fmt: skip
_CLIMBS = {Qt.Key.Key_PageUp: 2.0, Qt.Key.Key_PageDown: -2.0}
_DOLLIES = {Qt.Key.Key_Plus: 1.0, Qt.Key.Key_Minus: -1.0}


def _scene_of(event: QDropEvent) -> str | None:
    """The first dropped file of a known suffix."""
    paths = [url.toLocalFile() for url in event.mimeData().urls()]
    return next((p for p in paths if Path(p).suffix.lower() in SCENE_SUFFIXES), None)
