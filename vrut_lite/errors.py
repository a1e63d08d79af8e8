"""The exceptions that the command line tells in one sentence."""

_LONGEST_SENTENCE = 2000


class _Told(Exception):
    """Its text is one line that a terminal shows as it is, whatever names of a file it quotes."""

    def __str__(self) -> str:
        return one_line(super().__str__(), _LONGEST_SENTENCE)


class UserError(_Told):
    """Bad input: what is wrong, where, and what to do, in one sentence; exit code 2."""


class ModuleFailed(_Told):
    """A module raised what it should not; the text names it. Exit code 1."""


def one_line(text: str, longest: int) -> str:
    """A text with control characters as escapes, and without its middle if it is too long."""
    if len(text) > longest:
        text = f"{text[: longest * 2 // 3]} ... {text[-longest // 4 :]}"
    if text.isprintable():
        return text
    return "".join(map(_shown, text))


def _shown(letter: str) -> str:
    if letter.isprintable():
        return letter
    return " " if letter.isspace() else letter.encode("unicode_escape").decode()
