"""Adds examples, manual and the index's description to what pyproject.toml says."""

import re
import runpy
import shutil
from pathlib import Path

from setuptools import setup
from setuptools.command.build_py import build_py

ROOT = Path(__file__).parent
DATA = Path("vrut_lite") / "data"
NOT_BUILT = shutil.ignore_patterns("__pycache__")
PICTURE = re.compile(r"^!\[[^]]*\]\([^)]*\)\n+(?:\*(?:[^*]|\n(?!\n))*\*\n)?", re.MULTILINE)
LINK = re.compile(r"\[([^]]+)\]\((?!\w+://)[^)]*\)")


class BuildWithData(build_py):
    """Copies the scenes and examples, and writes the manual's pages, into the package's data."""

    def run(self) -> None:
        """Build; an editable installation finds the checkout's own files instead."""
        super().run()
        if self.editable_mode:
            return
        data = Path(self.build_lib) / DATA
        for source, target in (("examples", "examples"), ("scenes", "examples/scenes")):
            shutil.copytree(ROOT / source, data / target, ignore=NOT_BUILT, dirs_exist_ok=True)
        pages = runpy.run_path(str(ROOT / "vrut_lite" / "bundled" / "manual_pages.py"))
        pages["write_manual"](ROOT, data / "manual")


def description() -> str:
    """The README for a package index, which has neither its pictures nor the files it links."""
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    return LINK.sub(r"\1", PICTURE.sub("", readme))


setup(
    cmdclass={"build_py": BuildWithData},
    long_description=description(),
    long_description_content_type="text/markdown",
)
