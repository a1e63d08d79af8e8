"""The tables of a run as Markdown, for documents: what is on each front, and the peers."""

from collections.abc import Iterator, Sequence

from vrut_lite_bench.front import pareto_front
from vrut_lite_bench.peers import peer_rows
from vrut_lite_bench.results import GroupNote, Measured, Results


def markdown(results: Results) -> str:
    """Fronts of all groups that err, passes of those that do not, and others' figures."""
    lines: list[str] = []
    for group in results.groups:
        paths = [path for path in results.paths if path.group == group.name]
        if paths:
            judged = any(path.errors for path in paths)
            lines += [f"### {group.title}", ""]
            lines += [*(_front(group, paths) if judged else _times(paths)), ""]
    lines += ["### Beside others", "", *_peers(results)]
    return "\n".join(lines) + "\n"


def on_front(group: GroupNote, paths: Sequence[Measured]) -> list[Measured]:
    """The paths of a group that none beats in time and in its error by day, fastest first."""
    rivals = [path for path in paths if path.name.endswith(group.front_of) and path.errors]
    seconds = [path.seconds for path in rivals]
    return [rivals[i] for i in pareto_front(seconds, [path.worst() or 0.0 for path in rivals])]


def _front(group: GroupNote, paths: Sequence[Measured]) -> Iterator[str]:
    yield f"| on the front | ms for {group.unit} | error, mean | 99 % | at night, 99 % |"
    yield "|---|---:|---:|---:|---:|"
    for path in on_front(group, paths):
        errors = path.worst(size="mean"), path.worst(), path.worst(at_night=True)
        cells = (path.name, 1e3 * path.seconds, *errors)
        yield f"| {' | '.join(map(_cell, cells))} |"


def _times(paths: Sequence[Measured]) -> Iterator[str]:
    yield "| what | ms |"
    yield "|---|---:|"
    for path in paths:
        yield f"| {path.name} | {_cell(1e3 * path.seconds)} |"


def _peers(results: Results) -> Iterator[str]:
    yield "| what | who, on what | theirs, ms | ours, ms | theirs / ours |"
    yield "|---|---|---:|---:|---:|"
    for row in peer_rows(results.paths):
        cells = (row.what, f"{row.who}, {row.hardware}", row.theirs_ms, row.ours_ms, row.ratio)
        yield f"| {' | '.join(map(_cell, cells))} |"


def _cell(value: object) -> str:
    if value is None:
        return ""
    return f"{value:.3g}" if isinstance(value, float) else str(value)
