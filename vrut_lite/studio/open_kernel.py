"""Kernels for commands: reports modules that failed to load, and refuses missing light."""

from typing import TYPE_CHECKING

import click

from vrut_lite.daylight_kernel import daylight_kernel
from vrut_lite.errors import ModuleFailed
from vrut_lite.interrupts import interrupts_held
from vrut_lite.kernel.bus import Kernel
from vrut_lite.lazy import lazy
from vrut_lite.messages.sky import BackgroundChanged
from vrut_lite.messages.sun import SunMoved
from vrut_lite.studio.compile_message import tell_of_compilation

if TYPE_CHECKING:
    from vrut_lite.host import Host
    from vrut_lite.render.gl_owner import GlOwner

# Commands without a picture need no OpenGL.
_host = lazy("vrut_lite.host:Host")
_gl_owner = lazy("vrut_lite.render.gl_owner:GlOwner")


def open_kernel() -> Kernel:
    """A kernel with all installed modules; one line on standard error for each that is broken."""
    tell_of_compilation()
    kernel, failures = daylight_kernel()
    tell(failures)
    return kernel


def open_host(gl: "GlOwner | None" = None) -> "Host":
    """A host, and one line on standard error for each module that is broken."""
    tell_of_compilation(scene=True)
    gl = gl or open_gl()
    with interrupts_held():
        host: Host = _host(gl=gl)
    tell(host.failures)
    return host


def open_gl() -> "GlOwner":
    """OpenGL, opened while the caller goes on; for `open_host`, or to be closed."""
    with interrupts_held():
        owner: GlOwner = _gl_owner()
    return owner


def tell(failures: list[str]) -> None:
    """Print the modules that failed to load on standard error."""
    for failure in failures:
        click.echo(f"vrut-lite: {failure}", err=True)


def require_sun(kernel: Kernel) -> SunMoved:
    """The sun's position.

    Raises:
        ModuleFailed: no module holds the sun.
    """
    sun = kernel.last(SunMoved)
    if sun is None:
        raise ModuleFailed("no module tells where the sun stands: see `vrut-lite modules`")
    return sun


def require_sky(kernel: Kernel) -> BackgroundChanged:
    """The background of the slot's holder.

    Raises:
        ModuleFailed: no module holds the sun, or none the sky.
    """
    require_sun(kernel)
    background = kernel.last(BackgroundChanged)
    if background is None:
        raise ModuleFailed("no module makes a sky: see `vrut-lite modules`")
    return background
