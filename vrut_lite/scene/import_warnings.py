"""Import warnings: parts of a scene's files that the picture does not show.

A reader that leaves a part out, guesses, or shows a replacement adds a warning. The lines go with
`SceneOpened` to the window and to the command line.
"""

# Most kinds of warnings: a file may name any number of unknown parts.
MOST_KINDS = 32
_LONGEST = 160


class Notices:
    """One line for each kind of thing, with how often it occurs."""

    def __init__(self) -> None:
        self._counts: dict[tuple[str, str], int] = {}

    def tell(self, what: str, instead: str, count: int = 1) -> None:
        """Add a warning: `what` occurs `count` times more, and `instead` is its replacement.

        Both are parts of a sentence, as ("primitives of points or lines", "not drawn"). Text of the
        file itself is escaped and cut off.
        """
        if count > 0:
            key = (_safe(what), _safe(instead))
            self._counts[key] = self._counts.get(key, 0) + count

    def tell_once(self, what: str, instead: str) -> None:
        """Add a notice without a count, for geometry that is read in each pose."""
        self._counts[_safe(what), _safe(instead)] = 1

    def lines(self) -> tuple[str, ...]:
        """The lines, in the order in which their kinds were first told."""
        shown = [_line(what, instead, count) for (what, instead), count in self._counts.items()]
        if len(shown) > MOST_KINDS:
            shown[MOST_KINDS:] = [f"and {len(shown) - MOST_KINDS} other kinds of things: left out"]
        return tuple(shown)


def _line(what: str, instead: str, count: int) -> str:
    return f"{what}{f' ({count:,} times)' if count > 1 else ''}: {instead}"


def _safe(text: str) -> str:
    return ascii(text)[1:-1][:_LONGEST]
