"""Options of picture files that several commands share."""

import click

from vrut_lite.errors import UserError
from vrut_lite.pictures.display import Bits

bits_option = click.option(
    "--bits",
    type=click.Choice(["8", "16"]),
    help="Of a PNG's channels: 8 (the default), dithered, or 16.",
)


def picture_bits(text: str | None, suffix: str) -> Bits:
    """What --bits says.

    Raises:
        UserError: it was said of another format, whose precision is its own.
    """
    if text is not None and suffix != ".png":
        raise UserError(f"--bits is for .png: {suffix} has a precision of its own")
    return 16 if text == "16" else 8
