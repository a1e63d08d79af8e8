"""One page of a scene's daylight: pictures, numbers with their errors, and how they were found."""

from base64 import b64encode
from collections.abc import Mapping, Sequence
from html import escape
from io import BytesIO
from pathlib import Path
from typing import NamedTuple

from PIL import Image

from vrut_lite.write_atomic import atomic_output

_STYLE = """
body { font: 15px/1.45 system-ui, sans-serif; max-width: 62rem; margin: 2rem auto; padding: 0 1rem;
       color: #1c2430; background: #fff; }
h1 { font-size: 1.6rem; margin-bottom: .2rem; } h2 { font-size: 1.15rem; margin-top: 2rem; }
table { border-collapse: collapse; width: 100%; font-variant-numeric: tabular-nums; }
th, td { border-bottom: 1px solid #d8dde4; padding: .3rem .5rem; text-align: right; }
th:first-child, td:first-child { text-align: left; }
.table { overflow-x: auto; }
td { white-space: nowrap; }
.text th, .text td { text-align: left; vertical-align: top; white-space: normal; }
img { max-width: 100%; border-radius: 4px; } figure { margin: .5rem 0; }
.pictures { display: grid; gap: 1rem;
            grid-template-columns: repeat(auto-fit, minmax(min(24rem, 100%), 1fr)); }
.wide { grid-column: 1 / -1; }
figcaption, .faint { color: #5a6675; font-size: .9rem; }
"""


# Aspect ratio above which a picture takes the width of the page.
_WIDE = 1.6


class Table(NamedTuple):
    """A heading, the names of columns, and rows; `is_text` if most cells are words, not numbers."""

    heading: str
    columns: Sequence[str]
    rows: Sequence[Sequence[str]]
    is_text: bool = False


class ReportPage(NamedTuple):
    """Content of a report: `pictures` are captions by file, `method` are sentences."""

    title: str
    subtitle: str
    tables: Sequence[Table]
    pictures: Mapping[Path, str]
    method: Sequence[str]


def write_report(path: Path, page: ReportPage) -> None:
    """Write a page that needs no other file.

    Raises:
        UserError: it cannot be written.
    """
    pictures = [
        "<h2>Pictures</h2><div class='pictures'>",
        *(_figure(file, caption) for file, caption in page.pictures.items()),
        "</div>",
    ]
    parts = [
        "<!doctype html><html lang='en'><meta charset='utf-8'>",
        "<meta name='viewport' content='width=device-width'>",
        f"<title>{escape(page.title)}</title><style>{_STYLE}</style>",
        f"<h1>{escape(page.title)}</h1><p class='faint'>{escape(page.subtitle)}</p>",
        *map(_table, page.tables),
        *(pictures if page.pictures else []),
        "<h2>Method</h2><ul>",
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
    kind = "table text" if table.is_text else "table"
    body = f"<div class='{kind}'><table><tr>{head}</tr>{rows}</table></div>"
    return f"<h2>{escape(table.heading)}</h2>{body}"


def _figure(file: Path, caption: str) -> str:
    content = file.read_bytes()
    data, said = b64encode(content).decode(), escape(caption)
    with Image.open(BytesIO(content)) as picture:
        kind = "wide" if picture.width > _WIDE * picture.height else "plan"
    return (
        f"<figure class='{kind}'><img alt='{said}' src='data:image/png;base64,{data}'>"
        f"<figcaption>{said}</figcaption></figure>"
    )
