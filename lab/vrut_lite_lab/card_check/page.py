"""One Markdown page of a check's results."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from vrut_lite_lab.card_check.parts import PARTS, result


def write_page(folder: Path) -> None:
    """Write FOLDER/card.md."""
    driver, _ = result(folder, "driver")
    lines = [f"# Checked on {driver['card'] if driver else 'no driver'}", ""]
    for name, part in PARTS.items():
        found, end = result(folder, name)
        lines += [f"## {part.title}", "", f"{end['ended']}, {end['seconds']:.0f} s.", ""]
        if found is not None:
            lines += [*_WRITERS[name](found), ""]
    (folder / "card.md").write_text("\n".join(lines))


def _table(head: str, rows: Iterator[str]) -> list[str]:
    columns = head.count("|") - 1
    return [head, "|" + " --- |" * columns, *rows]


def _driver(found: dict[str, Any]) -> list[str]:
    said = ("card", "version", "vendor", "chosen", "trial_ns", "open_s", "cores", "python")
    named = {**{key: found[key] for key in said}, **found["limits"]}
    return _table("| what | value |", (f"| {key} | {value} |" for key, value in named.items()))


def _start(found: dict[str, Any]) -> list[str]:
    return _table(
        "| picture | s | exit code |",
        (f"| {name} | {run['seconds']:.2f} | {run['exit_code']} |" for name, run in found.items()),
    )


def _parity(found: dict[str, Any]) -> list[str]:
    def row(name: str, each: dict[str, Any]) -> str:
        if "error" in each:
            return f"| {name} | {each['error']} | | | |"
        return (
            f"| {name} | {each['worst']:.1e} | {each['where']} | {each['rms']:.1e} | "
            f"{each['not_finite']} |"
        )

    head = "| product | worst | where | rms | not finite |"
    return _table(head, (row(name, each) for name, each in found.items()))


def _tests(found: dict[str, Any]) -> list[str]:
    failed = [f"* `{name}`: {why}" for name, why in found["failed"].items()]
    count = f"{found['tests']} tests, {found['skipped']} skipped, {len(failed)} failed."
    return [count, *(["", *failed] if failed else [])]


def _rows(found: dict[str, Any]) -> list[str]:
    rows = (
        f"| {row['group']}: {row['name']} | {_time(row['seconds'])} | {row['unit']} | "
        f"{row['clock']} |"
        for row in found["rows"]
    )
    return [
        *_table("| path | time | of | clock |", rows),
        *(f"* {why}" for why in found["refused"]),
    ]


def _time(seconds: float) -> str:
    for unit, size in (("s", 1.0), ("ms", 1e-3), ("µs", 1e-6)):
        if seconds >= size:
            return f"{seconds / size:.3g} {unit}"
    return f"{seconds / 1e-9:.3g} ns"


def _frames(found: dict[str, Any]) -> list[str]:
    def row(name: str, each: dict[str, Any]) -> str:
        if "error" in each:
            return f"| {name} | {each['error']} | | | | | |"
        passes = sorted(each["passes_ms"].items(), key=lambda item: -item[1])
        shares = ", ".join(f"{of} {ms:.2f}" for of, ms in passes if ms >= 0.02)
        return (
            f"| {name} | {each['orbit_ms']:.1f} | {1e3 / each['orbit_ms']:.0f} | "
            f"{each['orbit_worst_ms']:.0f} | {each['moved_sun_ms']:.1f} | "
            f"{sum(each['passes_ms'].values()):.2f} | {shares} |"
        )

    head = (
        "| scene | a frame, ms | a second | worst, ms | moved sun, ms | passes, ms | of them, ms |"
    )
    return _table(head, (row(name, each) for name, each in found.items()))


_WRITERS = {
    "driver": _driver,
    "start": _start,
    "parity": _parity,
    "tests": _tests,
    "rows": _rows,
    "frames": _frames,
}
