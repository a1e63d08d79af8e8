"""The product does not import `bruneton_sky.reference`, but for two functions when called."""

import ast
from collections.abc import Iterator
from pathlib import Path

import bruneton_sky

PACKAGE = Path(bruneton_sky.__file__).parent
# By file and function.
IMPORTED_WHEN_CALLED = {
    ("precompute.py", "_on_gpu", "bruneton_sky.reference.gpu_pipeline"),
    ("single_scattering.py", "_of_scatterers", "bruneton_sky.reference.classical_rules"),
}


def imports(node: ast.AST, function: str = "") -> Iterator[tuple[str, str]]:
    """The function ("" outside all) and the full name of each thing that is imported."""
    if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
        function = node.name
    if isinstance(node, ast.Import):
        yield from ((function, alias.name) for alias in node.names)
    if isinstance(node, ast.ImportFrom):
        assert node.level == 0, "a relative import hides where it goes"
        yield from ((function, f"{node.module}.{alias.name}") for alias in node.names)
    for child in ast.iter_child_nodes(node):
        yield from imports(child, function)


def product_imports(folder: str = "") -> set[tuple[str, str, str]]:
    """File, function and name of all that the product's files below a folder import."""
    files = [path.relative_to(PACKAGE) for path in (PACKAGE / folder).rglob("*.py")]
    assert files
    return {
        (path.as_posix(), function, name)
        for path in files
        if path.parts[0] != "reference"
        for function, name in imports(ast.parse((PACKAGE / path).read_text("utf-8")))
    }


def test_the_product_imports_the_reference_in_two_functions_only() -> None:
    """Published pipelines, Monte Carlo and classical rules check the sky and are no part of it."""
    found = {
        (path, function, name.rpartition(".")[0])
        for path, function, name in product_imports()
        if f"{name}.".startswith("bruneton_sky.reference.")
    }
    assert found == IMPORTED_WHEN_CALLED


def test_the_solver_does_not_import_the_tables() -> None:
    """Tables are made from what the solver leaves; the solver need not know them."""
    names = {name for _, _, name in product_imports("solver")}
    assert not {name for name in names if name.startswith("bruneton_sky.tables")}
