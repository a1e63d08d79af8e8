"""Which driver there is, and its limits."""

import os
import platform
import sys
import time
from pathlib import Path
from typing import Any

from vrut_lite.render.gl_owner import GlOwner
from vrut_lite_lab.card_check.parts import Keep

# The bindings and sizes that the renderer uses.
_LIMITS = (
    "GL_MAX_TEXTURE_IMAGE_UNITS",
    "GL_MAX_COMBINED_TEXTURE_IMAGE_UNITS",
    "GL_MAX_UNIFORM_BLOCK_SIZE",
    "GL_MAX_UNIFORM_BUFFER_BINDINGS",
    "GL_MAX_SHADER_STORAGE_BUFFER_BINDINGS",
    "GL_MAX_IMAGE_UNITS",
    "GL_MAX_CUBE_MAP_TEXTURE_SIZE",
    "GL_MAX_3D_TEXTURE_SIZE",
    "GL_MAX_TEXTURE_SIZE",
    "GL_MAX_SAMPLES",
    "GL_MAX_COMPUTE_WORK_GROUP_INVOCATIONS",
)


def measure(_folder: Path, keep: Keep) -> None:
    """Open OpenGL as the program does."""
    start_s = time.perf_counter()
    owner = GlOwner()
    opened = owner.opened
    open_s = time.perf_counter() - start_s
    info = owner.call(lambda context: dict(context.info))
    keep(
        {
            "card": opened.device.renderer,
            "version": opened.device.version,
            "vendor": info["GL_VENDOR"],
            "chosen": opened.device.choices.name,
            "trial_ns": opened.device.trial_ns,
            "open_s": open_s,
            "limits": {name: _plain(info[name]) for name in _LIMITS if name in info},
            "extensions": owner.call(lambda context: sorted(context.extensions)),
            "cores": os.cpu_count(),
            "python": sys.version.split()[0],
            "system": platform.platform(),
        }
    )
    owner.close()


def _plain(value: Any) -> Any:
    return list(value) if isinstance(value, tuple) else value
