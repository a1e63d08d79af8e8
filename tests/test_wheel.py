"""The wheel holds everything that the checkout uses."""

import configparser
import os
import shutil
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import pytest

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
    for name in ("pyproject.toml", "README.md", "LICENSE"):
        shutil.copy(ROOT / name, source)
    for name in ("vrut_lite", "modules", "lab", "scenes"):
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
    folders = {f"vrut_lite-{PROJECT['version']}.{kind}" for kind in ("dist-info", "data")}
    assert tops == {*PACKAGES, *folders}


@pytest.mark.long
def test_the_first_scene_is_found_where_the_wheel_is_installed(wheel, tmp_path):
    """The first start without a checkout shows the street, with all its files."""
    home = tmp_path / "lib" / "site-packages"
    data = f"vrut_lite-{PROJECT['version']}.data/data/"
    record = f"vrut_lite-{PROJECT['version']}.dist-info/RECORD"
    wheel.extractall(home)
    # Data are beside `lib`, as an installer puts them.
    shutil.copytree(home / data, tmp_path, dirs_exist_ok=True)
    told = (home / record).read_text(encoding="utf-8").replace(data, "../../")
    (home / record).write_text(told, encoding="utf-8")
    ask = (
        "from vrut_lite.commands.run import _first_project;"
        "from vrut_lite.scene.loading import load_scene;"
        "project = _first_project();"
        "print(project.scene, project.at, load_scene(project.scene).triangles)"
    )
    done = subprocess.run(
        [sys.executable, "-c", ask],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(home)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    scene, hour, triangles = done.stdout.split()
    assert Path(scene) == tmp_path / "share" / "vrut_lite" / "scenes" / "street.obj"
    assert hour == "2026-06-21T18:40"
    assert int(triangles) > 1000


def test_without_a_distribution_there_is_no_first_scene(monkeypatch):
    """Without an installed distribution the window starts with an empty project."""
    from vrut_lite.commands import run

    monkeypatch.setattr(run, "_FIRST_SCENE", "nowhere.toml")
    monkeypatch.setattr(run, "_DISTRIBUTION", "no-such-distribution")
    assert run._first_project().scene == ""


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
