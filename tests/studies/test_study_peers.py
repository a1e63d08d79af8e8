"""Skies of other programs: how they are scored, and that what is missing is said in a line."""

import numpy as np
import pytest
from click.testing import CliRunner
from vrut_lite_studies.command import study
from vrut_lite_studies.peers.airs import air
from vrut_lite_studies.peers.blender import BLENDER, VARIABLE
from vrut_lite_studies.peers.peer import Shot
from vrut_lite_studies.peers.radiance_skies import _sun_of_hour, read_spectra, solar_hour, turned
from vrut_lite_studies.peers.run import Truths, scored_peers
from vrut_lite_studies.peers.scores import score
from vrut_lite_studies.peers.truth import Truth
from vrut_lite_studies.peers.views import HEIGHT, WIDTH, View, of_picture, rays, whole

from vrut_lite.geometry.panorama import lat_long_directions

VIEW = View(30.0)
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
            return {VIEW: Shot(whole(sky_of_two_colours().rgb), 0.1)}

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
