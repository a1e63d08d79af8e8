"""The OpenGL context of the process, on the graphics card that the user chose.

A laptop may have two cards, and Mesa's software renderer beside them; each is an EGL device.
`VRUT_LITE_GPU` names one by its number or a part of its name, such as "nvidia", "intel" or
"llvmpipe". Without it the first that has what the renderer needs is taken. Windows and macOS have
no EGL: there the system chooses the card, and moderngl the way (WGL with a hidden window, CGL).
"""

import os
from collections.abc import Iterable
from itertools import count
from typing import Any

from vrut_lite import operating_system
from vrut_lite.errors import UserError
from vrut_lite.operating_system import has_egl
from vrut_lite.render.reset_notice import told_of_resets
from vrut_lite.render.software_names import is_software

VARIABLE = "VRUT_LITE_GPU"
_NEEDED, _OLDEST = 430, 330
_WITHOUT = "skies (`vrut-lite sky`), numbers (`vrut-lite daylight`) and the path tracer need none"


def open_context(only_software: bool = False) -> Any:
    """A context of OpenGL 4.3 with clip control, current to this thread and told of resets.

    Args:
        only_software: whether a processor must draw, whatever the user's variable says.

    Raises:
        UserError: no device is sufficient, or the user's variable names no such device.
    """
    wish = "" if only_software else os.environ.get(VARIABLE, "").strip()
    seen: list[str] = []
    devices: Iterable[int] = count() if has_egl() else (0,)
    for index in devices:
        try:
            context = _create(index, _NEEDED)
        except Exception as error:  # moderngl raises plain exceptions.
            if "but found" in str(error):
                break
            # A missing library is missing for each device, of which there is no last one.
            if "not loaded" in str(error):
                raise no_opengl(str(error)) from error
            seen.append(f"{index}: {_older(index) or error}")
            continue
        name = context.info["GL_RENDERER"]
        lack = _lack(context)
        seen.append(f"{index}: {name}{lack and ' ' + lack}")
        fits = is_software(name) if only_software else _is_wished(wish, index, context)
        if not lack and fits:
            return told_of_resets(context, _NEEDED)
        context.release()
    if only_software:
        raise UserError(
            f"the graphics driver was reset again, and no software renderer is there "
            f"({'; '.join(seen)}): install Mesa's llvmpipe, or start the program again"
        )
    raise _refusal(wish, seen)


def _create(index: int, version: int) -> Any:
    import moderngl

    if not has_egl():
        return moderngl.create_context(standalone=True, require=version)
    # moderngl's annotation of `backend` is wrong: its own documentation passes a text.
    return moderngl.create_context(
        standalone=True,
        require=version,
        backend="egl",  # type: ignore[arg-type]
        device_index=index,  # type: ignore[arg-type]
    )


def _older(index: int) -> str:
    """Name and version of a device whose OpenGL is older; empty if it does not open at all."""
    try:
        context = _create(index, _OLDEST)
    except Exception:  # moderngl raises plain exceptions.
        return ""
    version = context.version_code
    said = f"{context.info['GL_RENDERER']} has OpenGL {version // 100}.{version % 100 // 10}"
    context.release()
    return said


def _lack(context: Any) -> str:
    has_clip_control = context.version_code >= 450 or "GL_ARB_clip_control" in context.extensions
    return "" if has_clip_control else "has no clip control (OpenGL 4.5)"


def _is_wished(wish: str, index: int, context: Any) -> bool:
    if wish.isdecimal():
        return index == int(wish)
    names = f"{context.info['GL_VENDOR']} {context.info['GL_RENDERER']}"
    return wish.lower() in names.lower()


def _refusal(wish: str, seen: list[str]) -> UserError:
    there = "; ".join(seen)
    if not seen:
        return no_opengl("no device answers")
    if wish:
        return UserError(f"{VARIABLE} names no usable graphics card: {wish!r}; there are {there}")
    return UserError(
        f"no OpenGL 4.3 with clip control{_way()} here ({there}): {_newer()}; {_WITHOUT}"
    )


def no_opengl(reason: str) -> UserError:
    """The refusal where no driver answers, or where it ends the process."""
    remedy = "install the packages libegl1 and libgl1, or their like" if has_egl() else _newer()
    return UserError(f"no OpenGL 4.3{_way()} here ({reason}): {remedy}; {_WITHOUT}")


def _way() -> str:
    return " through EGL" if has_egl() else ""


def _newer() -> str:
    """Advice on how to get a newer OpenGL."""
    if operating_system.NAME == "darwin":
        return "macOS has none above 4.1"
    mesa = ", or Mesa's llvmpipe" if has_egl() else ""
    return f"a newer driver is needed{mesa}"
