"""Record that OpenGL opened since the machine's boot, which spares a probe in another process.

The record is removed while OpenGL is opened: a driver that ends the process is probed next time.
"""

import os
from contextlib import suppress
from pathlib import Path

from vrut_lite.errors import UserError
from vrut_lite.write_atomic import atomic_output

_BOOT = Path("/proc/sys/kernel/random/boot_id")
# Prefixes of the environment variables that select a driver.
_CHOOSING = (
    "LIBGL", "MESA", "GALLIUM", "EGL", "__EGL", "__GL", "__NV", "DRI_", "LD_", "CUDA", "NVIDIA",
    "GLCONTEXT", "VRUT_LITE_GPU",
)  # fmt: skip


def take_record() -> str | None:
    """The renderer's name, if recorded for this boot and environment; removes the record."""
    with suppress(OSError, ValueError):
        file = _file()
        here, _, renderer = file.read_text(encoding="utf-8").rpartition("\n")
        file.unlink()
        return renderer if here == _here() else None
    return None


def keep_record(renderer: str) -> None:
    """Record that OpenGL was opened, if the cache folder is writable."""
    with suppress(OSError, UserError):
        here = _here()
        _file().parent.mkdir(parents=True, exist_ok=True)
        with atomic_output(_file()) as beside:
            beside.write_text(f"{here}\n{renderer}", encoding="utf-8")


def _here() -> str:
    chosen = sorted(each for each in os.environ.items() if each[0].startswith(_CHOOSING))
    return repr(
        (_BOOT.read_text(encoding="ascii"), os.stat("/").st_ino, os.stat("/").st_dev, chosen)
    )


def _file() -> Path:
    from platformdirs import user_cache_path

    return user_cache_path("vrut_lite") / "opengl.txt"
