"""The light of an hour by the graphics card's shaders beside the processor's, number by number."""

from pathlib import Path

import numpy as np
import pytest
from lamp_maker import lamps_of
from light_stage import box_file
from light_transport.drawing import hour_on_card
from light_transport.drawing.hour_on_card import PIECE, HourOnCard
from light_transport.hour.card_tables import largest_return, sweep_weights
from light_transport.hour.illumination import Illumination
from light_transport.public import (
    NODES,
    SceneTransport,
    TransportSizes,
    mirror_parts,
    surfaces_of,
    tree_of,
)

from vrut_lite.errors import GivenUp
from vrut_lite.geometry.cube_map import texel_directions
from vrut_lite.geometry.spherical_harmonics import irradiance_coefficients
from vrut_lite.kernel.work_counters import WorkCounters
from vrut_lite.messages.lamps import MOST_DRAWN
from vrut_lite.scene.loading import load_scene
from vrut_lite.scene.packing import packed

pytestmark = pytest.mark.gl

SCENES = Path(__file__).parents[2] / "scenes"
# Largest difference of a texel's channel, over the larger of the value and a hundredth of the
# brightest, where the processor's bounces go on to a ten-millionth.
WORST = 1e-4
CONVERGED = 1e-7
_UP = texel_directions(16)[..., 1:2]


def hour_under(zenith, clouds=0.0, sun=(0.36, 0.48, 0.8), sun_w_m2=600.0):
    """A sky of this radiance at the zenith, twice as bright at the horizon and with a sun."""
    noise = np.random.default_rng(3).uniform(0.2, 1.8, (6, 16, 16, 1))
    grown = (1.0 - clouds) + clouds * noise
    above = np.where(_UP > 0.0, zenith * (2.0 - np.clip(_UP, 0.0, 1.0)) * grown, 0.0)
    sky = (above * np.array([0.6, 0.8, 1.2])).astype(np.float32)
    return Illumination(
        sky=sky,
        ground_radiance_rgb=tuple(0.1 * zenith * np.array([1.0, 0.9, 0.7])),
        ground_albedo_rgb=(0.25, 0.22, 0.18),
        key_direction=sun,
        key_irradiance_rgb=(sun_w_m2, 0.9 * sun_w_m2, 0.8 * sun_w_m2),
        open_sky=irradiance_coefficients(sky),
    )


HOURS = {
    "clear noon": hour_under(30.0),
    "low sun": hour_under(12.0, sun=(0.995, 0.0998, 0.0), sun_w_m2=80.0),
    "overcast": hour_under(40.0, clouds=1.0, sun_w_m2=0.0),
    "moonlight": hour_under(2e-5, sun=(-0.6, 0.64, 0.48), sun_w_m2=4e-4),
}


def transport_of(scene, texels=6000, rays=64, lamps=None):
    surfaces = surfaces_of(scene)
    tree = tree_of(surfaces)
    made = SceneTransport.of_scene(
        scene, surfaces, TransportSizes(None, texels, 3.0, CONVERGED), tree
    )
    made.lamps = lamps
    made.add_mirrors(mirror_parts(scene, surfaces))
    made.add_rays(rays)
    return made


@pytest.fixture(scope="module")
def begin(gl_owner):
    """Begins the light of hours as a picture's frame part does: programs and light."""
    from vrut_lite.render.frame_parts import PartRenderer
    from vrut_lite.render.tiles import Patience

    made = []

    def begun(context):
        counters = WorkCounters()
        gl = PartRenderer(context, counters, Patience(counters), print)
        made.append((gl, HourOnCard(gl)))
        return made[-1]

    yield lambda: gl_owner.call(begun)
    gl_owner.call(lambda _: [thing.release() for pair in made for thing in reversed(pair)])


