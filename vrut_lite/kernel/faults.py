"""What an exception says, in the fields that a `Fault` and a `JobResult` share."""

import traceback
from typing import Any

from vrut_lite.errors import UserError


def described(error: Exception) -> dict[str, Any]:
    """The fields `error`, `trace` and `for_user`; a UserError speaks for itself."""
    for_user = isinstance(error, UserError)
    return {
        "error": str(error) if for_user else f"{type(error).__name__}: {error}",
        "trace": "".join(traceback.format_exception(error)),
        "for_user": for_user,
    }
