"""Whether the context of this thread is lost: its driver was reset, or it is gone."""

import ctypes
import threading
from collections.abc import Callable
from functools import lru_cache

from vrut_lite.errors import UserError
from vrut_lite.render.reset_notice import has_context

# Answers of glGetGraphicsResetStatus (OpenGL 4.5, GL_KHR_robustness).
_REASONS = {
    0x8253: "by work of this program",
    0x8254: "by work of another program",
    0x8255: "for an unknown reason",
}
# The error of calls in a lost context.
_CONTEXT_LOST = 0x0507
_NAMES = (
    b"glGetGraphicsResetStatus", b"glGetGraphicsResetStatusARB", b"glGetGraphicsResetStatusKHR",
)  # fmt: skip


class ContextLostError(UserError):
    """The context was lost while work was done in it; another has taken its place since."""


# Why the thread's context is lost: a driver may tell of a reset once only.
_known = threading.local()


def loss(error: BaseException | None = None) -> str:
    """Why the context of this thread is lost, for a sentence; empty while it is not.

    Args:
        error: an error of work in it, which may say so.
    """
    known: str = getattr(_known, "why", "")
    if known:
        return known
    if not has_context():
        _known.why = "its context is gone"
        return _known.why
    status = reset_status()
    if isinstance(error, ContextLostError):
        _known.why = str(error)
    elif status:
        _known.why = f"it was reset {_REASONS.get(status, hex(status))}"
    elif getattr(error, "err", 0) == _CONTEXT_LOST:
        _known.why = "it was reset"
    return getattr(_known, "why", "")


def begin_anew() -> None:
    """Another context is current to this thread."""
    _known.why = ""


def reset_status() -> int:
    """The driver's answer whether it was reset, 0 if not; also where it cannot tell."""
    ask = _question()
    return 0 if ask is None else ask()


@lru_cache(maxsize=1)
def _question() -> Callable[[], int] | None:
    from OpenGL.platform import PLATFORM

    found = filter(None, map(PLATFORM.getExtensionProcedure, _NAMES))
    address = next(found, None)
    return None if address is None else ctypes.CFUNCTYPE(ctypes.c_uint)(address)
