"""The page of the peers: tables, error against time, panoramas side by side."""

import os
from collections.abc import Callable, Sequence
from datetime import date
from functools import partial
from io import BytesIO
from typing import Any

import numpy as np

from vrut_lite.geometry.colour import luminance, srgb_encode
from vrut_lite.numeric_types import FloatArray
from vrut_lite_lab.bench.machine import load, processor
from vrut_lite_lab.study.peers.airs import air
from vrut_lite_lab.study.peers.run import (
    QUICK,
    VIEWS,
    Scored,
    Truths,
    scored_peers,
    usual_peers,
)
from vrut_lite_lab.study.peers.scores import ViewScore
from vrut_lite_lab.study.peers.views import HEIGHT, TIMED, WIDTH, SkyViewpoint, whole
from vrut_lite_lab.study.report.folder import PAGE, Folder
from vrut_lite_lab.study.report.page import Page

_SHOWN = (SkyViewpoint(60.0), SkyViewpoint(30.0), SkyViewpoint(3.0), SkyViewpoint(-6.0))
# Mean luminance of a panorama is shown so: of white, before the curve.
_GREY = 0.45
_PRODUCT_S_AIR = "continental"
_WHAT: dict[str, tuple[str, Callable[[ViewScore], float]]] = {
    "mean": ("Mean error of luminance in %", lambda s: 100.0 * s.mean),
    "most": ("99 % of the sky err by less than, in %", lambda s: 100.0 * s.most),
    "colour": ("Mean error of colour, 1000 u'v'", lambda s: s.colour),
    "level": ("Level: mean luminance over the truth's, taken out above", lambda s: s.level),
}


def steps() -> int:
    """How often `tell` is called."""
    return len(usual_peers())


def write_peers(folder: Folder, quick: bool, tell: Callable[[str], None]) -> None:
    """All files of the page."""
    truths = Truths()
    views = QUICK if quick else VIEWS
    before = load()[0]
    found = list(scored_peers(usual_peers(), views, truths, tell))
    here = [each for each in found if not each.reason]
    page = Page("Everyone's sky against one truth")
    page.paragraph(
        f"Made {date.today().isoformat()} on {os.cpu_count()} x {processor()}, load {before:.1f} "
        f"at the start, {load()[0]:.1f} at the end; CPU time of one thread for a picture of "
        f"{WIDTH} x {HEIGHT}, sun at {TIMED.sun_deg:g}°, all in one run. Each sky is held against "
        "the light of all orders in an atmosphere of its own parameters where they are known, else "
        "at equal optical depth. The truth is our solver, two rungs finer than usual, along exact "
        "rays; with the sun below -6° our Monte Carlo. The sky's mean luminance is made equal "
        "first: the level says by how much. Errors are of the upper half, from space of the lower "
        "half, the Earth's own light left out."
    )
    page.heading("Time, and what each cannot do")
    _times(page, folder, here)
    plot = folder.content("peers_error_time.png", _plot(here))
    page.figure(plot, "Error against time, sun at 30°; diamonds: ours, unnamed in others' air")
    for name, (title, number) in _WHAT.items():
        page.heading(title)
        _table(page, folder, f"peers_{name}", here, views, number)
    low = [each.scores[view].noise for each in here for view in each.scores if view.sun_deg < -6.0]
    if low:
        page.paragraph(
            f"At -12° the truth is Monte Carlo of 25 directions: a standard error of "
            f"{100.0 * min(low):.0f} to {100.0 * max(low):.0f} % each is part of the errors."
        )
    page.heading("Panoramas")
    picture = _panoramas(here, truths, [view for view in _SHOWN if view in views])
    page.figure(
        folder.content("peers_panoramas.png", picture),
        "Upper half of the sky, the sun's azimuth in the middle; each column at equal mean "
        "luminance, the truth of each air above its skies",
    )
    page.heading("Air")
    for name in dict.fromkeys(each.peer.air for each in here):
        page.paragraph(f"{air(name).title}: {air(name).note}.")
    page.heading("Left out")
    for each in found:
        if each.reason:
            page.paragraph(f"{each.peer.title}: {each.reason}")
    folder.content(PAGE, page.html().encode())


def _by_air(found: Sequence[Scored]) -> list[Scored]:
    airs = list(dict.fromkeys(each.peer.air for each in found))
    return sorted(found, key=lambda each: airs.index(each.peer.air))


