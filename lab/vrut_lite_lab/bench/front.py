"""The Pareto front: the paths than which none is both faster and more accurate."""

from collections.abc import Sequence

from vrut_lite_lab.bench.results import GroupNote, MeasuredPath


def pareto_front(seconds: Sequence[float], errors: Sequence[float]) -> list[int]:
    """Places of the points on the front, fastest first; of equals the first."""
    order = sorted(range(len(seconds)), key=lambda i: (seconds[i], errors[i], i))
    front: list[int] = []
    for place in order:
        if not front or errors[place] < errors[front[-1]]:
            front.append(place)
    return front


def on_front(group: GroupNote, paths: Sequence[MeasuredPath]) -> list[MeasuredPath]:
    """The paths of a group that none beats in time and in its error by day, fastest first."""
    rivals = [path for path in paths if path.name.endswith(group.front_of) and path.errors]
    seconds = [path.seconds for path in rivals]
    return [rivals[i] for i in pareto_front(seconds, [path.worst() or 0.0 for path in rivals])]
