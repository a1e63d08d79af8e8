"""Signs of buttons, drawn: a font may lack them."""

import atexit
from collections.abc import Callable, Iterable

from PySide6.QtCore import QPointF, QRectF, QSize, Qt
from PySide6.QtGui import QColor, QIcon, QPainter, QPainterPath, QPen, QPixmap, QPolygonF
from PySide6.QtWidgets import QAbstractButton

from vrut_lite.app import theme

# Signs are drawn in a square of 16 units, at the sizes that screens of one to three pixels a point
# need.
_UNITS = 16
_SCALES = (1, 2, 3)
_COLOURS = {
    (QIcon.Mode.Normal, QIcon.State.Off): theme.TEXT,
    (QIcon.Mode.Active, QIcon.State.Off): theme.TEXT,
    (QIcon.Mode.Disabled, QIcon.State.Off): "#5c5c60",
    (QIcon.Mode.Normal, QIcon.State.On): theme.BACKGROUND,
    (QIcon.Mode.Active, QIcon.State.On): theme.BACKGROUND,
}


def _play(painter: QPainter) -> None:
    _fill(painter, [(4.5, 3.0), (13.0, 8.0), (4.5, 13.0)])


def _pause(painter: QPainter) -> None:
    for left in (4.0, 9.0):
        _fill(painter, [(left, 3.0), (left + 3.0, 3.0), (left + 3.0, 13.0), (left, 13.0)])


def _before(painter: QPainter) -> None:
    _draw(painter, [(10.0, 3.5), (5.5, 8.0), (10.0, 12.5)])


def _after(painter: QPainter) -> None:
    _draw(painter, [(6.0, 3.5), (10.5, 8.0), (6.0, 12.5)])


def _close(painter: QPainter) -> None:
    _draw(painter, [(4.5, 4.5), (11.5, 11.5)])
    _draw(painter, [(11.5, 4.5), (4.5, 11.5)])


def _reset(painter: QPainter) -> None:
    arc = QPainterPath()
    circle = QRectF(3.5, 3.5, 9.0, 9.0)
    arc.arcMoveTo(circle, 140.0)
    arc.arcTo(circle, 140.0, 290.0)
    painter.drawPath(arc)
    _fill(painter, [(1.6, 6.4), (6.6, 6.6), (3.6, 2.4)])


def _browse(painter: QPainter) -> None:
    """A folder."""
    tab = [(2.0, 13.0), (2.0, 4.0), (6.0, 4.0), (7.5, 6.0)]
    _draw(painter, [*tab, (14.0, 6.0), (14.0, 13.0), (2.0, 13.0)])


_SIGNS: dict[str, Callable[[QPainter], None]] = {
    "play": _play, "pause": _pause, "before": _before, "after": _after, "close": _close,
    "reset": _reset, "browse": _browse,
}  # fmt: skip


# A window has some 80 of them: each is drawn once, and freed before Qt ends.
_DRAWN: dict[str, QIcon] = {}
atexit.register(_DRAWN.clear)


def sign(name: str) -> QIcon:
    """The icon of a sign: play, pause, before, after, close, reset, browse."""
    if name not in _DRAWN:
        _DRAWN[name] = _drawn(_SIGNS[name])
    return _DRAWN[name]


def _drawn(draw: Callable[[QPainter], None]) -> QIcon:
    icon = QIcon()
    for (mode, state), colour in _COLOURS.items():
        for scale in _SCALES:
            icon.addPixmap(_pixmap(draw, QColor(colour), scale), mode, state)
    return icon


def put_sign(button: QAbstractButton, name: str, size_px: int = _UNITS) -> None:
    """Show a sign on a button instead of a text."""
    button.setIcon(sign(name))
    button.setIconSize(QSize(size_px, size_px))


def _pixmap(draw: Callable[[QPainter], None], colour: QColor, scale: int) -> QPixmap:
    pixmap = QPixmap(_UNITS * scale, _UNITS * scale)
    pixmap.setDevicePixelRatio(scale)
    pixmap.fill(Qt.GlobalColor.transparent)
    painter = QPainter(pixmap)
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    cap, join = Qt.PenCapStyle.RoundCap, Qt.PenJoinStyle.RoundJoin
    painter.setPen(QPen(colour, 1.6, Qt.PenStyle.SolidLine, cap, join))
    draw(painter)
    painter.end()
    return pixmap


def _draw(painter: QPainter, points: Iterable[tuple[float, float]]) -> None:
    painter.drawPolyline(QPolygonF([QPointF(*point) for point in points]))


def _fill(painter: QPainter, points: Iterable[tuple[float, float]]) -> None:
    painter.save()
    painter.setBrush(painter.pen().color())
    painter.setPen(Qt.PenStyle.NoPen)
    painter.drawPolygon(QPolygonF([QPointF(*point) for point in points]))
    painter.restore()