def _times(page: Page, folder: Folder, found: Sequence[Scored]) -> None:
    header = ("sky", "picture, CPU s", "once for an air, CPU s", "has not")
    rows = [
        (
            f"{e.peer.title} ({air(e.peer.air).name} air)",
            e.cpu_s,
            e.peer.prepared_s(),
            e.peer.cannot,
        )
        for e in _by_air(found)
    ]
    shown = [tuple(_cell(value) for value in row) for row in rows]
    page.table(header, shown, folder.csv("peers_times", header, rows))


def _table(
    page: Page,
    folder: Folder,
    name: str,
    found: Sequence[Scored],
    views: Sequence[SkyViewpoint],
    number: Callable[[ViewScore], float],
) -> None:
    header = ("sky", "in the air", *(view.title for view in views))
    rows = []
    for each in _by_air(found):
        cells = [number(each.scores[v]) if v in each.scores else float("nan") for v in views]
        if not np.isnan(cells).all():
            rows.append((each.peer.title, each.peer.air, *cells))
    shown = [tuple(_cell(value) for value in row) for row in rows]
    page.table(header, shown, folder.csv(name, header, rows))


def _cell(value: object) -> object:
    if not isinstance(value, float):
        return value
    return "" if np.isnan(value) else f"{value:.2g}" if value < 10.0 else f"{value:.0f}"


def _plot(found: Sequence[Scored]) -> bytes:
    """PNG: a point for each sky, the mean error of its timed picture."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9.0, 5.4), layout="constrained")
    axis = figure.subplots()
    for each in found:
        if TIMED not in each.scores or np.isnan(each.cpu_s):
            continue
        ours = each.peer.name.startswith("ours")
        x, y = each.cpu_s, 100.0 * each.scores[TIMED].mean
        axis.plot(x, y, "D" if ours else "o", color="black" if ours else "tab:blue", ms=5)
        # Ours in the others' air lie close together: diamonds without words.
        if not ours or each.peer.air == _PRODUCT_S_AIR:
            axis.annotate(
                each.peer.title, (x, y), xytext=(5, 4), textcoords="offset points", fontsize=7
            )
    axis.set(xscale="log", yscale="log", ylabel="mean error of luminance in %")
    axis.set(xlabel=f"CPU seconds of a {WIDTH} x {HEIGHT} picture, without what an air costs once")
    axis.margins(x=0.25)
    axis.grid(alpha=0.3)
    return _png(figure)


def _panoramas(found: Sequence[Scored], truths: Truths, views: Sequence[SkyViewpoint]) -> bytes:
    """PNG: a row for each sky, above the first of an air its truth."""
    from matplotlib.figure import Figure

    rows: list[tuple[str, Callable[[SkyViewpoint], FloatArray | None]]] = []
    above = ""
    for each in _by_air(found):
        if each.peer.air != above:
            above = each.peer.air
            rows.append((f"truth in {above} air", partial(_truth, truths, above)))
        rows.append((each.peer.title, partial(_rgb, each)))
    figure = Figure(figsize=(3.4 * len(views), 1.0 * len(rows)), layout="constrained")
    axes: Any = figure.subplots(len(rows), len(views), squeeze=False)
    for line, (title, sky_at) in zip(axes, rows, strict=True):
        for axis, view in zip(line, views, strict=True):
            axis.set_axis_off()
            rgb = sky_at(view)
            if rgb is not None:
                axis.imshow(_shown(rgb), interpolation="bilinear", aspect="auto")
            axis.set_title(f"{title}, {view.title}" if rgb is not None else "", fontsize=7, pad=2)
    return _png(figure)


def _truth(truths: Truths, name: str, view: SkyViewpoint) -> FloatArray:
    return whole(truths.of(name, view).rgb)


def _rgb(each: Scored, view: SkyViewpoint) -> FloatArray | None:
    return each.shots[view].rgb if view in each.shots else None


def _shown(rgb: FloatArray) -> FloatArray:
    """What is seen (rows, columns, 3) at a mean luminance that all have."""
    exposed = np.maximum(rgb, 0.0) * (_GREY / np.mean(luminance(rgb)))
    return np.clip(srgb_encode(-np.expm1(-exposed)), 0.0, 1.0)


def _png(figure: Any) -> bytes:
    into = BytesIO()
    figure.savefig(into, format="png", dpi=110)
    return into.getvalue()
