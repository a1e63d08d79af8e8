"""The Pareto front: the ways than which none is both faster and more accurate."""

from collections.abc import Sequence


def pareto_front(seconds: Sequence[float], errors: Sequence[float]) -> list[int]:
    """Places of the points on the front, fastest first.

    Of equals the one that comes first.
    """
    order = sorted(range(len(seconds)), key=lambda i: (seconds[i], errors[i], i))
    front: list[int] = []
    for place in order:
        if not front or errors[place] < errors[front[-1]]:
            front.append(place)
    return front
