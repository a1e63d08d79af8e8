"""PNG with 16 bits a channel: Pillow cannot write it, so that it is held to the standard here."""

import struct
import sys
import zlib

import numpy as np
import pytest
from path_tracer_here import mitsuba_or_skip
from PIL import Image

from vrut_lite import cli
from vrut_lite.errors import UserError
from vrut_lite.pictures.display import display_picture
from vrut_lite.pictures.write_png import write_png

RGB16 = np.random.default_rng(3).integers(0, 65536, (37, 53, 3), dtype=np.uint16)


def chunks(data):
    """Kind and content of each chunk (PNG 3rd edition, section 5.3), checksums checked."""
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    at = 8
    while at < len(data):
        (size,) = struct.unpack_from(">I", data, at)
        kind, content = data[at + 4 : at + 8], data[at + 8 : at + 8 + size]
        assert struct.unpack_from(">I", data, at + 8 + size)[0] == zlib.crc32(kind + content)
        yield kind, content
        at += 12 + size


def read_16(path):
    """Pixels (h, w, 3) of a 16-bit RGB file without interlace and with filters none or up."""
    parts = list(chunks(path.read_bytes()))
    assert parts[0][0] == b"IHDR"
    assert parts[-1] == (b"IEND", b"")
    width, height, *kind = struct.unpack(">IIBBBBB", parts[0][1])
    assert kind == [16, 2, 0, 0, 0]
    packed = b"".join(content for name, content in parts if name == b"IDAT")
    rows = np.frombuffer(zlib.decompress(packed), np.uint8).reshape(height, 1 + 6 * width)
    assert (rows[:, 0] == 2).all()
    values = np.cumsum(rows[:, 1:], axis=0, dtype=np.uint8)
    return values.view(">u2").reshape(height, width, 3)


def test_every_value_comes_back(tmp_path):
    """The file is read by the standard's rules, by hand; the text and the sRGB chunk are there."""
    write_png(tmp_path / "a.png", RGB16, {"place": "Plzeň", "turbidity": 3.25})
    np.testing.assert_array_equal(read_16(tmp_path / "a.png"), RGB16)
    assert (b"sRGB", b"\0") in list(chunks((tmp_path / "a.png").read_bytes()))
    with Image.open(tmp_path / "a.png") as image:
        assert image.text == {"place": "Plzeň", "turbidity": "3.25"}
        seen = np.asarray(image.convert("RGB")).astype(int)
    assert np.abs(seen - RGB16 / 257.0).max() <= 1.0


def test_mitsuba_reads_it(tmp_path):
    """Another program's reader finds the same 16 bits."""
    mitsuba = mitsuba_or_skip()
    mitsuba.set_variant("scalar_rgb")
    write_png(tmp_path / "a.png", RGB16[::-1])
    np.testing.assert_array_equal(np.array(mitsuba.Bitmap(str(tmp_path / "a.png"))), RGB16[::-1])


def test_sixteen_bits_are_the_eight_without_dither():
    """A smooth ramp has its own value in each pixel, and rounds to that of 8 bits."""
    ramp = np.linspace(0.1, 30.0, 2048)[None, :, None] * np.array([0.6, 0.8, 1.0])
    fine = display_picture(ramp, ev100=11.0, bits=16)
    coarse = display_picture(ramp, ev100=11.0)
    assert fine.dtype == np.uint16
    assert np.abs(fine / 257.0 - coarse).max() <= 1.5
    rising = np.diff(fine[0, :, 1].astype(int))
    assert (rising >= 0).all()
    assert (rising > 0).mean() > 0.9


def run(monkeypatch, *arguments):
    monkeypatch.setattr(sys, "argv", ["vrut-lite", *map(str, arguments)])
    cli.main()


def test_the_sky_in_sixteen_bits(monkeypatch, tmp_path):
    """--bits 16 is for .png, and is refused for what has a precision of its own."""
    run(monkeypatch, "sky", "-o", tmp_path / "a.png", "--size", 32, "--bits", 16)
    assert read_16(tmp_path / "a.png").shape == (32, 64, 3)
    with pytest.raises(UserError, match=r"--bits is for \.png"):
        cli.root(["sky", "-o", str(tmp_path / "a.exr"), "--bits", "16"], standalone_mode=False)


@pytest.mark.gl
def test_a_scene_in_sixteen_bits_is_the_frames_own(monkeypatch, tmp_path):
    """The frame has 8 bits, dithered; the 16 are made of its radiance: two steps apart at most."""
    scene = write_box(tmp_path)
    for bits in (8, 16):
        where = tmp_path / f"{bits}.png"
        run(monkeypatch, "render", scene, "-o", where, "--size", "96x64", "--bits", bits)
    with Image.open(tmp_path / "8.png") as image:
        eight = np.asarray(image).astype(float)
    assert np.abs(read_16(tmp_path / "16.png") / 257.0 - eight).max() <= 2.0


def write_box(folder):
    import trimesh

    trimesh.creation.box((1, 1, 1)).export(folder / "box.glb")
    return folder / "box.glb"
