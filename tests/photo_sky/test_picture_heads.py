"""The heads of HDR pictures are honoured: unit, colours, order and packing of pixels."""

import os
import subprocess
from datetime import UTC, datetime
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import OpenEXR
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from photo_sky.module import PhotoSky
from photo_sky.read_panorama import read_panorama

from vrut_lite.errors import UserError
from vrut_lite.geometry.colour import LUMENS_PER_WATT, SRGB_FROM_XYZ, luminance
from vrut_lite.geometry.encoding import decode_float16
from vrut_lite.geometry.spherical_harmonics import horizontal_irradiance
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import ChooseSlot, Demand, SetClock, SetSetting
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.sky import BackgroundChanged
from vrut_lite.messages.sun import KeyLightChanged, SunMoved
from vrut_lite.pictures.write_exr import write_exr
from vrut_lite.pictures.write_hdr import rgbe_from_rgb, write_hdr

ROWS, COLUMNS = 8, 16
PICTURE = np.random.default_rng(3).uniform(0.2, 8.0, (ROWS, COLUMNS, 3)).astype(np.float32)
USUAL = b"-Y 8 +X 16\n"
XYZ_FROM_SRGB = np.linalg.inv(SRGB_FROM_XYZ)
# A wide gamut with D65 (ITU-R BT.2020), and Radiance's own primaries with white of equal energy.
BT_2020 = (0.708, 0.292, 0.170, 0.797, 0.131, 0.046, 0.3127, 0.3290)
RADIANCE = (0.640, 0.330, 0.290, 0.600, 0.150, 0.060, 0.3333, 0.3333)


def hdr(tmp_path, *variables, body=None, size=USUAL, end=b"\n"):
    """A file of rounded pixels, all heads with MANTISSAS so that numbers are exact."""
    body = rgbe_from_rgb(PICTURE).tobytes() if body is None else body
    lines = [b"#?RADIANCE", *(text.encode() for text in variables), b"MANTISSAS=rounded", b""]
    path = tmp_path / "sky.hdr"
    path.write_bytes(end.join(lines) + end + size.removesuffix(b"\n") + end + body)
    return path


STORED = rgbe_from_rgb(PICTURE)
EXACT = np.ldexp(STORED[..., :3].astype(float), STORED[..., 3:].astype(int) - 136)


