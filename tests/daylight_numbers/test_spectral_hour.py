"""Light by wavelength at sensors against sums over skies and analytic rooms."""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from boxes import box, floor, hour, quads
from click.testing import CliRunner
from daylight_numbers.command import daylight
from daylight_numbers.glazing.glass import no_glass
from daylight_numbers.matrix.operator import operator_of
from daylight_numbers.matrix.sensors import free_sensors
from daylight_numbers.now import hour_at_sensors
from daylight_numbers.opened_scene import OpenedScene
from daylight_numbers.sky_cells import CELLS
from daylight_numbers.spectra.daylight import daylight_of_rgb
from daylight_numbers.spectra.eye_responses import eye_responses
from daylight_numbers.spectra.reflectances import reflectances_of
from daylight_numbers.spectra.spectra_file import NO_SPECTRA, MaterialSpectra, read_spectra
from daylight_numbers.spectra.spectral_hour import spectral_hour
from daylight_numbers.spectra.spectral_sky import WAVELENGTHS_NM, SpectralSky, spectral_sky
from daylight_numbers.spectra.spectral_surfaces import SpectralSurfaces, spectral_surfaces
from daylight_numbers.work import DaylightWork
from dynamic_skylight import HosekWilkieSky
from light_transport.transport import SceneTransport
from test_daylight_command import glazed_house

from vrut_lite.atmosphere.sunlight import slant_depth
from vrut_lite.errors import UserError
from vrut_lite.geometry.colour import LUMENS_PER_WATT, luminance, solar_irradiance
from vrut_lite.messages.haze import DEFAULT_HAZE
from vrut_lite.project import Project

SCENE = Path(__file__).parents[2] / "scenes" / "work" / "ground.glb"
NM = np.array(WAVELENGTHS_NM)
BLUE = np.array([0.1, 0.3, 0.7])


def work_of_quads(surfaces, layout, places, normals, glass=None):
    transport = SceneTransport(surfaces, layout)
    transport.add_rays(256)
    glass = no_glass(len(surfaces.part)) if glass is None else glass
    sensors = free_sensors(np.array(places, float), np.array(normals, float), "points")
    return DaylightWork(transport, glass, sensors, operator_of(transport, glass, sensors, 0.01))


def work_parts(work):
    return work.transport, work.glass, work.operator, work.sensors


def spectral(transport, tints=None, tint_of_triangle=None, emitted=None):
    """Surfaces with the spectra of their colours."""
    patches = transport.patches
    count = len(transport.surfaces.part) if tint_of_triangle is None else 0
    return SpectralSurfaces(
        reflectances_of(patches.reflectance_rgb.astype(float), NM),
        daylight_of_rgb(patches.emitted_rgb, NM) if emitted is None else emitted,
        np.zeros((0, len(NM))) if tints is None else tints,
        np.full(count, -1) if tint_of_triangle is None else tint_of_triangle,
        tints is not None,
    )


def even_sky(spectrum):
    """A sky and ground of one spectrum, without a sun."""
    nothing = np.zeros(len(NM))
    return SpectralSky(
        np.tile(spectrum, (CELLS, 1)), spectrum, nothing, nothing, np.array([0.0, 1.0, 0.0]), True
    )


def in_the_open(project):
    """Irradiance on level ground, on a sensor above a dark floor, by the sky of a project."""
    opened = OpenedScene(project)
    try:
        sky = spectral_sky(opened, opened.hour())
        sun = opened.sun
        lux = LUMENS_PER_WATT * luminance(opened.hour().key_irradiance_rgb)
    finally:
        opened.close()
    surfaces, layout = quads(floor(-1, 1, -1, 1), reflectance=0.0)
    work = work_of_quads(surfaces, layout, [[0, 0.5, 0]], [[0, 1, 0]])
    found = spectral_hour(work, sky, spectral(work.transport), 0.1)
    return found.irradiance[0], sky, sun, lux


