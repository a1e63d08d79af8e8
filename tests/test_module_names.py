"""The host names no module: what it must know of one stands in the module's manifest."""

import ast
from functools import cache
from importlib.metadata import entry_points
from pathlib import Path

import pytest

import vrut_lite

HOST = Path(vrut_lite.__file__).parent
MODULES = sorted({point.name for point in entry_points(group="vrut_lite.modules")})
# Words of daylight that a module is called by too: texts may say them, imports may not.
WORDS = {"air", "clouds", "lamps"}


@cache
def nodes_of(source):
    return list(ast.walk(ast.parse(source)))


def names_in(source, is_module, texts_count=True):
    """Imports, and texts if they count, of a file that name a module."""
    for node in nodes_of(source):
        if isinstance(node, ast.Import):
            texts = [alias.name.partition(".")[0] for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            texts = [(node.module or "").partition(".")[0]]
        elif texts_count and isinstance(node, ast.Constant) and isinstance(node.value, str):
            texts = [node.value]
        else:
            continue
        yield from (f"line {node.lineno}: {text[:60]!r}" for text in texts if is_module(text))


def is_named(module):
    """A test of texts: the name may stand anywhere in one; an import must be all of it."""
    spellings = (module, module.replace("_", "-"))
    if module in WORDS:
        return module.__eq__
    return lambda text: any(spelling in text for spelling in spellings)


@pytest.mark.parametrize("module", MODULES)
def test_no_file_of_the_host_names_a_module(module):
    """Neither in an import nor in a text, docstrings and help included."""
    found = [
        f"{file.relative_to(HOST)} {named}"
        for file in sorted(HOST.rglob("*.py"))
        for named in names_in(file.read_text("utf-8"), is_named(module), module not in WORDS)
    ]
    assert found == []


def test_names_are_found():
    """The search itself: an import, a default, an example in a docstring."""
    source = 'import a_sky.module\nHOLDER = "a_sky"\n"""Example: --engine a-sky"""\nb_sky = 1\n'
    assert len(list(names_in(source, is_named("a_sky")))) == 3
    words = 'import air.module\nimport vrut_lite.air\nNAME = "air"\n'
    assert len(list(names_in(words, is_named("air"), texts_count=False))) == 1
