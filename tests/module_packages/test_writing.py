"""The package that `vrut-lite modules new` writes: whole, its tests pass, its names checked."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import OpenEXR
import pytest
from command_output import output_of

from vrut_lite.commands.modules import modules
from vrut_lite.errors import UserError
from vrut_lite.module_packages.writing import KINDS, write_package

SCENES = Path(__file__).parents[2] / "scenes"
# Tests of each kind that pass, at least.
PASS = {"sky": 30, "layer": 6, "tool": 4}
LONGEST = "a_name_of_thirty_letters_at_mo"


def python(*arguments, path, cwd):
    return subprocess.run(
        [sys.executable, *map(str, arguments)],
        env={**os.environ, "PYTHONPATH": os.pathsep.join([str(path), *sys.path])},
        cwd=cwd,
        capture_output=True,
        text=True,
        check=False,
    )


def installed(package, site):
    """Install a package into a folder, offline."""
    options = ("--no-deps", "--no-build-isolation", "--no-index", "--quiet", "--target", site)
    done = python("-m", "pip", "install", *options, package, path="", cwd=package)
    assert done.returncode == 0, done.stderr
    return site


@pytest.mark.parametrize(
    "kind", [pytest.param(kind, marks=[pytest.mark.long] * (kind != "sky")) for kind in KINDS]
)
def test_its_tests_pass_at_once(tmp_path, kind):
    """As its author runs them, on the package as a wheel installs it, its recorded session too."""
    pytest.importorskip("pip")
    package = tmp_path / "package"
    told = output_of(modules, "new", f"own_{kind}", "--kind", kind, "--into", package)
    assert told.startswith(f"{package}: ")
    check_files(package, kind)
    site = installed(package, tmp_path / "site")
    assert (site / f"own_{kind}" / "py.typed").is_file()
    done = python(
        "-m", "pytest", "-q", "-p", "no:cacheprovider", "-o", "pythonpath=tests", "tests",
        path=site, cwd=package,
    )  # fmt: skip
    passed = re.search(r"(\d+) passed", done.stdout)
    assert done.returncode == 0, done.stdout + done.stderr
    assert int(passed[1]) >= PASS[kind]
    assert "replays" in (package / "tests" / f"test_own_{kind}.py").read_text()
    listing = python("-c", LIST, path=site, cwd=tmp_path).stdout
    assert f"own_{kind} 0.1.0: Own {kind}; running" in listing
    assert f"package: own-{kind} 0.1.0, by Your name, MIT" in listing
    assert "fault" not in listing.partition(f"own_{kind} ")[2].partition("package")[0]


LIST = "import sys; sys.argv = ['vrut-lite', 'modules']; from vrut_lite.cli import main; main()"


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("name", [pytest.param("x", marks=pytest.mark.long), LONGEST])
def test_names_of_any_length_leave_it_clean(tmp_path, kind, name):
    """ruff by the package's own configuration, in its checks and in its format."""
    if shutil.which("ruff", path=os.path.dirname(sys.executable)) is None:
        pytest.skip("needs the package ruff")
    package = tmp_path / "package"
    write_package(name, kind, package)
    for check in (("check",), ("format", "--check", "--diff")):
        done = python("-m", "ruff", *check, "--no-cache", ".", path="", cwd=package)
        assert done.returncode == 0, done.stdout + done.stderr


def check_files(package, kind):
    """No name of the template is left, nor a file that nobody wrote."""
    files = [path for path in package.rglob("*") if path.is_file()]
    assert {path.suffix for path in files} <= {".py", ".toml", ".md", ".typed", ".mcap", ".frag"}
    for path in files:
        inner = path.relative_to(package)
        assert "new" not in str(inner)
        if path.suffix != ".mcap":
            assert not re.search(rf"new[_ -]{kind}", path.read_text(), re.IGNORECASE), inner


