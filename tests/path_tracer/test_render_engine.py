"""`vrut-lite render --engine path-tracer`: pictures, metadata, and what it says when it cannot."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from path_tracer_here import mitsuba_or_skip
from PIL import Image

from vrut_lite.commands.render import render
from vrut_lite.commands.sky import sky
from vrut_lite.errors import UserError

mitsuba_or_skip()
SPHERES = str(Path(__file__).parents[2] / "scenes" / "spheres.glb")
TRACED = ("--engine", "path-tracer", "--size", "32x20")


def run(*arguments):
    return CliRunner().invoke(render, [SPHERES, *arguments], standalone_mode=False)


@pytest.mark.long
def test_a_picture_names_its_engine_and_its_samples(tmp_path):
    """PNG text and EXR header say what drew; the EXR is radiance, the PNG a picture of it."""
    import OpenEXR

    for suffix in (".png", ".exr"):
        result = run("-o", str(tmp_path / f"picture{suffix}"), *TRACED, "--spp", "3")
        assert result.exception is None, result.exception
        assert "EV100" in result.output
    image = Image.open(tmp_path / "picture.png")
    assert image.size == (32, 20)
    assert (image.text["engine"], image.text["samplesPerPixel"]) == ("path-tracer", "3")
    with OpenEXR.File(str(tmp_path / "picture.exr")) as file:
        header = file.header()
        assert (header["engine"], header["samplesPerPixel"]) == ("path-tracer", 3.0)
        pixels = np.array(file.channels()["RGB"].pixels)
    assert np.isfinite(pixels).all()
    # A sunny afternoon: middle greys of a few tens of W m^-2 sr^-1.
    assert 1.0 < np.median(pixels) < 100.0


@pytest.mark.long
def test_a_project_says_how_to_trace_and_the_option_wins(tmp_path):
    """Settings of the module `path_tracer`, as for any module; --spp is its shorthand."""
    project = tmp_path / "spheres.toml"
    project.write_text(f'scene = "{SPHERES}"\n[settings.path_tracer]\nspp = 2\nmax_bounces = 1\n')
    for extra, samples in (((), "2"), (("--spp", "4"), "4")):
        path = tmp_path / "picture.png"
        arguments = [str(project), "-o", str(path), *TRACED, *extra]
        result = CliRunner().invoke(render, arguments, standalone_mode=False)
        assert result.exception is None, result.exception
        assert Image.open(path).text["samplesPerPixel"] == samples


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--spp", "8"), "--spp is for --engine path-tracer"),
        (("--engine", "raster"), "there is no engine 'raster': there are gl, path-tracer"),
        ((*TRACED, "--spp", "0"), "spp of path_tracer must be between 1 and 65536, not 0"),
        ((*TRACED, "--spp", "many"), "spp of path_tracer must be between 1 and 65536, not many"),
    ],
)
def test_bad_words_are_one_line(tmp_path, arguments, words):
    """Told before anything is opened."""
    result = run("-o", str(tmp_path / "picture.png"), *arguments)
    assert isinstance(result.exception, UserError)
    assert words in str(result.exception)


def test_a_missing_mitsuba_is_told_by_the_command(tmp_path, without_mitsuba):
    """One line that names the extra, and no picture."""
    result = run("-o", str(tmp_path / "picture.png"), *TRACED)
    assert isinstance(result.exception, UserError)
    assert "pip install 'vrut-lite[ref]'" in str(result.exception)
    assert not (tmp_path / "picture.png").exists()


def test_its_settings_are_no_options_of_other_commands():
    """They are no matter of daylight: `sky` knows none of them."""
    names = {name for option in (*sky.params, *render.params) for name in option.opts}
    assert "--turbidity" in names
    assert "--max-bounces" not in names
    assert "--spp" not in {name for option in sky.params for name in option.opts}


@pytest.mark.long
def test_neither_opengl_nor_mitsuba_is_loaded_without_need(tmp_path):
    """The engine imports no GL, and other commands import no mitsuba."""
    program = (
        "import sys\nfrom click.testing import CliRunner\n"
        "from vrut_lite.commands.render import render\nfrom path_tracer.module import PathTracer\n"
        "assert 'mitsuba' not in sys.modules\n"
        f"result = CliRunner().invoke(render, {[SPHERES, '-o', str(tmp_path / 'a.png'), *TRACED]}"
        " + ['--spp', '1'], standalone_mode=False)\n"
        "assert result.exception is None, result.exception\n"
        "assert 'mitsuba' in sys.modules and 'OpenGL' not in sys.modules\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=False, timeout=120
    )
    assert done.returncode == 0, done.stderr


@pytest.mark.long
def test_ctrl_c_ends_a_long_render(tmp_path):
    """Interrupted amid its samples, the command ends soon and leaves no picture."""
    command = [sys.executable, "-c", "from vrut_lite.cli import main; main()", "render", SPHERES]
    command += ["-o", str(tmp_path / "a.png"), "--engine", "path-tracer", "--spp", "60000"]
    environment = {**os.environ, "PYTHONUNBUFFERED": "1"}
    process = subprocess.Popen(
        command, stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env=environment,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    )  # fmt: skip
    try:
        wait_for_mitsuba(process.pid)
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=60)
    finally:
        process.kill()
    assert process.returncode not in (0, -signal.SIGSEGV, -signal.SIGABRT)
    assert "Traceback" not in errors
    assert list(tmp_path.iterdir()) == []


def wait_for_mitsuba(pid):
    """Until the process has mapped the library that traces, and a little more."""
    end = time.monotonic() + 60.0
    while "scalar_rgb" not in Path(f"/proc/{pid}/maps").read_text():
        assert time.monotonic() < end, "it never began to trace"
        time.sleep(0.05)
    time.sleep(1.0)
