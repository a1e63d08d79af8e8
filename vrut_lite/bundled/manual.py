"""The manual's start page on this machine."""

from pathlib import Path
from typing import Any

from platformdirs import user_cache_path

from vrut_lite.bundled.places import CHECKOUT, MANUAL, is_checkout
from vrut_lite.errors import UserError
from vrut_lite.lazy import lazy

# Only a checkout makes pages at run time.
manual_pages: Any = lazy("vrut_lite.bundled.manual_pages")


def manual_start() -> Path:
    """The manual's start page: the wheel's; in a checkout written now, into the cache folder.

    Raises:
        UserError: the program came without a manual, or the cache folder cannot be written.
    """
    if (MANUAL / "index.html").is_file():
        return MANUAL / "index.html"
    if not is_checkout():
        raise UserError(
            "this installation has no manual: install the wheel of vrut_lite, which holds it"
        )
    folder = user_cache_path("vrut_lite") / "manual"
    try:
        start: Path = manual_pages.write_manual(CHECKOUT, folder)
    except OSError as error:
        raise UserError(f"cannot write the manual into {folder}: {error.strerror}") from error
    return start
