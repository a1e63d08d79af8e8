"""A start whose kernels are all on disk does not import the compiler."""

import os
import subprocess
import sys
from pathlib import Path

# Builds a tree of boxes, whose kernels call numpy's functions and inner kernels.
TREE = """
import sys
import numpy as np
from light_transport.rays.tree import tree_over
from vrut_lite import compiled_code
corners = np.random.default_rng(3).random((60, 3, 3))
tree = tree_over(corners, np.zeros(60, np.float32))
print([np.asarray(part).tobytes().hex() for part in tree])
print(compiled_code.compilations, file=sys.stderr)
names = ("scipy.linalg", "numba.np.arraymath", "numba.np.linalg", "numba.cpython.unicode")
print([name for name in names if name in sys.modules], file=sys.stderr)
"""


def run(cache: Path) -> tuple[str, list[str]]:
    """Standard output of `TREE`, and the lines on its error stream."""
    folders = {"NUMBA_CACHE_DIR": str(cache), "XDG_CACHE_HOME": str(cache)}
    done = subprocess.run(
        [sys.executable, "-c", TREE],
        env=os.environ | folders,
        capture_output=True,
        text=True,
        check=True,
    )
    return done.stdout, done.stderr.splitlines()


def test_a_start_without_compilation_imports_no_compiler_parts(tmp_path: Path) -> None:
    """A second start prints the same, compiles nothing, and spares half a second of imports."""
    first, (compilations, _) = run(tmp_path)
    assert int(compilations) > 0
    second, (compilations, imported) = run(tmp_path)
    assert second == first
    assert int(compilations) == 0
    assert imported == "[]"
