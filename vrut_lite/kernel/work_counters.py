"""How much work was done and how much was skipped, counted beside the code that skips."""

from collections import Counter


class WorkCounters:
    """Counts of work done and skipped, by the name of the work."""

    def __init__(self) -> None:
        self.done: Counter[str] = Counter()
        self.skipped: Counter[str] = Counter()

    def did(self, work: str, amount: int = 1) -> None:
        """Count work done."""
        self.done[work] += amount

    def skip(self, work: str, amount: int = 1) -> None:
        """Count requested work that was not needed."""
        self.skipped[work] += amount
