"""Exceptions that the command line prints as one sentence, and the end of unwanted work."""

_LONGEST_SENTENCE = 2000


class _OneLine(Exception):
    """An exception whose text is one printable line, whatever file names it quotes."""

    def __str__(self) -> str:
        return one_line(super().__str__(), _LONGEST_SENTENCE)


class UserError(_OneLine):
    """Bad input: fault, place and remedy in one sentence; exit code 2."""


class ModuleFailed(_OneLine):
    """A module raised an unexpected exception; the text names the module. Exit code 1."""


class GivenUp(Exception):
    """Work that its caller no longer wants has ended."""


def one_line(text: str, longest: int) -> str:
    """A text with control characters escaped, and its middle cut out if it is too long."""
    if len(text) > longest:
        text = f"{text[: longest * 2 // 3]} ... {text[-longest // 4 :]}"
    if text.isprintable():
        return text
    return "".join(map(_shown, text))


def _shown(letter: str) -> str:
    if letter.isprintable():
        return letter
    return " " if letter.isspace() else letter.encode("unicode_escape").decode()
