"""The house's plan, held by its imports: which layer knows which, and what the kernel never says.

Imports are read from the files, also those in functions and those for type checkers alone.
"""

import ast
import re
from collections import defaultdict
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PACKAGES = {
    "vrut_lite": ROOT / "vrut_lite",
    **{folder.name: folder for folder in (ROOT / "modules").iterdir() if folder.is_dir()},
    "vrut_lite_lab": ROOT / "lab" / "vrut_lite_lab",
    "tools": ROOT / "tools",
}
PRODUCT = ("vrut_lite", *(name for name in PACKAGES if (ROOT / "modules" / name).is_dir()))
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
    "arguments", "array", "array_cache", "checks", "compiled_code", "deprecation", "errors",
    "file_lock", "foreign_errors", "host_version", "interrupts", "lazy", "mailbox",
    "memory_limit", "njit", "npz_arrays", "numba_compiler", "numba_shortcuts", "numeric_types",
    "operating_system", "package_facts", "plain_numbers", "quantities", "sound_environment",
    "text_files", "uniform_block", "write_atomic",
}  # fmt: skip
# They name what panels, commands and engines of modules may use of the layers above.
KITS = {"panel_kit", "headless", "scene_engine"}
# Parts of vrut_lite that modules may import.
FOR_MODULES = VALUES | KITS | {
    "kernel", "messages", "atmosphere", "sky", "geometry", "frame_part", "message_codec",
    "place_time", "vrut_lite",
}  # fmt: skip
BELOW = {
    "kernel": set(),
    "geometry": set(),
    "bundled": set(),
    "user_files": set(),
    "discovery": {"kernel"},
    "atmosphere": {"geometry"},
    "messages": {"kernel", "geometry", "atmosphere"},
    "weather": {"messages", "atmosphere", "sky"},
    "sky": {"kernel", "geometry", "messages", "atmosphere"},
    "recording": {"kernel", "message_codec", "messages", "sky", "discovery"},
    "pictures": {"geometry", "messages"},
    "scene": {
        "kernel",
        "geometry",
        "messages",
        "atmosphere",
        "sky",
        "pictures",
        "place_time",
        "frame_part",
        "installed_parts",
    },
    "message_codec": {"kernel"},
    "frame_part": {"kernel", "messages"},
    "installed_parts": {"kernel", "messages", "frame_part"},
    "render": {
        "kernel",
        "geometry",
        "messages",
        "atmosphere",
        "sky",
        "scene",
        "pictures",
        "frame_part",
        "installed_parts",
    },
    "testing": {"kernel", "geometry", "messages", "sky", "recording", "discovery"},
    "module_packages": {"kernel", "discovery"},
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
def syntax(name):
    """The syntax tree of a file."""
    return ast.parse(files()[name].read_text())


@cache
def imported(name):
    """Names of our own python modules that a file imports anywhere in it."""
    found = set()
    for node in ast.walk(syntax(name)):
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


# Files of modules by the packages that may import them.
PUBLIC = {"daylight_numbers": "light_transport.public", "share": "light_transport.public"}


@pytest.mark.parametrize("module", sorted(set(PRODUCT) - {"vrut_lite"}))
def test_no_module_imports_another(module):
    """All that passes between modules is messages, but for a file that names what it offers."""
    for name, _ in sources(module):
        others = {of_package(other) for other in imported(name) if other != PUBLIC.get(module)}
        assert others <= {module, "vrut_lite"}, name


def part(name):
    """The folder of vrut_lite that a file lies in, or the file itself."""
    return name.split(".")[1] if "." in name else name


def imports_of(packages):
    """Pairs (importer, imported) of files, the first in one of these packages."""
    return {
        (n, other) for package in packages for n, _ in sources(package) for other in imported(n)
    }


def test_the_product_does_not_import_the_laboratory():
    """Who installs the product gets neither studies, benchmarks nor truths, and needs none."""
    found = {
        (name, other) for name, other in imports_of(PRODUCT) if of_package(other) not in PRODUCT
    }
    assert not found


def test_the_products_tests_do_not_import_the_laboratory():
    """They run without it; comparisons with its truths are the laboratory's tests."""
    found = {
        path.relative_to(ROOT)
        for path in (ROOT / "tests").rglob("*.py")
        for node in ast.walk(ast.parse(path.read_text()))
        for target in targets(node)
        if of_package(target or "") == "vrut_lite_lab"
    }
    assert not found


def test_modules_import_lower_layers_only():
    """A module of somebody else, written against these, is no worse off than ours."""
    found = {
        (name, other)
        for name, other in imports_of(set(PRODUCT) - {"vrut_lite"})
        if of_package(other) == "vrut_lite" and part(other) not in FOR_MODULES
    }
    assert not found


@pytest.mark.parametrize("kit", sorted({f"vrut_lite.{kit}" for kit in KITS} | {*PUBLIC.values()}))
def test_a_kit_says_what_it_offers_and_offers_what_modules_use(kit):
    """Its page is all that an author reads of the layers above, and it does not grow by itself."""
    tree = syntax(kit)
    offered = {
        alias.name for node in tree.body if isinstance(node, ast.ImportFrom) for alias in node.names
    }
    assert [name for name in offered if name not in ast.get_docstring(tree)] == []
    used = {
        alias.name
        for name in files()
        if of_package(name) in PRODUCT and of_package(name) != "vrut_lite"
        for node in ast.walk(syntax(name))
        if isinstance(node, ast.ImportFrom) and node.module == kit
        for alias in node.names
    }
    assert used == offered


def steps_to(name):
    """The folders that a file lies in and the file, from the package down."""
    if files()[name].name == "__init__.py":
        name += ".__init__"
    parts = name.split(".")
    return [".".join(parts[:depth]) for depth in range(1, len(parts) + 1)]


def neighbours(name, other):
    """Where the ways to two files part: a folder or file of each, side by side in one folder."""
    return next(
        pair for pair in zip(steps_to(name), steps_to(other), strict=False) if pair[0] != pair[1]
    )


def reaches(graph, start, end):
    seen, waiting = set(), [start]
    while waiting:
        here = waiting.pop()
        if here == end:
            return True
        if here not in seen:
            seen.add(here)
            waiting += graph[here]
    return False


def test_no_folders_need_each_other():
    """Of what lies in one folder, files and folders with all in them, none needs what needs it."""
    graph = defaultdict(set)
    for name, other in imports_of(PACKAGES):
        here, there = neighbours(name, other)
        graph[here].add(there)
    circles = [(a, b) for a in sorted(graph) for b in sorted(graph[a]) if reaches(graph, b, a)]
    assert not circles


def test_a_class_has_its_name_alone():
    """Who reads a name in a message, a search or a signature knows which class it is."""
    homes = defaultdict(list)
    for name in sorted(files()):
        for node in syntax(name).body:
            if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
                homes[node.name].append(name)
    shared = {name: sorted(places) for name, places in homes.items() if len(places) > 1}
    assert not shared


def targets(statement):
    """Names that a statement imports; empty unless it is an import."""
    if isinstance(statement, ast.ImportFrom):
        return [statement.module]
    return [alias.name for alias in statement.names] if isinstance(statement, ast.Import) else []


def local_imports(name):
    """How many imports of our own python modules a file has inside functions."""
    kinds = (ast.FunctionDef, ast.AsyncFunctionDef)
    functions = (node for node in ast.walk(syntax(name)) if isinstance(node, kinds))
    # A function in a function is found twice, and counted once.
    inside = {node for function in functions for node in ast.walk(function)}
    return sum(of_package(target) in PACKAGES for node in inside for target in targets(node))


NUMBA = {"vrut_lite.numba_compiler", "vrut_lite.numba_shortcuts"}


@pytest.mark.parametrize("package", PRODUCT)
def test_numba_is_imported_in_one_place(package):
    """Two threads that import different parts of numba at once see half-made modules."""
    found = {
        name
        for name, _ in sources(package)
        for node in ast.walk(syntax(name))
        if isinstance(node, ast.Import | ast.ImportFrom)
        and any((target or "").split(".")[0] == "numba" for target in targets(node))
    }
    assert found <= NUMBA


def test_imports_stand_at_the_top():
    """A reader sees all imports of a file at once; late ones go through `vrut_lite.lazy`."""
    assert not [name for name in files() if local_imports(name)]


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