@pytest.fixture(scope="module")
def card(gl_owner, begin):
    """Computes an hour, and reads its textures."""
    _, on_card = begin()

    def computed(context, transport, hour):
        recipe = transport.card_hour(hour)
        tables = recipe.tables
        on_card.compute(recipe)
        height, width = tables.shown.shape
        texture = context.texture((width, height), 4, dtype="f4")
        on_card.write_map(texture)
        found = {"texels": floats(texture.read(), height, width)}
        if tables.probes is not None:
            nx, ny, nz = tables.probe_counts
            volume = context.texture3d((nx, ny, 6 * nz), 4, dtype="f4")
            on_card.write_probes(volume)
            found["probes"] = np.moveaxis(floats(volume.read(), 6, nz, ny, nx), 0, 3)
        if tables.target is not None:
            found["mirrors"] = np.stack(
                [
                    cube(context, number, tables.target.shape[2])
                    for number in range(len(tables.target))
                ]
            )
        return found

    def cube(context, number, edge):
        made = context.texture_cube((edge, edge), 4, dtype="f4")
        on_card.write_mirror(number, made)
        return np.stack([floats(made.read(face), edge, edge) for face in range(6)])

    return lambda transport, hour: gl_owner.call(lambda c: computed(c, transport, hour))


def floats(data, *shape):
    return np.frombuffer(data, np.float32).reshape(*shape, 4)


def worst(found, expected):
    """The largest difference of each kind of numbers."""
    errors = {}
    for name, values in found.items():
        truth = getattr(expected, name).astype(float)
        assert values.shape == truth.shape
        floor = 1e-2 * np.abs(truth).reshape(-1, 4).max(axis=0) + 1e-30
        errors[name] = float((np.abs(values - truth) / np.maximum(np.abs(truth), floor)).max())
    return errors


def check_hours(card, transport, *names):
    for name in names:
        light = transport.light(HOURS[name])
        errors = worst(card(transport, HOURS[name]), light)
        assert max(errors.values()) < WORST, (name, errors)
        assert light.texels[..., :3].max() > 0.0


@pytest.mark.parametrize("file", ["work/indoor.glb", "street.obj", "pavilion.gltf"])
def test_every_texel_is_the_processors_to_a_ten_thousandth(card, file):
    """Rooms, a street and a pavilion with their mirrors, by day, low sun, clouds and moonlight."""
    transport = transport_of(packed(load_scene(SCENES / file)))
    assert transport.mirrors is not None
    check_hours(card, transport, *HOURS)


