"""GL programs that llvmpipe compiles without optimisation draw the same picture."""

import os
import subprocess
import sys
from pathlib import Path

SCENES = Path(__file__).resolve().parents[2] / "scenes"
SHOT = """
import os, sys
from vrut_lite.cli import main
main()
print(os.environ["GALLIVM_PERF"])
"""


def shot(picture: Path, **environment: str) -> str:
    """Mesa's options of a process that renders a small picture."""
    words = ["render", str(SCENES / "pavilion.gltf"), "-o", str(picture), "--size", "96x60"]
    words += ["--set", "light_transport.on=false"]
    plain = {name: value for name, value in os.environ.items() if name != "GALLIVM_PERF"}
    done = subprocess.run(
        [sys.executable, "-c", SHOT, *words],
        env=plain | {"XDG_CACHE_HOME": str(picture.parent)} | environment,
        capture_output=True,
        text=True,
        check=True,
    )
    return done.stdout.splitlines()[-1]


def test_a_small_picture_is_compiled_quickly_and_the_same(tmp_path: Path) -> None:
    """Mesa's passes over shaders may change how long a picture takes, and none of its bits."""
    quick, optimised = tmp_path / "quick.exr", tmp_path / "optimised.exr"
    assert shot(quick) == "nopt"
    assert shot(optimised, GALLIVM_PERF="") == ""
    assert quick.read_bytes() == optimised.read_bytes()