def test_the_open_under_a_spectral_sky_has_its_integral():
    """Hosek and Wilkie's spectra by 40,000 directions, each 5 nm, and the sun behind the air."""
    settings = {"dynamic_skylight": {"sky_level": "published", "albedo": 0.1}}
    project = Project(
        scene=str(SCENE), at="2026-06-21T15:00", slots={"sky": "dynamic_skylight"},
        settings=settings,
    )  # fmt: skip
    found, sky, sun, lux = in_the_open(project)
    assert sky.is_own
    fine = np.arange(380.0, 761.0, 5.0)
    model = HosekWilkieSky(DEFAULT_HAZE.turbidity, 0.1, sun.apparent_elevation_rad)
    mu, around = (np.arange(200) + 0.5) / 200, (np.arange(200) + 0.5) * 2 * np.pi / 200
    level = np.sqrt(1 - mu**2)[:, None]
    up = np.broadcast_to(mu[:, None], (200, 200))
    gamma = np.arccos(
        np.clip(
            up * np.sin(sun.apparent_elevation_rad)
            + level * np.cos(around) * np.cos(sun.apparent_elevation_rad), -1, 1,
        )
    )  # fmt: skip
    radiance = model.spectral_radiance(np.arccos(up), gamma, fine)
    diffuse = 2 * np.pi * np.einsum("ijw,ij->w", radiance, up) / up.size
    sine = np.sin(sun.apparent_elevation_rad)
    layers = DEFAULT_HAZE.aerosol_layers, DEFAULT_HAZE.nitrogen_dioxide
    direct = solar_irradiance(fine) * np.exp(-slant_depth(0.0, sine, fine, *layers))
    direct *= lux / float(eye_responses(direct, fine).illuminance_lx)
    truth = eye_responses(diffuse + direct * sine, fine)
    ours = eye_responses(found, NM)
    np.testing.assert_allclose(ours.illuminance_lx, truth.illuminance_lx, rtol=0.01)
    np.testing.assert_allclose(ours.edi_lx, truth.edi_lx, rtol=0.01)


def test_the_open_under_weather_has_daylight_of_its_colour():
    """An overcast sky of CIE has 6,514 K: the D illuminant of that, melanopic ratio 1.00."""
    project = Project(
        scene=str(SCENE), slots={"sky": "weather_sky"},
        settings={"weather_sky": {"distribution": "cie-overcast"}},
    )  # fmt: skip
    found, sky, _, _ = in_the_open(project)
    assert not sky.is_own
    seen = eye_responses(found, NM)
    np.testing.assert_allclose(seen.edi_lx / seen.illuminance_lx, 1.0, atol=5e-3)


def test_light_in_a_closed_box_of_a_colour_is_analytic():
    """Walls of reflectance rho that glow with M: at each wavelength M / (1 - rho)."""
    surfaces, layout = quads(
        *box((-1, 0, -1), (1, 2, 1), inwards=True), reflectance=BLUE, emitted=1.0
    )
    work = work_of_quads(surfaces, layout, [[0.3, 0.85, 0.2]], [[0.0, 1.0, 0.0]])
    found = spectral_hour(work, even_sky(np.zeros(len(NM))), spectral(work.transport), 0.1)
    reflectance = reflectances_of([BLUE], NM)[0]
    emitted = daylight_of_rgb([1.0, 1.0, 1.0], NM)
    np.testing.assert_allclose(found.irradiance[0], emitted / (1 - reflectance), rtol=5e-3)


