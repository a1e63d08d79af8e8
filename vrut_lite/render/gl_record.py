"""Remembers that OpenGL could be opened since the machine's start, so that no process tries first.

The record is away while OpenGL is opened: after a driver that ends the process it is tried again.
"""

import os
from contextlib import suppress
from pathlib import Path

from vrut_lite.errors import UserError
from vrut_lite.write_atomic import atomic_output

_BOOT = Path("/proc/sys/kernel/random/boot_id")
# What the beginnings of variables are called that choose a driver.
_CHOOSING = ("LIBGL", "MESA", "GALLIUM", "EGL", "__EGL", "__GL", "DRI_", "LD_", "CUDA", "NVIDIA")


def take_record() -> str | None:
    """The renderer's name, if it was opened with the same start and environment; takes it away."""
    with suppress(OSError, ValueError):
        file = _file()
        here, _, renderer = file.read_text().rpartition("\n")
        file.unlink()
        return renderer if here == _here() else None
    return None


def keep_record(renderer: str) -> None:
    """OpenGL was opened; without a folder to write to nothing is kept."""
    with suppress(OSError, UserError):
        here = _here()
        _file().parent.mkdir(parents=True, exist_ok=True)
        with atomic_output(_file()) as beside:
            beside.write_text(f"{here}\n{renderer}")


def _here() -> str:
    chosen = sorted(each for each in os.environ.items() if each[0].startswith(_CHOOSING))
    return repr((_BOOT.read_text(), os.stat("/").st_ino, os.stat("/").st_dev, chosen))


def _file() -> Path:
    from platformdirs import user_cache_path

    return user_cache_path("vrut_lite") / "opengl.txt"
