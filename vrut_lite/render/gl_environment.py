"""Prepares the process before OpenGL libraries are imported.

pyrender 0.1.45 predates numpy 2 and Python 3.12, and imports a window toolkit that needs X11;
three small repairs let it load headless. Nothing outside `render/` imports pyrender.
"""

import os
import subprocess
import sys
import types
from functools import lru_cache
from typing import Any

import numpy as np

_PROBE = (
    "import moderngl;"
    "c = moderngl.create_context(standalone=True, backend='egl', require=430);"
    "print(c.info['GL_RENDERER'])"
)
_PROBE_TIMEOUT_S = 60


def prepare_environment() -> None:
    """Ask PyOpenGL and Qt for EGL; to be called before either is imported."""
    os.environ["PYOPENGL_PLATFORM"] = "egl"
    os.environ.setdefault("QT_XCB_GL_INTEGRATION", "xcb_egl")


@lru_cache(maxsize=1)
def probe_gl() -> tuple[str, str]:
    """Name of the GL renderer, or an empty text and the reason for its absence.

    Found by a separate process: a broken driver aborts instead of raising.
    """
    prepare_environment()
    try:
        probe = subprocess.run(
            [sys.executable, "-c", _PROBE],
            capture_output=True,
            text=True,
            timeout=_PROBE_TIMEOUT_S,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return "", f"the GL driver did not answer within {_PROBE_TIMEOUT_S} s"
    if probe.returncode == 0:
        return probe.stdout.strip(), ""
    lines = probe.stderr.strip().splitlines()
    return "", lines[-1] if lines else f"the GL driver ended the probe ({probe.returncode})"


@lru_cache(maxsize=1)
def import_pyrender() -> Any:
    """The pyrender package, repaired for this Python and numpy."""
    prepare_environment()
    np.infty = np.inf  # type: ignore[attr-defined]  # noqa: NPY201
    if sys.version_info >= (3, 12):
        from OpenGL.plugins import FormatHandler

        FormatHandler.by_name("ctypesparameter").check.append("_ctypes.CArgObject")
    viewer = types.ModuleType("pyrender.viewer")
    viewer.Viewer = None  # type: ignore[attr-defined]
    sys.modules.setdefault("pyrender.viewer", viewer)
    import pyrender

    return pyrender
