"""One page of a scene's daylight: pictures, numbers with their errors, and how they were found."""

from base64 import b64encode
from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path
from typing import NamedTuple

from vrut_lite.write_atomic import atomic_output

_STYLE = """
body { font: 15px/1.45 system-ui, sans-serif; max-width: 62rem; margin: 2rem auto; padding: 0 1rem;
       color: #1c2430; background: #fff; }
h1 { font-size: 1.6rem; margin-bottom: .2rem; } h2 { font-size: 1.15rem; margin-top: 2rem; }
table { border-collapse: collapse; width: 100%; font-variant-numeric: tabular-nums; }
th, td { border-bottom: 1px solid #d8dde4; padding: .3rem .5rem; text-align: right; }
th:first-child, td:first-child { text-align: left; }
img { max-width: 100%; border-radius: 4px; } figure { margin: 1rem 0; }
.pictures { display: grid; grid-template-columns: repeat(auto-fit, minmax(24rem, 1fr)); gap: 1rem; }
figcaption, .faint { color: #5a6675; font-size: .9rem; }
"""


class Table(NamedTuple):
    """A heading, the names of columns, and rows of text."""

    heading: str
    columns: Sequence[str]
    rows: Sequence[Sequence[str]]


class Page(NamedTuple):
    """What a report says: `pictures` are captions by file, `method` are sentences."""

    title: str
    subtitle: str
    tables: Sequence[Table]
    pictures: Mapping[Path, str]
    method: Sequence[str]


def write_report(path: Path, page: Page) -> None:
    """Write a page that needs no other file.

    Raises:
        UserError: it cannot be written.
    """
    parts = [
        "<!doctype html><html lang='en'><meta charset='utf-8'>",
        "<meta name='viewport' content='width=device-width'>",
        f"<title>{escape(page.title)}</title><style>{_STYLE}</style>",
        f"<h1>{escape(page.title)}</h1><p class='faint'>{escape(page.subtitle)}</p>",
        *map(_table, page.tables),
        "<h2>Pictures</h2><div class='pictures'>",
        *(_figure(file, caption) for file, caption in page.pictures.items()),
        "</div><h2>Method</h2><ul>",
        *(f"<li>{escape(sentence)}</li>" for sentence in page.method),
        "</ul></html>",
    ]
    with atomic_output(path) as beside:
        beside.write_text("\n".join(parts), encoding="utf-8")


def _table(table: Table) -> str:
    head = "".join(f"<th>{escape(name)}</th>" for name in table.columns)
    rows = "".join(
        "<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in row) + "</tr>" for row in table.rows
    )
    return f"<h2>{escape(table.heading)}</h2><table><tr>{head}</tr>{rows}</table>"


def _figure(file: Path, caption: str) -> str:
    data = b64encode(file.read_bytes()).decode()
    said = escape(caption)
    return (
        f"<figure><img alt='{said}' src='data:image/png;base64,{data}'>"
        f"<figcaption>{said}</figcaption></figure>"
    )
