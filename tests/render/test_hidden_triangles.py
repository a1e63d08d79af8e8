"""Of meshes in a finished picture only triangles are drawn of which something is seen."""

from types import SimpleNamespace

import numpy as np
import pytest
import trimesh
from box_stage import sun_at, uniform_sky
from scene_stage import light, look
from stateful_backend import opened

from vrut_lite.render.passes import mesh_renderer, triangles
from vrut_lite.render.passes.triangles import Run, joined, runs_of

pytestmark = pytest.mark.gl
EYE, TARGET = (0.3, 1.2, 9.0), (0.0, 1.0, 0.0)


@pytest.fixture
def drawn(monkeypatch):
    """Triangles that were drawn in colour, counted from the runs."""
    count = {"triangles": 0}
    draw_side = mesh_renderer.draw_side

    def counted(primitive, side, blended=False, runs=None):
        if runs is None:
            count["triangles"] += primitive.indices.size // 3
        else:
            count["triangles"] += sum(run.triangles for run in runs)
        draw_side(primitive, side, blended, runs)

    monkeypatch.setattr(mesh_renderer, "draw_side", counted)
    return count


def test_what_is_hidden_is_left_out_and_the_picture_stays(
    shared_gl_backend, tmp_path, monkeypatch, drawn
):
    """One mesh of a wall and forty boxes behind it, and two before it."""
    boxes = [trimesh.creation.box((5.0, 3.0, 0.2)).apply_translation((0, 1.5, 3.0))]
    for number in range(40):
        box = trimesh.creation.box((0.4, 0.4, 0.4))
        boxes.append(box.apply_translation((0.1 * number - 2.0, 0.5, -0.5 * number)))
    boxes += [trimesh.creation.box((0.5,) * 3).apply_translation((x, 0.4, 4)) for x in (-1, 1)]
    path = tmp_path / "boxes.glb"
    trimesh.util.concatenate(boxes).export(path)
    backend = shared_gl_backend(size_px=(160, 120), scene=opened(path))
    light(backend, uniform_sky(1.0), sun_direction=sun_at(35.0, 40.0), sun_irradiance=(9, 8, 7))
    monkeypatch.setattr(mesh_renderer, "_SHORTEST_RUN", 10**6)
    whole = look(backend, EYE, TARGET)
    of_whole = drawn["triangles"]
    monkeypatch.setattr(mesh_renderer, "_SHORTEST_RUN", 12)
    drawn["triangles"] = 0
    parts = look(backend, EYE, TARGET)
    np.testing.assert_array_equal(parts.radiance, whole.radiance)
    # The ground is a mesh of its own.
    assert of_whole - drawn["triangles"] == 12 * 40


def test_runs_hold_each_triangle_once():
    """The last is shorter; neighbours are joined, and points have none."""
    mesh = SimpleNamespace(indices=np.arange(3 * 100), mode=triangles.GL.GL_TRIANGLES)
    runs = runs_of(mesh, 48)
    assert runs == (Run(0, 48), Run(48, 48), Run(96, 4))
    assert joined(runs) == (Run(0, 100),)
    assert joined([runs[0], runs[2]]) == (runs[0], runs[2])
    assert joined([]) == ()
    assert (
        triangles.runs_of(SimpleNamespace(indices=None, mode=triangles.GL.GL_TRIANGLES), 48) == ()
    )
    assert runs_of(SimpleNamespace(indices=np.arange(4), mode=triangles.GL.GL_LINES), 48) == ()
