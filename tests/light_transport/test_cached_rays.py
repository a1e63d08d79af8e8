"""Rays kept on disk: the same light, sooner."""

import numpy as np
import pytest
from boxes import box, floor, hour, quads
from light_stage import COARSE, WANT, LightStage, Shine, Show, box_file, lights
from light_transport.transport import SceneTransport
from light_transport.transport_files import wait_for_rays

NOON = Shine(radiance=1.0, irradiance=3.0)


@pytest.fixture
def scene(tmp_path):
    return Show(path=str(box_file(tmp_path)))


def light_of(*inputs):
    stage = LightStage()
    said = stage.tell(*COARSE, WANT, NOON, *inputs)
    stage.kernel.close()
    assert stage.kernel.last_fault("light_transport") is None
    return lights(said)


@pytest.fixture
def traced(monkeypatch):
    """How many rays of each texel were traced, round by round."""
    counts, add_rays = [], SceneTransport.add_rays

    def noted(self, count, *arguments):
        counts.append(count)
        return add_rays(self, count, *arguments)

    monkeypatch.setattr(SceneTransport, "add_rays", noted)
    return counts


def test_a_scene_opened_again_traces_no_rays(scene, traced):
    """Another session finds the rays of the first, and the very same light."""
    first = light_of(scene)
    assert traced == [64, 64]
    again = light_of(scene)
    assert traced == [64, 64]
    assert [light.rays for light in again[-1:]] == [128]
    assert again[-1] == first[-1]


def test_other_colours_need_no_other_rays(scene, traced, tmp_path):
    """Kept rays do not depend on albedos; only the light of an hour does."""
    grey = light_of(scene)[-1]
    white = light_of(Show(path=str(box_file(tmp_path, colour=0.9))))[-1]
    assert traced == [64, 64]
    assert white != grey


def test_another_shape_needs_its_own_rays(scene, traced, tmp_path):
    """A box of another size is another scene."""
    light_of(scene)
    light_of(Show(path=str(box_file(tmp_path, "larger.obj", boxes=((0.0, 2.5),)))))
    assert traced == [64, 64, 64, 64]


def test_rays_after_another_first_round_have_other_patches(traced):
    """The first round tells which texels lie inside bodies, and so what patches are: rays that end
    on the patches of other rounds are not taken, even where all rounds together are as many."""
    scene = quads(*box((0, -0.5, 0), (1, 0.5, 1)), floor(-2, 3, -2, 3), texels=16)
    now = hour(2.0, irradiance=50.0, key=(0.5, 0.6, 0.3))

    def light_after(add, *rounds):
        transport = SceneTransport(*scene)
        for count in rounds:
            add(transport, count)
        return transport.light(now).texels

    light_after(SceneTransport.add_cached_rays, 16, 48)
    kept = light_after(SceneTransport.add_cached_rays, 48, 16)
    assert traced == [16, 48, 48, 16]
    np.testing.assert_array_equal(kept, light_after(SceneTransport.add_rays, 48, 16))


def test_rays_of_two_rounds_may_be_traced_at_once():
    """A still's rays are kept for a window, which asks for them round by round."""
    scene = quads(*box((0, -0.5, 0), (1, 0.5, 1)), floor(-2, 3, -2, 3), texels=16)
    tables = []
    for rounds in ((16, 16, 32), (16, 48)):
        transport = SceneTransport(*scene)
        for count in rounds:
            transport.add_rays(count)
        tables.append(transport.table)
    for by_rounds, at_once in zip(*tables, strict=True):
        np.testing.assert_array_equal(by_rounds, at_once)


def test_damaged_files_are_traced_again(scene, traced, tmp_path):
    """Half a file, or one that a foreign program wrote, is as good as none."""
    first = light_of(scene)
    wait_for_rays()
    kept = sorted((tmp_path / "cache").rglob("light_maps/*.arrays"))
    assert len(kept) == 2
    kept[0].write_bytes(kept[0].read_bytes()[:-100])
    kept[1].write_bytes(b"no rays")
    assert light_of(scene)[-1] == first[-1]
    assert traced == [64] * 4
    assert light_of(scene)[-1] == first[-1]
    assert traced == [64] * 4


def test_a_folder_that_cannot_be_written_costs_nothing_but_time(scene, traced, tmp_path):
    """Light comes all the same."""
    first = light_of(scene)
    for path in (tmp_path / "cache").rglob("*.arrays"):
        path.unlink()
    folder = next((tmp_path / "cache").rglob("light_maps"))
    folder.rmdir()
    folder.write_bytes(b"a file in its place")
    assert light_of(scene)[-1] == first[-1]
