"""The frame through air of constant extinction and radiance: pixels worked out on paper.

Such air has transmittance T = exp(-k d) and adds (1 - T) S before whatever stands at d.
"""

import msgspec
import numpy as np
import pytest
import trimesh
from air_phases import lobe
from air_stage import EARTH_M, air_of, volume_of
from light_messages import light_messages
from scene_stage import look, square
from stateful_backend import opened

from vrut_lite.geometry.cube_map import texel_directions
from vrut_lite.messages.ground_disc import GroundDisc
from vrut_lite.scene.loading import load_scene
from vrut_lite.sky.ground_albedo import ground_albedo

pytestmark = pytest.mark.gl
EXTINCTION = np.array([1.2e-5, 2.5e-5, 6e-5])
SOURCE = np.array([3.0, 5.0, 9.0])
# From the eye at 1.7 m, a little upwards: over the horizon, where the air's tables reach farthest.
EYE = np.array([0.0, 1.7, 0.0])


@pytest.fixture
def backend(gl_backend):
    return gl_backend(size_px=(48, 32))


def show_light(backend, cube, **changes):
    background, sun, ambient = light_messages(cube)
    background = msgspec.structs.replace(background, **changes)
    backend.change(background=background, key_light=sun, ambient=ambient)
    backend.change(ground_albedo_rgb=ground_albedo(background, sun, ambient))


def uniform_sky(radiance):
    return np.full((6, 16, 16, 3), radiance, float)


def wall(distance_m, albedo):
    """A square wall before the eye, as wide as its distance; its near side stands at -z."""
    box = trimesh.creation.box((distance_m, distance_m, 0.01 * distance_m))
    box.apply_translation((0.0, EYE[1], -1.005 * distance_m))
    # A black metal has no coat that reflects, as black paint has.
    material = trimesh.visual.material.PBRMaterial(
        baseColorFactor=[albedo, albedo, albedo, 1.0], metallicFactor=1.0, roughnessFactor=1.0
    )
    box.visual = trimesh.visual.TextureVisuals(material=material)
    return box


def scene_of(folder, *meshes):
    path = folder / "scene.glb"
    trimesh.Scene(meshes).export(path)
    return load_scene(path)


def through(radiance, metres, extinction=EXTINCTION, source=SOURCE):
    """What is seen of a radiance so far away (...,): (..., 3)."""
    transmittance = np.exp(-np.asarray(metres, float)[..., None] * extinction)
    return radiance * transmittance + (1.0 - transmittance) * source


@pytest.mark.parametrize("distance_m", [1e3, 1e4, 1e5])
@pytest.mark.parametrize("albedo", [0.0, 1.0])
def test_walls_fade_into_the_air(backend, tmp_path, distance_m, albedo):
    """A white wall gives back the 4 of a uniform sky, a black one nothing: T L + (1 - T) S, 1 %."""
    backend.change(scene=opened(scene_of(tmp_path, wall(distance_m, albedo))))
    show_light(backend, uniform_sky(4.0))
    backend.hear(air_of(volume_of(EXTINCTION, SOURCE)))
    target = np.add(EYE, (0.0, 0.1 * distance_m, -distance_m))
    picture = look(backend, EYE, target, 0.02)
    expected = through(4.0 * albedo, np.linalg.norm(target - EYE))
    np.testing.assert_allclose(
        picture.radiance, np.broadcast_to(expected, picture.radiance.shape), rtol=0.01
    )
    assert backend.counters.done["air"] == 1


def test_sunlit_air_has_its_phase_functions(backend, tmp_path):
    """direct p_R(nu) + aerosol p(nu) beside shaded light: in and away from the sun, within 1 %."""
    g, factor, form = 0.7, 0.05, 0.3
    backend.change(scene=opened(scene_of(tmp_path, wall(1e4, 0.0))))
    show_light(backend, uniform_sky(0.0))
    for sun in ((0.0, 0.1, -1.0), (0.0, 0.6, 0.8)):
        direction = np.array(sun) / np.linalg.norm(sun)
        volume = volume_of(
            EXTINCTION,
            1.0,
            30.0,
            8.0,
            sun_direction=tuple(direction),
            aerosol_phase=lobe(g, factor, form),
        )
        backend.hear(air_of(volume))
        target = np.add(EYE, (0.0, 1e3, -1e4))
        picture = look(backend, EYE, target, 0.02)
        nu = (target - EYE) @ direction / np.linalg.norm(target - EYE)
        phase = factor * (1 + form * nu**2) / (1 + g**2 - 2 * g * nu) ** 1.5
        rayleigh = 3.0 / (16.0 * np.pi) * (1.0 + nu**2)
        source = 1.0 + 30.0 * rayleigh + 8.0 * phase
        expected = through(0.0, np.linalg.norm(target - EYE), source=source)
        np.testing.assert_allclose(picture.radiance[16, 24], expected, rtol=0.01)


def test_what_is_behind_glass_has_its_own_air(backend, tmp_path):
    """Half-clear black glass at 2 km before a sky of 4: a (1 - T) S + (1 - a) 4, within 1 %.

    The sky behind has all of its air; that before the glass is not to be drawn twice.
    """
    corners = 2e3 * np.array([[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1]], float)
    glass = {
        "alphaMode": "BLEND",
        "pbrMetallicRoughness": {"baseColorFactor": [0, 0, 0, 0.5], "metallicFactor": 1.0},
    }
    backend.change(scene=opened(square(tmp_path, glass, corners=corners)))
    show_light(backend, uniform_sky(4.0))
    backend.hear(air_of(volume_of(EXTINCTION, SOURCE)))
    target = np.array([0.0, 200.0, -2e3])
    picture = look(backend, EYE, target, 0.02)
    expected = 0.5 * through(0.0, np.linalg.norm(target - EYE)) + 0.5 * 4.0
    np.testing.assert_allclose(picture.radiance[16, 24], expected, rtol=0.01)