@pytest.mark.parametrize(
    ("name", "reason"),
    [
        ("Rain", "is no name of a module"),
        ("2rain", "is no name of a module"),
        ("rain-radar", "is no name of a module"),
        ("../rain", "is no name of a module"),
        ("rain__radar", "is no name of a module"),
        ("class", "is no name of a module"),
        (f"{LONGEST}s", "is no name of a module"),
        ("clouds", "a module called clouds is installed already"),
        ("scene", "a module called scene is installed already"),
        ("numpy", "a python package called numpy is installed already"),
        ("statistics", "a python package called statistics is installed already"),
    ],
)
def test_names_that_cannot_be_are_refused(tmp_path, name, reason):
    with pytest.raises(UserError, match=reason):
        write_package(name, "tool", tmp_path / "package")
    assert list(tmp_path.iterdir()) == []


def test_a_folder_with_files_is_left_alone(tmp_path):
    (tmp_path / "notes.txt").write_text("mine")
    with pytest.raises(UserError, match="is not empty: name another folder with --into"):
        write_package("rain", "tool", tmp_path)
    with pytest.raises(UserError, match="is not empty"):
        write_package("rain", "tool", tmp_path / "notes.txt")
    assert [path.name for path in tmp_path.iterdir()] == ["notes.txt"]


@pytest.mark.gl
def test_the_rainbow_in_the_picture_is_its_twins(tmp_path):
    """What rain adds to a picture, against the radiance on arrays, by rays from the picture's
    camera: the shader is the same function."""
    package = tmp_path / "package"
    write_package("rain", "layer", package)
    (tmp_path / "vrut_lite_command.py").write_text("from vrut_lite.cli import main\n\nmain()\n")
    path = os.pathsep.join([str(installed(package, tmp_path / "site")), str(tmp_path)])
    pictures = []
    for rain in ("0", "1"):
        picture = tmp_path / f"{rain}.exr"
        done = python(
            "-m", "vrut_lite_command", "render", SCENES / "sundial.glb", "-o", picture,
            "--rain", rain, "--at", "2026-06-21T18:30", "--size", "96x64", "--fov", "8",
            "--eye=0,20,0", "--target=3,21,0", "--no-air", "--set", "light_transport.on=false",
            path=path, cwd=tmp_path,
        )  # fmt: skip
        assert done.returncode == 0, done.stderr
        part = OpenEXR.File(str(picture)).parts[0]
        pictures.append(part.channels["RGB"].pixels)
    added = pictures[1] - pictures[0]
    np.save(tmp_path / "added.npy", added)
    sun, light = part.header["sunDirection"], part.header["sunIrradianceRgb"]
    done = python("-c", TWIN, tmp_path / "added.npy", *sun.split(), *light.split(), path=path,
                  cwd=tmp_path)  # fmt: skip
    assert done.returncode == 0, done.stderr
    greatest, worst, mean_ratio = map(float, done.stdout.split())
    assert greatest > 1.0
    assert worst < 0.06 * greatest
    assert mean_ratio == pytest.approx(1.0, abs=0.01)


# Rays through the middles of pixels of the picture above, which shows the top of the first bow.
TWIN = """
import sys
import numpy as np
from rain.bow import RainbowShown, radiance
added, numbers = np.load(sys.argv[1]), np.array(sys.argv[2:], float)
rows, columns = np.mgrid[0:64, 0:96] + 0.5
forward = np.array([3.0, 1.0, 0.0]) / np.sqrt(10.0)
right, up = np.array([0.0, 0.0, 1.0]), np.array([-1.0, 3.0, 0.0]) / np.sqrt(10.0)
focal = 32.0 / np.tan(np.radians(4.0))
rays = forward + ((columns - 48.0) / focal)[..., None] * right
rays = rays - ((rows - 32.0) / focal)[..., None] * up
rays /= np.linalg.norm(rays, axis=-1, keepdims=True)
shown = RainbowShown(antisolar=tuple(-numbers[:3]), light_rgb=tuple(numbers[3:]))
expected = radiance(shown, rays)
print(expected.max(), np.abs(added - expected).max(), added.mean() / expected.mean())
"""
