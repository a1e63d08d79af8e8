"""The page: headings, paragraphs, tables and figures in plain HTML, pictures in files beside it."""

from collections.abc import Sequence
from html import escape

_STYLE = """
body { font: 15px/1.5 sans-serif; margin: 2em auto; max-width: 1400px; padding: 0 1em; }
table { border-collapse: collapse; margin: 1em 0; }
th, td { border-bottom: 1px solid #ccc; padding: 2px 10px; text-align: right; }
th:first-child, td:first-child { text-align: left; }
img { max-width: 100%; }
figcaption { color: #444; }
"""


class Page:
    """A page that is written from top to bottom."""

    def __init__(self, title: str) -> None:
        self._title = title
        self._parts = [f"<h1>{escape(title)}</h1>"]

    def heading(self, text: str) -> None:
        """A heading of a part."""
        self._parts.append(f"<h2>{escape(text)}</h2>")

    def paragraph(self, text: str) -> None:
        """Plain text."""
        self._parts.append(f"<p>{escape(text)}</p>")

    def figure(self, file_name: str, caption: str) -> None:
        """A picture that lies beside the page."""
        name, said = escape(file_name), escape(caption)
        self._parts.append(
            f'<figure><img src="{name}" alt="{said}"><figcaption>{said}</figcaption></figure>'
        )

    def table(self, header: Sequence[str], rows: Sequence[Sequence[object]], csv: str) -> None:
        """Rows of texts and numbers, and where they are as CSV."""
        lines = [_row("th", header), *(_row("td", row) for row in rows)]
        self._parts.append(f"<table>{''.join(lines)}</table>")
        self._parts.append(f'<p><a href="{escape(csv)}">{escape(csv)}</a></p>')

    def html(self) -> str:
        """All of it."""
        head = f"<meta charset='utf-8'><title>{escape(self._title)}</title><style>{_STYLE}</style>"
        body = "\n".join(self._parts)
        return (
            f"<!doctype html>\n<html lang='en'><head>{head}</head><body>\n{body}\n</body></html>\n"
        )


def in_text(value: object) -> str:
    """A cell: numbers with three digits or so."""
    if isinstance(value, float):
        return f"{value:.3g}" if abs(value) < 0.01 or abs(value) >= 1e5 else f"{value:.4g}"
    if isinstance(value, tuple):
        return " × ".join(map(str, value))
    return str(value)


def _row(kind: str, cells: Sequence[object]) -> str:
    return "<tr>" + "".join(f"<{kind}>{escape(in_text(c))}</{kind}>" for c in cells) + "</tr>"
