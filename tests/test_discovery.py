"""Discovery by folder: what is loaded, in which order, and what is refused with a reason."""

import sys

import pytest

from vrut_lite.discovery import discover
from vrut_lite.errors import UserError

MODULE = """
from vrut_lite.kernel.module import Manifest, Module

class {name}(Module):
    manifest = Manifest(name="{name}", title="{name}", version="1")
"""


@pytest.fixture
def folder(tmp_path):
    known = set(sys.modules)
    yield tmp_path
    sys.path[:] = [path for path in sys.path if not path.startswith(str(tmp_path))]
    for name in set(sys.modules) - known:
        if str(getattr(sys.modules[name], "__file__", "")).startswith(str(tmp_path)):
            del sys.modules[name]


def found_in(*folders):
    """Names and failures other than those of the installed modules."""
    installed, failures = discover()
    modules, all_failures = discover(folders)
    return [m.manifest.name for m in modules[len(installed) :]], all_failures[len(failures) :]


def test_files_and_packages_load_in_order_of_their_names(folder):
    """Load order, which is the order of delivery, does not depend on the file system."""
    (folder / "probe_zebra.py").write_text(MODULE.format(name="zebra"))
    (folder / "probe_apple").mkdir()
    (folder / "probe_apple" / "__init__.py").write_text("from .inside import mango\n")
    (folder / "probe_apple" / "inside.py").write_text(MODULE.format(name="mango"))
    (folder / "notes.txt").write_text("no module")
    assert found_in(folder) == (["mango", "zebra"], [])


def test_module_names_the_class_to_load(folder):
    """A file with several classes names the one to load as MODULE."""
    two = MODULE.format(name="base") + MODULE.format(name="real")
    (folder / "probe_two.py").write_text(two + "MODULE = real\n")
    assert found_in(folder) == (["real"], [])


@pytest.mark.parametrize(
    ("file", "text", "reason"),
    [
        ("probe_none.py", "x = 1", "defines 0 module classes"),
        ("probe_many.py", MODULE.format(name="a") + MODULE.format(name="b"), "2 module classes"),
        ("probe_raises.py", "1 / 0", "division by zero"),
        ("probe_syntax.py", "def (", "invalid syntax"),
        ("probe_number.py", "MODULE = 3", "3 is no subclass"),
        ("probe_clash.py", MODULE.format(name="bruneton_sky"), "another module is called"),
        ("numpy.py", MODULE.format(name="numpy"), "'numpy' is installed already"),
    ],
)
def test_failures_are_reported_and_other_modules_load(folder, file, text, reason):
    """A broken import is reported in one sentence, and the other modules load."""
    (folder / file).write_text(text)
    (folder / "probe_good.py").write_text(MODULE.format(name="good"))
    names, failures = found_in(folder)
    assert names == ["good"]
    assert len(failures) == 1
    assert file in failures[0]
    assert reason in failures[0]


def test_a_missing_folder_is_named(tmp_path):
    """A missing folder is an error, not a folder without modules."""
    with pytest.raises(UserError, match=r"no folder of modules .*nowhere"):
        discover([tmp_path / "nowhere"])
