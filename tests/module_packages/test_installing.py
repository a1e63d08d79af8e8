"""`vrut-lite modules install`, `update` and `remove`, in an environment of their own."""

import os
import re
import sys
import zipfile

import pytest
from command_output import output_of
from foreign_packages import ENDING, EXITING, MODULE, RAISING, put, wheel_of

from vrut_lite.commands.modules import modules
from vrut_lite.errors import UserError
from vrut_lite.module_packages.installing import try_loading
from vrut_lite.module_packages.wheels import check_installable, read_wheel

pytest.importorskip("pip")


@pytest.fixture(autouse=True)
def _clean(environment):
    """Nothing that a test installed is left for the next."""
    yield
    for path in environment.site.glob("*.dist-info"):
        environment.run("-m", "pip", "uninstall", "--yes", path.name.partition("-")[0])


def refused(done):
    """The one sentence of a command that refuses."""
    assert done.returncode == 2, done.stdout + done.stderr
    assert done.stderr.startswith("vrut-lite: ")
    assert done.stderr.count("\n") == 1
    return done.stderr


def listing(environment):
    return environment.vrut_lite("modules").stdout


def test_a_wheel_is_shown_installed_updated_and_removed(environment, tmp_path):
    """Name, version, author, licence, hash, what it brings and whose rights it has come first."""
    first, second = (wheel_of(tmp_path, "rain", version=version) for version in ("1.0", "1.1"))
    done = environment.vrut_lite("modules", "install", first, answer="y\n")
    assert done.returncode == 0, done.stderr
    shown, _, after = done.stdout.partition("Install it? [y/N]")
    lines = shown.splitlines()
    assert lines[0] == "rain 1.0, by Ada, BSD-3-Clause"
    assert len(lines[1].removeprefix("  sha256: ")) == 64
    assert lines[2] == "  modules: rain"
    assert "runs with your rights" in lines[3]
    assert after.endswith("rain 1.0 is installed and loads\n")
    assert "package: rain 1.0, by Ada, BSD-3-Clause" in listing(environment)
    assert "is installed already" in refused(environment.vrut_lite("modules", "install", second))
    done = environment.vrut_lite("modules", "update", "rain", second, "--yes")
    assert done.stdout.endswith("rain is updated from 1.0 to 1.1 and loads\n"), done.stderr
    assert "there is no other" in refused(
        environment.vrut_lite("modules", "update", "rain", second)
    )
    done = environment.vrut_lite("modules", "remove", "rain", "--yes")
    assert done.stdout.endswith("rain 1.1 is removed\n"), done.stderr
    assert "rain" not in listing(environment).split()


def test_without_a_yes_nothing_is_installed(environment, tmp_path):
    wheel = wheel_of(tmp_path, "rain")
    for answer in ("n\n", ""):
        done = environment.vrut_lite("modules", "install", wheel, answer=answer)
        assert done.returncode == 130
    assert not list(environment.site.glob("rain*"))


def test_a_folder_is_installed_as_the_wheel_that_it_makes(environment, tmp_path):
    """The very package that `new` writes, by its own build."""
    folder = tmp_path / "own_tool"
    done = environment.vrut_lite("modules", "new", "own_tool", "--kind", "tool", "--into", folder)
    assert done.returncode == 0, done.stderr
    before = sorted(folder.rglob("*"))
    done = environment.vrut_lite("modules", "install", folder, "--yes")
    assert done.stdout.endswith("own-tool 0.1.0 is installed and loads\n"), done.stderr
    assert sorted(folder.rglob("*")) == before
    assert "panels: own_tool" in done.stdout
    done = environment.vrut_lite("modules", "remove", "own_tool", "--yes")
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize(
    ("name", "facts", "reason"),
    [
        ("none", {"points": {"console_scripts": {"x": "none:x"}}}, "none brings no module"),
        ("later", {"requires": ["vrut-lite>=99"]}, "it needs vrut_lite >=99, and this is"),
        ("other", {"points": {"vrut_lite.modules": {"clouds": "other:Foreign"}}},
         "brings a module called clouds, which vrut-lite has already"),
        ("mine", {"package": "numpy"}, "brings a python package called numpy, which numpy has"),
        ("mine", {"package": "mine-1.0.data/purelib/numpy"}, "called numpy, which numpy has"),
        ("mine", {"package": "mine-1.0.data/platlib/numpy"}, "called numpy, which numpy has"),
        ("mine", {"package": "json"}, "brings a python package called json, which Python has"),
        ("vrut_lite", {"package": "new_thing"}, "vrut_lite is vrut_lite itself"),
    ],
)  # fmt: skip
def test_what_must_not_be_installed_is_refused_by_its_metadata(tmp_path, name, facts, reason):
    """Importing any of these would end this process."""
    with pytest.raises(UserError, match=reason):
        check_installable(read_wheel(wheel_of(tmp_path, name, ENDING, **facts)))


