"""A font for systems that have none, on which Qt would write boxes."""

from pathlib import Path

from PySide6.QtGui import QFont, QFontDatabase, QFontMetrics
from PySide6.QtWidgets import QApplication

_FONT = Path(__file__).parent / "data" / "DejaVuSans.ttf"
_SIZE_PT = 9


def ensure_font(app: QApplication) -> None:
    """Write in the bundled font where Qt has no letter A.

    Without fonts of the system fontconfig still lists its families Sans Serif, Serif and Monospace.
    """
    if QFontMetrics(app.font()).inFont("A"):
        return
    number = QFontDatabase.addApplicationFont(str(_FONT))
    for family in QFontDatabase.applicationFontFamilies(number)[:1]:
        app.setFont(QFont(family, _SIZE_PT))
