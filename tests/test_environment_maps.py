"""Environment maps: with or without the sun's disc, rotated for other programs."""

import json
import sys

import numpy as np
import OpenEXR
import pytest
from long_parameters import mostly_long
from path_tracer_here import mitsuba_or_skip

from vrut_lite import cli
from vrut_lite.geometry.sky_map import CubeFaces, FisheyeMap, LatLongMap

AFTERNOON = ["--at", "2026-06-21T16:30", "--place", "50.0755,14.4378"]
MAPS = {"lat-long": LatLongMap(64), "fisheye": FisheyeMap(64), "cube": CubeFaces(64)}


@pytest.fixture
def sky(monkeypatch, tmp_path):
    """Write a map by the command line; returns its path."""

    def run(name, *arguments):
        path = tmp_path / name
        command = ["vrut-lite", "sky", "-o", path, "--size", 64, *AFTERNOON, *arguments]
        monkeypatch.setattr(sys, "argv", list(map(str, command)))
        cli.main()
        return path

    return run


def npz(path):
    content = dict(np.load(path))
    radiance = content.pop("cube", content.pop("radiance", None))
    return radiance.astype(float), content


def vector(text):
    return np.array(str(text).split(), float)


@pytest.mark.parametrize("projection", MAPS)
@pytest.mark.parametrize(
    "model", mostly_long(["dynamic_skylight", "bruneton_sky"], "dynamic_skylight".__eq__)
)
def test_a_map_with_the_disc_has_the_light_of_sky_and_sun(sky, projection, model):
    """Level irradiance with the disc = without it + the sun's, within 0.5 %; both in the header."""
    options = ["--projection", projection, "--sky", model]
    bare, facts = npz(sky("bare.npz", *options))
    whole, _ = npz(sky("whole.npz", *options, "--sun-disc"))
    sky_map = MAPS[projection]
    level = sky_map.solid_angles() * np.maximum(sky_map.directions()[..., 1], 0.0)
    of_sky, of_both = (np.tensordot(level, map_, level.ndim) for map_ in (bare, whole))
    sun = vector(facts["sunIrradianceRgb"]) * vector(facts["sunDirection"])[1]
    np.testing.assert_allclose(of_both, of_sky + sun, rtol=0.005)
    np.testing.assert_allclose(vector(facts["skyHorizontalIrradianceRgb"]), of_sky, rtol=1e-5)
    assert facts["sunDisc"] == "not in the picture"
    assert of_both.sum() > 2 * of_sky.sum()


@pytest.mark.parametrize("projection", ["lat-long", "fisheye"])
def test_the_header_says_which_pixel_the_sun_is_in(sky, projection):
    """For any rotation the brightest pixel is at sunPixel, counted from the corner."""
    for turned_deg in (0, 77):
        options = ["--projection", projection, "--sun-disc", "--rotate", turned_deg]
        radiance, facts = npz(sky(f"{turned_deg}.npz", *options))
        column, row = vector(facts["sunPixel"])
        brightest = np.unravel_index(radiance.sum(axis=-1).argmax(), radiance.shape[:2])
        assert np.abs(np.array(brightest) + 0.5 - (row, column)).max() <= 1.0
        in_map = vector(facts["sunDirectionInMap"])
        azimuth_deg = np.degrees(np.arctan2(in_map[0], -in_map[2]))
        expected = float(facts["sunAzimuthDeg"]) - turned_deg
        assert abs((azimuth_deg - expected + 180.0) % 360.0 - 180.0) < 1e-4


def test_turning_moves_the_map_and_nothing_else(sky):
    """Turned by 90 degrees: a quarter of the columns, a fisheye's quarter turn, another face."""
    for projection, turn in (
        ("lat-long", lambda map_: np.roll(map_, -32, axis=1)),
        ("fisheye", lambda map_: np.rot90(map_, -1)),
        ("cube", lambda map_: map_[[4, 5, 2, 3, 1, 0]]),
    ):
        options = ["--projection", projection]
        as_is, _ = npz(sky("as_is.npz", *options))
        turned, facts = npz(sky("turned.npz", *options, "--rotate", 90))
        expected = turn(as_is)
        if projection == "cube":
            # The top and bottom faces rotate in their plane.
            expected, turned = expected[[0, 1, 4, 5]], turned[[0, 1, 4, 5]]
            assert facts["northOffsetDeg"] == 90.0
        # A cube map's look-up does not interpolate across faces, so edges may differ.
        error = np.abs(turned - expected) / as_is.max()
        assert np.quantile(error, 0.98) < 1e-3
        assert error.max() < 0.03


def test_the_sidecar_says_what_the_header_says(sky):
    """FILE.json has the header's values, numbers as numbers."""
    path = sky("sky.exr", "--sidecar", "--sun-disc")
    facts = json.loads((path.parent / "sky.exr.json").read_text())
    header = OpenEXR.File(str(path)).parts[0].header
    assert facts["time"] == header["time"] == "2026-06-21 16:30 CEST"
    assert facts["latitudeDeg"] == header["latitudeDeg"][0] == 50.0755
    assert facts["sunDisc"] == header["sunDisc"] == "in the picture"
    for name in ("sunDirection", "sunIrradianceRgb", "sunPixel", "skyHorizontalIrradianceRgb"):
        np.testing.assert_allclose(facts[name], vector(header[name]))
    assert facts["skyModel"] == "dynamic_skylight"


def sun_of(path):
    return vector(OpenEXR.File(str(path)).parts[0].header["sunDirection"])