def test_lamps_of_the_map_and_those_in_mirrors_are_the_processors(card):
    """More lamps than the frame draws: the map holds some, and all light patches and mirrors."""
    scene = packed(load_scene(SCENES / "work/indoor.glb"))
    middle = 0.5 * (np.array(scene.lower_m) + scene.upper_m)
    number = MOST_DRAWN + 3
    places = [np.array([0.3 * (k % 4) - 0.5, 0.2, 0.3 * (k // 4) - 0.5]) for k in range(number)]
    lamps = lamps_of(*({"position_m": middle + place} for place in places))
    transport = transport_of(scene, lamps=lamps)
    assert transport.card_hour(HOURS["moonlight"]).tables.lamps is not None
    check_hours(card, transport, "moonlight", "clear noon")


def test_probes_buried_in_bodies_show_their_neighbours_light(card, tmp_path):
    """Light by probes alone, some of which stand in a cube."""
    path = box_file(tmp_path, boxes=((0.0, 2.0), (3.0, 1.5)))
    scene = packed(load_scene(path))
    surfaces = surfaces_of(scene)
    transport = SceneTransport.of_probes(scene, surfaces, tree_of(surfaces))
    transport.bounces_left = CONVERGED
    transport.add_rays(32)
    assert not transport.good[len(transport.texels.pixel) :].all()
    assert transport.card_hour(HOURS["overcast"]).tables.probes is not None
    check_hours(card, transport, "overcast", "clear noon")


def test_sweeps_end_within_their_share_of_all_bounces():
    """Chebyshev's sweeps beside the exact solution in double precision, up to an albedo of 0.97."""
    scene = packed(load_scene(SCENES / "work/indoor.glb"))
    tables = transport_of(scene, 3000).card_hour(HOURS["overcast"]).tables
    patches = len(tables.patches)
    row = np.repeat(np.arange(patches), np.diff(tables.transfer.start.astype(int)))
    other = tables.transfer.entry[:, 0].astype(int) - NODES
    transfer = np.zeros((patches, patches))
    np.add.at(transfer, (row, other), tables.transfer.entry[:, 1].copy().view(np.float32))
    direct = np.random.default_rng(1).uniform(0.0, 1.0, patches) ** 8
    for albedo in (0.2, 0.8, 0.97):
        exact = np.linalg.solve(np.eye(patches) - albedo * transfer, direct)
        largest = float((albedo * transfer.sum(axis=1)).max())
        now = before = direct
        for weight in sweep_weights(min(largest, 0.999)):
            once = direct + albedo * transfer @ now
            now, before = weight * (once - before) + before, now
        assert np.abs(now / exact - 1.0).max() < 2e-5


def test_the_largest_return_bounds_each_bounce():
    """No patch sends back more of what all send than the number by which sweeps are counted."""
    scene = packed(load_scene(SCENES / "pavilion.gltf"))
    tables = transport_of(scene, 3000).card_hour(HOURS["overcast"]).tables
    for albedo in (0.0, 0.9):
        most = largest_return(tables, (albedo,) * 3)
        returned = tables.patches[:, 1, :3].max(axis=1)
        returned[tables.patches[:, 0, 3] > 0.0] = albedo
        assert most == pytest.approx(float((returned * tables.enclosure).max()))
        assert 0.0 < most < 1.0


# --- a bake's tables and programs, piece by piece --------------------------------------------


def map_of(context, on_card, tables):
    texture = context.texture(tables.shown.shape[::-1], 4, dtype="f4")
    on_card.write_map(texture)
    return texture.read()


def test_a_bake_comes_in_pieces_of_stated_size_and_gives_the_same_light(
    gl_owner, begin, monkeypatch
):
    """A call brings one piece: so many bytes of tables, or one program. Until the last has come the
    hour before stays; then the map is to the byte that of a bake that came whole."""
    before = transport_of(packed(load_scene(SCENES / "work/indoor.glb")), 2000)
    now = transport_of(packed(load_scene(SCENES / "pavilion.gltf")), 2000)
    first, then = before.card_hour(HOURS["low sun"]), now.card_hour(HOURS["overcast"])
    gl, on_card = begin()
    _, at_once = begin()
    monkeypatch.setattr(hour_on_card, "PIECE_BYTES", 300_000)
    compiled = []
    monkeypatch.setattr(
        gl, "compute", lambda *key: compiled.append(key) or type(gl).compute(gl, *key)
    )

    def one_a_call(context, hour):
        """Calls until the hour is there."""
        calls = 1
        while not on_card.compute(hour, 1):
            assert gl.counters.done[PIECE] == calls
            calls += 1
        gl.counters.done.clear()
        return calls

    def work(context):
        calls = one_a_call(context, first)
        programs = len(compiled)
        shown = map_of(context, on_card, first.tables)
        assert not on_card.compute(then, 1)
        assert not on_card.compute(then, 0)
        gl.counters.done.clear()
        assert map_of(context, on_card, first.tables) == shown
        assert on_card.holds(first)
        pieces = one_a_call(context, then)
        assert at_once.compute(then)
        maps = [map_of(context, each, then.tables) for each in (on_card, at_once)]
        return calls, programs, pieces, maps

    calls, programs, pieces, maps = gl_owner.call(work)
    assert len(set(compiled)) == len(compiled) == programs
    for hour, count in ((first, calls - programs), (then, pieces + 1)):
        data = sum(array.nbytes for array in hour.tables.arrays)
        # Besides the tables there are rows in which an hour is computed: a fifth as much, or less.
        assert data < count * 300_000 < 1.5 * data + 600_000
    assert maps[0] == maps[1]
    assert np.frombuffer(maps[0], np.float32).max() > 0.0


def test_a_still_that_is_given_up_leaves_its_pieces_to_the_next(gl_owner, begin):
    """Somebody drags while a still waits for a bake's tables: it ends after a piece, and the next
    picture goes on with the second."""
    hour = transport_of(packed(load_scene(SCENES / "work/indoor.glb")), 2000).card_hour(
        HOURS["overcast"]
    )
    gl, on_card = begin()

    def work(_):
        gl._patience.is_given_up = lambda: True
        for calls in (1, 2):
            with pytest.raises(GivenUp):
                on_card.compute(hour)
            assert gl.counters.done[PIECE] == calls
        gl._patience.is_given_up = None
        assert on_card.compute(hour)

    gl_owner.call(work)
