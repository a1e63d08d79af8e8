"""The OpenXR runtime of this machine, and how it shares textures with our OpenGL."""

import ctypes
from typing import Any

from vrut_lite import operating_system
from vrut_lite.errors import UserError

# The extension by which a runtime takes pictures of an EGL context, and what it builds on.
_EGL, _OPENGL = "XR_MNDX_egl_enable", "XR_KHR_opengl_enable"
_EGL_CONFIG_ID, _EGL_NONE = 0x3028, 0x3038


def import_xr() -> Any:
    """The package pyopenxr.

    Raises:
        UserError: it is not installed, it cannot be loaded, or this system has no EGL.
    """
    if not operating_system.has_egl():
        raise UserError("VR needs OpenGL through EGL, which this system does not have")
    from OpenGL import platform

    # pyopenxr makes PyOpenGL look for its functions by GLX; they are EGL's here.
    chosen = platform.PLATFORM
    try:
        import xr
    except ModuleNotFoundError:
        raise UserError("VR needs pyopenxr: pip install 'vrut-lite[vr]'") from None
    except (ImportError, OSError) as error:
        raise UserError(f"VR is not possible: pyopenxr cannot be loaded ({error})") from error
    finally:
        platform.PLATFORM = chosen
    return xr


def open_runtime(xr: Any) -> Any:
    """An instance of the active runtime.

    Raises:
        UserError: no runtime answers, or the active one takes no pictures from EGL.
    """
    needed = [_OPENGL, _EGL]
    try:
        offered = {
            each.extension_name.decode() for each in xr.enumerate_instance_extension_properties()
        }
        if not offered.issuperset(needed):
            raise UserError(
                f"the OpenXR runtime takes no pictures from EGL ({_EGL}): Monado does, and "
                "runtimes built on it, such as WiVRn"
            )
        program = xr.ApplicationInfo("vrut_lite", 1, "vrut_lite", 1, xr.Version(1, 0, 0))
        return xr.create_instance(
            xr.InstanceCreateInfo(application_info=program, enabled_extension_names=needed)
        )
    except xr.XrException as error:
        raise UserError(
            f"no OpenXR runtime answers ({name_of(error)}): start one, such as Monado or WiVRn, or "
            "name its file in XR_RUNTIME_JSON"
        ) from error


def egl_binding(xr: Any) -> Any:
    """The EGL display, configuration and context that are current to this thread, for a session."""
    egl = ctypes.CDLL("libEGL.so.1")
    egl.eglGetCurrentDisplay.restype = egl.eglGetCurrentContext.restype = ctypes.c_void_p
    display = ctypes.c_void_p(egl.eglGetCurrentDisplay())
    context = ctypes.c_void_p(egl.eglGetCurrentContext())
    number, config, count = ctypes.c_int(), ctypes.c_void_p(), ctypes.c_int()
    egl.eglQueryContext(display, context, _EGL_CONFIG_ID, ctypes.byref(number))
    chosen_by = (ctypes.c_int * 3)(_EGL_CONFIG_ID, number.value, _EGL_NONE)
    egl.eglChooseConfig(display, chosen_by, ctypes.byref(config), 1, ctypes.byref(count))
    binding = xr.GraphicsBindingEGLMNDX
    # Their types depend on what PyOpenGL had loaded before pyopenxr.
    types = dict(binding._fields_)
    handles = {"display": display, "config": config, "context": context}
    return binding(
        get_proc_address=ctypes.cast(egl.eglGetProcAddress, types["get_proc_address"]),
        **{name: ctypes.cast(handle, types[name]) for name, handle in handles.items()},
    )


def name_of(error: BaseException) -> str:
    """The name of an error of OpenXR, as its specification writes it but for the case."""
    return type(error).__name__.removesuffix("Error")


def failure(error: BaseException) -> str:
    """A sentence on an error of OpenXR in a session; empty of any other error."""
    if type(error).__module__ != "xr.exception":
        return ""
    return f"the OpenXR runtime has failed ({name_of(error)}): start it again, and then enter VR"