def radiance_program(name, *arguments, data=None):
    if (found := find_spec("pyradiance")) is None:
        pytest.skip("Radiance (the wheel pyradiance) is not installed")
    program = Path(found.origin).parent / "bin" / name
    done = subprocess.run([program, *map(str, arguments)], input=data, capture_output=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_exposure_lines_multiply(tmp_path):
    """Radiance's luminance is 179 lm/W times value over all exposures, whatever spaces stand."""
    found = read_panorama(hdr(tmp_path, "EXPOSURE=2", "view", "EXPOSURE= 0.25 "))
    np.testing.assert_allclose(found.pixels, EXACT)
    assert found.cd_m2_per_unit == pytest.approx(179.0 / 0.5)
    assert read_panorama(hdr(tmp_path)).cd_m2_per_unit == 179.0


def test_colour_corrections_are_undone(tmp_path):
    """Channels were multiplied by them, a line after another."""
    found = read_panorama(hdr(tmp_path, "COLORCORR=2 1 0.5", "COLORCORR= 1 4 1"))
    np.testing.assert_allclose(found.pixels, EXACT / [2.0, 4.0, 0.5])


def test_xyz_pixels_become_rgb(tmp_path):
    """FORMAT=32-bit_rle_xyze: grey is of equal energy there, and Y is cd/m² over EXPOSURE."""
    grey = rgbe_from_rgb(np.full((ROWS, COLUMNS, 3), 0.5)).tobytes()
    found = read_panorama(hdr(tmp_path, "FORMAT=32-bit_rle_xyze", "EXPOSURE=0.01", body=grey))
    np.testing.assert_allclose(found.pixels, 0.5, atol=1e-4)
    assert found.cd_m2_per_unit == 100.0


@pytest.mark.parametrize("primaries", [BT_2020, RADIANCE])
@pytest.mark.parametrize("suffix", [".exr", ".hdr"])
def test_primaries_are_honoured(tmp_path, primaries, suffix):
    """White stays white, of its luminance; red is the file's red, not sRGB's."""
    picture = np.ones((ROWS, COLUMNS, 3), np.float32)
    picture[0] = (1.0, 0.0, 0.0)
    path = tmp_path / f"sky{suffix}"
    if suffix == ".exr":
        header = {"chromaticities": primaries, "type": OpenEXR.scanlineimage}
        OpenEXR.File(header, {"RGB": picture}).write(os.fspath(path))
    else:
        text = f"PRIMARIES={' '.join(map(str, primaries))}"
        path = hdr(tmp_path, text, body=rgbe_from_rgb(picture).tobytes())
    found = read_panorama(path).pixels
    np.testing.assert_allclose(found[1:], 1.0, atol=2e-4)
    xyz = found[0, 0] @ XYZ_FROM_SRGB.T
    chromaticity = xyz[:2] / xyz.sum()
    if primaries is BT_2020:
        # Both whites are D65: no adaptation.
        np.testing.assert_allclose(chromaticity, primaries[:2], atol=1e-3)
        np.testing.assert_allclose(xyz[1], 0.2627, atol=1e-3)
    else:
        assert np.linalg.norm(chromaticity - primaries[:2]) < 0.01
        assert not np.allclose(found[0], [1.0, 0.0, 0.0], atol=0.02)


def test_white_luminance_is_the_unit(tmp_path):
    """EXR's standard attribute says what 1 is; without it 1 is W m^-2 sr^-1 of 683 lm/W."""
    for header, expected in (({"whiteLuminance": 80.0}, 80.0), ({}, 683.0)):
        header = {"type": OpenEXR.scanlineimage, **header}
        OpenEXR.File(header, {"RGB": PICTURE}).write(os.fspath(tmp_path / "sky.exr"))
        assert read_panorama(tmp_path / "sky.exr").cd_m2_per_unit == pytest.approx(expected)


@pytest.mark.parametrize("vertical", "-+")
@pytest.mark.parametrize("horizontal", "+-")
@pytest.mark.parametrize("by_columns", [False, True])
def test_all_eight_orders(tmp_path, vertical, horizontal, by_columns):
    """The top left pixel is the same, in whatever order the file has them."""
    stored = STORED[::-1] if vertical == "+" else STORED
    stored = stored[:, ::-1] if horizontal == "-" else stored
    size = f"{vertical}Y {ROWS} {horizontal}X {COLUMNS}"
    if by_columns:
        stored = stored.transpose(1, 0, 2)
        size = f"{horizontal}X {COLUMNS} {vertical}Y {ROWS}"
    path = hdr(tmp_path, body=stored.tobytes(), size=size.encode() + b"\n")
    np.testing.assert_allclose(read_panorama(path).pixels, EXACT)


def test_heads_with_other_line_ends(tmp_path):
    """A carriage return belongs to the text, never to a pixel."""
    found = read_panorama(hdr(tmp_path, "EXPOSURE=2", end=b"\r\n"))
    np.testing.assert_allclose(found.pixels, EXACT)
    assert found.cd_m2_per_unit == 89.5


def test_plain_files_that_begin_as_packed_ones(tmp_path):
    """2, 2, 128 or more is a dark blue pixel: packed lines have less than 128 there."""
    stored = STORED.copy()
    stored[0, 0] = (2, 2, 200, 130)
    found = read_panorama(hdr(tmp_path, body=stored.tobytes())).pixels
    np.testing.assert_allclose(found[0, 0], np.array([2, 2, 200]) / 64.0)
    np.testing.assert_allclose(found[1:], EXACT[1:])


def test_old_run_lengths(tmp_path):
    """1, 1, 1, n repeats a pixel; a second mark holds the number's next 8 bits."""
    rows, columns = 200, 400
    one, other = bytes((200, 100, 50, 129)), bytes((10, 200, 30, 128))
    line = one + bytes((1, 1, 1, 399 - 256, 1, 1, 1, 1))
    mixed = other * 3 + bytes((1, 1, 1, 7)) + one + bytes((1, 1, 1, 133, 1, 1, 1, 1))
    body = line * (rows - 1) + mixed
    found = read_panorama(hdr(tmp_path, body=body, size=b"-Y 200 +X 400\n")).pixels
    expected = np.tile(np.array([200, 100, 50]) / 128.0, (rows, columns, 1))
    expected[-1, :10] = np.array([10, 200, 30]) / 256.0
    np.testing.assert_allclose(found, expected)
    with pytest.raises(UserError, match="is damaged"):
        read_panorama(hdr(tmp_path, body=body[:-4], size=b"-Y 200 +X 400\n"))


def test_own_files_come_back_unbiased(tmp_path):
    """Half a step of the largest channel at most, 1/256, and no brighter in the mean."""
    picture = np.random.default_rng(5).uniform(0.5, 1.0, (64, 128, 3)).astype(np.float32)
    write_hdr(tmp_path / "sky.hdr", picture)
    ratio = read_panorama(tmp_path / "sky.hdr").pixels / picture
    assert abs(float(ratio.mean()) - 1.0) < 2e-4
    largest = picture.max(axis=-1, keepdims=True)
    assert (np.abs(ratio - 1.0) * picture / largest).max() <= 1.0 / 256.0
    # Half a step is added to files of other programs, which cut mantissas off, even where they
    # copied this program's head.
    data = (tmp_path / "sky.hdr").read_bytes()
    (tmp_path / "sky.hdr").write_bytes(data.replace(b"\nFORMAT", b"\n\tpfilt -1\nFORMAT", 1))
    halves = read_panorama(tmp_path / "sky.hdr").pixels / picture
    assert 1.002 < float(halves.mean()) < 1.004


def test_a_sky_of_ours_has_the_luminance_it_had(tmp_path):
    """By default, as EXR and as HDR; --photo-cd-m2 is what the value 1 in the file has."""
    picture = np.full((64, 128, 3), 2.0, np.float32)
    write_exr(tmp_path / "sky.exr", picture, {})
    write_hdr(tmp_path / "sky.hdr", picture)
    kernel = Kernel()
    kernel.add_module(PhotoSky)
    for kind in (SunMoved, BackgroundChanged, KeyLightChanged):
        kernel.inject(Demand(consumer="test", message=kind.__name__, size=32))
    kernel.inject(SetPlace(latitude_deg=50.0, longitude_deg=14.0))
    kernel.inject(SetClock(instant=datetime(2026, 6, 21, 12, tzinfo=UTC)))
    for slot in ("sun", "sky"):
        kernel.inject(ChooseSlot(slot=slot, module="photo_sky"))

    def level_lux(**asked):
        for name, value in asked.items():
            kernel.inject(SetSetting(module="photo_sky", name=name, value=value))
        kernel.pump_until_idle()
        shown = kernel.last(BackgroundChanged)
        cube = decode_float16(shown.cube.values, shown.radiance_scale).astype(float)
        return LUMENS_PER_WATT * float(luminance(horizontal_irradiance(cube)))

    expected = np.pi * 2.0 * LUMENS_PER_WATT
    for suffix in (".exr", ".hdr"):
        path = str(tmp_path / f"sky{suffix}")
        assert level_lux(photo=path, photo_cd_m2=None) == pytest.approx(expected, rel=0.01)
        assert level_lux(photo_cd_m2=683.0) == pytest.approx(expected, rel=0.01)
        assert level_lux(photo_cd_m2=68.3) == pytest.approx(0.1 * expected, rel=0.01)
    kernel.close()


def test_what_radiance_writes(tmp_path):
    """Exposed, flipped, turned into XYZ and packed by its own tools: the same radiance, 1 %."""
    smooth = np.linspace(0.5, 4.0, 64 * 128 * 3).reshape(64, 128, 3).astype(np.float32)
    path = tmp_path / "sky.hdr"
    write_hdr(path, smooth)
    whole = read_panorama(path)
    for tool, *arguments in (
        ("pfilt", "-1", "-e", "4", path),
        ("pfilt", "-1", "-er", "2", "-eb", "0.5", path),
        ("ra_xyze", path),
        ("ra_xyze", "-u", path),
    ):
        changed = tmp_path / "changed.hdr"
        changed.write_bytes(radiance_program(tool, *arguments))
        found = read_panorama(changed)
        np.testing.assert_allclose(
            found.pixels * found.cd_m2_per_unit,
            whole.pixels * whole.cd_m2_per_unit,
            rtol=0.012,
            atol=0.012 * 4.0 * 683.0,
        )


def test_radiance_reads_the_same_luminance(tmp_path):
    """Y in cd/m² by ra_xyze of a grey file of ours is the luminance that we read."""
    grey = np.repeat(PICTURE[..., :1], 3, axis=2)
    write_hdr(tmp_path / "sky.hdr", grey)
    (tmp_path / "xyz.hdr").write_bytes(radiance_program("ra_xyze", "-u", tmp_path / "sky.hdr"))
    said = radiance_program("pvalue", "-h", "-H", "-d", "-o", tmp_path / "xyz.hdr")
    y_cd_m2 = np.array(said.split(), float).reshape(ROWS, COLUMNS, 3)[..., 1]
    found = read_panorama(tmp_path / "sky.hdr")
    # Radiance adds half a step to rounded mantissas, twice: up to 0.8 %.
    np.testing.assert_allclose(y_cd_m2, luminance(found.pixels) * found.cd_m2_per_unit, rtol=0.01)


HEADS = st.lists(
    st.one_of(
        st.tuples(
            st.sampled_from(["EXPOSURE", "COLORCORR", "PRIMARIES", "FORMAT", "VIEW", "MANTISSAS"]),
            st.lists(
                st.one_of(
                    st.floats(width=32).map(str),
                    st.floats(0.01, 100.0).map(str),
                    st.sampled_from(["32-bit_rle_rgbe", "32-bit_rle_xyze", "x", ""]),
                ),
                max_size=9,
            ).map(" ".join),
        ).map("=".join),
        st.text(st.characters(codec="latin-1", exclude_characters="\n\r"), max_size=20),
    ),
    max_size=5,
)


@settings(max_examples=150, deadline=None)
@given(variables=HEADS, end=st.sampled_from([b"\n", b"\r\n"]), noise=st.binary(max_size=600))
def test_any_head_is_read_or_refused(variables, end, noise, tmp_path_factory):
    """Finite light with a unit above 0, or one sentence; never a traceback, never NaN."""
    head = end.join([b"#?RADIANCE", *(v.encode("latin-1") for v in variables), b"", b"-Y 8 +X 16"])
    path = tmp_path_factory.getbasetemp() / "any.hdr"
    path.write_bytes(head + end + noise + STORED.tobytes())
    try:
        found = read_panorama(path)
    except UserError:
        return
    assert found.pixels.shape == (ROWS, COLUMNS, 3)
    assert np.isfinite(found.pixels).all()
    assert 0.0 < found.cd_m2_per_unit < np.inf
