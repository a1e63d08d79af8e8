"""The sky of glTF files of other programs, and what is refused."""

import json
from base64 import b64encode
from io import BytesIO

import numpy as np
import pytest
from photo_sky.read_panorama import read_panorama
from photo_sky.read_png16 import is_png16, read_png16
from PIL import Image

from vrut_lite.errors import UserError
from vrut_lite.geometry.colour import srgb_decode


def png(pixels):
    target = BytesIO()
    Image.fromarray(pixels).save(target, "PNG")
    return target.getvalue()


def document(**sky):
    """As the extension's own example: a panorama, and a sun on a node below another."""
    return {
        "asset": {"version": "2.0"},
        "extensions": {
            "KHR_lights_punctual": {"lights": [{"type": "directional", "intensity": 5.0}]},
            "OMI_environment_sky": {
                "skies": [{"type": "panorama", "panorama": {"equirectangular": 0}, **sky}]
            },
        },
        "extensionsUsed": ["KHR_lights_punctual", "OMI_environment_sky"],
        "images": [{"mimeType": "image/png", "uri": "sky.png"}],
        "nodes": [
            {"children": [1], "rotation": [0.0, 0.7071067811865476, 0.0, 0.7071067811865476]},
            {"extensions": {"KHR_lights_punctual": {"light": 0}}},
        ],
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "textures": [{"source": 0}],
    }


@pytest.fixture
def pixels():
    return np.random.default_rng(4).integers(1, 256, (16, 32, 3), np.uint8)


def write(folder, content):
    path = folder / "sky.gltf"
    path.write_text(json.dumps(content))
    return path


def test_a_file_with_pictures_of_8_bits_beside_it_is_read(tmp_path, pixels):
    """A quarter turn about +Y turns the light's +Z, where the sun stands, to +X."""
    (tmp_path / "sky.png").write_bytes(png(pixels))
    found = read_panorama(write(tmp_path, document()))
    # Its middle is +Z, ours -Z.
    assert found.pixels == pytest.approx(np.roll(srgb_decode(pixels / 255.0), 16, axis=1))
    assert found.sun.direction == pytest.approx([1.0, 0.0, 0.0], abs=1e-9)
    assert found.sun.illuminance_lx == pytest.approx([5.0, 5.0, 5.0])


def test_a_data_uri_and_a_stated_scale_are_read(tmp_path, pixels):
    content = document(extras={"cd_m2_per_unit": 1234.5})
    content["images"][0] = {"uri": "data:image/png;base64," + b64encode(png(pixels)).decode()}
    assert read_panorama(write(tmp_path, content)).cd_m2_per_unit == 1234.5


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (lambda d: d["extensions"].pop("OMI_environment_sky"), "has no equirectangular sky"),
        (lambda d: d["images"][0].update(uri="../sky.png"), "outside its folder"),
        (lambda d: d["images"][0].update(uri="none.png"), "is damaged"),
        (lambda d: d["nodes"][1].update(children=[0]), "is damaged"),
        (lambda d: d.update(textures=[]), "is damaged"),
        (lambda d: d["extensions"].update(OMI_environment_sky=[1]), "is damaged"),
    ],
)
def test_broken_files_are_refused_in_one_line(tmp_path, pixels, change, says):
    (tmp_path / "sky.png").write_bytes(png(pixels))
    content = document()
    change(content)
    with pytest.raises(UserError, match=r"^[^\n]+$") as refusal:
        read_panorama(write(tmp_path, content))
    assert says in str(refusal.value)


@pytest.mark.parametrize("alpha", [False, True])
def test_16_bits_of_another_encoder_are_read(tmp_path, alpha):
    """Qt's libpng chooses among all filters row by row."""
    gui = pytest.importorskip("PySide6.QtGui")
    random = np.random.default_rng(2)
    smooth = np.linspace(0, 60_000, 40 * 24 * 4).reshape(24, 40, 4)
    pixels = (smooth + random.integers(0, 900, (24, 40, 4))).astype("<u2")
    pixels[..., 3] = 65535
    kind = gui.QImage.Format.Format_RGBA64 if alpha else gui.QImage.Format.Format_RGBX64
    path = tmp_path / "qt.png"
    assert gui.QImage(pixels.tobytes(), 40, 24, 320, kind).save(str(path))
    data = path.read_bytes()
    assert is_png16(data)
    assert np.array_equal(read_png16(data), pixels[..., :3])


def test_a_damaged_picture_of_16_bits_is_told(tmp_path):
    data = b"\x89PNG\r\n\x1a\n" + bytes(40)
    assert not is_png16(data)
    assert not is_png16(png(np.zeros((4, 4, 3), np.uint8)))
