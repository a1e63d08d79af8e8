"""What an exception says, in the fields that a `Fault` and a `JobResult` share."""

import traceback
from typing import Any

from vrut_lite.errors import UserError


def described(error: BaseException) -> dict[str, Any]:
    """The fields `error`, `trace` and `for_user`; a UserError speaks for itself."""
    for_user = isinstance(error, UserError)
    return {
        "error": _text(error) if for_user else f"{type(error).__name__}: {_text(error)}",
        "trace": "".join(traceback.format_exception(error)),
        "for_user": for_user,
    }


def _text(error: BaseException) -> str:
    """What it says, if it can say it."""
    try:
        return str(error)
    except Exception:
        return "(its text cannot be made)"
