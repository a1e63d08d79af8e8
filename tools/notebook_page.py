"""docs/notebook.md as a notebook, run, and rendered to a page.

    python -m tools.notebook_page PAGE.html

Needs the extra `notebook`. The notebook lies beside the page, as PAGE.ipynb.
"""

import argparse
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[1]
SOURCE = ROOT / "docs" / "notebook.md"


def cells_of(text: str) -> Iterator[tuple[str, str]]:
    """Words as cells `markdown`, Python as cells `code`; pictures are left to the cells."""
    for n, part in enumerate(re.split(r"```python\n(.*?)```", text, flags=re.DOTALL)):
        if n % 2:
            yield "code", part.rstrip()
        else:
            yield "markdown", re.sub(r"^!\[.*$|^\*.*\*$", "", part, flags=re.MULTILINE).strip()


def notebook(text: str) -> Any:
    """The cells as a notebook."""
    import nbformat

    make = {"code": nbformat.v4.new_code_cell, "markdown": nbformat.v4.new_markdown_cell}
    return nbformat.v4.new_notebook(cells=[make[kind](cell) for kind, cell in cells_of(text)])


def main() -> None:
    """Write both files."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition(":")[0])
    parser.add_argument("page", type=Path)
    page = parser.parse_args().page
    import nbformat
    from nbconvert import HTMLExporter
    from nbconvert.preprocessors import ExecutePreprocessor

    made = notebook(SOURCE.read_text(encoding="utf-8"))
    ExecutePreprocessor(timeout=600).preprocess(made, {"metadata": {"path": str(ROOT)}})
    page.parent.mkdir(parents=True, exist_ok=True)
    nbformat.write(made, page.with_suffix(".ipynb"))
    page.write_text(HTMLExporter().from_notebook_node(made)[0], encoding="utf-8")


if __name__ == "__main__":
    main()
