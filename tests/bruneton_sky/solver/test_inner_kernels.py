"""Inner kernels count no references: they must not call those that make arrays."""

import ast
from collections import defaultdict
from pathlib import Path

import bruneton_sky


def kernels_by_decorator() -> dict[str, dict[str, ast.FunctionDef]]:
    """The module's kernels by the name of their decorator, then by file and name."""
    found: dict[str, dict[str, ast.FunctionDef]] = defaultdict(dict)
    package = Path(bruneton_sky.__file__).parent
    for path in package.rglob("*.py"):
        for node in ast.parse(path.read_text("utf-8")).body:
            if isinstance(node, ast.FunctionDef):
                for decorator in node.decorator_list:
                    if isinstance(decorator, ast.Name):
                        place = "" if not node.name.startswith("_") else f"{path.stem}."
                        found[decorator.id][f"{place}{node.name}"] = node
    return found


def test_no_inner_kernel_calls_one_that_makes_arrays():
    """Its caller would never free them: some arrays a ray fill the memory in an hour of play."""
    kernels = kernels_by_decorator()
    assert "empty_cells" in kernels["making"]
    assert "gather_later" in kernels["inner"]
    calls = {
        (name, call.func.id)
        for name, kernel in kernels["inner"].items()
        for call in ast.walk(kernel)
        if isinstance(call, ast.Call) and isinstance(call.func, ast.Name)
    }
    assert [(inner, called) for inner, called in calls if called in kernels["making"]] == []
