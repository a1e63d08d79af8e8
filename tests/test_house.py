"""The house's plan, held by its imports: which layer knows which, and what the kernel never says.

Imports are read from the files, also those in functions and those for type checkers alone.
"""

import ast
import re
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PACKAGES = {
    "vrut_lite": ROOT / "vrut_lite",
    **{folder.name: folder for folder in (ROOT / "modules").iterdir() if folder.is_dir()},
    "vrut_lite_bench": ROOT / "benchmarks" / "vrut_lite_bench",
    "vrut_lite_studies": ROOT / "studies" / "vrut_lite_studies",
}
MODULES = [
    folder.name for folder in (ROOT / "modules").iterdir() if (folder / "module.py").exists()
]
# 2,400 for the bus, its modules and jobs, and 200 for revisions.
KERNEL_LINES = 2600
# Words of daylight, as they stand in names, sentences and comments.
DAYLIGHT = (
    "sky|skies|sun|suns|moon|clouds?|camera|scene|daylight|exposure|radiance|haze|aerosols?|"
    "atmospheres?|latitude|tolerance|tone"
)

# Which parts of vrut_lite each part may import; all may import the single files beside them that
# are listed as values.
VALUES = {
    "arguments", "array", "array_cache", "checks", "compiled_code", "errors", "foreign_errors",
    "interrupts", "mailbox", "memory_limit", "njit", "npz_arrays", "numeric_types",
    "plain_numbers", "sound_environment", "write_atomic",
}  # fmt: skip
BELOW = {
    "kernel": set(),
    "geometry": set(),
    "discovery": {"kernel"},
    "daylight": {"kernel", "geometry", "discovery"},
    "recording": {"kernel", "daylight", "discovery"},
    "pictures": {"geometry", "daylight"},
    "scene": {"kernel", "geometry", "daylight", "pictures"},
    "render": {"kernel", "geometry", "daylight", "scene", "pictures"},
    "testing": {"kernel", "geometry", "daylight", "recording", "discovery"},
}


def sources(package):
    """Python files of a package by the dotted name under which they are imported."""
    folder = PACKAGES[package]
    for path in sorted(folder.rglob("*.py")):
        parts = [package, *path.relative_to(folder).with_suffix("").parts]
        yield ".".join(part for part in parts if part != "__init__"), path


@cache
def files():
    return {name: path for package in PACKAGES for name, path in sources(package)}


@cache
def imported(name):
    """Names of our own python modules that a file imports anywhere in it."""
    found = set()
    for node in ast.walk(ast.parse(files()[name].read_text())):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{name} has a relative import"
            inner = {f"{node.module}.{alias.name}" for alias in node.names}
            # `from package import name` needs the package alone, unless the name is a module.
            found |= inner & files().keys() or {node.module}
            if {f"{node.module}.{alias.name}" for alias in node.names} - files().keys():
                found.add(node.module)
    return {other for other in found if other in files() and other != name}


def test_no_imports_run_in_a_circle():
    """A file can be read, moved and tested without those that need it."""
    graph = {name: imported(name) for name in files()}
    done, circles = set(), []

    def visit(name, path):
        if name in path:
            circles.append(" -> ".join([*path[path.index(name) :], name]))
            return
        if name in done:
            return
        for other in sorted(graph[name]):
            visit(other, [*path, name])
        done.add(name)

    for name in graph:
        visit(name, [])
    assert not circles, "\n".join(circles)


def test_the_kernel_is_small():
    """An author of a module can read all of it in an afternoon."""
    lines = sum(
        len(path.read_text().splitlines()) for path in PACKAGES["vrut_lite"].glob("kernel/*.py")
    )
    assert lines <= KERNEL_LINES


@pytest.mark.parametrize(
    "path", sorted((ROOT / "vrut_lite" / "kernel").glob("*.py")), ids=lambda p: p.name
)
def test_the_kernel_knows_no_daylight(path):
    """It links modules of any kind: no sky, place or camera is named in it, not even in words."""
    words = re.findall(r"[A-Za-z][a-z]*", path.read_text())
    assert not [word for word in words if re.fullmatch(DAYLIGHT, word.lower())]


def of_package(name):
    return name.partition(".")[0]


@pytest.mark.parametrize("module", MODULES)
def test_no_module_imports_another(module):
    """All that passes between modules is messages."""
    for name, _ in sources(module):
        others = {of_package(other) for other in imported(name)}
        assert others <= {module, "vrut_lite"}, name


def part(name):
    """The folder of vrut_lite that a file lies in, or the file itself."""
    return name.split(".")[1] if "." in name else name


@pytest.mark.parametrize("upper", BELOW)
def test_imports_point_down(upper):
    """A layer needs only the layers below it; modules need only the lower ones."""
    for name, _ in sources("vrut_lite"):
        if part(name) == upper:
            ours = {part(other) for other in imported(name) if of_package(other) == "vrut_lite"}
            assert ours <= BELOW[upper] | VALUES | {upper, "vrut_lite"}, name


def test_values_know_nothing_of_what_uses_them():
    """They are what every layer may take for granted."""
    for name, _ in sources("vrut_lite"):
        if part(name) in VALUES:
            assert {part(other) for other in imported(name)} <= VALUES | {"vrut_lite"}, name
