"""docs/notebook.md as a notebook, run, and rendered to a page.

    python -m tools.notebook_page PAGE.html

Needs the extra `notebook`. The notebook lies beside the page, as PAGE.ipynb.
"""

import argparse
import re
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[1]
SOURCE = ROOT / "docs" / "notebook.md"


def notebook(text: str) -> Any:
    """Words as cells of text, Python as cells of code; pictures are left to the cells."""
    import nbformat

    cells = []
    for n, part in enumerate(re.split(r"```python\n(.*?)```", text, flags=re.DOTALL)):
        if n % 2:
            cells.append(nbformat.v4.new_code_cell(part.rstrip()))
        else:
            words = re.sub(r"^!\[.*$|^\*.*\*$", "", part, flags=re.MULTILINE).strip()
            cells.append(nbformat.v4.new_markdown_cell(words))
    return nbformat.v4.new_notebook(cells=cells)


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
