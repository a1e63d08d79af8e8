"""Contexts that tell of a reset of the graphics driver, by EGL.

A context that is made without this notification hears of no reset: its calls do nothing, or the
driver ends the process (EGL 1.5 section 3.7.1; GL_KHR_robustness).
"""

import ctypes
from functools import lru_cache
from typing import Any

from vrut_lite.operating_system import has_egl

_EXTENSIONS, _CONFIG_ID, _NONE = 0x3055, 0x3028, 0x3038
_MAJOR_VERSION, _MINOR_VERSION = 0x3098, 0x30FB
_PROFILE_MASK, _CORE_PROFILE = 0x30FD, 0x1
_RESET_STRATEGY, _LOSE_CONTEXT = 0x31BD, 0x31BF
_NEEDED = b"EGL_KHR_create_context"
_Pointer = ctypes.c_void_p
_LEFT: list[Any] = []


def told_of_resets(context: Any, version: int) -> Any:
    """A context like this one, which is current, that is told of resets; or this one itself.

    Args:
        context: moderngl's; it is released where another takes its place.
        version: of OpenGL, such as 430.
    """
    if not has_egl():
        return context
    egl = _egl()
    display = egl.eglGetCurrentDisplay()
    extensions = egl.eglQueryString(display, _EXTENSIONS) or b""
    made = _made(egl, display, version) if _NEEDED in extensions.split() else None
    if not made:
        return context
    import moderngl

    _leave(context)
    egl.eglMakeCurrent(display, None, None, made)
    moderngl.init_context(_Loader(egl))
    found: Any = moderngl.get_context()
    found.own_egl = display, made
    return found


class _Loader:
    """Finds the functions of OpenGL for moderngl, which owns no context then."""

    def __init__(self, egl: Any):
        self._egl = egl

    def load_opengl_function(self, name: str) -> int:
        """Address of a function, 0 without one."""
        return self._egl.eglGetProcAddress(name.encode()) or 0

    def release(self) -> None:
        """Nothing: `destroy` ends the context."""


def destroy(context: Any) -> None:
    """Release a context of this thread and end it with all its objects."""
    _leave(context)
    if not has_egl():
        return
    egl = _egl()
    own = getattr(context, "own_egl", None)
    if own is not None:
        display, handle = own
        egl.eglMakeCurrent(display, None, None, None)
        egl.eglDestroyContext(display, handle)
    # A context that is current to a thread lives on, with every texture that is left in it.
    egl.eglReleaseThread()


def _leave(context: Any) -> None:
    """Release a context, which unbinds whatever is current to this thread.

    The object stays: to free it would do so again, at any moment and on any thread.
    """
    context.release()
    _LEFT.append(context)


def _made(egl: Any, display: Any, version: int) -> Any:
    """EGL's handle of a context with the present one's configuration; None if it refuses."""
    number, config, count = ctypes.c_int(), _Pointer(), ctypes.c_int()
    egl.eglQueryContext(display, egl.eglGetCurrentContext(), _CONFIG_ID, ctypes.byref(number))
    chosen = (ctypes.c_int * 3)(_CONFIG_ID, number.value, _NONE)
    egl.eglChooseConfig(display, chosen, ctypes.byref(config), 1, ctypes.byref(count))
    if count.value != 1:
        return None
    asked = (_MAJOR_VERSION, version // 100, _MINOR_VERSION, version % 100 // 10,
             _PROFILE_MASK, _CORE_PROFILE, _RESET_STRATEGY, _LOSE_CONTEXT, _NONE)  # fmt: skip
    return egl.eglCreateContext(display, config, None, (ctypes.c_int * len(asked))(*asked))


def has_context() -> bool:
    """Whether a context is current to this thread; true where only the system could say."""
    return not has_egl() or bool(_egl().eglGetCurrentContext())


@lru_cache(maxsize=1)
def _egl() -> Any:
    egl = ctypes.CDLL("libEGL.so.1")
    for name in ("eglGetCurrentDisplay", "eglGetCurrentContext", "eglCreateContext",
                 "eglGetProcAddress"):  # fmt: skip
        getattr(egl, name).restype = _Pointer
    egl.eglQueryString.restype = ctypes.c_char_p
    pointers = {
        "eglQueryString": (_Pointer, ctypes.c_int),
        "eglQueryContext": (_Pointer, _Pointer, ctypes.c_int, _Pointer),
        "eglChooseConfig": (_Pointer, _Pointer, _Pointer, ctypes.c_int, _Pointer),
        "eglCreateContext": (_Pointer, _Pointer, _Pointer, _Pointer),
        "eglMakeCurrent": (_Pointer, _Pointer, _Pointer, _Pointer),
        "eglDestroyContext": (_Pointer, _Pointer),
        "eglGetProcAddress": (ctypes.c_char_p,),
    }
    for name, kinds in pointers.items():
        getattr(egl, name).argtypes = kinds
    return egl
