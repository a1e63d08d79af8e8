"""The one thread that owns the process's OpenGL context."""

from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import suppress
from time import perf_counter
from typing import Any, NamedTuple, TypeVar

from vrut_lite.errors import UserError
from vrut_lite.render.context_loss import ContextLostError, begin_anew, loss
from vrut_lite.render.device import Device, device_of
from vrut_lite.render.first_mipmaps import make_first_mipmaps
from vrut_lite.render.gl_choice import open_context
from vrut_lite.render.gl_environment import prepare_environment, probe_gl
from vrut_lite.render.gl_record import keep_record
from vrut_lite.render.graphics_memory import GraphicsMemoryFullError
from vrut_lite.render.reset_notice import destroy

T = TypeVar("T")
# After so many resets within so long (s) a software renderer draws.
_MOST_RESETS, _SOON_S = 2, 60.0


class Opened(NamedTuple):
    """OpenGL as the GL thread opened it: renderer name, context and device."""

    renderer: str
    context: Any
    device: Device


class Reset(NamedTuple):
    """A lost context: why, when it was noticed (perf_counter), and what took its place."""

    why: str
    at_s: float
    renderer: str


class GlOwner:
    """Runs work on the GL thread, one piece after another.

    Work is a callable that gets the moderngl context; it must not keep it. Everything that
    touches OpenGL in this process goes through here, so that no two threads ever share it.

    OpenGL is opened while the caller continues, for example with imports; `opened` waits for it.
    A given `trial_ns` replaces the renderer's trial (see `device`), so that a processor draws as a
    card would, or a card as a processor.

    A context that is lost, because the driver was reset, is replaced by another before more work is
    done: of the first device that opens, or of a software renderer after the second loss within a
    minute. Who keeps objects of OpenGL makes them anew by `on_reset`.
    """

    def __init__(self, trial_ns: float | None = None) -> None:
        self._trial_ns = trial_ns
        self._thread = ThreadPoolExecutor(max_workers=1, thread_name_prefix="gl-owner")
        self._opened = self._thread.submit(_open, trial_ns)
        # The context that replaced the first one.
        self._reopened: Opened | None = None
        self._rebuilders: list[Callable[[Any], None]] = []
        self._resets: list[Reset] = []
        self._untold: Reset | None = None
        self._thread.submit(lambda: make_first_mipmaps(self.opened.context))

    @property
    def opened(self) -> Opened:
        """The renderer, context and device; waits until OpenGL is open.

        Raises:
            UserError: there is no OpenGL 4.3 on this machine.
        """
        return self._reopened or self._opened.result()

    @property
    def resets(self) -> int:
        """How many contexts were lost."""
        return len(self._resets)

    def on_reset(self, rebuild: Callable[[Any], None]) -> None:
        """Call `rebuild(context)` on the GL thread after each reset.

        Objects of the lost context are gone: to free them would free those of the new one.
        """
        self._rebuilders.append(rebuild)

    def forget(self, rebuild: Callable[[Any], None]) -> None:
        """Call it no more."""
        self._rebuilders.remove(rebuild)

    def untold_reset(self) -> Reset | None:
        """The last reset, once."""
        untold, self._untold = self._untold, None
        return untold

    def submit(self, work: Callable[[Any], T]) -> "Future[T]":
        """Queue work for the GL thread."""
        return self._thread.submit(lambda: self._done(work))

    def call(self, work: Callable[[Any], T]) -> T:
        """Do work on the GL thread and wait for its result.

        Raises:
            ContextLostError: the context was lost meanwhile; there is another by now.
            UserError: OpenGL failed, for example without free memory.
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
                f"OpenGL failed ({said}): the graphics driver may be out of memory; "
                "try again, or a smaller picture"
            ) from error

    def close(self) -> None:
        """Finish queued work and release the context with all its objects."""
        if self._opened.exception() is None:
            self._thread.submit(lambda: _release(self.opened.context)).result()
        self._thread.shutdown()

    # --- on the GL thread ----------------------------------------------------------------

    def _done(self, work: Callable[[Any], T]) -> T:
        """Do work in a context that is there.

        Raises:
            ContextLostError: the context was lost meanwhile, or the work says so.
        """
        context = self.opened.context
        if why := loss():
            context = self._reopen(why)
        try:
            result = work(context)
        except BaseException as error:
            if not (why := loss(error)):
                raise
            self._reopen(why)
            raise ContextLostError(f"the graphics driver failed: {why}") from error
        if why := loss():
            self._reopen(why)
            raise ContextLostError(f"the graphics driver failed: {why}")
        return result

    def _reopen(self, why: str) -> Any:
        """Another context in place of the lost one, with all that is kept in it."""
        at_s = perf_counter()
        recent = [reset for reset in self._resets if at_s - reset.at_s < _SOON_S]
        with suppress(Exception):  # Of a dead driver's context nothing is certain.
            _release(self.opened.context)
        context = _create_context(only_software=len(recent) >= _MOST_RESETS - 1)
        begin_anew()
        name = context.info["GL_RENDERER"]
        self._reopened = Opened(name, context, device_of(context, self._trial_ns))
        self._untold = Reset(why, at_s, name)
        self._resets.append(self._untold)
        for rebuild in list(self._rebuilders):
            rebuild(context)
        return context


def _open(trial_ns: float | None) -> Opened:
    renderer, reason = probe_gl()
    if not renderer:
        raise UserError(reason)
    context = _create_context()
    begin_anew()
    keep_record(renderer)
    return Opened(renderer, context, device_of(context, trial_ns))


def _release(context: Any) -> None:
    from OpenGL import contextdata

    # PyOpenGL keeps arrays that were passed to this context, by its address.
    contextdata.cleanupContext()
    destroy(context)


def _create_context(only_software: bool = False) -> Any:
    prepare_environment()
    context = open_context(only_software)
    context.extra = context.simple_framebuffer((1, 1))
    return context


def bind_permanent_framebuffer(context: Any) -> None:
    """Bind a framebuffer that lives as long as the context; call it before releasing others.

    moderngl binds the last used framebuffer again, even after its release.
    """
    context.extra.use()
