"""The wheel holds everything that the checkout uses."""

import configparser
import os
import re
import shutil
import subprocess
import sys
import sysconfig
import tomllib
import venv
import zipfile
from pathlib import Path

import pytest

from vrut_lite.errors import UserError

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
PACKAGES = {
    "vrut_lite": ROOT / "vrut_lite",
    **{path.parent.name: path.parent for path in sorted((ROOT / "modules").glob("*/__init__.py"))},
}


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    """The wheel of a copy of the sources, so that the checkout gets no build folder."""
    source = tmp_path_factory.mktemp("source")
    for path in (*ROOT.glob("*.md"), *ROOT.glob("*.in"), *ROOT.glob("*.toml"), *ROOT.glob("*.yml")):
        shutil.copy(path, source)
    for name in ("setup.py", "LICENSE"):
        shutil.copy(ROOT / name, source)
    for name in ("vrut_lite", "modules", "lab", "scenes", "examples", "docs"):
        shutil.copytree(ROOT / name, source / name, ignore=shutil.ignore_patterns("__pycache__"))
    done = subprocess.run(
        [sys.executable, "-m", "build", "--wheel", "--no-isolation", "--outdir", "dist"],
        cwd=source,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    (built,) = (source / "dist").iterdir()
    with zipfile.ZipFile(built) as archive:
        yield archive


def information(wheel: zipfile.ZipFile, name: str) -> str:
    """A file of the wheel's .dist-info folder."""
    folder = f"vrut_lite-{PROJECT['version']}.dist-info"
    return wheel.read(f"{folder}/{name}").decode()


@pytest.mark.long
@pytest.mark.parametrize("package", PACKAGES)
def test_every_file_of_the_packages_is_in_the_wheel(wheel, package):
    """Code, data, shaders and py.typed alike, byte for byte."""
    folder = PACKAGES[package]
    files = [
        path
        for path in folder.rglob("*")
        if path.is_file() and not {"__pycache__", ".ruff_cache"} & {*path.parts}
    ]
    assert files
    for path in files:
        member = f"{package}/{path.relative_to(folder).as_posix()}"
        assert member in wheel.namelist()
        assert wheel.read(member) == path.read_bytes()


@pytest.mark.parametrize("package", PACKAGES)
def test_the_packages_are_marked_as_typed(wheel, package):
    """PEP 561: type checkers ignore packages without the marker."""
    assert f"{package}/py.typed" in wheel.namelist()


def test_nothing_else_is_in_the_wheel(wheel):
    """Tests, tools and the laboratory are not packages of the wheel."""
    tops = {name.split("/")[0] for name in wheel.namelist()}
    assert tops == {*PACKAGES, f"vrut_lite-{PROJECT['version']}.dist-info"}


@pytest.fixture(scope="module")
def installation(wheel, tmp_path_factory):
    """A separate environment with the wheel, installed by pip; dependencies are this one's."""
    folder = tmp_path_factory.mktemp("installed") / "environment"
    venv.create(folder)
    python = folder / "bin" / "python"
    asked = [python, "-c", "import sysconfig; print(sysconfig.get_path('purelib'))"]
    site = Path(subprocess.run(asked, capture_output=True, text=True, check=True).stdout.strip())
    (site / "packages_of_the_tests.pth").write_text(sysconfig.get_path("purelib") + "\n")
    pip(python, "install", "--no-deps", "--no-index", wheel.filename)
    return python, site


def pip(python, *arguments):
    """Run this environment's pip for another one."""
    command = [sys.executable, "-m", "pip", "--python", python, *arguments]
    subprocess.run(command, capture_output=True, text=True, check=True)


def answer(python, cache, *arguments):
    """The output of an installed Python, or of its `vrut-lite`, with an empty cache folder."""
    environment = {
        k: v for k, v in os.environ.items() if k not in ("NUMBA_CACHE_DIR", "PYTHONPATH")
    }
    done = subprocess.run(
        [python, *arguments],
        cwd=cache,
        env=environment | {"XDG_CACHE_HOME": str(cache)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_the_first_scene_and_the_examples_are_in_the_installation(installation, tmp_path):
    """The first start without a checkout shows the street; all examples can be copied and open."""
    python, site = installation
    ask = (
        "from vrut_lite.commands.run import _first_project;"
        "from vrut_lite.scene.loading import load_scene;"
        "project = _first_project();"
        "print(project.scene, project.at, load_scene(project.scene).triangles)"
    )
    scene, hour, triangles = answer(python, tmp_path, "-c", ask).split()
    assert Path(scene) == site / "vrut_lite/data/examples/scenes/street.obj"
    assert hour == "2026-06-21T18:40"
    assert int(triangles) > 1000
    command = python.with_name("vrut-lite")
    copied = answer(python, tmp_path, command, "examples", "copy", "mine")
    assert copied.startswith("mine: 27 files")
    listed = tomllib.loads((ROOT / "examples" / "examples.toml").read_text())["example"]
    for file in {file for example in listed for file in example["files"]}:
        assert (tmp_path / "mine" / file).is_file(), file
    again = subprocess.run(
        [python, command, "examples", "copy", "mine"], cwd=tmp_path, capture_output=True, text=True
    )
    assert again.returncode == 2
    assert "is there already" in again.stderr


def test_the_manual_is_in_the_installation(installation, tmp_path):
    """Help without a network: pages of HTML with small pictures."""
    python, site = installation
    start = Path(answer(python, tmp_path, python.with_name("vrut-lite"), "manual").strip())
    assert start == site / "vrut_lite/data/manual/index.html"
    sizes = [file.stat().st_size for file in start.parent.rglob("*") if file.is_file()]
    assert max(sizes) <= 300_000
    assert sum(sizes) < 9e6


def test_removing_the_package_leaves_nothing_beside_the_users_cache(installation, tmp_path):
    """Compiled kernels are the user's files, not the package's: 160 MB stayed before."""
    python, site = installation
    before = {"packages_of_the_tests.pth"}
    sky = "from dynamic_skylight import HosekWilkieSky as S; S(turbidity=3.0, albedo=0.1,"
    sky += " sun_elevation_rad=0.8).cube_map(size=16)"
    answer(python, tmp_path, "-c", sky)
    assert [*(tmp_path / "vrut_lite" / "kernels" / PROJECT["version"]).rglob("*.nbc")]
    assert not [*site.rglob("*.nb[ic]")]
    pip(python, "uninstall", "--yes", "vrut-lite")
    assert {file.name for file in site.iterdir()} == before
    assert not python.with_name("vrut-lite").exists()


def test_packages_without_the_examples_start_with_an_empty_project(monkeypatch):
    """Who copied the code alone gets a window, and a sentence from the menu."""
    from vrut_lite.bundled import examples
    from vrut_lite.commands import run

    monkeypatch.setattr(examples, "EXAMPLES_HERE", ())
    examples.all_examples.cache_clear()
    assert run._first_project().scene == ""
    with pytest.raises(UserError, match="holds the examples"):
        examples.all_examples()


def test_the_description_has_what_an_index_can_show(wheel):
    """Neither pictures nor links to files of the repository, which a package index has not."""
    description = information(wheel, "METADATA").partition("\n\n")[2]
    assert "vrut_lite renders scenes in daylight" in description
    assert "![" not in description
    assert not re.findall(r"\]\((?!https?://)", description)


def test_licence_notices_travel_with_the_wheel(wheel):
    """The MIT licence and that of the Hosek-Wilkie data require their notices in all copies."""
    assert PROJECT["license-files"]
    for name in PROJECT["license-files"]:
        assert information(wheel, f"licenses/{name}") == (ROOT / name).read_text(encoding="utf-8")
    assert "The vrut_lite authors" in information(wheel, "licenses/LICENSE")
    hosek = information(wheel, "licenses/modules/dynamic_skylight/data/LICENSE.hosek_wilkie")
    assert "Lukas Hosek and Alexander Wilkie" in hosek


def test_entry_points_are_those_of_the_project_and_lead_to_files_of_the_wheel(wheel):
    """Modules and commands are found by entry point only, so none may be missing."""
    parser = configparser.ConfigParser(delimiters=("=",))
    parser.optionxform = str
    parser.read_string(information(wheel, "entry_points.txt"))
    found = {group: dict(parser[group]) for group in parser.sections()}
    assert found == {"console_scripts": PROJECT["scripts"], **PROJECT["entry-points"]}
    for target in (target for group in found.values() for target in group.values()):
        path = target.partition(":")[0].replace(".", "/")
        assert {f"{path}.py", f"{path}/__init__.py"} & set(wheel.namelist()), target