def test_turned_by_90_degrees_it_fits_blender(sky):
    """Cycles looks up u = 1/2 - atan2(y, x) / 2 pi, v = acos(z) / pi from the top.

    (Blender 4, intern/cycles/kernel/camera/projection.h, direction_to_equirectangular.) Its
    import of glTF takes (x, y, z) to (x, -z, y): where that puts the sun, the map has its disc.
    """
    path = sky("sky.exr", "--sun-disc", "--rotate", 90)
    x, y, z = sun_of(path)
    x, y, z = x, -z, y
    u, v = 0.5 - np.arctan2(y, x) / (2 * np.pi), np.arccos(z) / np.pi
    picture = OpenEXR.File(str(path)).parts[0].channels["RGB"].pixels
    row, column = np.unravel_index(picture.sum(axis=-1).argmax(), picture.shape[:2])
    assert abs(v * 64 - row - 0.5) <= 1.0
    assert abs(u * 128 - column - 0.5) <= 1.0


def test_turned_by_180_degrees_mitsuba_lights_the_scenes_own_axes_with_it(sky):
    """Mitsuba's own reader and its envmap: the brightest direction is the sun's, in world axes."""
    mitsuba = mitsuba_or_skip()
    mitsuba.set_variant("scalar_rgb")
    path = sky("sky.exr", "--sun-disc", "--rotate", 180)
    emitter = mitsuba.load_dict({"type": "envmap", "filename": str(path)})
    scene = mitsuba.load_dict({"type": "scene", "light": emitter})
    hit = mitsuba.SurfaceInteraction3f()

    def seen(direction):
        hit.wi = mitsuba.Vector3f(*(-np.asarray(direction, float)))
        return float(np.sum(scene.emitters()[0].eval(hit)))

    sun = sun_of(path)
    assert seen(sun) > 1e4
    for x_sign, z_sign in ((-1, 1), (1, -1), (-1, -1)):
        assert seen(sun * (x_sign, 1, z_sign)) < 1e3


def test_mitsuba_reads_the_metadata(sky):
    """Another program's EXR reader finds place, time and model in the header."""
    mitsuba = mitsuba_or_skip()
    mitsuba.set_variant("scalar_rgb")
    bitmap = mitsuba.Bitmap(str(sky("sky.exr")))
    assert bitmap.metadata()["skyModel"] == "dynamic_skylight"
    assert bitmap.metadata()["time"] == "2026-06-21 16:30 CEST"
    assert "W m^-2 sr^-1" in bitmap.metadata()["unit"]


def test_from_space_the_sun_is_the_observer_s(sky):
    """Outside the air sunlight is complete, by day and after sunset at the ground; the header
    has the height."""
    height = ["--sky", "bruneton_sky", "--height", "3000000", "--at", "2026-06-21T23:00"]
    bare, facts = npz(sky("bare.npz", *height))
    whole, _ = npz(sky("whole.npz", *height, "--sun-disc"))
    sun = vector(facts["sunIrradianceRgb"])
    assert float(str(facts["observerHeightM"])) == 3e6
    # G-173's extraterrestrial sunlight: 133 klx, somewhat less in the year's aphelion.
    assert 683.0 * (sun @ [0.2126, 0.7152, 0.0722]) == pytest.approx(133e3, rel=0.03)
    added = ((whole - bare) * LatLongMap(64).solid_angles()[..., None]).sum(axis=(0, 1))
    np.testing.assert_allclose(added, sun, rtol=5e-3)


@pytest.mark.parametrize("projection", MAPS)
def test_stokes_is_the_same_light_in_exr_and_npz(sky, projection):
    """One convention: channels of the EXR are the arrays of the npz, whose degree is highest 90
    degrees from the sun, where vibration is across the plane of view and sun."""
    options = ["--projection", projection, "--sky", "bruneton_sky", "--stokes"]
    radiance, arrays = npz(sky("sky.npz", *options))
    channels = OpenEXR.File(str(sky("sky.exr", *options)), separate_channels=True).channels()
    degree = arrays["dolp"]
    d = MAPS[projection].directions()
    sun = vector(arrays["sunDirection"])
    seen = d[..., 1] > 0.1
    brightest = np.where(seen, degree, 0.0).argmax()
    towards = d.reshape(-1, 3)[brightest]
    assert abs(np.degrees(np.arccos(towards @ sun)) - 90.0) < 8.0
    assert 0.4 < degree[seen].max() < 0.8
    assert np.all(np.hypot(arrays["q"], arrays["u"]) <= radiance * (1.0 + 1e-6))
    assert not degree[d[..., 1] < 0.0].any()
    level = np.cross(towards, [0.0, 1.0, 0.0])
    level /= np.linalg.norm(level)
    turn = np.radians(arrays["aolp"].reshape(-1)[brightest])
    # Counter-clockwise, seen from inside: from up to the left.
    vibration = np.cos(turn) * np.cross(level, towards) - np.sin(turn) * level
    assert abs(vibration @ sun) < 0.1
    if projection != "cube":
        np.testing.assert_array_equal(channels["Q.B"].pixels, arrays["q"][..., 2])
        np.testing.assert_array_equal(channels["aolp"].pixels, arrays["aolp"])
    assert (
        channels["U.R"].pixels.shape == channels["dolp"].pixels.shape == channels["R"].pixels.shape
    )


def test_stokes_is_refused_where_it_cannot_be(sky, capsys):
    """A sky without polarisation, and a format without room for it: one sentence, exit code 2."""
    for name, model in (("sky.exr", "dynamic_skylight"), ("sky.png", "bruneton_sky")):
        with pytest.raises(SystemExit) as exit_:
            sky(name, "--stokes", "--sky", model)
        assert exit_.value.code == 2
        (sentence,) = capsys.readouterr().err.strip().splitlines()
        assert "polarisation" in sentence
