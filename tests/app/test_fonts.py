"""On a system without fonts the window's text is drawn, not boxes."""

import os
import subprocess
import sys
from collections.abc import Mapping
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


LEGEND = """
import hashlib
import numpy as np
from vrut_lite.pictures.value_picture import value_pixels, values_of
values = np.linspace(10.0, 900.0, 200 * 120, dtype=np.float32).reshape(120, 200)
pixels = value_pixels(values_of(values, "illuminance"))
print(hashlib.blake2b(pixels.tobytes()).hexdigest())
"""


def without_fonts(folder: Path) -> dict[str, str]:
    """The environment of a process whose system has no font."""
    (folder / "fonts.conf").write_text(
        '<?xml version="1.0"?><!DOCTYPE fontconfig SYSTEM "fonts.dtd"><fontconfig></fontconfig>'
    )
    return os.environ | {
        "FONTCONFIG_FILE": str(folder / "fonts.conf"),
        "XDG_DATA_HOME": str(folder),
        "QT_QPA_PLATFORM": "offscreen",
        "QT_QPA_FONTDIR": str(folder / "none"),
    }


def printed(code: str, environment: Mapping[str, str], *arguments: str) -> list[str]:
    """Lines that Python code prints in a process of this environment."""
    command = [sys.executable, "-c", code, *arguments]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    return done.stdout.splitlines()


def drawn(folder: Path, font: str) -> tuple[str, list[str]]:
    """The font, and the letters' digests, by a process whose system has no font."""
    family, *digests = printed(DRAW, without_fonts(folder), font, LETTERS)
    return family, digests


def test_letters_differ_without_fonts_of_the_system(tmp_path: Path) -> None:
    """Each is drawn, and as itself; without the bundled font all of them look alike."""
    assert drawn(tmp_path, "without")[0] == ""
    family, letters = drawn(tmp_path, "with")
    assert family == "DejaVu Sans"
    assert len({*letters}) == len(LETTERS)


def test_the_legend_of_false_colours_needs_no_font_of_the_system(tmp_path: Path) -> None:
    """Pillow brings the font in which pictures are labelled: the picture is the same."""
    assert printed(LEGEND, without_fonts(tmp_path)) == printed(LEGEND, os.environ)


def test_a_systems_own_font_is_kept(qapp) -> None:
    """The user chose it."""
    from PySide6.QtGui import QFontDatabase, QFontMetrics

    from vrut_lite.app.fonts import ensure_font

    if not QFontMetrics(qapp.font()).inFont("A"):
        pytest.skip("this system has no font")
    before = qapp.font().toString(), QFontDatabase.families()
    ensure_font(qapp)
    assert (qapp.font().toString(), QFontDatabase.families()) == before
