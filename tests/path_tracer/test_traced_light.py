"""Sky and sun as the path tracer has them, against integrals and against mitsuba's own sky."""

from dataclasses import replace

import msgspec
import numpy as np
import pytest
import trimesh
from dynamic_skylight import HosekWilkieSky
from light_messages import light_messages, radiance_of
from path_tracer import tracer as tracer_module
from path_tracer.settings import PathTracerSettings
from path_tracer.sky_map import environment_map, map_directions, sky_emitter
from path_tracer.subject import Subject
from path_tracer.sun import disc_picture
from path_tracer.tracer import Tracer
from path_tracer_here import mitsuba_or_skip
from stateful_backend import opened

from vrut_lite.geometry.cube_map import sample_cube, texel_directions, texel_solid_angles
from vrut_lite.geometry.frames import direction_from_angles, world_from_enu
from vrut_lite.messages.camera import MoveCamera
from vrut_lite.messages.ground_disc import GroundDisc
from vrut_lite.scene.scene_state import SceneState

mitsuba = mitsuba_or_skip()
# Mitsuba divides RGB by the integral of CIE Y; our radiance is not normalised so.
CIE_Y_NORMALISATION = 106.7502593994140625


def sun_at(azimuth_deg, elevation_deg):
    angles = np.radians([azimuth_deg, elevation_deg])
    return tuple(world_from_enu(direction_from_angles(*angles)))


def subject_of(path, cube, size=(48, 32), eye=(7.0, 5.0, 8.0), angle_rad=0.8, **sun):
    background, key_light, ambient = light_messages(cube, **sun)
    return Subject(
        SceneState(
            scene=opened(path, GroundDisc((0.0, 0.0), 0.0, 100.0)),
            background=background,
            key_light=key_light,
            ambient=ambient,
            ground_albedo_rgb=(0.3,) * 3,
            moved_camera=MoveCamera(
                eye_m=eye, target_m=(0.0, 0.5, 0.0), vertical_field_of_view_rad=angle_rad
            ),
            size_px=size,
        ).under_clear_sky()
    )


@pytest.fixture(scope="module")
def box_file(tmp_path_factory):
    path = tmp_path_factory.mktemp("scene") / "box.glb"
    trimesh.creation.box((2, 2, 2)).apply_translation((0, 1, 0)).export(path)
    return path


@pytest.mark.parametrize("elevation_deg", [3.0, 40.0])
@pytest.mark.parametrize("axis", [(0, 1, 0), (1, 0, 0), (0, 0, -1), (0, -1, 0)])
def test_the_environment_map_keeps_the_skys_energy(elevation_deg, axis):
    """Irradiance on planes that face anywhere, by quadrature over map and cube: 0.2 %."""
    sky = HosekWilkieSky(3.0, 0.1, np.radians(elevation_deg))
    cube = sky.cube_map(64, 0.7).astype(float)
    cube[texel_directions(64)[..., 1] < 0.0] = 2.0
    cosine = np.maximum(texel_directions(64) @ axis, 0.0)
    expected = np.einsum("fij,ij,fijc->c", cosine, texel_solid_angles(64), cube)
    image = environment_map(cube)
    rows = len(image)
    # The trapezoidal rule in angle: mitsuba's map is linear between its rows.
    polar = np.pi * np.arange(rows) / (rows - 1)
    weight = np.sin(polar) * (np.pi / (rows - 1)) * (np.pi / rows)
    cosine = np.maximum(map_directions(rows) @ axis, 0.0)
    found = np.einsum("i,ij,ijc->c", weight, cosine, image)
    np.testing.assert_allclose(found, expected, rtol=2e-3)


