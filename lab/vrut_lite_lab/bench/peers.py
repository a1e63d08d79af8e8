"""Published figures of others, and programs of others, beside the paths of a run."""

from collections.abc import Sequence
from typing import NamedTuple

from vrut_lite_lab.bench.results import MeasuredPath

THESIS = "thesis (Hvezda 2020)"
CPU, CARD = "i7-8750H", "GTX 1060"
# Table 5.1 of the thesis: milliseconds by size of a Hosek-Wilkie cube map.
THESIS_MS = {
    CPU: {256: 108.5, 512: 383.65, 1024: 1564.39, 2048: 6360.62, 4096: 26079.375},
    CARD: {256: 1.74, 512: 3.07, 1024: 6.96, 2048: 6.01, 4096: 9.65},
}
# Section 5.2 and table 5.2.
THESIS_PRECOMPUTATION_MS = 1138.03
THESIS_CUBE_MS = {256: 0.89, 512: 2.87, 1024: 4.48, 2048: 10.58, 4096: 30.05}
# Hillaire 2020: a 1280 x 720 frame with all its small tables made anew.
HILLAIRE_MS = 0.31
_FLOAT32, _LIVE = "cube_map, float32", "this machine, live"


class PeerFigure(NamedTuple):
    """A figure of others, and the path of this run that does the same.

    `ms` is None if it was measured in this run: then `theirs` is the path.
    """

    what: str
    who: str
    hardware: str
    ms: float | None
    ours: tuple[str, str]
    theirs: tuple[str, str] | None = None


class PeerRow(NamedTuple):
    """A line of the table: milliseconds, ours and theirs, and theirs over ours."""

    what: str
    who: str
    hardware: str
    theirs_ms: float
    ours: str
    ours_ms: float
    ratio: float


def peers() -> list[PeerFigure]:
    """All figures of others."""
    return [*_cube_maps(), *_live(), *_bruneton()]


def _cube_maps() -> list[PeerFigure]:
    """Table 5.1."""
    return [
        PeerFigure(f"Hosek-Wilkie cube map, {size}²", THESIS, hardware, ms, _ours(size))
        for size in THESIS_MS[CPU]
        for hardware in (CPU, CARD)
        for ms in [THESIS_MS[hardware][size]]
    ]


def _ours(size: int) -> tuple[str, str]:
    return "hosek-wilkie", f"{_FLOAT32}, {size}²"


def _live() -> list[PeerFigure]:
    """Peers measured in the same run: numpy, mitsuba, and others' signals."""
    rows = []
    for name in ("pluggy", "PySide6"):
        for count, who in ((1, "1 subscriber"), (4, "4 subscribers")):
            group = f"dispatch-{count}"
            what, ours = f"a thousand messages, {who}", (group, "vrut_lite, posts after one input")
            rows.append(PeerFigure(what, name, _LIVE, None, ours, (group, name)))
    for size in (64, 256, 1024):
        what, group = f"Hosek-Wilkie cube map, {size}²", "hosek-wilkie"
        sky_only = group, f"{_FLOAT32}, sky rows only, {size}²"
        for name, ours in (
            ("numpy float64, all texels", _ours(size)),
            ("numpy float64, sky texels", sky_only),
            ("mitsuba's sunsky, all texels", _ours(size)),
            ("mitsuba's sunsky, sky texels", sky_only),
        ):
            theirs = group, f"{name}, {size}²"
            rows.append(PeerFigure(what, name, _LIVE, None, ours, theirs))
    return rows


def _bruneton() -> list[PeerFigure]:
    """Section 5.2, table 5.2, and Hillaire's frame."""
    tables = "tables", "fast solver, 4 orders, published size"
    rows = [
        PeerFigure("tables, four orders", THESIS, CARD, THESIS_PRECOMPUTATION_MS, tables),
        PeerFigure(
            "tables, four orders, a quarter the nodes an axis", "published pipeline, numpy float64",
            _LIVE, None, ("tables", "fast solver, 4 orders, quarter size"),
            ("tables", "published pipeline, numpy float64, 4 orders, quarter size"),
        ),
        PeerFigure(
            "tables, four orders", "published pipeline as shaders", _LIVE, None,
            tables, ("tables", "published pipeline, GPU shaders, 4 orders, published size"),
        ),
    ]  # fmt: skip
    for size, ms in THESIS_CUBE_MS.items():
        ours = "sky-cube", f"fill_cube, float32, {size}²"
        rows.append(PeerFigure(f"cube map of all scattering, {size}²", THESIS, CARD, ms, ours))
    moved = "sky-chain", "moved sun, clear air"
    rows.append(PeerFigure("sky of a moved sun", "Hillaire 2020", "GTX 1080", HILLAIRE_MS, moved))
    return rows


def peer_rows(paths: Sequence[MeasuredPath]) -> list[PeerRow]:
    """The lines whose path was measured."""
    by_key = {(path.group, path.name): path for path in paths}
    rows = []
    for peer in peers():
        ours = by_key.get(peer.ours)
        live = by_key.get(peer.theirs) if peer.theirs else None
        theirs_ms = peer.ms if live is None else 1e3 * live.seconds
        if ours is None or theirs_ms is None:
            continue
        ours_ms = 1e3 * ours.seconds
        rows.append(
            PeerRow(
                peer.what, peer.who, peer.hardware, theirs_ms, ours.name, ours_ms,
                theirs_ms / ours_ms,
            )
        )  # fmt: skip
    return rows
