"""Scenes, the third sky and the notebook are examples, copied only where nothing is."""

import json
from pathlib import Path

import pytest
from click.testing import CliRunner

from tools import write_examples
from vrut_lite.bundled.examples import all_examples, copy_examples, example_named, installed
from vrut_lite.commands.examples import examples
from vrut_lite.errors import UserError
from vrut_lite.project import project_of_path

ROOT = Path(__file__).parents[2]


def test_every_file_of_the_scenes_belongs_to_an_example() -> None:
    """A scene that nobody lists would be in no installation."""
    listed = {file for example in all_examples().values() for file in example.files}
    there = {
        path.relative_to(ROOT).as_posix() for path in (ROOT / "scenes").rglob("*") if path.is_file()
    }
    assert there <= listed


@pytest.mark.parametrize("name", [e.name for e in all_examples().values() if e.kind == "scene"])
def test_a_scene_opens_with_its_listed_files_alone(name: str, tmp_path: Path) -> None:
    """Copied by its name it names no file that stayed behind."""
    example = example_named(name)
    copies = copy_examples([example], tmp_path)
    project = project_of_path(str(copies[0]))
    assert Path(project.scene).is_file()
    assert Path(project.scene).is_relative_to(tmp_path)


@pytest.mark.parametrize("name", write_examples.FILES)
def test_what_the_documentation_prints_is_the_example(name: str) -> None:
    """`python -m tools.write_examples` updates them after a change of the page."""
    assert installed(name).read_text(encoding="utf-8") == write_examples.FILES[name]()


def test_the_notebook_needs_the_product_alone() -> None:
    """Its cells name the scene where the copy has it, and import no laboratory."""
    notebook = json.loads(installed("notebook.ipynb").read_text(encoding="utf-8"))
    code = ["".join(cell["source"]) for cell in notebook["cells"] if cell["cell_type"] == "code"]
    assert len(code) == 5
    assert not any("vrut_lite_lab" in cell for cell in code)
    assert any("scenes/street.toml" in cell for cell in code)


def test_a_file_that_is_there_is_not_overwritten(tmp_path: Path) -> None:
    """Somebody's work may be in it; nothing else is copied then either."""
    (tmp_path / "scenes").mkdir()
    mine = tmp_path / "scenes" / "sundial.glb"
    mine.write_text("mine")
    with pytest.raises(UserError, match=r"sundial\.glb is there already"):
        copy_examples(all_examples().values(), tmp_path)
    assert [path for path in tmp_path.rglob("*") if path.is_file()] == [mine]
    assert mine.read_text() == "mine"


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (("sundail", "here"), "there is no example 'sundail'"),
        (("street",), "name a folder too"),
        (("street", "file/in/it"), "cannot copy examples into file/in/it: Not a directory"),
    ],
)
def test_bad_input_ends_in_a_sentence(
    words: tuple[str, ...], sentence: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A misspelt name, a forgotten folder, a folder below a file."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "file").touch()
    with pytest.raises(UserError, match=sentence):
        CliRunner().invoke(examples, ["copy", *words], catch_exceptions=False)


def test_the_bare_command_lists_all() -> None:
    """By name, title and the file to open."""
    said = CliRunner().invoke(examples, []).output.splitlines()
    assert len(said) == len(all_examples())
    assert said[0] == "street: A narrow street of an old town (scenes/street.toml)"
