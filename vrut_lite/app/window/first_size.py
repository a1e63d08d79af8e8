"""The size of a window that is opened for the first time."""

from PySide6.QtCore import QRect, QSize

_WIDTH, _HEIGHT = 1600, 1000
# Window managers draw a title and edges around a window; Qt knows how wide only once it is seen.
_FRAME_WIDTH, _FRAME_HEIGHT = 16, 40


def first_place(free: QRect) -> QRect:
    """Where a new window lies, without its frame: at most 1600 x 1000, inside the screen's free
    area and in its middle."""
    room = QSize(free.width() - _FRAME_WIDTH, free.height() - _FRAME_HEIGHT)
    place = QRect(free.topLeft(), QSize(_WIDTH, _HEIGHT).boundedTo(room))
    place.moveCenter(free.center())
    # The title is higher than the edge below.
    place.translate(0, (_FRAME_HEIGHT - _FRAME_WIDTH) // 2)
    return place
