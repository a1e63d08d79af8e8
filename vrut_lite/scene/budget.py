"""Memory budget for loading one scene: all its files, arrays, images and objects.

The rule: loading takes at most `PEAK_PER_BYTE` times the bytes counted here, plus `BASE_BYTES`.
A reader counts the declared size before it takes memory, and reads and counts once what the
scene refers to many times.

Work is limited too: what the scene asks to have read, overlapping arrays and arrays without
bytes included, is compared with the bytes in its files.
"""

from vrut_lite.memory_limit import VARIABLE, memory_limit_bytes
from vrut_lite.scene.scene_file_error import SceneFileError

PEAK_PER_BYTE = 2.5
BASE_BYTES = 512 * 2**20
# Bytes that a scene may ask for: per byte of its files, and in any case.
_ASKED_PER_BYTE = 8
_ASKED_BASE_BYTES = 4 * 2**20
_MIB, _GIB = 2.0**20, 2.0**30


class SceneBudget:
    """Counts the bytes that one scene takes in memory, has in its files, and asks for."""

    def __init__(self, limit_bytes: float) -> None:
        self._limit_bytes = limit_bytes
        self._counted_bytes = 0
        self._found_bytes = 0
        self._asked_bytes = 0

    @property
    def peak_bytes(self) -> float:
        """The most memory that loading takes, by the sizes counted so far."""
        return PEAK_PER_BYTE * self._counted_bytes + BASE_BYTES

    @property
    def room_bytes(self) -> float:
        """The memory that loading may still take, by the sizes counted so far."""
        return max(self._limit_bytes - self.peak_bytes, 0.0)

    def check(self, size_bytes: int, what: str) -> None:
        """Refuse a size that exceeds the limit, without counting it.

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
        """Count memory that is about to be taken until the scene is loaded.

        Raises:
            SceneFileError: as `check` does.
        """
        self.check(size_bytes, what)
        self._counted_bytes += size_bytes

    def release(self, size_bytes: int) -> None:
        """Count off memory that was taken and is given back."""
        self._counted_bytes -= size_bytes

    def find(self, size_bytes: int) -> None:
        """Count bytes of the scene's files."""
        self._found_bytes += size_bytes

    def ask(self, size_bytes: int, what: str) -> None:
        """Count data that the scene asks to have read.

        Raises:
            SceneFileError: if they far exceed the bytes of its files.
        """
        self._asked_bytes += size_bytes
        if self._asked_bytes > _ASKED_BASE_BYTES + _ASKED_PER_BYTE * self._found_bytes:
            raise SceneFileError(
                f"{what} and what it names before count {self._asked_bytes / _MIB:,.1f} MiB, above "
                f"the limit for a scene of {self._found_bytes / _MIB:,.1f} MiB (8 times that and "
                "4 MiB); export it again with its data"
            )


def budget_of_environment() -> SceneBudget:
    """A budget with the environment's memory limit.

    Raises:
        UserError: the variable is not a number.
    """
    return SceneBudget(memory_limit_bytes())
