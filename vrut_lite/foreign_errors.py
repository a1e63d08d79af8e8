"""The text of an exception, in the fields that `Fault` and `JobResult` share.

An exception's texts are a module's code: they may raise, return other types, or fill the memory.
"""

import traceback
from collections.abc import Callable
from typing import Any

from vrut_lite.errors import UserError
from vrut_lite.interrupts import pass_interrupt

# Letters of an error's text and of its trace, whose ends are kept.
_LONGEST_ERROR, _LONGEST_TRACE = 2_000, 20_000


def described(error: BaseException) -> dict[str, Any]:
    """The fields `error`, `trace` and `for_user`; a UserError speaks for itself."""
    return {
        "error": sentence_of(error),
        "trace": _shortened(
            safe_text(lambda: "".join(traceback.format_exception(error)), "no traceback"),
            _LONGEST_TRACE,
        ),
        "for_user": isinstance(error, UserError),
    }


def sentence_of(error: BaseException) -> str:
    """Its text, after its class's name unless that is UserError; bounded in length."""
    text = safe_text(lambda: str(error), "(its text cannot be made)")
    if not isinstance(error, UserError):
        name = safe_text(lambda: type(error).__name__, "BaseException")
        text = f"{name}: {text}"
    return _shortened(text, _LONGEST_ERROR)


def safe_text(make: Callable[[], str], otherwise: str) -> str:
    """A module's text as a plain str, or a substitute where reading it raises."""
    try:
        # A slice of a subclass is a plain text.
        return _escaped(str.__getitem__(make(), slice(None)))
    except BaseException as error:
        pass_interrupt(error)
        return otherwise


def _escaped(text: str) -> str:
    """The text with control characters and lone surrogates escaped."""
    return "".join(
        letter if letter.isprintable() or letter in "\n\t" else ascii(letter)[1:-1]
        for letter in text
    )


def _shortened(text: str, most: int) -> str:
    if len(text) <= most:
        return text
    return f"{text[: most // 2]} [... {len(text) - most} letters ...] {text[-most // 2 :]}"
