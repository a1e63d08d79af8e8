"""The kernel's trace in the Trace Event Format, which Chrome and Perfetto open."""

from collections import defaultdict
from collections.abc import Iterable
from typing import Any

from vrut_lite.kernel.trace import Remark, TraceEntry


def export_chrome(entries: Iterable[TraceEntry], remarks: Iterable[Remark] = ()) -> dict[str, Any]:
    """The trace in the Trace Event Format's JSON form.

    A row for each receiver; arrows lead from a message to those that its handlers posted.
    """
    rows: defaultdict[str, int] = defaultdict(lambda: len(rows) + 1)
    events: list[dict[str, Any]] = []
    causes: dict[int, TraceEntry] = {}
    for entry in entries:
        causes.setdefault(entry.sequence, entry)
        told = {"sequence": entry.sequence, "cause": entry.cause, "sender": entry.sender}
        row = rows[entry.receiver or "(nobody)"]
        events.append(_span(entry.type, row, entry.start_ns, entry.end_ns, told))
        if entry.cause in causes:
            cause = causes[entry.cause]
            events += _arrow(cause, rows[cause.receiver or "(nobody)"], entry, row, len(events))
    for remark in remarks:
        row = rows[f"{remark.module}: {remark.kind}"]
        events.append(_span(remark.text, row, remark.start_ns, remark.end_ns, {}))
    names = [
        {"name": "thread_name", "ph": "M", "pid": 1, "tid": row, "args": {"name": name}}
        for name, row in rows.items()
    ]
    return {"traceEvents": names + events, "displayTimeUnit": "ns"}


def _span(name: str, row: int, start_ns: int, end_ns: int, told: dict[str, Any]) -> dict[str, Any]:
    times_us = {"ts": start_ns / 1e3, "dur": (end_ns - start_ns) / 1e3}
    return {"name": name, "ph": "X", **times_us, "pid": 1, "tid": row, "args": told}


def _arrow(
    cause: TraceEntry, cause_row: int, effect: TraceEntry, row: int, number: int
) -> list[dict[str, Any]]:
    shared = {"name": "causes", "cat": "cause", "id": number, "pid": 1}
    return [
        {**shared, "ph": "s", "ts": cause.start_ns / 1e3, "tid": cause_row},
        {**shared, "ph": "f", "bp": "e", "ts": effect.start_ns / 1e3, "tid": row},
    ]
