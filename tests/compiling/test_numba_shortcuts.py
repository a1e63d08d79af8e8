"""numba's compiler with shortcuts makes the code that it makes without them."""

import os
import subprocess
import sys
from pathlib import Path

# Prints the machine code of kernels with tuples, errors, sums and inner functions, without the
# numbers that numba gives to functions, and without the functions by which Python calls kernels.
CODE = r"""
import re, sys
FUNCTION = r"^\t\.type\t(\S+),@function$(.*?)^\.Lfunc_end"
from vrut_lite import numba_shortcuts
if sys.argv[1] == "without":
    numba_shortcuts.install = lambda: None
from vrut_lite.compiling.kernel_list import announced_kernels, compile_kernel
from importlib import import_module
for group in announced_kernels().of("light_transport"):
    for kernel in group.kernels:
        if kernel.function in ("_part", "_best_neighbours", "_copied", "_fill_map"):
            compile_kernel(*kernel.key)
            code = getattr(import_module(kernel.module), kernel.function).inspect_asm()
            text = re.sub(r"(v|B)[0-9]+", r"\1", "".join(code.values()))
            for name, body in re.findall(FUNCTION, text, re.MULTILINE | re.DOTALL):
                if "7cpython" not in name:
                    print(name, body)
"""


def start(cache: Path, *arguments: str) -> subprocess.Popen[str]:
    """`CODE` in a process with an empty cache."""
    folders = {"NUMBA_CACHE_DIR": str(cache), "XDG_CACHE_HOME": str(cache)}
    # Names of functions hold sets of options, in the order of their hashes.
    environment = os.environ | folders | {"PYTHONHASHSEED": "0"}
    command = [sys.executable, "-c", CODE, *arguments]
    return subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment)


def test_the_machine_code_is_the_same(tmp_path: Path) -> None:
    """Results of kernels are compared by digest: no bit of them may depend on a shortcut."""
    processes = [start(tmp_path / way, way) for way in ("without", "with")]
    plain, short = (process.communicate()[0] for process in processes)
    assert plain.count(" \n_ZN15light_transport") >= 4
    assert short == plain
