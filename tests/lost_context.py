"""Takes the context from under the GL thread, as a reset of the driver does."""

import ctypes


def destroy_context(owner):
    """End the context of the GL thread with all that it holds."""
    # Beside the owner's own way, which would look at the context thereafter.
    owner._thread.submit(_destroy).result()


def unbind_context():
    """Leave this thread, the GL thread, without a context."""
    egl, display, _ = _current()
    assert egl.eglMakeCurrent(display, None, None, None)


def _destroy():
    egl, display, context = _current()
    assert egl.eglMakeCurrent(display, None, None, None)
    assert egl.eglDestroyContext(display, context)


def _current():
    egl = ctypes.CDLL("libEGL.so.1")
    for name in ("eglGetCurrentDisplay", "eglGetCurrentContext"):
        getattr(egl, name).restype = ctypes.c_void_p
    pointers = egl.eglGetCurrentDisplay(), egl.eglGetCurrentContext()
    return egl, *map(ctypes.c_void_p, pointers)
