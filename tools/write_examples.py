"""Writes the examples that are printed in the documentation: the third sky and the notebook.

    python -m tools.write_examples

`examples/third_sky/preetham_sky.py` is the sky of docs/write_a_module.md, `examples/notebook.ipynb`
the cells of docs/notebook.md that need the product alone. A test compares them with the pages.
"""

import json
import re
from pathlib import Path
from typing import Any

from tools.notebook_page import cells_of

ROOT = Path(__file__).parents[1]
EXAMPLES = ROOT / "examples"
# Cells of the laboratory are left out with the words before them.
_LABORATORY = "vrut_lite_lab"


def third_sky() -> str:
    """The source of the module `preetham_sky`."""
    page = (ROOT / "docs" / "write_a_module.md").read_text(encoding="utf-8")
    blocks = re.findall(r"```python\n(.*?)```", page, re.DOTALL)
    return next(block for block in blocks if "class PreethamSky" in block)


def notebook() -> str:
    """The notebook as JSON (nbformat 4.5), without outputs."""
    page = (ROOT / "docs" / "notebook.md").read_text(encoding="utf-8")
    cells: list[dict[str, Any]] = []
    for kind, text in cells_of(page.partition("\n## ")[0]):
        if kind == "code" and _LABORATORY in text:
            cells.pop()
            continue
        cell: dict[str, Any] = {
            "cell_type": kind,
            "id": f"cell-{len(cells)}",
            "metadata": {},
            "source": text.splitlines(keepends=True),
        }
        if kind == "code":
            cell |= {"execution_count": None, "outputs": []}
        cells.append(cell)
    python = {"display_name": "Python 3", "language": "python", "name": "python3"}
    whole = {
        "cells": cells,
        "metadata": {"kernelspec": python, "language_info": {"name": "python"}},
        "nbformat": 4,
        "nbformat_minor": 5,
    }
    return json.dumps(whole, indent=1, ensure_ascii=False) + "\n"


FILES = {"third_sky/preetham_sky.py": third_sky, "notebook.ipynb": notebook}


def main() -> None:
    """Write all files."""
    for name, text in FILES.items():
        (EXAMPLES / name).write_text(text(), encoding="utf-8")


if __name__ == "__main__":
    main()
