"""On a system without fonts the window's text is drawn, not boxes."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

# Draws letters on Qt's platform `offscreen`; prints the font, then a digest of each letter.
DRAW = """
import hashlib, sys
from PySide6.QtGui import QFontInfo, QImage, QPainter
from PySide6.QtWidgets import QApplication
from vrut_lite.app.fonts import ensure_font
app = QApplication([])
if sys.argv[1] == "with":
    ensure_font(app)
print(QFontInfo(app.font()).family())
for letter in sys.argv[2]:
    image = QImage(32, 32, QImage.Format.Format_Grayscale8)
    image.fill(255)
    painter = QPainter(image)
    painter.setFont(app.font())
    painter.drawText(image.rect(), 0, letter)
    painter.end()
    print(hashlib.blake2b(bytes(image.constBits())).hexdigest())
"""
# Letters, and signs that panels use: degrees, minus, times, squares, micro, ellipsis, dash, Greek.
LETTERS = "Wm il09\N{DEGREE SIGN}\N{MINUS SIGN}\N{MULTIPLICATION SIGN}\N{SUPERSCRIPT TWO}" + (
    "\N{MICRO SIGN}\N{HORIZONTAL ELLIPSIS}\N{EN DASH}\N{GREEK SMALL LETTER LAMDA}"
)


def drawn(folder: Path, font: str) -> tuple[str, list[str]]:
    """The font, and the letters' digests, by a process whose system has no font."""
    (folder / "fonts.conf").write_text(
        '<?xml version="1.0"?><!DOCTYPE fontconfig SYSTEM "fonts.dtd"><fontconfig></fontconfig>'
    )
    empty = {
        "FONTCONFIG_FILE": str(folder / "fonts.conf"),
        "XDG_DATA_HOME": str(folder),
        "QT_QPA_PLATFORM": "offscreen",
        "QT_QPA_FONTDIR": str(folder / "none"),
    }
    done = subprocess.run(
        [sys.executable, "-c", DRAW, font, LETTERS],
        env=os.environ | empty,
        capture_output=True,
        text=True,
        check=True,
    )
    first, *digests = done.stdout.splitlines()
    return first, digests


def test_letters_differ_without_fonts_of_the_system(tmp_path: Path) -> None:
    """Each is drawn, and as itself; without the bundled font all of them look alike."""
    assert drawn(tmp_path, "without")[0] == ""
    family, letters = drawn(tmp_path, "with")
    assert family == "DejaVu Sans"
    assert len({*letters}) == len(LETTERS)


def test_a_systems_own_font_is_kept(qapp) -> None:
    """The user chose it."""
    from PySide6.QtGui import QFontDatabase, QFontMetrics

    from vrut_lite.app.fonts import ensure_font

    if not QFontMetrics(qapp.font()).inFont("A"):
        pytest.skip("this system has no font")
    before = qapp.font().toString(), QFontDatabase.families()
    ensure_font(qapp)
    assert (qapp.font().toString(), QFontDatabase.families()) == before
