"""Run time against error, both logarithmic, one plot for each group."""

import io
from collections.abc import Sequence
from typing import Any

import numpy as np

from vrut_lite_lab.bench.front import on_front
from vrut_lite_lab.bench.results import GroupNote, MeasuredPath

_MARKS = "osD^vPXphd*<>"
# Smaller errors than double precision has are drawn here.
_LEAST_ERROR = 1e-16


def plot_png(group: GroupNote, paths: Sequence[MeasuredPath]) -> bytes:
    """The group's plot as PNG: run time against error, or bars for groups without errors."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(figsize=(9.0, 5.4), dpi=100)
    judged = [path for path in paths if path.worst() is not None]
    if judged:
        _points(axes, group, judged)
    else:
        _bars(axes, group, paths)
    axes.set_title(group.title, fontsize=11)
    file = io.BytesIO()
    figure.tight_layout()
    figure.savefig(file, format="png", metadata={"Software": None})
    plt.close(figure)
    return file.getvalue()


def _points(axes: Any, group: GroupNote, paths: Sequence[MeasuredPath]) -> None:
    factor, unit = _unit(paths)
    times = [factor * path.seconds for path in paths]
    errors = [max(path.worst() or 0.0, _LEAST_ERROR) for path in paths]
    front = [paths.index(path) for path in on_front(group, paths)]
    axes.plot(
        [times[i] for i in front], [errors[i] for i in front],
        color="0.75", linewidth=6, solid_capstyle="round", zorder=0,
        label=f"Pareto front {group.front_of}".strip(),
    )  # fmt: skip
    for number, family in enumerate(dict.fromkeys(path.family for path in paths)):
        _family(axes, [p for p in paths if p.family == family], factor, _MARKS[number % 13])
    for i in front:
        axes.annotate(
            _label(paths[i]), (times[i], errors[i]), xytext=(4, 4), textcoords="offset points",
            fontsize=6,
        )  # fmt: skip
    axes.set(xscale="log", yscale="log", xlabel=f"least {paths[0].clock} for {group.unit}, {unit}")
    night = any(path.worst(at_night=True) is not None for path in paths)
    hollow = "; hollow: sun below the horizon" if night else ""
    _decorate(axes)
    axes.set_ylabel(f"error that 99 % stay below, worst condition{hollow}", fontsize=8)
    axes.grid(visible=True, which="major", linewidth=0.3)
    axes.legend(fontsize=7, loc="best")


def _decorate(axes: Any) -> None:
    """Plain numbers on the axis, and room for the labels of the fastest and the slowest."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    low, high = axes.get_xlim()
    decades = np.log10(high / low)
    axes.set_xlim(low, high * 10 ** (0.12 * decades))
    steps = (1.0, 2.0, 5.0) if decades < 2.0 else (1.0,)
    axes.xaxis.set_major_locator(LogLocator(subs=steps))
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.xaxis.set_minor_formatter(NullFormatter())


def _family(axes: Any, paths: Sequence[MeasuredPath], factor: float, mark: str) -> None:
    """By day filled and joined, by night hollow."""
    ordered = sorted(paths, key=lambda path: path.seconds)
    times = [factor * path.seconds for path in ordered]
    day = [max(path.worst() or 0.0, _LEAST_ERROR) for path in ordered]
    (line,) = axes.plot(times, day, mark + "-", linewidth=0.8, markersize=5, label=paths[0].family)
    night = [(t, e) for t, p in zip(times, ordered, strict=True) if (e := p.worst(at_night=True))]
    if night:
        hollow = {"mfc": "none", "color": line.get_color(), "alpha": 0.5}
        axes.plot(*np.array(night).T, mark, markersize=5, **hollow)


def _label(path: MeasuredPath) -> str:
    """A point's name within its family."""
    return path.name.removeprefix(path.family).lstrip(", ") or path.name


def _bars(axes: Any, group: GroupNote, paths: Sequence[MeasuredPath]) -> None:
    families = list(dict.fromkeys(path.family for path in paths))
    kinds = list(dict.fromkeys(_label(path) for path in paths))
    height = 0.8 / max(len(kinds), 1)
    for number, kind in enumerate(kinds):
        chosen = [path for path in paths if _label(path) == kind]
        places = [families.index(path.family) + number * height for path in chosen]
        axes.barh(places, [1e3 * path.seconds for path in chosen], height=height, label=kind)
    axes.set_yticks(np.arange(len(families)) + 0.4, families, fontsize=8)
    axes.invert_yaxis()
    axes.set(xscale="log", xlabel=f"ms for {group.unit} ({paths[0].clock})")
    axes.grid(visible=True, axis="x", linewidth=0.3)
    axes.legend(fontsize=7)


def _unit(paths: Sequence[MeasuredPath]) -> tuple[float, str]:
    """Microseconds where most take less than a hundredth of a millisecond."""
    middle = float(np.median([path.seconds for path in paths]))
    return (1e6, "microseconds") if middle < 1e-5 else (1e3, "ms")
