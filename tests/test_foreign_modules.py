"""Modules of somebody else's packages: what is listed of them, and what a broken one may do."""

import os
import subprocess
import sys

import pytest
from foreign_packages import ENDING, EXITING, MODULE, RAISING, on_path, put

from vrut_lite import __version__, host_version
from vrut_lite.discovery import discover
from vrut_lite.errors import UserError
from vrut_lite.host_version import check_host, host_range
from vrut_lite.package_facts import SAFE_MODE_VARIABLE

# A package for another version, which notes that it is imported.
NEVER = "import pathlib\n\npathlib.Path({marker!r}).touch()\n" + MODULE


def command(folder, *arguments):
    """The command line where the folder's packages are installed."""
    paths = os.pathsep.join([str(folder), *sys.path])
    code = "from vrut_lite.cli import main; main()"
    return subprocess.run(
        [sys.executable, "-c", code, *arguments],
        env={**os.environ, "PYTHONPATH": paths},
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.mark.parametrize("requirement", ["", ">=1.0", ">=0.1,<2", f"=={__version__}"])
def test_versions_that_fit_pass(requirement):
    check_host(requirement)


@pytest.mark.parametrize(
    ("requirement", "reason"),
    [
        (">=99", f"it needs vrut_lite >=99, and this is {__version__}"),
        ("<0.1", "it needs vrut_lite <0.1"),
        ("of today", "'of today' on vrut_lite is none: write one such as '>=1.0,<2'"),
    ],
)
def test_other_versions_are_refused(requirement, reason):
    with pytest.raises(UserError, match=reason):
        check_host(requirement)


@pytest.mark.parametrize(
    ("version", "range_"),
    [("1.0.0", ">=1.0,<2"), ("1.4.2", ">=1.4,<2"), ("2.12.0", ">=2.12,<3")],
)
def test_a_new_module_is_for_versions_up_to_the_next_major_one(monkeypatch, version, range_):
    """Which contain the present one."""
    monkeypatch.setattr(host_version, "__version__", version)
    assert host_range() == range_
    check_host(host_range())


def test_a_sound_package_loads_and_is_listed_with_its_author(tmp_path):
    put(tmp_path, "sound", requires=["vrut-lite>=0.1", "numpy", "vrut-lite-lab>=99"])
    listing = command(tmp_path, "modules").stdout
    assert "sound 1: Foreign; running\n  package: sound 1.0, by Ada, BSD-3-Clause\n" in listing


@pytest.mark.parametrize(
    ("code", "reason"),
    [
        (RAISING, "ZeroDivisionError: division by zero"),
        (EXITING, "SystemExit: 3"),
        (None, "ModuleNotFoundError: No module named 'broken'"),
    ],
)
def test_a_broken_package_is_named_and_all_others_load(tmp_path, code, reason):
    """With package, version, author, licence, the reason, and the ways out."""
    put(tmp_path, "broken", code)
    put(tmp_path, "sound")
    installed = {module.manifest.name for module in discover()[0]}
    with on_path(tmp_path):
        modules, failures = discover()
    assert {module.manifest.name for module in modules} == {*installed, "sound"}
    assert failures == [
        "module 'broken' (broken:Foreign) of broken 1.0, by Ada, BSD-3-Clause, failed to load: "
        f"{reason}; `vrut-lite run --safe-mode` starts without modules of others, "
        "`vrut-lite modules remove broken` removes this one"
    ]


def test_a_package_for_another_version_is_never_imported(tmp_path):
    """Its metadata say so; it is listed with the reason."""
    marker = tmp_path / "imported"
    code = NEVER.replace("{marker!r}", repr(str(marker)))
    put(tmp_path, "later", code, requires=["numpy", "vrut_lite >=99,<100"])
    done = command(tmp_path, "modules")
    assert "of later 1.0, by Ada, BSD-3-Clause, failed to load: it needs vrut_lite <100,>=99, " in (
        done.stdout
    )
    assert not marker.exists()


@pytest.mark.parametrize(
    ("metadata", "title"),
    [
        (
            b"Metadata-Version: 2.4\nName: odd\nVersion: 1\nRequires-Dist: vrut-lite >=>= 3\n",
            "odd 1,",
        ),
        (b"Name: odd\nVersion: \xff\xfe\n", "a package without metadata"),
        (None, "a package without metadata"),
    ],
    ids=["requirement", "letters", "none"],
)
def test_metadata_that_cannot_be_read_stop_no_other_module(tmp_path, metadata, title):
    """They fit no version; whoever damaged the file gets a sentence."""
    put(tmp_path, "odd", EXITING)
    put(tmp_path, "sound")
    file = tmp_path / "odd-1.0.dist-info" / "METADATA"
    file.unlink()
    if metadata is not None:
        file.write_bytes(metadata)
    with on_path(tmp_path):
        modules, failures = discover()
    assert "sound" in {module.manifest.name for module in modules}
    assert len(failures) == 1
    assert title in failures[0]
    assert "its requirement '(it cannot be read)' on vrut_lite is none" in failures[0]


def test_a_requirement_of_this_python_alone_counts_and_one_of_an_extra_does_not(tmp_path):
    """As pip reads them."""
    holds, other = "python_version>='3'", "extra=='old'"
    put(tmp_path, "sound", requires=[f"vrut-lite[app]>=0.1; {holds}", f"vrut-lite<0.0.1; {other}"])
    put(tmp_path, "later", requires=[f"vrut-lite>=99; {holds}"])
    with on_path(tmp_path):
        modules, failures = discover()
    assert "sound" in {module.manifest.name for module in modules}
    assert ["of later 1.0" in failure for failure in failures] == [True]


def test_a_manifest_names_versions_too(tmp_path):
    """For modules in folders, which have no metadata."""
    code = MODULE.replace('version="1"', 'version="1", host=">=99"').replace("{name}", "later")
    (tmp_path / "later.py").write_text(code)
    failures = discover([tmp_path])[1]
    sys.path.remove(str(tmp_path))
    assert len(failures) == 1
    assert "failed to load: it needs vrut_lite >=99" in failures[0]


def test_safe_mode_imports_nothing_of_others(tmp_path, monkeypatch):
    """Not even a package whose import ends the process, which no sentence could tell."""
    put(tmp_path, "ending", ENDING)
    assert command(tmp_path, "modules").returncode == 3
    monkeypatch.setenv(SAFE_MODE_VARIABLE, "1")
    done = command(tmp_path, "modules")
    assert done.returncode == 0
    assert "left out by safe mode: ending 1.0, by Ada, BSD-3-Clause\n" in done.stdout
    monkeypatch.delenv(SAFE_MODE_VARIABLE)
    assert "--safe-mode" in command(tmp_path, "run", "--safe-mode", "--help").stdout


@pytest.mark.parametrize("code", [RAISING, EXITING, None])
@pytest.mark.parametrize(
    "group", ["frame_parts", "sky_layers", "commands", "panels"], ids=lambda group: group
)
def test_what_else_a_broken_package_brings_stops_no_command(tmp_path, group, code):
    """Frame part, layer, command or panel: the list of commands and of modules is whole."""
    put(tmp_path, "broken", code, points={f"vrut_lite.{group}": {"broken": "broken:Foreign"}})
    for arguments in (("--help",), ("modules",)):
        done = command(tmp_path, *arguments)
        assert done.returncode == 0, done.stderr
    assert "night_sky" in done.stdout
    if group == "commands":
        done = command(tmp_path, "broken")
        assert done.returncode == 1
        assert done.stderr.startswith("vrut-lite: the command broken failed to load: ")
