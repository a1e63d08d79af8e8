"""What is remembered of OpenGL: that it was opened here, until it is opened again."""

import pytest

from vrut_lite.render import gl_record


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    return tmp_path


def test_a_record_is_away_while_opengl_is_opened():
    """A driver that ends the process leaves none, so that the next start tries it first."""
    assert gl_record.take_record() is None
    gl_record.keep_record("llvmpipe (LLVM 15.0.6, 256 bits)")
    assert gl_record.take_record() == "llvmpipe (LLVM 15.0.6, 256 bits)"
    assert gl_record.take_record() is None


@pytest.mark.parametrize(
    "variable", ["LIBGL_ALWAYS_SOFTWARE", "EGL_PLATFORM", "CUDA_VISIBLE_DEVICES", "VRUT_LITE_GPU"]
)
def test_another_driver_is_tried_first(monkeypatch, variable):
    """What chooses one is part of the record."""
    gl_record.keep_record("a card")
    monkeypatch.setenv(variable, "other")
    assert gl_record.take_record() is None


def test_a_damaged_record_is_none(folder):
    """Whatever it holds."""
    gl_record.keep_record("a card")
    for content in (b"", b"\xff\xfe", b"a card", b"\n" * 9):
        (folder / "vrut_lite" / "opengl.txt").write_bytes(content)
        assert gl_record.take_record() is None
