"""What loading one scene may take: one budget for all its files, arrays, images and objects.

The rule: loading takes at most `PEAK_PER_BYTE` times what was counted here, plus `BASE_BYTES`.
Whoever is about to take memory asks first, with the size that the file declares; so what is
referred to many times must be read once and counted once, by whoever reads it.

A small file may not ask for much work either: arrays that overlap, or that no bytes stand
behind, are counted against the bytes that the scene brings.
"""

from vrut_lite.memory_limit import VARIABLE, memory_limit_bytes
from vrut_lite.scene.scene_file_error import SceneFileError

PEAK_PER_BYTE = 2.5
BASE_BYTES = 512 * 2**20
# Of each byte in its files a scene may ask for so many, beside what any scene may ask for.
_ASKED_PER_BYTE = 8
_ASKED_BASE_BYTES = 4 * 2**20
_MIB, _GIB = 2.0**20, 2.0**30


class SceneBudget:
    """Counts what one scene holds, is to hold, and asks for."""

    def __init__(self, limit_bytes: float) -> None:
        self._limit_bytes = limit_bytes
        self._counted_bytes = 0
        self._found_bytes = 0
        self._asked_bytes = 0

    @property
    def peak_bytes(self) -> float:
        """The most memory that loading takes with what was counted so far."""
        return PEAK_PER_BYTE * self._counted_bytes + BASE_BYTES

    def check(self, size_bytes: int, what: str) -> None:
        """Refuse what would not fit, without counting it.

        Raises:
            SceneFileError: naming `what`, its size, the limit, and how to raise it.
        """
        peak_bytes = self.peak_bytes + PEAK_PER_BYTE * size_bytes
        if peak_bytes > self._limit_bytes:
            raise SceneFileError(
                f"{what} would hold {size_bytes / _MIB:,.0f} MiB in memory, so that loading takes "
                f"up to {peak_bytes / _GIB:,.1f} GiB, above the limit of "
                f"{self._limit_bytes / _GIB:g} GiB; simplify it, or raise {VARIABLE}"
            )

    def take(self, size_bytes: int, what: str) -> None:
        """Count memory that will be held until the scene is loaded.

        Raises:
            SceneFileError: as `check` does.
        """
        self.check(size_bytes, what)
        self._counted_bytes += size_bytes

    def find(self, size_bytes: int) -> None:
        """Bytes that the scene brings, in a file or in itself."""
        self._found_bytes += size_bytes

    def ask(self, size_bytes: int, what: str) -> None:
        """Count what the scene wants to have read or worked on.

        Raises:
            SceneFileError: if that is far more than the bytes it brings.
        """
        self._asked_bytes += size_bytes
        if self._asked_bytes > _ASKED_BASE_BYTES + _ASKED_PER_BYTE * self._found_bytes:
            raise SceneFileError(
                f"{what} and what it names before count {self._asked_bytes / _MIB:,.1f} MiB, above "
                f"the limit for a scene of {self._found_bytes / _MIB:,.1f} MiB (8 times that and "
                "4 MiB); export it again with its data"
            )


def budget_of_environment() -> SceneBudget:
    """The budget that the memory limit of the environment leaves.

    Raises:
        UserError: the variable holds no number.
    """
    return SceneBudget(memory_limit_bytes())
