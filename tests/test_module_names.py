"""The host names no module: what it must know of one stands in the module's manifest."""

import ast
from functools import cache
from importlib.metadata import entry_points
from pathlib import Path

import pytest

import vrut_lite

HOST = Path(vrut_lite.__file__).parent
MODULES = sorted({point.name for point in entry_points(group="vrut_lite.modules")})
# Words of daylight that a module is called by too: the frame draws clouds, whoever makes them.
WORDS = {"clouds"}
DRAWN_IN = "render"


@cache
def nodes_of(source):
    return list(ast.walk(ast.parse(source)))


def names_in(source, is_module):
    """Imports and texts of a file that name a module."""
    for node in nodes_of(source):
        if isinstance(node, ast.Import):
            texts = [alias.name.partition(".")[0] for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            texts = [(node.module or "").partition(".")[0]]
        elif isinstance(node, ast.Constant) and isinstance(node.value, str):
            texts = [node.value]
        else:
            continue
        yield from (f"line {node.lineno}: {text[:60]!r}" for text in texts if is_module(text))


def is_named(module):
    """A test of texts: a word must be all of one; another name may stand anywhere in it."""
    spellings = (module, module.replace("_", "-"))
    if module in WORDS:
        return lambda text: text in spellings
    return lambda text: any(spelling in text for spelling in spellings)


@pytest.mark.parametrize("module", MODULES)
def test_no_file_of_the_host_names_a_module(module):
    """Neither in an import nor in a text, docstrings and help included."""
    found = [
        f"{file.relative_to(HOST)} {named}"
        for file in sorted(HOST.rglob("*.py"))
        if module not in WORDS or not str(file.relative_to(HOST)).startswith(DRAWN_IN)
        for named in names_in(file.read_text(encoding="utf-8"), is_named(module))
    ]
    assert found == []


def test_names_are_found():
    """The search itself: an import, a default, an example in a docstring."""
    source = 'import a_sky.module\nHOLDER = "a_sky"\n"""Example: --engine a-sky"""\nb_sky = 1\n'
    assert len(list(names_in(source, is_named("a_sky")))) == 3
    assert not list(names_in("CLOUD = 'clouds: none'", is_named("clouds")))
