"""Guided paths bring the same light with less noise; scenes without openings are not guided."""

from dataclasses import replace

import msgspec
import numpy as np
import pytest
import trimesh
from light_messages import light_messages
from path_tracer import openings, tracer
from path_tracer.direction_table import BINS, DirectionTable, Grid
from path_tracer.library import load_mitsuba
from path_tracer.openings import _smoothed
from path_tracer.settings import PathTracerSettings
from path_tracer.subject import Subject
from path_tracer.tracer import Tracer
from path_tracer_here import mitsuba_or_skip
from stateful_backend import opened

from vrut_lite.errors import UserError
from vrut_lite.messages.camera import MoveCamera
from vrut_lite.messages.ground_disc import GroundDisc
from vrut_lite.scene.scene_state import SceneState

mitsuba_or_skip()
try:
    mitsuba = load_mitsuba("llvm")
except UserError as error:
    pytest.skip(str(error), allow_module_level=True)


CLOSED = [((0.1, 3.0, 4.0), (-2.05, 1.5, 0))]
WINDOW = [
    ((0.1, 1.0, 4.0), (-2.05, 0.5, 0)), ((0.1, 1.0, 4.0), (-2.05, 2.5, 0)),
    ((0.1, 1.0, 1.5), (-2.05, 1.5, -1.25)), ((0.1, 1.0, 1.5), (-2.05, 1.5, 1.25)),
]  # fmt: skip
TERRACE = [((0.1, 1.0, 4.0), (-2.05, 0.5, 0))]


def room(path, albedo, parapets):
    """A room of 4 x 3 x 4 m; its west wall is these boxes: sizes and centres. Its file."""
    walls = [
        ((4.2, 0.1, 4.2), (0, -0.05, 0)), ((4.2, 0.1, 4.2), (0, 3.05, 0)),
        ((0.1, 3.0, 4.0), (2.05, 1.5, 0)), ((4.2, 3.0, 0.1), (0, 1.5, 2.05)),
        ((4.2, 3.0, 0.1), (0, 1.5, -2.05)), *parapets,
    ]  # fmt: skip
    boxes = [trimesh.creation.box(size).apply_translation(at) for size, at in walls]
    mesh = trimesh.util.concatenate(boxes)
    paint = trimesh.visual.material.PBRMaterial(
        baseColorFactor=[albedo, albedo, albedo, 1.0], metallicFactor=0.0, roughnessFactor=1.0
    )
    mesh.visual = trimesh.visual.TextureVisuals(material=paint)
    mesh.export(path)
    return path


def subject_of(path, eye=(1.5, 1.5, 1.5), target=(-1.0, 1.0, -1.0), **sun):
    background, key_light, ambient = light_messages(np.ones((6, 8, 8, 3)), **sun)
    return Subject(
        SceneState(
            scene=opened(path, GroundDisc((0.0, 0.0), -0.1, 60.0)),
            background=background,
            key_light=key_light,
            ambient=ambient,
            ground_albedo_rgb=(0.3,) * 3,
            moved_camera=MoveCamera(eye_m=eye, target_m=target, vertical_field_of_view_rad=1.0),
            size_px=(24, 16),
        ).under_clear_sky()
    )


def pictures(subject, count=12, spp=32):
    traced = Tracer(subject, PathTracerSettings(spp=4096, variant="llvm", surfaces="bare"))
    return np.array([traced.trace(spp * n, spp).mean(axis=-1) for n in range(count)]), traced


