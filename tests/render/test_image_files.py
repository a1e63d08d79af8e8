"""Picture files must hold what was given to the writers, and never half of it."""

import contextlib
import os
import resource
import tempfile
from pathlib import Path

import numpy as np
import OpenEXR
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image

from vrut_lite.errors import UserError
from vrut_lite.pictures.image_files import (
    PICTURE_FORMATS,
    atomic_output,
    check_writable,
    picture_format,
    write_exr,
    write_hdr,
    write_npz,
    write_png,
)
from vrut_lite.pictures.write_hdr import LARGEST, rgbe_from_rgb

RADIANCE = np.random.default_rng(1).lognormal(0, 3, (37, 53, 3)).astype(np.float32)
RGB8 = np.random.default_rng(2).integers(0, 256, (37, 53, 3), dtype=np.uint8)
FACTS = {"place": "Plzeň", "turbidity": 3.25, "latitude_deg": 50.0755}

WRITERS = {
    ".exr": lambda path: write_exr(path, RADIANCE, FACTS),
    ".hdr": lambda path: write_hdr(path, RADIANCE, FACTS),
    ".npz": lambda path: write_npz(path, {"radiance": RADIANCE}, FACTS),
    ".png": lambda path: write_png(path, RGB8, FACTS),
}


@contextlib.contextmanager
def without_root():
    """Root may write anywhere: act as nobody for the while, if root."""
    if os.geteuid() != 0:
        yield
        return
    os.seteuid(65534)
    try:
        yield
    finally:
        os.seteuid(0)


@contextlib.contextmanager
def file_size_limit(size_bytes: int):
    """Let the kernel refuse to grow files beyond the size, as a full disk does."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size_bytes, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


def read_rgbe(path: Path) -> tuple[dict[str, str], np.ndarray]:
    """The header and the pixels as most readers take them: value = byte * 2^(exponent - 136)."""
    head, _, rest = path.read_bytes().partition(b"\n\n")
    size, _, pixels = rest.partition(b"\n")
    first, *lines = head.decode().split("\n")
    assert first == "#?RADIANCE"
    y, height, x, width = size.decode().split(" ")
    assert (y, x) == ("-Y", "+X")
    rgbe = np.frombuffer(pixels, np.uint8).reshape(int(height), int(width), 4).astype(int)
    return dict(line.split("=", 1) for line in lines), rgb_from_rgbe(rgbe)


def rgb_from_rgbe(rgbe: np.ndarray) -> np.ndarray:
    exponent = rgbe[..., 3:].astype(int)
    return np.where(exponent > 0, np.ldexp(rgbe[..., :3].astype(float), exponent - 136), 0.0)


@pytest.mark.parametrize("precision", [np.float16, np.float32])
def test_exr_keeps_every_bit_and_says_what_it_holds(tmp_path, precision):
    """The OpenEXR library reads back the same floats, sRGB's chromaticities and the metadata."""
    pixels = np.minimum(RADIANCE, 60000).astype(precision)
    write_exr(tmp_path / "sky.exr", pixels[::-1], FACTS)
    with OpenEXR.File(os.fspath(tmp_path / "sky.exr")) as file:
        header, read = dict(file.header()), file.channels()["RGB"].pixels.copy()
    assert read.dtype == precision
    assert read.tobytes() == pixels[::-1].tobytes()
    assert header["compression"] == OpenEXR.ZIP_COMPRESSION
    np.testing.assert_allclose(header["chromaticities"][:2], (0.64, 0.33), rtol=1e-6)
    np.testing.assert_allclose(header["chromaticities"][6:], (0.3127, 0.3290), rtol=1e-6)
    assert header["whiteLuminance"] == 683.0
    assert header["place"] == "Plzeň"
    assert header["latitude_deg"] == 50.0755


def test_hdr_keeps_the_numbers_to_its_eight_bits(tmp_path):
    """Half a step of a mantissa of at least 128 is 1/256 of the largest channel (Ward 1991)."""
    write_hdr(tmp_path / "sky.hdr", RADIANCE, FACTS)
    header, read = read_rgbe(tmp_path / "sky.hdr")
    largest = RADIANCE.max(axis=-1, keepdims=True)
    assert (np.abs(read - RADIANCE) / largest).max() <= 1 / 256
    assert abs((read - RADIANCE).sum() / RADIANCE.sum()) < 1 / 1024
    assert header["FORMAT"] == "32-bit_rle_rgbe"
    assert header["place"] == "Plzeň"
    assert header["PRIMARIES"] == "0.64 0.33 0.3 0.6 0.15 0.06 0.3127 0.329"


def test_hdr_gives_radiance_tools_the_right_luminance(tmp_path):
    """Radiance reckons 179 lm/W times the pixel over EXPOSURE; we reckon 683 lm/W times Y."""
    write_hdr(tmp_path / "white.hdr", np.ones((1, 1, 3), np.float32))
    header, read = read_rgbe(tmp_path / "white.hdr")
    assert 179.0 * read[0, 0, 1] / float(header["EXPOSURE"]) == pytest.approx(683.0, rel=1e-8)


