"""A still's light, its layout and that one's cut texels kept on disk: the same bytes, sooner."""

import numpy as np
import pytest
from boxes import box, floor, quads
from light_stage import COARSE, LightStage, Look, Shine, Show, box_file, lights
from light_transport import transport, transport_files
from light_transport.transport import SceneTransport
from light_transport.transport_files import cached_split_texels

from vrut_lite.kernel.messages import LARGEST_DEMAND, Demand, JobResult
from vrut_lite.messages.light_map import SurfaceLightChanged
from vrut_lite.messages.view_light import ViewLightChanged

STILL = (
    Demand(consumer="still", message=SurfaceLightChanged.__name__, size=LARGEST_DEMAND),
    Demand(consumer="still", message=ViewLightChanged.__name__),
)
LOOK, ELSEWHERE = Look(eye_m=(3.0, 4.0, 5.0)), Look(eye_m=(4.0, 4.0, 5.0))
NOON, LATER = Shine(radiance=1.0, irradiance=3.0), Shine(radiance=1.5, irradiance=3.0)


@pytest.fixture
def made(monkeypatch):
    """What was computed, in order."""
    names = []

    def note(module, name):
        work = getattr(module, name)

        def noted(*arguments, **named):
            names.append(name)
            return work(*arguments, **named)

        monkeypatch.setattr(module, name, noted)

    note(transport, "hour_light")
    note(transport, "view_light")
    note(transport_files, "split_texels")
    note(transport, "lay_out")
    return names


@pytest.fixture
def scene(tmp_path):
    return Show(path=str(box_file(tmp_path)))


def still_of(scene, look=LOOK, hour=NOON):
    """The last light of a map and of a view, by another session."""
    said = told(scene, look, hour)
    views = [message for message in said if isinstance(message, ViewLightChanged)]
    return lights(said)[-1], views[-1]


def told(scene, look=LOOK, hour=NOON):
    """All that is told of a still."""
    stage = LightStage()
    said = stage.tell(*COARSE, *STILL, hour, look, scene)
    stage.kernel.close()
    assert stage.kernel.last_fault("light_transport") is None
    return said


def kept(tmp_path, name):
    return sorted((tmp_path / "cache").rglob(f"{name}/*.arrays"))


def test_a_still_made_again_computes_no_light(scene, made):
    """Another session finds the layout and both lights of the first, and says the same, to the
    byte: layout, rounds of rays and light."""
    first = [message for message in told(scene) if not isinstance(message, JobResult)]
    assert sorted(made) == ["hour_light", "lay_out", "split_texels", "view_light"]
    made.clear()
    again = [message for message in told(scene) if not isinstance(message, JobResult)]
    assert again == first
    assert made == []


def test_another_view_hour_or_colour_has_light_of_its_own(scene, made, tmp_path):
    """Nothing is taken that was made of anything else."""
    first = still_of(scene)
    made.clear()
    other_view = still_of(scene, look=ELSEWHERE)
    assert sorted(made) == ["hour_light", "lay_out", "view_light"]
    assert other_view[0] == first[0]
    for other in (
        still_of(scene, hour=LATER),
        still_of(Show(path=str(box_file(tmp_path, "white.obj", colour=0.9)))),
    ):
        assert other[0] != first[0]
        assert other[1] != first[1]
    assert made.count("view_light") == 3


def test_damaged_files_are_made_again(scene, made, tmp_path):
    """Half a file is as good as none."""
    first = still_of(scene)
    files = [*kept(tmp_path, "still_light"), *kept(tmp_path, "cut_texels")]
    assert len(files) == 3
    for path in files:
        path.write_bytes(path.read_bytes()[:-100])
    made.clear()
    assert still_of(scene) == first
    assert sorted(made) == ["hour_light", "lay_out", "split_texels", "view_light"]


def test_cut_texels_are_the_same_read_as_found(made):
    """All arrays of a bake; texels of another size are cut anew."""
    scene = quads(*box((0, -0.5, 0), (1, 0.5, 1)), floor(-2, 3, -2, 3), texels=16)
    finer = quads(*box((0, -0.5, 0), (1, 0.5, 1)), floor(-2, 3, -2, 3), texels=24)
    found, read = (SceneTransport(*scene, cut=cached_split_texels) for _ in range(2))
    assert made == ["split_texels"]
    assert len(found.texels.cell_row)
    for one, other in zip(found.arrays, read.arrays, strict=True):
        assert one.dtype == other.dtype
        np.testing.assert_array_equal(one, other)
    SceneTransport(*finer, cut=cached_split_texels)
    assert made == ["split_texels"] * 2
