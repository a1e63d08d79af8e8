"""Checks whether a window can be opened, before Qt would abort the process.

Qt ends a process that has no display or lacks a library, without an exception. So a separate
process tries it, as for OpenGL; its output becomes one sentence.
"""

import os
import re
import subprocess
import sys
from collections.abc import Callable

from vrut_lite import operating_system
from vrut_lite.errors import UserError
from vrut_lite.render.gl_environment import prepare_environment

# Qt's platforms that need no display.
_SCREENLESS = ("offscreen", "minimal", "vnc")
_PROBE = "from PySide6.QtWidgets import QApplication; QApplication([])"
_PROBE_TIMEOUT_S = 60
_HEADLESS = "`vrut-lite render SCENE -o PICTURE` draws without a window"
_WITHOUT_GL = "until then `vrut-lite sky -o PICTURE` draws the sky on the CPU alone"
PACKAGES = (
    "libegl1 libgl1 libglib2.0-0 libfontconfig1 libxkbcommon0 libdbus-1-3 libxcb-cursor0 "
    "libxcb-icccm4 libxcb-keysyms1 libxcb-image0 libxcb-render-util0 libxcb-shape0 libxcb-xkb1 "
    "libxkbcommon-x11-0"
)


def require_desktop(meanwhile: Callable[[], object] = lambda: None) -> None:
    """Return if a window can be opened; `meanwhile` is called while that is tried.

    Raises:
        UserError: there is no display, or Qt or a library that it needs is missing.
    """
    if not has_display():
        raise UserError(f"there is no display to open a window on: {_HEADLESS}")
    prepare_environment()
    probe = subprocess.Popen(
        [sys.executable, "-c", _PROBE],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        encoding="locale",
        errors="replace",
    )
    try:
        meanwhile()
        _, said = probe.communicate(timeout=_PROBE_TIMEOUT_S)
    except subprocess.TimeoutExpired:
        raise UserError(
            f"the display did not answer within {_PROBE_TIMEOUT_S} s: {_HEADLESS}"
        ) from None
    finally:
        probe.kill()
    if probe.returncode:
        raise UserError(objection(said))


def has_display() -> bool:
    """Whether the environment names a display, or needs none."""
    if os.environ.get("QT_QPA_PLATFORM", "").partition(":")[0] in _SCREENLESS:
        return True
    if operating_system.NAME in ("win32", "darwin"):
        return True
    return bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))


def objection(said: str) -> str:
    """A sentence from the text that Qt printed before it aborted."""
    if "No module named 'PySide6'" in said:
        return f"the window needs PySide6: pip install 'vrut-lite[app]'; {_HEADLESS}"
    missing = re.search(r"(\S+\.so[.\d]*): cannot open shared object file", said)
    needed = re.search(r"(\S*xcb-cursor\S*) is needed", said)
    if missing or needed or "Could not load the Qt platform plugin" in said:
        if "could not connect to display" in said:
            return f"the display {os.environ.get('DISPLAY', '')} does not answer: {_HEADLESS}"
        name = missing[1] if missing else "a library of the X window system"
        return f"Qt lacks {name}: install the packages {PACKAGES}, or their like; {_WITHOUT_GL}"
    lines = said.strip().splitlines()
    return f"Qt cannot open a window here ({lines[-1] if lines else 'it was ended'}): {_HEADLESS}"
