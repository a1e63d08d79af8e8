"""When the window draws a finished picture, which takes seconds, and what may end it early."""

# How long a finished picture waits for what drafts stand in for, and between two questions whether
# it is there: the first light of any of the project's scenes takes less.
DRAFT_PATIENCE_S, LOOK_AGAIN_S = 5.0, 0.05


class Finishing:
    """The finished picture: whether it is shown, when it is due, and whether inputs end it.

    Each method is an event, and changes what its row names:

    | event | stands | due_s | insists |
    |---|---|---|---|
    | moved | | after a rest | no |
    | lit | | now | no |
    | waits for drafts | | a little later | |
    | begun | | None | |
    | given up | | at once | yes |
    | shown | whether finished | | |
    | exposed | | now | |

    Attributes:
        stands: whether the last picture is a finished one.
        due_s: when the next finished picture is drawn; None where none is due.
        insists: whether one was given up and nothing visible has changed since, so that no input
            ends the next: a playing clock sends inputs more often than pictures can be drawn.
    """

    def __init__(self) -> None:
        self.stands = False
        self.due_s: float | None = None
        self.insists = False
        self._waits_since_s = 0.0

    def moved(self, due_s: float) -> None:
        """A visible change: the finished picture is due at `due_s`, if nothing moves before."""
        self.due_s = self._waits_since_s = due_s
        self.insists = False

    def lit(self, now_s: float) -> None:
        """Refined light has come: the finished picture is due now, without another draft."""
        self.moved(now_s)

    def is_due(self, now_s: float) -> bool:
        """Whether a finished picture is due."""
        return self.due_s is not None and now_s >= self.due_s

    def waits_for_drafts(self, now_s: float) -> bool:
        """Put off the picture that is due, for what drafts stand in for; False after a while."""
        waits = now_s < self._waits_since_s + DRAFT_PATIENCE_S
        if waits:
            self.due_s = now_s + LOOK_AGAIN_S
        return waits

    def begun(self) -> None:
        """The picture that was due is drawn; if it fails it is not tried again."""
        self.due_s = None

    def given_up(self, start_s: float) -> None:
        """An input ended the picture that was begun at `start_s`."""
        self.due_s = start_s
        self.insists = True

    def shown(self, still: bool) -> None:
        """A picture is shown, finished or not."""
        self.stands = still

    def exposed(self, now_s: float) -> None:
        """The shown picture has led to another exposure: it is drawn with that."""
        self.due_s = now_s
