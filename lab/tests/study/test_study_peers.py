"""Skies of other programs: how they are scored, and that what is missing is said in a line."""

import numpy as np
import pytest
from click.testing import CliRunner

from vrut_lite.geometry.panorama import lat_long_directions
from vrut_lite_lab.study.command import study
from vrut_lite_lab.study.peers.airs import air
from vrut_lite_lab.study.peers.blender import BLENDER, VARIABLE
from vrut_lite_lab.study.peers.peer import NotHere, PeerShot
from vrut_lite_lab.study.peers.prague import VARIABLE as PRAGUE_FILE
from vrut_lite_lab.study.peers.prague import Prague, read_prague
from vrut_lite_lab.study.peers.radiance_skies import _sun_of_hour, read_spectra, solar_hour, turned
from vrut_lite_lab.study.peers.run import Truths, scored_peers
from vrut_lite_lab.study.peers.scores import score
from vrut_lite_lab.study.peers.truth import Truth
from vrut_lite_lab.study.peers.views import HEIGHT, WIDTH, SkyViewpoint, of_picture, rays, whole

VIEW = SkyViewpoint(30.0)
EVERYWHERE = (slice(None), slice(None))


def sky_of_two_colours():
    """Truth: bluish light that brightens to the sun."""
    seen = rays(VIEW)
    rgb = np.exp(seen.nu)[..., None] * np.array([0.5, 0.8, 1.0])
    return Truth(rgb, EVERYWHERE, rgb, 0.0)


def test_a_scale_is_no_error():
    """A sky in other units errs by nothing, and its level is the ratio."""
    known = sky_of_two_colours()
    got = score(whole(3.0 * known.rgb), known, VIEW)
    assert got.level == pytest.approx(3.0)
    assert got.mean == pytest.approx(0.0, abs=1e-12)
    assert got.colour == pytest.approx(0.0, abs=1e-9)


def test_errors_are_those_that_were_put_in():
    """A tenth too bright on one side of the sun and too dark on the other: ten percent."""
    known = sky_of_two_colours()
    sides = np.concatenate([0.9 * known.rgb[:, ::-1], 1.1 * known.rgb], axis=1)
    got = score(sides, known, VIEW)
    assert got.level == pytest.approx(1.0)
    assert got.mean == pytest.approx(0.1)
    assert got.most == pytest.approx(0.1)
    assert np.isnan(score(sides, known, VIEW, grey=True).colour)


def test_measured_pixels_are_where_rays_go():
    """A picture of each direction's height and angle from the sun holds those of the rays."""
    direction = lat_long_directions(HEIGHT)
    nu = direction @ np.array(VIEW.sun_direction)
    seen = of_picture(np.stack([direction[..., 1], nu, nu], axis=-1), VIEW)
    expected = whole(np.stack([rays(VIEW).mu, rays(VIEW).nu], axis=-1))
    np.testing.assert_allclose(seen[..., :2], expected, atol=1e-12)


def test_air_of_blender_has_its_depths():
    """Of molecules as of air at sea level, 0.09 at 560 nm; ozone of 334 Dobson units, 0.03."""
    of_blender = air("blender-multiple").atmosphere
    molecules = of_blender.rayleigh_scattering[1] * of_blender.rayleigh_scale_height_m
    assert molecules == pytest.approx(0.0909, abs=0.002)
    ozone = np.trapezoid(of_blender.absorber_density, of_blender.absorber_altitude_m)
    assert of_blender.absorption_extinction[1] * ozone == pytest.approx(0.035, abs=0.003)


def test_radiance_s_hour_puts_the_sun_where_it_is_wanted():
    """At each elevation of the study; in the morning, north of east in summer's dawn."""
    for sun_deg in (60.0, 3.0, -12.0):
        assert np.degrees(np.arcsin(_sun_of_hour(sun_deg)[2])) == pytest.approx(sun_deg)
        assert solar_hour(sun_deg) < 12.0
        assert np.linalg.norm(_sun_of_hour(sun_deg)) == pytest.approx(1.0)


