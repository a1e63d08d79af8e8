"""Removes invalid environment variables that make libraries crash.

numba, LLVM and numpy read these variables while they are imported; an invalid value ends in a
traceback or an abort of the process. Without the variable the library uses its default.
"""

import os
import re

# Valid values of each variable.
_SOUND = {
    "NUMBA_NUM_THREADS": r"0{0,8}[1-9]\d{0,3}",
    "NUMBA_CPU_FEATURES": r"[+-][\w.-]+(,[+-][\w.-]+)*",
    "NUMBA_COLOR_SCHEME": r"no_color|dark_bg|light_bg|blue_bg|jupyter_nb",
    # numpy converts it to a date.
    "SOURCE_DATE_EPOCH": r"\d{1,15}",
}


def leave_out_nonsense() -> None:
    """Remove invalid variables; call it before the libraries are imported."""
    for name, sound in _SOUND.items():
        value = os.environ.get(name)
        if value is not None and not re.fullmatch(sound, value.strip(), re.ASCII):
            del os.environ[name]