@pytest.mark.parametrize(
    "towards",
    [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
    ids=["window", "wall", "ceiling"],
)
def test_coloured_glass_filters_all_light_of_a_room(towards):
    """A grey room whose one side passes its colour at all angles: light seen and bounced has that
    colour, also the ceiling's, which comes from the lit ground outside."""
    rgb = np.array([0.3, 0.5, 0.7])
    passed = reflectances_of([rgb], NM)[0]
    outside = floor(1.0, 5.0, -3.0, 3.0, y=-0.1)
    surfaces, layout = quads(*box((-1, 0, -1), (1, 2, 1), inwards=True), outside, reflectance=0.3)
    surfaces.opacity[:2] = 1.0 - luminance(rgb)
    glass, which = no_glass(len(surfaces.part)), np.full(len(surfaces.part), -1)
    # Sides of a body whose index is that of air.
    glass.tint[:2], glass.ior[:2], glass.panes[:2], which[:2] = rgb, 1.0001, 0, 0
    work = work_of_quads(surfaces, layout, [[0.0, 1.0, 0.0]], [towards], glass)
    own = spectral(work.transport, passed[None], which)
    white = daylight_of_rgb([1.0, 1.0, 1.0], NM)
    found = spectral_hour(work, even_sky(white), own, 0.1).irradiance[0]
    filtered = found / white / passed
    np.testing.assert_allclose(filtered, filtered.mean(), rtol=0.025)
    in_colours = hour_at_sensors(*work_parts(work), hour(1.0)).total[0]
    assert eye_responses(found, NM).illuminance_lx == pytest.approx(in_colours, rel=0.02)


def test_spectra_of_materials_are_read_and_their_ends_go_on(tmp_path):
    path = tmp_path / "paint.csv"
    path.write_text("# measured\nwavelength_nm,wall,glass\n400,0.2,0.5\n700,0.8,0.9\n")
    found = read_spectra(path)
    np.testing.assert_allclose(found.at("wall", [380.0, 550.0, 780.0]), [0.2, 0.5, 0.8])
    assert found.notices() == [
        f"the spectra {path} cover 400 to 700 nm: from 380 to 780 nm their end values are taken "
        "beyond"
    ]
    assert NO_SPECTRA.notices() == []


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("", "has no heading of spectra"),
        ("wavelength_nm,wall,wall\n400,0,0\n700,0,0\n", "has no heading of spectra"),
        ("wavelength_nm,wall\n400,0.5\n", "has 1 wavelengths"),
        ("wavelength_nm,wall\n400,0.5\n400,0.5\n", "line 3 of .* must rise, not from 400 to 400"),
        ("wavelength_nm,wall\n450,0.5\n700,0.5\n", "cover 450 to 700 nm: give at least 400"),
        ("wavelength_nm,wall\n400,-0.1\n700,0.5\n", "line 2 of .*: -0.1 is no share from 0 to 1"),
        ("wavelength_nm,wall\n400,0.5\n700,1.2\n", "line 3 of .*: 1.2 is no share from 0 to 1"),
        ("wavelength_nm,wall\n400,nan\n700,1\n", "nan is no share"),
        ("wavelength_nm,wall\n400,x\n700,1\n", "line 2 of .* is no numbers: 400,x"),
        ("wavelength_nm,wall\n400,0.5,0.2\n700,1\n", "line 2 of .* has 3 numbers: its heading"),
    ],
)
def test_broken_spectra_are_refused_in_a_sentence(tmp_path, text, sentence):
    path = tmp_path / "paint.csv"
    path.write_text(text)
    with pytest.raises(UserError, match=sentence):
        read_spectra(path)


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["--spectra", "none.csv"], "add --spectral"),
        (["--spectral", "--spectra", "none.csv"], "cannot read the spectra none.csv"),
    ],
)
def test_spectral_options_that_mean_nothing_are_refused(tmp_path, arguments, sentence):
    with pytest.raises(UserError, match=sentence):
        CliRunner().invoke(
            daylight, ["none.glb", "-o", str(tmp_path), *arguments], catch_exceptions=False
        )


def test_spectra_of_no_material_of_the_scene_are_refused():
    """In one line, with the names that there are."""
    materials = SimpleNamespace(all=lambda: [SimpleNamespace(name="wall")])
    scene, transport = SimpleNamespace(materials=materials), SimpleNamespace(patches=())
    measured = MaterialSpectra("paint.csv", np.array([380.0, 780.0]), {"wal": np.ones(2)})
    with pytest.raises(
        UserError, match=r"paint\.csv: the scene has no material 'wal'; it has wall"
    ):
        spectral_surfaces(scene, transport, no_glass(1), measured)


@pytest.mark.long
def test_a_room_with_yellow_walls_has_less_melanopic_light(tmp_path):
    """By the command: an eye at walls that send back no blue has less than half of the melanopic
    light that grey walls leave it; the window's light stays."""
    project, eyes, paint = (tmp_path / name for name in ("room.toml", "eyes.csv", "paint.csv"))
    glass = '[glazing."glass"]\ntransmittance = 0.7\n'
    project.write_text(f'scene = "{glazed_house(tmp_path)}"\n{glass}')
    eyes.write_text("0,1.2,0,1,0,0\n0,1.2,0,-1,0,0\n")
    paint.write_text("wavelength_nm,wall\n380,0.02\n520,0.02\n560,0.5\n780,0.5\n")
    where = [str(project), "--at", "2026-03-21T12:00", "--sensors", str(eyes), "--spectral"]
    edi = {}
    for name, more in (("grey", []), ("yellow", ["--spectra", str(paint)])):
        out = tmp_path / name
        CliRunner().invoke(daylight, [*where, "-o", str(out), *more], catch_exceptions=False)
        numbers = np.load(out / "sensors.npz")
        assert numbers["spectral_irradiance"].shape == (2, len(NM))
        assert "Spectral light of the hour" in (out / "report.html").read_text()
        edi[name] = numbers["melanopic_edi_lx"]
    assert edi["yellow"][0] > 0.7 * edi["grey"][0]
    assert 0.0 < edi["yellow"][1] < 0.5 * edi["grey"][1]
