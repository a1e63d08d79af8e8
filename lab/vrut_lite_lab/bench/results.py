"""The results of a run as structs, which are written and read as JSON."""

from pathlib import Path

import msgspec

from vrut_lite.errors import UserError

FORMAT = 1


class Errors(msgspec.Struct, frozen=True):
    """Relative errors of a picture or a grid: mean, 99th percentile, largest."""

    mean: float
    p99: float
    largest: float


class MeasuredPath(msgspec.Struct, frozen=True):
    """One path: seconds and errors.

    Attributes:
        group, name, family, device, parameters: as of the path.
        clock: how `rounds_s` were counted.
        rounds_s: the least seconds per unit of each round; one round alone if a call is long.
        wall_s: the least wall time per unit.
        errors: by condition; empty where nothing can err.
    """

    group: str
    name: str
    family: str
    device: str
    parameters: dict[str, int | float | str]
    clock: str
    rounds_s: list[float]
    wall_s: float
    errors: dict[str, Errors]

    @property
    def seconds(self) -> float:
        """The least of all rounds, per unit."""
        return min(self.rounds_s)

    def worst(self, at_night: bool = False, size: str = "p99") -> float | None:
        """The largest of a size of `Errors` over all conditions by day, or those at night."""
        sizes = [getattr(e, size) for name, e in self.errors.items() if is_night(name) == at_night]
        return max(sizes, default=None)


def is_night(condition: str) -> bool:
    """Whether a condition's name says that the sun is below the horizon."""
    return "sun -" in condition


class GroupNote(msgspec.Struct, frozen=True):
    """A group's description: see `bench_path.Group`."""

    name: str
    title: str
    unit: str
    norm: str
    truth: str
    front_of: str


class Machine(msgspec.Struct, frozen=True):
    """Where and when: UTC date, processor, versions, OpenGL, load before and after.

    `pace_s`: the least seconds of a fixed piece of work, tried all along.
    """

    date: str
    processor: str
    cores: int
    system: str
    renderer: str
    versions: dict[str, str]
    load_before: tuple[float, float, float]
    load_after: tuple[float, float, float]
    pace_s: float


class Results(msgspec.Struct, frozen=True):
    """All of a run.

    Attributes:
        quick: whether it was the short form, whose truths are coarser.
        kinds: the computations that were measured.
        spent_s: wall time of all.
        left_out: paths and groups that could not be measured, and why.
    """

    format: int
    quick: bool
    kinds: list[str]
    machine: Machine
    spent_s: float
    groups: list[GroupNote]
    paths: list[MeasuredPath]
    left_out: dict[str, str]


def to_json(results: Results) -> bytes:
    """As a file holds them."""
    return msgspec.json.format(msgspec.json.encode(results), indent=1)


def read_results(path: str) -> Results:
    """The results in a file.

    Raises:
        UserError: there is no such file, or it holds none of this benchmark's results.
    """
    try:
        content = Path(path).read_bytes()
    except OSError as error:
        raise UserError(f"cannot read {path}: {error.strerror or error}") from error
    try:
        results = msgspec.json.decode(content, type=Results)
    except (msgspec.DecodeError, UnicodeDecodeError) as error:
        raise UserError(
            f"{path} holds no results of vrut-lite bench ({error}): name the bench.json of a run"
        ) from error
    if results.format != FORMAT:
        raise UserError(
            f"{path} has format {results.format} of the results, this version knows {FORMAT}: "
            "measure anew"
        )
    return results
