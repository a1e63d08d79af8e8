"""Variables of the environment that libraries choke on: those that say nothing are left out.

numba, LLVM and numpy read them while they are imported, and end in a traceback, or the process in
an abort, at what they cannot make sense of. Without the variable each takes its default.
"""

import os
import re

# What each may say.
_SOUND = {
    "NUMBA_NUM_THREADS": r"0{0,8}[1-9]\d{0,3}",
    "NUMBA_CPU_FEATURES": r"[+-][\w.-]+(,[+-][\w.-]+)*",
    "NUMBA_COLOR_SCHEME": r"no_color|dark_bg|light_bg|blue_bg|jupyter_nb",
    # numpy makes a date of it.
    "SOURCE_DATE_EPOCH": r"\d{1,15}",
}


def leave_out_nonsense() -> None:
    """Take variables away that hold nothing of use; before the libraries are imported."""
    for name, sound in _SOUND.items():
        value = os.environ.get(name)
        if value is not None and not re.fullmatch(sound, value.strip(), re.ASCII):
            del os.environ[name]