@settings(deadline=None)
@given(st.lists(st.floats(width=32, allow_nan=False, allow_infinity=False), min_size=3, max_size=3))
def test_rgbe_holds_any_finite_value(values):
    """No float32 wraps around a byte: negatives are black, the brightest are the format's most."""
    rgb = np.array(values, np.float32)
    clipped = np.clip(rgb.astype(float), 0.0, LARGEST)
    read = rgb_from_rgbe(rgbe_from_rgb(rgb))
    assert (np.abs(read - clipped) <= clipped.max() / 256 + 2.0**-128).all()


def test_rgbe_of_known_colours():
    """1 is 128/256 * 2^1; a mantissa that rounds to 256 takes the next exponent; 0 is all zero."""
    rgb = [[1, 0.5, 0], [255.9 / 256, 0, 0], [0, 0, 0], [-1, -1, -1], [1e-39, 0, 0], [3e38, 0, 0]]
    assert rgbe_from_rgb(np.array(rgb, np.float32)).tolist() == [
        [128, 64, 0, 129],
        [128, 0, 0, 129],
        [0, 0, 0, 0],
        [0, 0, 0, 0],
        [0, 0, 0, 0],
        [255, 0, 0, 255],
    ]


def test_hdr_refuses_what_it_cannot_hold(tmp_path):
    """RGBE has no code for inf or nan, and a line break in the header would end it."""
    with pytest.raises(ValueError, match="finite"):
        write_hdr(tmp_path / "a.hdr", np.full((1, 1, 3), np.nan, np.float32))
    for name, value in (("FORMAT", "x"), ("a=b", "x"), ("a", "x\n\n"), ("", "x")):
        with pytest.raises(ValueError, match="header"):
            write_hdr(tmp_path / "a.hdr", RADIANCE, {name: value})
    assert not list(tmp_path.iterdir())


def test_png_keeps_every_pixel_and_is_marked_srgb(tmp_path):
    """Pillow reads the pixels, the texts, and the sRGB chunk, which stands before the pixels."""
    write_png(tmp_path / "sky.png", RGB8[:, ::-1], FACTS)
    with Image.open(tmp_path / "sky.png") as image:
        assert image.mode == "RGB"
        assert np.array_equal(np.asarray(image), RGB8[:, ::-1])
        assert image.info["srgb"] == 0
        assert image.text == {key: str(value) for key, value in FACTS.items()}
    data = (tmp_path / "sky.png").read_bytes()
    assert 0 < data.index(b"sRGB") < data.index(b"IDAT")


def test_npz_keeps_arrays_and_metadata(tmp_path):
    """numpy reads them without pickle, types kept."""
    write_npz(tmp_path / "sky.npz", {"radiance": RADIANCE, "file": RGB8}, FACTS)
    with np.load(tmp_path / "sky.npz", allow_pickle=False) as read:
        assert sorted(read.files) == sorted(["file", "radiance", *FACTS])
        assert read["radiance"].tobytes() == RADIANCE.tobytes()
        assert np.array_equal(read["file"], RGB8)
        assert read["place"] == "Plzeň"
        assert read["latitude_deg"] == 50.0755


def test_npz_refuses_doubled_names_and_objects(tmp_path):
    """Neither a silent overwrite nor a pickle."""
    with pytest.raises(ValueError, match="'a' names both"):
        write_npz(tmp_path / "a.npz", {"a": RGB8}, {"a": 1.0})
    with pytest.raises(ValueError, match="allow_pickle"):
        write_npz(tmp_path / "a.npz", {"a": RGB8, "b": np.array([object()])})
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("suffix", PICTURE_FORMATS)
def test_the_same_content_gives_the_same_bytes(tmp_path, suffix):
    """Files can be compared by digest: no date, no name of the machine, no order of insertion."""
    WRITERS[suffix](tmp_path / f"a{suffix}")
    WRITERS[suffix](tmp_path / f"b{suffix}")
    first, second = (tmp_path / f"{name}{suffix}" for name in "ab")
    assert first.read_bytes() == second.read_bytes()


def test_npz_bytes_do_not_depend_on_the_order_of_insertion(tmp_path):
    """Members are sorted by name."""
    write_npz(tmp_path / "a.npz", {"x": RGB8, "y": RADIANCE})
    write_npz(tmp_path / "b.npz", {"y": RADIANCE, "x": RGB8})
    assert (tmp_path / "a.npz").read_bytes() == (tmp_path / "b.npz").read_bytes()


@pytest.mark.parametrize("pixels", [RADIANCE[0], RADIANCE[..., :2], RADIANCE[:0], RGB8])
def test_wrong_arrays_are_refused_before_a_file_exists(tmp_path, pixels):
    """A picture is (height, width, 3); linear ones are floats."""
    for write in (write_exr, write_hdr):
        with pytest.raises(ValueError, match="picture"):
            write(tmp_path / "a", pixels, {})
    with pytest.raises(ValueError, match="picture"):
        write_png(tmp_path / "a", RADIANCE)
    assert not list(tmp_path.iterdir())