def test_guided_paths_bring_the_same_light_with_less_noise(tmp_path, monkeypatch):
    """Sun and sky through a window: means of the quarters agree to 3.5 standard errors, and the
    relative variance is lower."""
    sun = {"sun_direction": (-0.6, 0.8, 0.0), "sun_irradiance": (3.0, 3.0, 3.0)}
    subject = subject_of(room(tmp_path / "room.glb", 0.6, WINDOW), **sun)
    guided, traced = pictures(subject)
    assert traced.guided == 2
    monkeypatch.setattr(tracer, "_guided", lambda *_: None)
    plain, traced = pictures(subject)
    assert traced.guided == 0
    for rows in (slice(0, 8), slice(8, 16)):
        for columns in (slice(0, 12), slice(12, 24)):
            a, b = (many[:, rows, columns].mean(axis=(1, 2)) for many in (guided, plain))
            error = np.sqrt((a.var(ddof=1) + b.var(ddof=1)) / len(a))
            assert error < 0.03 * b.mean()
            assert abs(a.mean() - b.mean()) < 3.5 * error
    noise = [np.mean(many.var(axis=0) / plain.mean(axis=0) ** 2) for many in (guided, plain)]
    assert noise[0] < 0.7 * noise[1]


def test_a_white_room_in_an_even_sky_is_a_furnace(tmp_path):
    """A white room without a wall, and nothing else: every radiance is the sky's."""
    subject = subject_of(room(tmp_path / "room.glb", 1.0, TERRACE))
    # Without the ground disc the sky is below too.
    scene = msgspec.structs.replace(subject.state.scene, ground=None)
    guided, traced = pictures(Subject(replace(subject.state, scene=scene)), spp=64)
    assert traced.guided == 1
    error = guided.mean(axis=(1, 2)).std(ddof=1) / np.sqrt(len(guided))
    assert error < 0.03
    assert guided.mean() == pytest.approx(1.0, abs=4.0 * error)


@pytest.mark.parametrize(("west", "eye"), [(CLOSED, (1.5, 1.5, 1.5)), (WINDOW, (12.0, 8.0, 12.0))])
def test_a_scene_without_openings_is_traced_as_before(tmp_path, west, eye, monkeypatch):
    """A closed room, and a house seen from outside: no table is learnt."""
    monkeypatch.setattr(tracer, "learn", None)
    subject = subject_of(room(tmp_path / "room.glb", 0.6, west), eye=eye, target=(0.0, 1.0, 0.0))
    _, traced = pictures(subject, count=1, spp=1)
    assert traced.guided == 0


def test_draws_have_the_density_that_the_table_tells():
    """Counts of a million draws by bin against the histogram: 5 standard deviations; densities
    integrate to 1."""
    random = np.random.default_rng(5)
    light = random.random((1, BINS)) + 0.1
    grid = Grid((0.0, 0.0, 0.0), 1.0, (1, 1, 1))
    table = DirectionTable(mitsuba, grid, np.array([2]), light, 0.5)
    count = 2**20
    u = random.random((3, count)).astype(np.float32)
    row = table.row(mitsuba.Point3f(0.5), mitsuba.Normal3f(0.0, 1.0, 0.0), True)
    assert row[0] == 1
    rows = mitsuba.UInt32(np.ones(count, np.uint32))
    drawn = table.draw(rows, mitsuba.Float(u[0]), mitsuba.Point2f(u[1], u[2]), True)
    density = np.array(table.density(rows, drawn, True))
    bins = np.array(openings.direction_bin(mitsuba, drawn))
    share = light[0] / light.sum()
    counts = np.bincount(bins, minlength=BINS)
    # A draw on the border of two bins may be counted in the other.
    assert np.abs(counts - count * share).max() < 5.0 * np.sqrt(count * share.max()) + 5
    np.testing.assert_allclose(
        np.median(density / (share[bins] * BINS / (4 * np.pi))), 1.0, rtol=1e-3
    )
    assert np.mean(1.0 / density) == pytest.approx(4.0 * np.pi, rel=0.02)


def test_what_one_sample_brought_is_spread_and_what_many_did_is_kept():
    """A row's sum stays; one sample's light goes to its neighbours, that of 10,000 does not."""
    light = np.zeros((2, BINS))
    light[:, 700] = 1.0
    squares = light * [[1.0], [1e-4]]
    one, many = _smoothed(light, squares)
    assert one.sum() == pytest.approx(1.0)
    assert many.sum() == pytest.approx(1.0)
    assert one[700] < 0.05
    assert many[700] > 0.99
