"""Draws the memory of one or two runs of the tour over time, and what the last one's is made of.

python -m vrut_lite_lab.memory_tour.curve PICTURE.png FOLDER [FOLDER_OF_A_LATER_RUN]
"""

import argparse
import csv
from pathlib import Path
from typing import Any

import numpy as np

Columns = dict[str, list[str]]


def columns_of(folder: Path) -> Columns:
    """The columns of a run's `memory.csv`."""
    with (folder / "memory.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    return {name: [row[name] for row in rows] for name in rows[0]}


def _numbers(columns: Columns, name: str) -> Any:
    return np.array([float(text) for text in columns[name]])


def _chapters(axes: Any, columns: Columns) -> None:
    """The name of each chapter where it begins."""
    minutes, chapters = _numbers(columns, "minute"), columns["chapter"]
    for place, chapter in enumerate(chapters):
        if not place or chapter != chapters[place - 1]:
            axes.axvline(minutes[place], color="0.8", linewidth=0.7, zorder=0)
            axes.text(
                minutes[place], 0.99, f" {chapter}", fontsize=7, rotation=90, color="0.4",
                transform=axes.get_xaxis_transform(), va="top",
            )  # fmt: skip


def draw(picture: Path, runs: list[Columns]) -> None:
    """Write the picture."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, (above, below) = plt.subplots(2, 1, figsize=(9.0, 7.4), dpi=100)
    for columns, title in zip(runs, ("before", "after") if len(runs) > 1 else ("",), strict=True):
        above.plot(
            _numbers(columns, "minute"), _numbers(columns, "resident"), linewidth=1.2, label=title
        )
    if len(runs) > 1:
        above.legend(fontsize=8, loc="lower right")
    last = runs[-1]
    file_backed = _numbers(last, "resident") - _numbers(last, "anonymous")
    parts = {
        "files (libraries)": file_backed,
        "compiled code": _numbers(last, "code"),
        "Python's small objects": _numbers(last, "python"),
        "given out by malloc": _numbers(last, "heap_used"),
    }
    rest = _numbers(last, "resident") - np.sum(list(parts.values()), axis=0)
    parts["free in malloc, stacks and others"] = np.maximum(rest, 0.0)
    below.stackplot(_numbers(last, "minute"), *parts.values(), labels=list(parts))
    handles, labels = below.get_legend_handles_labels()
    below.legend(handles[::-1], labels[::-1], fontsize=7, loc="lower right")
    for axes, columns in ((above, runs[0]), (below, last)):
        axes.set_ylabel("resident memory, MiB")
        axes.set_xlabel("minutes")
        axes.set_ylim(bottom=0.0)
        axes.margins(x=0.0)
        axes.grid(linewidth=0.3)
        _chapters(axes, columns)
    figure.tight_layout()
    figure.savefig(picture, metadata={"Software": None})


def main() -> None:
    """Draw the runs."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("picture", type=Path)
    parser.add_argument("folders", type=Path, nargs="+")
    chosen = parser.parse_args()
    draw(chosen.picture, [columns_of(folder) for folder in chosen.folders[:2]])


if __name__ == "__main__":
    main()
