"""The picture, and the camera in the user's hands.

Frames are drawn on the GL owner's thread and arrive as images; Qt paints them and the overlays. A
`QOpenGLWidget` would draw on Qt's thread: with a software renderer a frame takes some hundred
milliseconds, during which no slider would move. It could not share our context's textures either:
EGL shares within one display, and ours is the card's device, Qt's the window system. So the bytes
for display are read, a quarter of the radiance, after the frame and without waiting within it.
"""

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

from vrut_lite.app.engine.engine import Shown
from vrut_lite.app.engine.session import Session
from vrut_lite.app.view.camera_rig import CameraRig, height_text
from vrut_lite.app.view.compass import Compass
from vrut_lite.app.view.dropped_files import dropped_scene
from vrut_lite.app.view.flight import Flight
from vrut_lite.app.view.hand import CameraMode, Hand
from vrut_lite.app.view.light_probe import LightProbe
from vrut_lite.app.view.loading import Loading
from vrut_lite.app.view.picture_painting import paint_picture, write
from vrut_lite.app.view.picture_sign import PictureSign
from vrut_lite.app.view.sun_path import SunPath
from vrut_lite.app.view.surroundings import OccupiedCells
from vrut_lite.app.widgets import make_timer, rgb_image
from vrut_lite.messages.camera import MoveCamera, frame_bounds, pixel_rays
from vrut_lite.messages.picture import Resize
from vrut_lite.messages.scene import SceneOpened
from vrut_lite.numeric_types import FloatArray, Vector

_INVITATION = "Drop a scene (glTF, OBJ, USD, IFC, STL) here, or open one with Ctrl+O"
_SETTLED_MS = 60
_BEHIND = "#101012"
_SMALLEST_PX = 16
# A press that moves farther is a drag.
_CLICK_PX = 3


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
        self._hand = Hand()
        self._flight = Flight(self._speed_m_s, self)
        self.probe = LightProbe(session, self)
        self.loading = Loading(session, self)
        self.sign = PictureSign(session, self)
        self._sun_path, self._compass = sun_path, compass
        self._image: QImage | None = None
        self._sent: MoveCamera | None = None
        self._scene: SceneOpened | None = None
        self._knows_surroundings = False
        self._grip: QPointF | None = None
        self._pressed: QPointF | None = None
        self._resized = make_timer(self, _SETTLED_MS, self._send_size, once=True)
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
        self.sign.changed.connect(self.update)
        self._flight.flown.connect(self._fly)

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
    def rig(self) -> CameraRig:
        """The camera rig that the mouse and keys move."""
        return self._hand.rig

    @property
    def mode(self) -> CameraMode:
        """The mode of camera control."""
        return self._hand.mode

    @property
    def camera(self) -> MoveCamera:
        """The present camera."""
        return self._sent or self.rig.camera()

    def set_mode(self, mode: CameraMode) -> None:
        """Switch to another mode."""
        self._hand.mode = mode
        self._flight.end()
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

    def look_along(self, direction: Vector) -> None:
        """Turn the camera to a unit vector in world axes, where it stands."""
        self.rig.look_along(direction)
        self.send_camera()

    def send_camera(self) -> None:
        """Send the rig's camera."""
        self._sent = self.rig.camera()
        self._session.send(self._sent)

    # --- messages ----------------------------------------------------------------------------

    def _show_picture(self, shown: Shown) -> None:
        self._image = rgb_image(shown.picture.display)
        self.update()
        self._look_around()

    def _note_scene(self, scene: SceneOpened) -> None:
        self._scene, self._hand.surroundings = scene, None
        self._knows_surroundings = False

    def _look_around(self) -> None:
        """Find a new scene's walls once it is seen: its first picture does not wait for them."""
        scene = self._scene
        if scene is not None and not self._knows_surroundings:
            self._knows_surroundings = True
            self._session.look_up(lambda _: (scene, OccupiedCells(scene)), self._take_surroundings)

    def _take_surroundings(self, found: tuple[SceneOpened, OccupiedCells]) -> None:
        if found[0] is self._scene:
            self._hand.surroundings = found[1]

    def _adopt(self, camera: MoveCamera) -> None:
        """Take over the camera of a scene or a project; not the echo of our own."""
        if self._grip is not None or self._flight.is_on or camera == self._sent:
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
        self._hand.begin_drag()
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
        self._hand.drag(way.x(), -way.y(), bool(shifting))
        self.send_camera()

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

    def wheelEvent(self, event: QWheelEvent) -> None:
        """Move nearer, narrow the view or climb, by the mode."""
        steps = event.angleDelta().y() / 120.0
        if not steps:
            return
        self._hand.wheel(steps)
        self.send_camera()

    # --- by key ------------------------------------------------------------------------------

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Arrows turn; W A S D Q E fly; PageUp and PageDown climb; plus and minus go nearer."""
        key = Qt.Key(event.key())
        if self.mode is CameraMode.FLY and self._flight.hold(key):
            return
        if self._hand.press(key):
            self.send_camera()
        else:
            super().keyPressEvent(event)

    def keyReleaseEvent(self, event: QKeyEvent) -> None:
        """Stop flying in that direction."""
        if not event.isAutoRepeat():
            self._flight.release(Qt.Key(event.key()))
        super().keyReleaseEvent(event)

    def focusOutEvent(self, event: QFocusEvent) -> None:
        """Forget held keys: their release would go to another widget."""
        self._flight.end()
        super().focusOutEvent(event)

    def _fly(self, way_m: FloatArray) -> None:
        self.rig.fly(*way_m)
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
        if dropped_scene(event) is not None:
            event.acceptProposedAction()

    def dropEvent(self, event: QDropEvent) -> None:
        """Open the dropped file."""
        path = dropped_scene(event)
        if path is not None:
            event.acceptProposedAction()
            self.scene_dropped.emit(path)

    # --- painting ----------------------------------------------------------------------------

    def paintEvent(self, event: QPaintEvent) -> None:
        """Paint the picture and its overlays."""
        painter, place = QPainter(self), QRectF(self.rect())
        painter.fillRect(place, QColor(_BEHIND))
        if self._image is None:
            if not self.loading.is_on:
                write(painter, place, Qt.AlignmentFlag.AlignCenter, _INVITATION)
            self.loading.paint(painter, place)
            return
        paint_picture(painter, place, self._image)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        for overlay in (self._sun_path, self._compass):
            overlay.paint(painter, place, self.camera)
        edge, corner = place.adjusted(10.0, 8.0, -10.0, -8.0), Qt.AlignmentFlag
        shown = self._session.shown
        has_legend = shown is not None and shown.picture.values is not None
        side = corner.AlignTop if has_legend else corner.AlignBottom
        write(painter, edge, corner.AlignLeft | side, self.probe.text)
        if self.mode is CameraMode.SPACE or self.rig.eye_m[1] > 1000.0:
            height = height_text(float(self.rig.eye_m[1]))
            write(painter, edge, corner.AlignRight | corner.AlignBottom, height)
        if not self.loading.is_on:
            write(painter, edge, corner.AlignHCenter | corner.AlignBottom, self.sign.text)
        self.loading.paint(painter, place)
