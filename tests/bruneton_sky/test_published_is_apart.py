"""The sky is computed without `bruneton_sky.published`, and the solver without tables."""

import ast
from collections.abc import Iterator
from pathlib import Path

import bruneton_sky

PACKAGE = Path(bruneton_sky.__file__).parent


def imports(folder: str = "") -> Iterator[tuple[str, str]]:
    """File and name of all that the files below a folder import, `published` left out."""
    files = [path.relative_to(PACKAGE) for path in (PACKAGE / folder).rglob("*.py")]
    assert files
    for path in files:
        if path.parts[0] == "published":
            continue
        for node in ast.walk(ast.parse((PACKAGE / path).read_text("utf-8"))):
            if isinstance(node, ast.Import):
                yield from ((path.as_posix(), alias.name) for alias in node.names)
            if isinstance(node, ast.ImportFrom):
                assert node.level == 0, "a relative import hides where it goes"
                yield path.as_posix(), str(node.module)


def test_only_the_package_itself_names_what_is_published() -> None:
    """Published pipelines and textbook rules are for scripts, and for checks on the sky."""
    found = {path for path, name in imports() if f"{name}.".startswith("bruneton_sky.published.")}
    assert found == {"__init__.py"}


def test_the_solver_does_not_import_the_tables() -> None:
    """Tables are made from what the solver leaves; the solver need not know them."""
    names = {name for _, name in imports("solver")}
    assert not {name for name in names if name.startswith("bruneton_sky.tables")}
