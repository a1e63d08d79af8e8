"""Prepares the process before OpenGL libraries are imported.

pyrender 0.1.45 predates numpy 2 and Python 3.12; two small repairs let it load. Its package imports
a window toolkit that needs X11, and trimesh, which takes a second: here only the parts that are
used are imported. Nothing outside `render/` imports pyrender.
"""

import importlib.util
import os
import subprocess
import sys
import types
from functools import lru_cache
from typing import Any

import numpy as np

from vrut_lite.operating_system import has_egl
from vrut_lite.render.gl_choice import no_opengl
from vrut_lite.render.gl_record import take_record

_PROBE = (
    "import sys\n"
    "from vrut_lite.errors import UserError\n"
    "from vrut_lite.render.gl_choice import open_context\n"
    "try:\n"
    "    print(open_context().info['GL_RENDERER'])\n"
    "except UserError as refusal:\n"
    "    print(refusal, file=sys.stderr)\n"
    "    sys.exit(3)"
)
_REFUSED, _PROBE_TIMEOUT_S = 3, 60
_PARTS = {
    "material": "MetallicRoughnessMaterial",
    "primitive": "Primitive",
    "renderer": "Renderer",
    "sampler": "Sampler",
    "texture": "Texture",
}


def prepare_environment() -> None:
    """Ask PyOpenGL and Qt for EGL, where it is; to be called before either is imported."""
    if not has_egl():
        return
    os.environ["PYOPENGL_PLATFORM"] = "egl"
    os.environ.setdefault("QT_XCB_GL_INTEGRATION", "xcb_egl")


def compile_quickly() -> None:
    """Let llvmpipe compile programs for little drawing; to be called before OpenGL is opened.

    Mesa's option "nopt" leaves out LLVM's passes over them. Pictures are the same to the bit.
    Compiling takes half the time, drawing 10 to 40 % more. Other drivers ignore it.
    """
    os.environ.setdefault("GALLIVM_PERF", "nopt")


@lru_cache(maxsize=1)
def begin_probe() -> "str | subprocess.Popen[str]":
    """The renderer on record, or the process of `probe_gl`, at work while others import."""
    prepare_environment()
    return take_record() or subprocess.Popen(
        [sys.executable, "-c", _PROBE],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        encoding="locale",
        errors="replace",
    )


@lru_cache(maxsize=1)
def probe_gl() -> tuple[str, str]:
    """Name of the GL renderer, or an empty text and a sentence that says why there is no renderer.

    Found by a separate process: a broken driver aborts instead of raising.
    """
    probe = begin_probe()
    if isinstance(probe, str):
        return probe, ""
    try:
        said, complaint = probe.communicate(timeout=_PROBE_TIMEOUT_S)
    except subprocess.TimeoutExpired:
        probe.kill()
        probe.communicate()
        reason = f"the GL driver did not answer within {_PROBE_TIMEOUT_S} s"
        return "", str(no_opengl(reason))
    if probe.returncode == 0:
        return said.strip(), ""
    lines = complaint.strip().splitlines()
    if probe.returncode == _REFUSED:
        return "", lines[-1]
    said = lines[-1] if lines else "it said nothing"
    return "", str(no_opengl(f"the GL driver ended the probe ({probe.returncode}): {said}"))


@lru_cache(maxsize=1)
def import_pyrender() -> Any:
    """The parts of pyrender that the renderer uses, repaired for this Python and numpy."""
    prepare_environment()
    np.infty = np.inf  # type: ignore[attr-defined]  # noqa: NPY201
    if sys.version_info >= (3, 12):
        from OpenGL.plugins import FormatHandler

        FormatHandler.by_name("ctypesparameter").check.append("_ctypes.CArgObject")
    found = importlib.util.find_spec("pyrender")
    if found is None or found.submodule_search_locations is None:
        raise ModuleNotFoundError("No module named 'pyrender'", name="pyrender")
    package = types.ModuleType("pyrender")
    package.__path__ = found.submodule_search_locations
    sys.modules["pyrender"] = package
    for part, name in _PARTS.items():
        setattr(package, name, getattr(importlib.import_module(f"pyrender.{part}"), name))
    return package