def test_a_sky_seen_from_aloft_is_seen_and_does_not_light(box_file):
    """The scene is lit by the sky of the ground; behind it stands what the eye sees of its own."""
    ground_sky = np.ones((6, 16, 16, 3))
    view = {"size": (24, 16), "eye": (7.0, 1.5, 8.0)}
    seen_from_aloft = subject_of(box_file, 5.0 * ground_sky, **view)
    low = light_messages(ground_sky)[0]
    aloft = seen_from_aloft.state
    lit = msgspec.structs.replace(aloft.sky_light, radiance=radiance_of(low))
    state = replace(aloft, sky_light=lit)
    alike = subject_of(box_file, ground_sky, **view)
    pictures = []
    for subject in (Subject(state), alike):
        pictures.append(Tracer(subject, PathTracerSettings(spp=8, variant="scalar")).trace(0, 8))
    aloft, plain = pictures
    np.testing.assert_allclose(aloft[:5], 5.0, rtol=1e-3)
    np.testing.assert_allclose(plain[:5], 1.0, rtol=1e-3)
    # Below the horizon the same rays meet the same light.
    np.testing.assert_allclose(aloft[7:], plain[7:], atol=1e-4)
    # Between, only the share of a pixel that the sky fills is brighter.
    assert (aloft[5:7] >= plain[5:7] - 1e-4).all()


def test_mitsuba_looks_the_map_up_where_we_put_it():
    """Its emitter, asked for 200 directions, answers with the cube's own radiance: 1 %."""
    cube = 2.0 + texel_directions(64)
    emitter = mitsuba_of(cube)
    towards = np.random.default_rng(1).normal(size=(200, 3))
    towards /= np.linalg.norm(towards, axis=1, keepdims=True)
    towards = towards[np.abs(towards[:, 1]) > 0.02]
    interaction = mitsuba.SurfaceInteraction3f()
    found = []
    for direction in towards:
        interaction.wi = mitsuba.Vector3f(*map(float, -direction))
        found.append(list(emitter.eval(interaction)))
    np.testing.assert_allclose(found, sample_cube(cube, towards), rtol=0.01)


def mitsuba_of(cube):
    mitsuba.set_variant("scalar_rgb")
    return mitsuba.load_dict(sky_emitter(mitsuba, cube))


@pytest.mark.long
def test_our_hosek_wilkie_lights_a_scene_as_mitsubas_own_sunsky_does(box_file, monkeypatch):
    """Same scene, same samples: means of the picture and of each quarter agree within noise.

    `sunsky` is an independent implementation of the model, without our cube and map; its frame
    has +Z up. Noise: three standard errors of the difference of 24 independent pictures.
    """
    elevation_rad, azimuth_rad, turbidity, albedo = np.radians(35.0), np.radians(140.0), 4.0, 0.2
    sky = HosekWilkieSky(turbidity, albedo, elevation_rad)
    cube = sky.cube_map(128, azimuth_rad).astype(float)
    # The horizon, where a map is blurred by half a row, is not in the picture itself.
    subject = subject_of(box_file, cube, angle_rad=0.6)
    settings = PathTracerSettings(spp=4)

    def pictures(first):
        tracer = Tracer(subject, settings)
        return np.array([tracer.trace(first + 4 * number, 4) for number in range(24)])

    ours = pictures(0)
    sun = world_from_enu(direction_from_angles(azimuth_rad, elevation_rad))
    theirs_dict = {
        "type": "sunsky",
        "sun_direction": [float(value) for value in sun],
        "turbidity": turbidity,
        "albedo": albedo,
        "sun_scale": 0.0,
        "sky_scale": CIE_Y_NORMALISATION,
        "to_world": mitsuba.ScalarTransform4f().rotate([1, 0, 0], -90.0),
    }
    monkeypatch.setattr(tracer_module, "sky_emitter", lambda mitsuba, cube: theirs_dict)
    # Other samples: the same ones would not be independent. Those from 1000 on are three errors off
    # from mitsuba's own others in llvm, by chance.
    theirs = pictures(20_000)
    for rows in (slice(0, 16), slice(16, 32)):
        for columns in (slice(0, 24), slice(24, 48)):
            a, b = (many[:, rows, columns].mean(axis=(1, 2)) for many in (ours, theirs))
            error = np.sqrt((a.var(axis=0) + b.var(axis=0)) / (len(a) - 1))
            assert np.all(error < 0.01 * a.mean(axis=0))
            np.testing.assert_array_less(np.abs(a.mean(axis=0) - b.mean(axis=0)), 3.0 * error)