def test_a_package_for_another_version_leaves_the_environment_alone(environment, tmp_path):
    """Through the very command."""
    wheel = wheel_of(tmp_path, "later", ENDING, requires=["vrut-lite>=99"])
    done = environment.vrut_lite("modules", "install", wheel, "--yes")
    assert "later 1.0, by Ada, BSD-3-Clause, is not for this version" in refused(done)
    assert not list(environment.site.glob("later*"))


def test_what_cannot_be_loaded_is_told_with_how_to_remove_it(environment, tmp_path):
    """It is installed then, and can be removed though it fails."""
    wheel = wheel_of(tmp_path, "broken", RAISING)
    told = refused(environment.vrut_lite("modules", "install", wheel, "--yes"))
    assert told == (
        "vrut-lite: broken is installed and cannot be loaded: broken (broken:Foreign): "
        "ZeroDivisionError: division by zero; `vrut-lite modules remove broken` removes it\n"
    )
    assert environment.vrut_lite("modules", "remove", "broken", "--yes").returncode == 0


@pytest.mark.parametrize(
    ("code", "reason"),
    [
        (EXITING, "SystemExit: 3"),
        (None, "No module named 'broken'"),
        (ENDING, "it ended the process with code 3"),
        (MODULE.replace('title="Foreign"', "title=5"), "title of a manifest"),
        (MODULE + "\n    def __init__(self, link, settings):\n        1 / 0\n", "division by zero"),
    ],
)
def test_loading_is_tried_in_a_process_of_its_own(tmp_path, monkeypatch, code, reason):
    """An import that ends it, a manifest or a constructor that fails."""
    put(tmp_path / "site", "broken", code)
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([str(tmp_path / "site"), *sys.path]))
    with pytest.raises(UserError, match=reason):
        try_loading("broken", tmp_path)


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (("install", "no.whl"), "cannot open no.whl: there is no such file"),
        (("install", "bad.whl"), "bad.whl"),
        (("install", "lib"), "lib is no package: the folder has no pyproject.toml"),
        (("install", "git+ssh://host/x"), "cannot be installed: name a wheel"),
        (("install", "x @ file:///x"), "cannot be installed: name a wheel"),
        (("install", "street.toml/"), "cannot be installed: name a wheel"),
        (("install", "--", "--index-url"), "cannot be installed: name a wheel"),
        (("install", "no-such-package-here"), "no-such-package-here"),
        (("update", "clouds"), "clouds is a part of vrut-lite"),
        (("remove", "clouds"), "clouds is a part of vrut-lite"),
        (("remove", "vrut-lite"), "vrut-lite is a part of vrut-lite"),
        (("remove", "nobody"), "no package of modules called nobody is installed"),
    ],
)
def test_bad_names_end_in_a_sentence(tmp_path, monkeypatch, arguments, reason):
    """Nothing is asked, and nothing sought where pip could find it by chance."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PIP_NO_INDEX", "1")
    (tmp_path / "bad.whl").write_text("no wheel")
    (tmp_path / "lib").mkdir()
    with pytest.raises(UserError, match=re.escape(reason)):
        output_of(modules, *arguments)


def test_a_package_outside_the_environment_is_not_said_to_be_removed(environment, tmp_path):
    """pip leaves it alone, and calls that a success."""
    site = tmp_path / "site"
    with zipfile.ZipFile(wheel_of(tmp_path, "rain")) as archive:
        archive.extractall(site)
    done = environment.vrut_lite("modules", "remove", "rain", "--yes", PYTHONPATH=str(site))
    assert f"pip leaves rain in {site}, outside the environment" in refused(done)
    assert (site / "rain.py").is_file()


def test_without_pip_the_sentence_says_where_it_is_missing(environment, tmp_path):
    """The environment that runs: an environment of uv has none."""
    hide = tmp_path / "sitecustomize.py"
    hide.write_text(
        "import importlib.util as u\nfind = u.find_spec\n"
        "u.find_spec = lambda name, package=None: None if name == 'pip' else find(name, package)\n"
    )
    done = environment.vrut_lite(
        "modules", "install", wheel_of(tmp_path, "rain"), "--yes", PYTHONPATH=str(tmp_path)
    )
    assert f"the environment {environment.folder} has no pip" in refused(done)
    assert sys.prefix not in done.stderr