def test_a_pixel_on_an_edge_is_the_mean_of_near_and_far(backend, tmp_path):
    """A black wall at 50 m before one at 20 km: thirds of the way from one's air to the other's.

    Air drawn by a resolved depth would give such pixels the depth of no surface at all.
    """
    near = wall(50.0, 0.0)
    # A slanting upper edge about the middle of the picture.
    near.apply_transform(trimesh.transformations.rotation_matrix(0.2, [0, 0, 1], EYE))
    near.apply_translation((0.0, -25.0 + 5.0, 0.0))
    far = wall(2e4, 0.0)
    backend.change(scene=opened(scene_of(tmp_path, near, far)))
    show_light(backend, uniform_sky(0.0))
    backend.hear(air_of(volume_of(EXTINCTION, SOURCE)))
    picture = look(backend, EYE, np.add(EYE, (0.0, 5.0, -50.0)), 0.1)
    ends = through(0.0, [50.0, 2e4])[:, 1]
    share = (picture.radiance[..., 1] - ends[0]) / (ends[1] - ends[0])
    assert (share < 0.02).mean() > 0.2
    assert (share > 0.95).mean() > 0.2
    edges = share[(share > 0.02) & (share < 0.95)]
    assert edges.size > 20
    np.testing.assert_allclose(edges * 3.0, np.round(edges * 3.0), atol=0.06)


def test_without_air_the_picture_is_bit_for_bit_the_one_of_before(backend, tmp_path):
    """Before any air is posted, without air, and after its removal; counters name the reason."""
    backend.change(scene=opened(scene_of(tmp_path, wall(1e3, 0.5))))
    show_light(backend, uniform_sky(4.0))
    view = EYE, np.add(EYE, (300.0, 100.0, -1e3)), 0.8
    before = look(backend, *view)
    pictures = []
    for volume in (None, volume_of(EXTINCTION, SOURCE), None):
        backend.hear(air_of(volume))
        pictures.append(look(backend, *view))
    for picture, same in zip(pictures, (True, False, True), strict=True):
        assert np.array_equal(picture.radiance, before.radiance) is same
    assert backend.counters.skipped["air: none to be seen"] == 3
    assert backend.counters.done["air"] == 1


def horizon_sky():
    """4 above the horizon, ground of 1.5 below it."""
    above = texel_directions(32)[..., 1:2] > 0.0
    return np.where(above, 4.0, 1.5) * np.ones(3)


# Heights of the eye, and a scene's half diagonal.
HEIGHTS = [(1.7, 10.0), (1.7, 100.0), (100.0, 100.0), (3e3, 100.0), (3e3, 1e3), (3e4, 1e3)]


@pytest.mark.parametrize(("height_m", "radius_m"), HEIGHTS)
def test_the_ground_goes_on_beyond_the_disc(backend, tmp_path, height_m, radius_m):
    """Disc and sky's ground are one sphere through one air: each pixel within 0.5 % of float64.

    From the feet to the horizon, the rim at 60 radii in between: no line there, since both
    sides are what they should be; and above the horizon the sky is untouched, bit for bit.
    """
    backend.change(size_px=(32, 256))
    behind = trimesh.creation.box((1, 1, 1)).apply_translation((0.0, 0.0, 2 * height_m))
    ground = GroundDisc((0.0, 0.0), 0.0, 60.0 * radius_m)
    backend.change(scene=opened(scene_of(tmp_path, behind), ground))
    show_light(backend, horizon_sky())
    volume = volume_of(EXTINCTION, SOURCE, observer_altitude_m=height_m, reach_m=2e6)
    horizon = np.arcsin(-np.sqrt(height_m * (2 * EARTH_M + height_m)) / (EARTH_M + height_m))
    rim = -np.arctan2(height_m, ground.radius_m)
    # A view that holds rim and horizon, as through a tele lens where they are near each other.
    half = np.clip(1.2 * abs(rim - horizon), 0.05, 0.6)
    middle = max(0.5 * (rim + horizon), horizon - 0.7 * half)
    eye = np.array([0.0, height_m, 0.0])
    target = np.add(eye, (0.0, np.tan(middle), -1.0))
    backend.hear(air_of(volume))
    radiance = look(backend, eye, target, 2 * half).radiance[:, 16]
    angle = middle + np.arctan(np.tan(half) * (1.0 - (np.arange(256) + 0.5) / 128))
    pixel = np.abs(np.diff(angle)).max()
    sky, land = angle > horizon + 2 * pixel, angle < horizon - 2 * pixel
    assert land.sum() > 100
    assert sky.sum() > 10
    np.testing.assert_array_equal(radiance[sky], 4.0)
    along = (EARTH_M + height_m) * np.sin(angle[land])
    tangent = height_m * (2 * EARTH_M + height_m)
    metres = tangent / (np.sqrt(along**2 - tangent) - along)
    np.testing.assert_allclose(radiance[land], through(1.5, metres), rtol=5e-3)


def test_ground_that_has_its_air_gets_no_more(backend, tmp_path):
    """A sky that shows its ground through the air is drawn as it is, below the horizon too."""
    backend.change(scene=opened(scene_of(tmp_path, wall(10.0, 0.5))))
    show_light(backend, horizon_sky(), ground_through_air=True)
    view = (EYE, np.add(EYE, (1.0, -0.2, 0.0)), 1.0)
    clear = look(backend, *view)
    backend.hear(air_of(volume_of(EXTINCTION, SOURCE)))
    np.testing.assert_array_equal(look(backend, *view).radiance, clear.radiance)