@pytest.mark.parametrize("elevation_deg", [40.0, 0.1])
def test_the_disc_has_all_of_the_irradiance_above_the_horizon(elevation_deg):
    """Radiance times solid angle adds up to E also of a disc that is cut: 1e-3, by hand."""
    cube = np.zeros((6, 2, 2, 3))
    direction, irradiance = sun_at(80.0, elevation_deg), (100.0, 80.0, 50.0)
    _, sun, _ = light_messages(cube, direction, irradiance)
    picture = disc_picture(sun)
    side_rad = 2.0 * (1.0 + 4.0 / len(picture)) * np.tan(sun.angular_radius_rad)
    energy = picture.sum(axis=(0, 1)) * (side_rad / len(picture)) ** 2
    np.testing.assert_allclose(energy, irradiance, rtol=1e-3)
    lit = picture[..., 1].any(axis=1)
    # The lower rows of a disc whose middle is 0.1 degrees high lie below the horizon.
    assert lit[20] == (elevation_deg > 1.0)
    assert lit[100]


def test_a_sharp_sun_gives_the_light_of_its_disc(box_file):
    """Direction or disc: the sunlit ground has one radiance, a / pi E sin(elevation), to 0.5 %."""
    sun = {"sun_direction": sun_at(90.0, 40.0), "sun_irradiance": (100.0, 80.0, 50.0)}
    subject = subject_of(box_file, np.zeros((6, 2, 2, 3)), eye=(30.0, 25.0, 60.0), **sun)
    expected = 0.3 / np.pi * np.array([100.0, 80.0, 50.0]) * np.sin(np.radians(40.0))
    for kind in ("disc", "sharp"):
        settings = PathTracerSettings(spp=16, max_bounces=1, sun=kind)
        picture = Tracer(subject, settings).trace(0, 16)
        np.testing.assert_allclose(picture[-6:].mean(axis=(0, 1)), expected, rtol=5e-3)


def test_the_disc_softens_the_edge_of_a_shadow(box_file):
    """A sharp sun leaves pixels all lit or dark but for the edge's own; a disc 20 times as wide."""
    sun = {"sun_direction": sun_at(90.0, 30.0), "sun_irradiance": (100.0,) * 3}
    subject = subject_of(box_file, np.zeros((6, 2, 2, 3)), **sun)
    # The top edge, 2 m high, throws its shadow to x = -1 - 2 / tan(30 deg) = -4.46.
    camera = MoveCamera(
        eye_m=(-4.46, 3.0, 0.0), target_m=(-4.46, 0.0, 0.0), vertical_field_of_view_rad=0.05
    )
    subject = Subject(replace(subject.state, moved_camera=camera))
    between = {}
    for kind in ("disc", "sharp"):
        settings = PathTracerSettings(spp=32, max_bounces=1, sun=kind)
        row = Tracer(subject, settings).trace(0, 32)[..., 1].mean(axis=0)
        full = 0.3 / np.pi * 100.0 * 0.5
        between[kind] = np.sum((row > 0.03 * full) & (row < 0.97 * full))
    # 4 m from the edge to the ground, seen from the sun: 4 * 2 * 0.00465 / sin 30 = 7.4 cm.
    metres_a_pixel = 3.0 * 2 * np.tan(0.025) / 32
    assert between["sharp"] <= 1
    assert between["disc"] == pytest.approx(0.88 * 0.0744 / metres_a_pixel, abs=3)
