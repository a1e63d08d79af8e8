"""A sky from a photograph: energy kept, the sun found, turned, scaled; files that are none."""

from datetime import UTC, datetime
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from photo_sky.light import PhotoLight
from photo_sky.module import PhotoSky
from photo_sky.photograph import photograph_of, solid_angles
from photo_sky.read_panorama import read_panorama

from vrut_lite.errors import UserError
from vrut_lite.geometry.colour import luminance
from vrut_lite.geometry.cube_map import texel_directions, texel_solid_angles
from vrut_lite.geometry.panorama import lat_long_directions
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import ChooseSlot, Demand, Fault, SetClock, SetSetting
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.sky import BackgroundChanged
from vrut_lite.messages.sun import KeyLightChanged, SunMoved
from vrut_lite.pictures.write_exr import write_exr
from vrut_lite.pictures.write_hdr import write_hdr

PHOTOS = Path(__file__).parents[3] / "shared" / "photos"
ROWS = 128
GROUND = (0.2, 0.2, 0.2)
NORMALS = {"level": (0.0, 1.0, 0.0), "a wall": (0.6, 0.0, -0.8), "a roof": (0.48, 0.6, -0.64)}


def panorama(sun_elevation_deg=40.0, sun_azimuth_deg=50.0, sun=4000.0):
    """A smooth blue sky with a glow, brown ground, and a sun of three pixels across."""
    directions = lat_long_directions(ROWS)
    elevation, azimuth = np.radians([sun_elevation_deg, sun_azimuth_deg])
    level = np.cos(elevation)
    towards = np.array([level * np.sin(azimuth), np.sin(elevation), -level * np.cos(azimuth)])
    gamma = np.arccos(np.clip(directions @ towards, -1.0, 1.0))
    glow = 1.0 + 3.0 * np.exp(-gamma / 0.3)
    picture = glow[..., None] * np.array([0.5, 0.8, 1.4])
    picture[ROWS // 2 :] = (0.3, 0.25, 0.2)
    picture[gamma < np.radians(2.2)] += sun * np.array([1.1, 1.0, 0.8])
    return picture, towards


def of_picture(picture, normal):
    """Irradiance (3,) of a plane by the upper half of a panorama, pixel by pixel."""
    directions = lat_long_directions(len(picture))
    weight = solid_angles(len(picture))[:, None] * np.maximum(directions @ np.array(normal), 0.0)
    return np.einsum("ijc,ij->c", picture, weight * (directions[..., 1] > 0.0))


def of_light(light, normal):
    """The same by what the module posts: its cube above the horizon and its key light."""
    cube = light.sky_cube(64)
    weight = np.maximum(texel_directions(64) @ np.array(normal), 0.0) * texel_solid_angles(64)
    sun = light.sun()
    facing = 0.0 if sun.direction is None else max(float(np.dot(sun.direction, normal)), 0.0)
    return np.einsum("fijc,fij->c", cube, weight) + sun.irradiance_rgb * facing


@pytest.mark.parametrize("normal", NORMALS)
def test_energy_is_kept(normal):
    """On level ground, a wall and a roof: sky and sun give what the photograph does, to 1 %."""
    picture, _ = panorama()
    light = PhotoLight(photograph_of(picture), 0.0, 683.0, None, GROUND)
    expected = of_picture(picture, NORMALS[normal])
    np.testing.assert_allclose(of_light(light, NORMALS[normal]), expected, rtol=0.01)


def test_the_sun_is_found_and_taken_out():
    """Its direction to a fifth of a pixel; nothing bright stays in the sky, and no hole."""
    picture, towards = panorama()
    found = photograph_of(picture)
    assert np.degrees(np.arccos(found.sun_direction @ towards)) < 0.2 * 180 / ROWS
    expected = 4000.0 * np.pi * np.radians(2.2) ** 2
    assert float(found.sun_irradiance[1]) == pytest.approx(expected, rel=0.06)
    assert found.sky[: ROWS // 2].max() < 4 * 1.4 * 3
    near = lat_long_directions(ROWS) @ towards > np.cos(np.radians(6))
    assert found.sky[near].min() > 0.5 * np.median(found.sky[near])


def test_a_sky_without_a_sun_has_none():
    """Overcast, night, or a sun behind a hill: all light stays in the sky."""
    picture, _ = panorama(sun=0.0)
    found = photograph_of(picture)
    assert found.sun_direction is None
    np.testing.assert_array_equal(found.sky, picture)


def test_a_sun_of_less_than_no_red_keeps_its_luminance():
    """A file packed with loss: what lies below 0 in one channel is taken from the others' light."""
    picture, towards = panorama()
    disc = lat_long_directions(ROWS) @ towards > np.cos(np.radians(2.2))
    picture[disc] = (-800.0, -100.0, 9000.0)
    light = PhotoLight(photograph_of(picture), 0.0, 683.0, None, GROUND)
    kept, expected = (
        luminance(f(NORMALS["level"]))
        for f in (partial(of_light, light), partial(of_picture, picture))
    )
    assert kept == pytest.approx(expected, rel=2e-3)


def test_a_photograph_turns():
    """A quarter turn clockwise brings the sun and the sky a quarter turn on."""
    picture, _ = panorama(sun_azimuth_deg=50.0)
    found = photograph_of(picture)
    still, turned = (PhotoLight(found, angle, 683.0, None, GROUND) for angle in (0.0, np.pi / 2))
    x, y, z = still.sun_direction
    assert turned.sun_direction == pytest.approx((-z, y, x))
    # North's face has turned to the east.
    np.testing.assert_allclose(turned.sky_cube(32)[0], still.sky_cube(32)[5], rtol=1e-6)


def test_a_photograph_is_scaled():
    """To an illuminance of level ground, or by the luminance of the value 1."""
    found = photograph_of(panorama()[0])
    asked = PhotoLight(found, 0.0, 683.0, 50_000.0, GROUND)
    assert 683.0 * luminance(of_light(asked, NORMALS["level"])) == pytest.approx(50_000.0, rel=5e-3)
    once, twice = (PhotoLight(found, 0.0, unit, None, GROUND) for unit in (683.0, 1366.0))
    np.testing.assert_allclose(2.0 * once.sky_cube(16), twice.sky_cube(16))
    np.testing.assert_allclose(2.0 * once.sun().irradiance_rgb, twice.sun().irradiance_rgb)


@pytest.mark.parametrize("name", ["park", "sunrise", "dawn", "sky", "night"])
def test_real_photographs_keep_their_light(name):
    """Luminance on level ground to 1 %, also where packing left the sun in blue alone."""
    path = PHOTOS / f"{name}.exr"
    if not path.is_file():
        pytest.skip(f"{path} is not there")
    picture = read_panorama(path).pixels
    found = photograph_of(picture)
    assert (found.sun_direction is not None) == (name in ("park", "sunrise", "sky"))
    light = PhotoLight(found, 1.0, 683.0, None, GROUND)
    expected = luminance(of_picture(picture, NORMALS["level"]))
    assert luminance(of_light(light, NORMALS["level"])) == pytest.approx(expected, rel=0.01)


@pytest.mark.parametrize("suffix", [".exr", ".hdr"])
def test_both_formats_are_read(tmp_path, suffix):
    """What this program writes as EXR or HDR is read back, to the format's digits."""
    picture = panorama()[0].astype(np.float32)
    path = tmp_path / f"sky{suffix}"
    (write_exr if suffix == ".exr" else write_hdr)(path, picture, {})
    np.testing.assert_allclose(read_panorama(path).pixels, picture, rtol=0.01, atol=0.02)


BROKEN = {
    "none.exr": (None, "there is no such file"),
    "words.exr": (b"words", "is damaged"),
    "words.hdr": (b"words", "is damaged"),
    "cut.hdr": (b"#?RADIANCE\n\n-Y 8 +X 16\n\x02\x02\x00\x10\x90", "is damaged"),
    "square.hdr": (b"#?RADIANCE\n\n-Y 16 +X 16\n", "twice as wide as high"),
    "huge.hdr": (b"#?RADIANCE\n\n-Y 90000 +X 180000\n", "too large"),
    "black.hdr": (b"#?RADIANCE\n\n-Y 8 +X 16\n" + bytes(8 * 16 * 4), "is black"),
    "sky.jpg": (b"words", "an EXR, HDR or glTF file is needed"),
}


@pytest.mark.parametrize("name", BROKEN)
def test_broken_files_are_refused_in_one_line(tmp_path, name):
    """Never a traceback: what is wrong, and with which file."""
    content, said = BROKEN[name]
    if content is not None:
        (tmp_path / name).write_bytes(content)
    with pytest.raises(UserError, match=r"^[^\n]+$") as refusal:
        read_panorama(tmp_path / name)
    assert said in str(refusal.value)
    assert name in str(refusal.value)


@pytest.fixture
def told():
    """A kernel with the module in both slots, and the faults that it posts."""
    kernel, faults = Kernel(), []
    kernel.tap(lambda m, _: faults.append(m.error) if isinstance(m, Fault) else None)
    kernel.add_module(PhotoSky)
    for kind in (SunMoved, BackgroundChanged, KeyLightChanged):
        kernel.inject(Demand(consumer="test", message=kind.__name__, size=16))
    kernel.inject(SetPlace(latitude_deg=50.0, longitude_deg=14.0))
    for slot in ("sun", "sky"):
        kernel.inject(ChooseSlot(slot=slot, module="photo_sky"))
    kernel.pump_until_idle()
    yield kernel, faults
    kernel.close()


def test_the_sun_stands_still(told, tmp_path):
    """Whatever the clock says, sun and key light stand where the photograph has them."""
    kernel, _ = told
    picture, towards = panorama()
    write_exr(tmp_path / "sky.exr", picture.astype(np.float32), {})
    kernel.inject(SetSetting(module="photo_sky", name="photo", value=str(tmp_path / "sky.exr")))
    for hour in (3, 12):
        kernel.inject(SetClock(instant=datetime(2026, 6, 21, hour, tzinfo=UTC)))
        kernel.pump_until_idle()
        assert kernel.last(KeyLightChanged).direction == pytest.approx(tuple(towards), abs=0.01)
        assert kernel.last(SunMoved).direction == kernel.last(KeyLightChanged).direction
        assert min(kernel.last(KeyLightChanged).irradiance_rgb) > 0.0


def test_without_a_photograph_it_says_so(told):
    """One line says what to set; the sky is even and grey meanwhile."""
    kernel, faults = told
    assert set(faults) == {"photo_sky has no picture: set photo to an EXR, HDR or glTF panorama"}
    kernel.inject(SetSetting(module="photo_sky", name="photo", value="/none/sky.exr"))
    kernel.pump_until_idle()
    assert faults[-1] == "cannot open the panorama /none/sky.exr: there is no such file"
    assert kernel.last(BackgroundChanged) is not None
