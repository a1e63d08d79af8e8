"""The commands and code of docs/tutorial.md work as printed, here with smaller pictures."""

import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).parents[1]
PAGE = (ROOT / "docs" / "tutorial.md").read_text(encoding="utf-8")
PYTHON = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
SHELL = re.findall(r"```sh\n(.*?)```", PAGE, re.DOTALL)
# Replaces the command: the same, with smaller sizes and fewer steps.
COMMAND = f"""#!{sys.executable}
import sys
from vrut_lite.cli import main
small = {{"2h": "8h", "sun,hosek-wilkie": "sun"}}
arguments = [small.get(argument, argument) for argument in sys.argv[1:]]
if arguments[0] == "render":
    arguments += ["--size", "48x30"]
if arguments[0] == "sky" and "--size" not in arguments:
    arguments += ["--size", "32"]
sys.argv = ["vrut-lite", *arguments]
main()
"""


@pytest.fixture
def desk(tmp_path, monkeypatch):
    """A folder with the scenes, where the command is found."""
    (tmp_path / "scenes").symlink_to(ROOT / "scenes")
    command = tmp_path / "bin" / "vrut-lite"
    command.parent.mkdir()
    command.write_text(COMMAND)
    command.chmod(0o755)
    monkeypatch.setenv("PATH", f"{command.parent}{os.pathsep}{os.environ['PATH']}")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def run(block: str) -> str:
    """Output of a block of shell commands, each of which must succeed."""
    done = subprocess.run(
        ["bash", "-eu", "-o", "pipefail", "-c", block], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def block_with(text: str) -> str:
    """The only block of commands with this text."""
    (block,) = [each for each in SHELL if text in each]
    return block


def test_every_block_is_tried_here() -> None:
    """Every block of the page is run by a test."""
    tried = ("noon.exr", "dusk.png", "day_%04d.png", "hazy.png", "model.npz", "bench", "my_modules")
    assert len(SHELL) == len(tried) + 1
    assert [len([b for b in SHELL if text in b]) for text in tried] == [1] * len(tried)
    assert SHELL[0] == "vrut-lite modules\n"
    assert len(PYTHON) == 3


@pytest.mark.long
@pytest.mark.gl
def test_pictures(desk) -> None:
    """A picture at dusk, and one for each step of a day."""
    run(block_with("dusk.png"))
    run(block_with("day_%04d.png"))
    names = {path.name for path in desk.glob("*.png")}
    assert names == {"dusk.png", "day_0001.png", "day_0002.png", "day_0003.png"}


@pytest.mark.long
def test_skies_of_other_atmospheres(desk) -> None:
    """The environment map, the hazy evening and the red planet are written."""
    run(block_with("noon.exr"))
    run(block_with("hazy.png"))
    assert {path.name for path in desk.iterdir()} >= {"noon.exr", "hazy.png", "red_planet.png"}


def test_python_s_atmosphere() -> None:
    """The ratios are those in the page's comment, and the tables give light."""
    names: dict = {}
    exec(PYTHON[0], names)
    ratio = names["once"][names["small"]] / names["once"][names["earth"]]
    said = re.search(r"# ([\d.]+), ([\d.]+) and ([\d.]+) times as bright", PYTHON[0])
    assert said is not None
    np.testing.assert_allclose(ratio, [float(number) for number in said.groups()], atol=0.06)
    assert 0.0 < names["red"] < names["blue"]


@pytest.mark.long
def test_comparison(desk, capsys) -> None:
    """The two skies of one hour agree within a factor of 1.5, in the median direction."""
    run(block_with("model.npz"))
    exec(PYTHON[1], {})
    (ratio,) = re.findall(r"is ([\d.]+) times as bright", capsys.readouterr().out)
    assert 0.67 < float(ratio) < 1.5


@pytest.mark.long
def test_benchmark(desk) -> None:
    """The output is where the text says."""
    pytest.importorskip("pvlib", reason="the extra `bench` is not installed")
    run(block_with("vrut-lite bench"))
    assert (desk / "bench" / "index.html").exists()
    assert (desk / "bench" / "bench.json").exists()


@pytest.mark.long
def test_module(desk) -> None:
    """The module posts two golden hours a day, and the journal replays."""
    (desk / "my_modules").mkdir()
    (desk / "my_modules" / "golden_hour.py").write_text(PYTHON[2])
    said = run(block_with("my_modules"))
    assert "golden_hour" in said
    told = [line for line in said.splitlines() if '"GoldenHour"' in line or "GoldenHour" in line]
    begins = [bool(re.search(r'"begins":\s*true', line)) for line in told]
    assert begins == [True, False, True, False]
    assert "are equal" in said
