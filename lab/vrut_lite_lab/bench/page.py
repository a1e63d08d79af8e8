"""The files of a run: an HTML page of plots and tables, the plots, tables as CSV and Markdown."""

import csv
import io
from base64 import b64encode
from collections.abc import Iterator, Sequence
from html import escape

from vrut_lite_lab.bench.front import on_front
from vrut_lite_lab.bench.peers import PeerRow, peer_rows
from vrut_lite_lab.bench.plots import plot_png
from vrut_lite_lab.bench.results import GroupNote, MeasuredPath, Results, to_json

PAGE, JSON = "index.html", "bench.json"
_STYLE = """
body { font: 15px/1.5 sans-serif; margin: 2em auto; max-width: 1000px; padding: 0 1em; }
table { border-collapse: collapse; margin: 1em 0; font-size: 13px; }
th, td { border-bottom: 1px solid #ccc; padding: 2px 10px; text-align: right; }
th:first-child, td:first-child { text-align: left; }
img { max-width: 100%; }
"""
_PATH_HEADER = (
    "path", "device", "ms", "wall, ms", "noise", "error, mean", "error, 99 %", "at night, 99 %",
)  # fmt: skip
_PEER_HEADER = ("what", "who", "on", "theirs, ms", "ours", "ours, ms", "theirs / ours")


def files_of(results: Results) -> dict[str, bytes]:
    """Every file of a run's folder by name; the page comes last."""
    files = {JSON: to_json(results)}
    for group in results.groups:
        paths = [path for path in results.paths if path.group == group.name]
        if paths:
            files[f"bench_{group.name}.png"] = plot_png(group, paths)
    files["paths.csv"] = _csv(("group", *_PATH_HEADER), _all_rows(results))
    files["peers.csv"] = _csv(_PEER_HEADER, peer_rows(results.paths))
    files["tables.md"] = "".join(f"{line}\n" for line in _markdown(results)).encode()
    files[PAGE] = _page(results, files).encode()
    return files


def path_row(path: MeasuredPath) -> tuple[str | float | None, ...]:
    """A path's line: times in ms, noise and errors as shares."""
    noise = max(path.rounds_s) / path.seconds - 1.0 if len(path.rounds_s) > 1 else None
    return (
        path.name, path.device, 1e3 * path.seconds, 1e3 * path.wall_s, noise,
        path.worst(size="mean"), path.worst(), path.worst(at_night=True),
    )  # fmt: skip


def _all_rows(results: Results) -> Iterator[tuple[str | float | None, ...]]:
    return ((path.group, *path_row(path)) for path in results.paths)


def _page(results: Results, files: dict[str, bytes]) -> str:
    parts = ["<h1>Run time against error</h1>", _paragraph(machine_in_words(results))]
    for group in results.groups:
        paths = [path for path in results.paths if path.group == group.name]
        if not paths:
            continue
        picture = b64encode(files[f"bench_{group.name}.png"]).decode()
        parts += [
            f"<h2>{escape(group.title)}</h2>",
            f'<img alt="{escape(group.title)}" src="data:image/png;base64,{picture}">',
            _paragraph(f"Times are for {group.unit}. Errors: {group.norm}. Truth: {group.truth}."),
            _table(_PATH_HEADER, [path_row(path) for path in paths]),
        ]
    rows = peer_rows(results.paths)
    if rows:
        parts += ["<h2>Beside others</h2>", _table(_PEER_HEADER, rows)]
    if results.left_out:
        parts.append("<h2>Left out</h2>")
        parts += [_paragraph(f"{what}: {why}") for what, why in results.left_out.items()]
    head = f"<meta charset='utf-8'><title>vrut-lite bench</title><style>{_STYLE}</style>"
    body = "\n".join(parts)
    return f"<!doctype html>\n<html lang='en'><head>{head}</head><body>\n{body}\n</body></html>\n"


def machine_in_words(results: Results) -> str:
    """Date, machine, versions and load."""
    on = results.machine
    versions = ", ".join(f"{name} {version}" for name, version in on.versions.items())
    before, after = (" ".join(f"{x:.1f}" for x in load) for load in (on.load_before, on.load_after))
    form = "the quick form" if results.quick else "the full form"
    return (
        f"{on.date}, {form}, {results.spent_s:.0f} s; {on.processor}, {on.cores} cores; "
        f"{on.system}; OpenGL: {on.renderer}; {versions}; "
        f"load (1, 5, 15 minutes) before {before}, after {after}"
    )


def _paragraph(text: str) -> str:
    return f"<p>{escape(text)}</p>"


def _table(header: Sequence[str], rows: Sequence[Sequence[object]]) -> str:
    lines = [_line("th", header), *(_line("td", row) for row in rows)]
    return f"<table>{''.join(lines)}</table>"


def _line(kind: str, cells: Sequence[object]) -> str:
    return "<tr>" + "".join(f"<{kind}>{escape(_cell(c))}</{kind}>" for c in cells) + "</tr>"


def _cell(value: object) -> str:
    if value is None:
        return ""
    return f"{value:.3g}" if isinstance(value, float) else str(value)


def _csv(header: Sequence[str], rows: Iterator[Sequence[object]] | Sequence[PeerRow]) -> bytes:
    file = io.StringIO(newline="")
    writer = csv.writer(file)
    writer.writerow(header)
    writer.writerows(rows)
    return file.getvalue().encode()


def _markdown(results: Results) -> Iterator[str]:
    """Fronts of the groups that have errors, times of the others, and others' figures."""
    for group in results.groups:
        paths = [path for path in results.paths if path.group == group.name]
        if paths:
            judged = any(path.errors for path in paths)
            yield from (f"### {group.title}", "")
            yield from (*(_front_lines(group, paths) if judged else _time_lines(paths)), "")
    yield from ("### Beside others", "")
    yield "| what | who, on what | theirs, ms | ours, ms | theirs / ours |"
    yield "|---|---|---:|---:|---:|"
    for row in peer_rows(results.paths):
        who = f"{row.who}, {row.hardware}"
        yield _cells(row.what, who, row.theirs_ms, row.ours_ms, row.ratio)


def _front_lines(group: GroupNote, paths: Sequence[MeasuredPath]) -> Iterator[str]:
    yield f"| on the front | ms for {group.unit} | error, mean | 99 % | at night, 99 % |"
    yield "|---|---:|---:|---:|---:|"
    for path in on_front(group, paths):
        errors = path.worst(size="mean"), path.worst(), path.worst(at_night=True)
        yield _cells(path.name, 1e3 * path.seconds, *errors)


def _time_lines(paths: Sequence[MeasuredPath]) -> Iterator[str]:
    yield "| what | ms |"
    yield "|---|---:|"
    for path in paths:
        yield _cells(path.name, 1e3 * path.seconds)


def _cells(*cells: object) -> str:
    return f"| {' | '.join(map(_cell, cells))} |"
