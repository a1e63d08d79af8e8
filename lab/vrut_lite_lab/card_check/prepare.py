"""Fills the folder that travels to the machine with the card."""

import shutil
import subprocess
import sys
from pathlib import Path

from vrut_lite_lab.checkout import ROOT

# Missing on a machine that has PyTorch, numba, scipy, pillow, matplotlib, pytest, hypothesis.
WHEELS = (
    "astronomy-engine", "click", "DracoPy", "flip-evaluator", "freetype-py", "glcontext", "lz4",
    "mcap", "moderngl", "msgspec", "OpenEXR", "platformdirs", "pyglet", "pyrender==0.1.45",
    "PythonicDISORT", "rich", "tomli-w", "trimesh", "typing-extensions", "tzdata", "tzfpy",
    "zstandard",
)  # fmt: skip
# pyrender asks for this version, of which there is no wheel.
BUILT = ("PyOpenGL==3.1.0",)
LOADERS = ("libegl1", "libglvnd0", "libopengl0", "libgl1", "libglx0", "libgles2")
# The newest glibc whose wheels are taken, and older ones.
_GLIBC = (35, 34, 31, 28, 27, 24, 17, 5)
_RUN = """#!/bin/sh
# Unpacks the loaders, where there are none, and the wheels; then runs the check in the checkout,
# whose code is used, not the wheels': sh .card/run.sh FOLDER [--only PARTS]
set -eu
here=$(CDPATH='' cd -- "$(dirname -- "$0")" && pwd)
site=/tmp/card_check_site
if ! ldconfig -p | grep -q 'libEGL\\.so\\.1'; then
    for package in "$here"/loaders/*.deb; do dpkg -x "$package" /; done
    ldconfig
fi
[ -d "$site" ] || python3 -m pip install -q --no-index --no-deps --no-cache-dir \\
    --target "$site" "$here"/wheels/*.whl
PYTHONPATH=$PWD:$PWD/modules:$PWD/lab:$site python3 -m vrut_lite_lab.card_check run "$@"
"""


def fill_folder(folder: Path, python: str) -> None:
    """Download and build all wheels for a Python such as "3.12", and the loaders' packages."""
    wheels, loaders = folder / "wheels", folder / "loaders"
    shutil.rmtree(folder, ignore_errors=True)
    for each in (wheels, loaders):
        each.mkdir(parents=True)
    platforms = [f"--platform=manylinux_2_{minor}_x86_64" for minor in _GLIBC]
    platforms += ["--platform=manylinux2014_x86_64", "--platform=manylinux1_x86_64"]
    _pip(
        "download", "--no-deps", "--only-binary=:all:", "--implementation=cp",
        f"--python-version={python}", *platforms, f"--dest={wheels}", *WHEELS,
    )  # fmt: skip
    # A build folder would bring files of an earlier build into the wheel.
    builds = [ROOT / "build", ROOT / "lab" / "build"]
    for build in builds:
        shutil.rmtree(build, ignore_errors=True)
    _pip("wheel", "--no-deps", f"--wheel-dir={wheels}", *BUILT, str(ROOT), str(ROOT / "lab"))
    for build in builds:
        shutil.rmtree(build, ignore_errors=True)
    # _apt has no right to write into some folders: it downloads into the current one.
    subprocess.run(["apt-get", "download", *LOADERS], cwd=loaders, check=True)
    (folder / "run.sh").write_text(_RUN)
    size = sum(file.stat().st_size for file in folder.rglob("*") if file.is_file())
    print(f"{folder} holds {size / 2**20:.1f} MiB")


def _pip(*arguments: str) -> None:
    subprocess.run([sys.executable, "-m", "pip", "-q", *arguments], check=True)