def test_exr_metadata_cannot_overwrite_the_format(tmp_path):
    """A text under 'dataWindow' would make the file unreadable."""
    with pytest.raises(ValueError, match="'dataWindow'"):
        write_exr(tmp_path / "a.exr", RADIANCE, {"dataWindow": "all"})


@pytest.mark.parametrize("suffix", PICTURE_FORMATS)
def test_a_full_disk_leaves_the_older_file(tmp_path, suffix):
    """When the kernel refuses bytes in the middle, the error is one sentence, the file whole."""
    path = tmp_path / f"sky{suffix}"
    path.write_bytes(b"older")
    with file_size_limit(1000), pytest.raises(UserError, match=r"cannot write .*sky") as caught:
        WRITERS[suffix](path)
    assert "\n" not in str(caught.value)
    assert path.read_bytes() == b"older"
    assert list(tmp_path.iterdir()) == [path]


def write_half(path: Path, interruption: type[BaseException]) -> None:
    with atomic_output(path) as beside:
        beside.write_bytes(b"half")
        assert beside.parent == path.parent
        assert not path.exists()
        raise interruption


@pytest.mark.parametrize("interruption", [RuntimeError, KeyboardInterrupt])
def test_an_exception_in_the_middle_leaves_nothing(tmp_path, interruption):
    """Neither the file nor the one beside it stays, and the exception comes through."""
    with pytest.raises(interruption):
        write_half(tmp_path / "a.bin", interruption)
    assert not list(tmp_path.iterdir())


def test_a_link_stays_a_link(tmp_path):
    """Writing through a symbolic link replaces its target, as other programs do."""
    (tmp_path / "data").mkdir()
    (tmp_path / "link.png").symlink_to(tmp_path / "data" / "real.png")
    check_writable(tmp_path / "link.png")
    write_png(tmp_path / "link.png", RGB8)
    assert (tmp_path / "link.png").is_symlink()
    assert (tmp_path / "data" / "real.png").is_file()


def test_new_files_have_the_permissions_of_any_new_file(tmp_path):
    """Not the 0600 of temporary files: a picture for others must be readable by others."""
    write_png(tmp_path / "a.png", RGB8)
    (tmp_path / "plain").touch()
    assert (tmp_path / "a.png").stat().st_mode == (tmp_path / "plain").stat().st_mode


def test_check_writable_leaves_no_trace(tmp_path):
    """A path that can be written passes, whether the file exists or not, and nothing is made."""
    check_writable(tmp_path / "new.png")
    assert not list(tmp_path.iterdir())
    (tmp_path / "old.png").write_bytes(b"older")
    check_writable(tmp_path / "old.png")
    assert (tmp_path / "old.png").read_bytes() == b"older"


@pytest.mark.parametrize(
    ("name", "why"),
    [
        ("absent/a.png", "there is no folder"),
        ("file/a.png", "there is no folder"),
        ("folder.png", "it is a folder"),
        ("pipe.png", "no plain file"),
        ("a" * 300 + ".png", "name too long"),
    ],
)
def test_check_writable_says_what_is_wrong(tmp_path, name, why):
    """Each obstacle has its own sentence, with the path, before the long work begins."""
    (tmp_path / "file").touch()
    (tmp_path / "folder.png").mkdir()
    os.mkfifo(tmp_path / "pipe.png")
    with pytest.raises(UserError, match=why) as caught:
        check_writable(tmp_path / name)
    assert str(caught.value).startswith(f"cannot write {tmp_path / name}: ")


def test_check_writable_respects_permissions():
    """A folder that takes no files and a file that takes no bytes are refused."""
    # pytest's own folders are closed to other users, and so to the user that root becomes here.
    with tempfile.TemporaryDirectory() as name:
        folder, locked = Path(name), Path(name) / "locked.png"
        locked.touch()
        locked.chmod(0o444)
        folder.chmod(0o777)
        with without_root(), pytest.raises(UserError, match="permission denied"):
            check_writable(locked)
        folder.chmod(0o555)
        with without_root(), pytest.raises(UserError, match="permission denied"):
            check_writable(folder / "new.png")
        folder.chmod(0o755)


@pytest.mark.parametrize("name", ["a.EXR", "b.hdr", "c.d.npz", "../e.Png"])
def test_formats_go_by_suffix(name):
    """In any case of letters, the last suffix counting."""
    assert picture_format(name) == "." + name.rsplit(".", 1)[1].lower()


@pytest.mark.parametrize("name", ["a.jpg", "a", ".png"])
def test_unknown_formats_are_refused_naming_the_known(name):
    """The sentence lists what can be written instead."""
    with pytest.raises(UserError, match=r"known are \.exr, \.hdr, \.npz, \.png$"):
        picture_format(name)
