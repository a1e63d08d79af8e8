"""The figures of one set of models: a row for each time, a column for each sky."""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vrut_lite.geometry.preview import captioned_html, png
from vrut_lite_lab.study.framework.errors import rmse
from vrut_lite_lab.study.framework.fisheye import Picture, SkyPixels
from vrut_lite_lab.study.report.moments import Moment
from vrut_lite_lab.study.report.panels import (
    ERROR_FIGURE,
    ERROR_TITLE,
    FIGURES,
    Paint,
    error_panel,
    panel,
)
from vrut_lite_lab.study.report.sheets import sheet
from vrut_lite_lab.study.report.skies import StudySky

MEASUREMENTS = "Measurements"
_SCALES = {"figure3_luminance": "luminance", "figure4_relative_luminance": "percent"}


class MomentSkies(NamedTuple):
    """The skies of one moment: the models', the physics reference and what was measured."""

    moment: Moment
    models: tuple[StudySky, ...]
    physics: StudySky
    measured: StudySky | None

    @property
    def reference(self) -> StudySky:
        """The reference for errors: the measurement, or without one the converged sky."""
        return self.physics if self.measured is None else self.measured


class Figure(NamedTuple):
    """A picture (h, w, 3), its file's name without suffix, and what it shows."""

    name: str
    title: str
    image: NDArray[np.uint8]

    def _repr_png_(self) -> bytes:
        """The picture, for what shows no HTML."""
        return png(self.image)

    def _repr_html_(self) -> str:
        """What a notebook shows: the picture and its title."""
        return captioned_html(self._repr_png_(), self.title)


def figures(
    titles: Sequence[str], physics_title: str, rows: Sequence[MomentSkies], at: SkyPixels
) -> Iterator[Figure]:
    """Figures 2 to 6, columns after the titles of the models and then the references."""
    measured = any(row.measured is not None for row in rows)
    columns = [*titles, physics_title, *([MEASUREMENTS] if measured else [])]
    for name, (title, paint) in FIGURES.items():
        tiles = [_tiles(row, paint, at, measured) for row in rows]
        notes = [[""] * len(columns) for _ in rows]
        image = sheet(columns, _captions(rows), tiles, notes, _SCALES.get(name, ""))
        yield Figure(name, title, image)
    yield _error_figure([*titles, *([physics_title] if measured else [])], rows, at)


def _tiles(row: MomentSkies, paint: Paint, at: SkyPixels, measured: bool) -> list[Picture | None]:
    tiles: list[Picture | None] = [
        panel(paint, sky, row.moment, at) for sky in (*row.models, row.physics)
    ]
    if measured:
        none = row.measured is None
        tiles.append(None if none else panel(paint, row.reference, row.moment, at))
    return tiles


def _error_figure(columns: list[str], rows: Sequence[MomentSkies], at: SkyPixels) -> Figure:
    tiles, notes = [], []
    for row in rows:
        skies = (*row.models, row.physics)[: len(columns)]
        none = row.reference is row.physics and len(columns) > len(row.models)
        tiles.append([error_panel(sky, row.reference, row.moment, at) for sky in skies])
        notes.append([f"{1e3 * rmse(s.radiance, row.reference.radiance):.1f}" for s in skies])
        if none:
            tiles[-1][-1], notes[-1][-1] = np.full_like(tiles[-1][-1], 255), ""
    image = sheet(columns, _captions(rows), tiles, notes, "error")
    return Figure(ERROR_FIGURE, ERROR_TITLE, image)


def _captions(rows: Sequence[MomentSkies]) -> list[str]:
    return [row.moment.title for row in rows]