def test_a_sun_anywhere_is_turned_to_the_middle():
    """Brightest column of a picture whose columns rise from the west, as Radiance's do."""
    azimuth = (np.arange(WIDTH) + 0.5) / WIDTH * 2.0 * np.pi - np.pi
    sun = np.array([np.cos(1.2), np.sin(1.2), 0.0])
    bright = np.exp(5.0 * np.cos(azimuth - 1.2))[None, :, None]
    middle = turned(bright, sun)[0, :, 0]
    np.testing.assert_allclose(middle, middle[::-1], rtol=1e-3)
    assert np.argmax(middle) in (WIDTH // 2 - 1, WIDTH // 2)


def test_spectra_of_radiance_are_read(tmp_path):
    """Bytes share an exponent; the file has the longest wavelength first."""
    pixels = np.zeros((1, 2, 21), np.uint8)
    pixels[0, 0, :20], pixels[0, 0, 20] = np.arange(20) * 10, 128
    path = tmp_path / "sky.hsr"
    path.write_bytes(b"#?RADIANCE\nNCOMP=20\n\n-Y 1 +X 2\n" + pixels.tobytes())
    got = read_spectra(path)
    assert got.shape == (1, 2, 20)
    np.testing.assert_allclose(got[0, 0], (np.arange(20)[::-1] * 10 + 0.5) / 256.0)
    assert not got[0, 1].any()


def test_what_is_not_here_is_said_in_a_line(monkeypatch):
    """A program that cannot be started is left out with its reason, and the others go on."""

    class Known(Truths):
        def of(self, air, view):
            return sky_of_two_colours()

    class Itself:
        title, air, grey = "itself", "continental", False

        def shots(self, views):
            return {VIEW: PeerShot(whole(sky_of_two_colours().rgb), 0.1)}

    monkeypatch.setenv(VARIABLE, "/nowhere/python")
    told = []
    gone, here = scored_peers([BLENDER[0], Itself()], [VIEW], Known(), told.append)
    assert gone.reason == f"{VARIABLE} cannot be run: No such file or directory"
    assert here.scores[VIEW].mean == pytest.approx(0.0, abs=1e-12)
    assert told == ["Blender 5, multiple scattering", "itself"]


def test_peers_go_with_no_other_choice(tmp_path):
    """Measurements and models belong to the other page: one sentence."""
    done = CliRunner().invoke(study, ["--peers", "--models", "bruneton", "-o", str(tmp_path / "x")])
    assert "--peers goes with --quick and --output alone" in str(done.exception)


# Views and light of the file below: x, y, z up; the sun's height; visibility, albedo, altitude.
# Found by the functions of the authors' program (PragueSkyModel.cpp, commit 0470b6f).
PRAGUE = (
    ((0.3, 0.2, 0.9), 25.0, (0.0, 59.4, 0.5), (0.146845499, 0.325229166, 0.450950768)),
    ((-0.5, 0.4, 0.1), -3.0, (2000.0, 80.0, 0.2), (0.293716917, 0.303517044, 0.244966846)),
    ((0.1, -0.9, -0.2), 5.0, (10_000.0, 20.0, 0.0), (0.170862055, 0.223001655, 0.0768420528)),
    ((0.05, 0.02, 1.0), -6.0, (0.0, 200.0, 1.0), (1.26664994, 0.327182938, 0.200629621)),
)


def prague_file(path):
    """A small file of random numbers in the layout of the published ones."""
    random = np.random.default_rng(3)
    int32 = lambda number: np.int32(number).tobytes()  # noqa: E731
    nodes = lambda values: int32(len(values)) + np.array(values, float).tobytes()  # noqa: E731
    halves = lambda *law: random.uniform(*law).astype("<f2").tobytes()  # noqa: E731
    axes = [20.0, 60.0, 131.8], [0.0, 1.0], [0.0, 5000.0, 15000.0], [-4.2, 0.0, 10.0, 90.0]
    parts = [nodes(axis) for axis in axes]
    parts += [int32(3), np.array([320.0, 40.0]).tobytes(), int32(2)]
    parts += [nodes(np.linspace(0.0, np.pi, count)) for count in (5, 4, 3)]
    for _ in range(3 * 2 * 3 * 4 * 3):
        for _ in range(2):
            parts += [halves(0.1, 1.0, 5), np.float64(random.uniform(1.0, 3.0)).tobytes()]
            parts.append(halves(-0.2, 1.0, 4))
        parts.append(halves(0.5, 2.0, 3))
    path.write_bytes(b"".join(parts))


def test_prague_s_file_is_read_as_its_authors_program_does(tmp_path):
    """By day, below the horizon, aloft, and beyond the file's range, to nine digits."""
    path = tmp_path / "prague.dat"
    prague_file(path)
    sky = read_prague(path)
    for (east, north, up), sun_deg, where, expected in PRAGUE:
        seen = np.array([east, up, -north]) / np.linalg.norm([east, north, up])
        sun = np.array([np.cos(np.radians(sun_deg)), np.sin(np.radians(sun_deg)), 0.0])
        np.testing.assert_allclose(sky.radiance(seen, sun, *where), expected, rtol=1e-7)
    path.write_bytes(path.read_bytes()[:-1])
    with pytest.raises(NotHere, match="no file of the Prague sky"):
        read_prague(path)


def test_prague_asks_for_its_file(monkeypatch):
    """Its coefficients are with the user or nowhere: a line says how to name them."""
    monkeypatch.delenv(PRAGUE_FILE, raising=False)
    with pytest.raises(NotHere, match="let PRAGUE_SKY name the file"):
        Prague().shots([VIEW])
