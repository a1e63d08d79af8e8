"""The one thread that owns the process's OpenGL context."""

from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Any, NamedTuple, TypeVar

from vrut_lite.errors import UserError
from vrut_lite.operating_system import has_egl
from vrut_lite.render.device import Device, device_of
from vrut_lite.render.first_mipmaps import make_first_mipmaps
from vrut_lite.render.gl_choice import open_context
from vrut_lite.render.gl_environment import prepare_environment, probe_gl
from vrut_lite.render.gl_record import keep_record
from vrut_lite.render.graphics_memory import GraphicsMemoryFullError

T = TypeVar("T")


class Opened(NamedTuple):
    """OpenGL as the GL thread opened it: renderer name, context and device."""

    renderer: str
    context: Any
    device: Device


class GlOwner:
    """Runs work on the GL thread, one piece after another.

    Work is a callable that gets the moderngl context; it must not keep it. Everything that
    touches OpenGL in this process goes through here, so that no two threads ever share it.

    OpenGL is opened while the caller continues, for example with imports; `opened` waits for it.
    A given `trial_ns` replaces the renderer's trial (see `device`), so that a processor draws as a
    card would, or a card as a processor.
    """

    def __init__(self, trial_ns: float | None = None) -> None:
        self._thread = ThreadPoolExecutor(max_workers=1, thread_name_prefix="gl-owner")
        self._opened = self._thread.submit(_open, trial_ns)
        self._thread.submit(lambda: make_first_mipmaps(self.opened.context))

    @property
    def opened(self) -> Opened:
        """The renderer, context and device; waits until OpenGL is open.

        Raises:
            UserError: there is no OpenGL 4.3 on this machine.
        """
        return self._opened.result()

    def submit(self, work: Callable[[Any], T]) -> "Future[T]":
        """Queue work for the GL thread."""
        return self._thread.submit(lambda: work(self.opened.context))

    def call(self, work: Callable[[Any], T]) -> T:
        """Do work on the GL thread and wait for its result.

        Raises:
            UserError: OpenGL failed, for example after a driver reset or without free memory.
        """
        from moderngl import Error
        from OpenGL.error import Error as LowLevelError

        try:
            return self.submit(work).result()
        except GraphicsMemoryFullError as error:
            raise UserError(
                f"there is {error}: close other programs, or try a smaller one"
            ) from error
        except (Error, LowLevelError) as error:
            reason = getattr(error, "description", None) or error
            said = reason.decode() if isinstance(reason, bytes) else str(reason)
            raise UserError(
                f"OpenGL failed ({said}): the graphics driver was reset or is out of memory; "
                "try again, or a smaller picture"
            ) from error

    def close(self) -> None:
        """Finish queued work and release the context with all its objects."""
        if self._opened.exception() is None:
            self.submit(_release).result()
        self._thread.shutdown()


def _open(trial_ns: float | None) -> Opened:
    renderer, reason = probe_gl()
    if not renderer:
        raise UserError(reason)
    context = _create_context()
    keep_record(renderer)
    return Opened(renderer, context, device_of(context, trial_ns))


def _release(context: Any) -> None:
    from OpenGL import contextdata

    # PyOpenGL keeps arrays that were passed to this context, by its address.
    contextdata.cleanupContext()
    context.release()
    if has_egl():
        from OpenGL import EGL

        # A context that is current to a thread lives on, with every texture that is left in it.
        EGL.eglReleaseThread()


def _create_context() -> Any:
    prepare_environment()
    context = open_context()
    context.extra = context.simple_framebuffer((1, 1))
    return context


def bind_permanent_framebuffer(context: Any) -> None:
    """Bind a framebuffer that lives as long as the context; call it before releasing others.

    moderngl binds the last used framebuffer again, even after its release.
    """
    context.extra.use()
