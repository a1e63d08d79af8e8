"""Points and lines of glTF files stand where their nodes place them, in their own colours."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from loaded_scenes import WriteScene, add_array

from vrut_lite.errors import UserError
from vrut_lite.messages.points_and_lines import PointsAndLines
from vrut_lite.scene.budget import SceneBudget
from vrut_lite.scene.loading import OpenScene, load_scene

CORNERS = np.array([[0, 0, 0], [1, 0, 0], [1, 2, 0]], "<f4")


def stroked(mode: int, colour: bool = False, order: list[int] | None = None, **node: Any) -> Any:
    """An edit that adds a node with three corners in one of glTF's modes."""

    def edit(document: dict[str, Any]) -> None:
        primitive: dict[str, Any] = {"mode": mode, "attributes": {}, "material": 0}
        primitive["attributes"]["POSITION"] = add_array(document, CORNERS)
        if colour:
            values = np.array([[255, 0, 0, 255]] * 3, "B")
            number = add_array(document, values, normalized=True)
            primitive["attributes"]["COLOR_0"] = number
        if order is not None:
            primitive["indices"] = add_array(document, np.array(order, "<H")[:, None])
        document["materials"][0] = {"pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.5, 1, 1]}}
        document["meshes"].append({"primitives": [primitive]})
        document["nodes"].append({"mesh": len(document["meshes"]) - 1, **node})
        document["scenes"][0]["nodes"].append(len(document["nodes"]) - 1)

    return edit


def found(path: Path) -> PointsAndLines:
    strokes = load_scene(path).points_and_lines
    assert strokes is not None
    strokes.check()
    strokes.check_arrays()
    return strokes


@pytest.mark.parametrize(
    ("mode", "order", "ends"),
    [
        (1, None, [(0, 1)]),
        (1, [2, 0, 1, 2], [(2, 0), (1, 2)]),
        (2, None, [(0, 1), (1, 2), (2, 0)]),
        (3, None, [(0, 1), (1, 2)]),
    ],
)
def test_lines_loops_and_strips_join_their_vertices(
    write_square: WriteScene, mode: int, order: list[int] | None, ends: list[tuple[int, int]]
) -> None:
    """As glTF says of each mode; the node moves them, the material and the vertex colour them."""
    edit = stroked(mode, colour=True, order=order, translation=[0, 5, 0], scale=[2, 2, 2])
    strokes = found(write_square(edit))
    np.testing.assert_allclose(strokes.lines_m.values, 2 * CORNERS[np.array(ends)] + [0, 5, 0])
    np.testing.assert_allclose(strokes.line_rgba.values[..., :3].reshape(-1, 3)[0], [0.5, 0, 0])
    assert not strokes.points_m.shape[0]


def test_points_stand_at_their_vertices(write_square: WriteScene) -> None:
    """Three points of the material's colour."""
    strokes = found(write_square(stroked(0)))
    np.testing.assert_allclose(strokes.points_m.values, CORNERS)
    np.testing.assert_allclose(strokes.point_rgba.values, [[0.5, 0.5, 1, 1]] * 3)


def test_a_scene_without_them_has_none(write_square: WriteScene) -> None:
    """What a scene does not use costs nothing."""
    assert load_scene(write_square()).points_and_lines is None


def test_vertices_that_are_not_there_are_refused(write_square: WriteScene) -> None:
    """In one sentence."""
    with pytest.raises(UserError, match="vertices that are not there"):
        load_scene(write_square(stroked(1, order=[0, 7])))


def test_poses_take_no_more_memory_each(write_square: WriteScene) -> None:
    """Their lines move with their node, and a played animation never fills the budget."""

    def edit(document: dict[str, Any]) -> None:
        stroked(1)(document)
        times, values = np.array([0, 1], "<f4"), np.array([[0, 0, 0], [4, 0, 0]], "<f4")
        sampler = {"input": add_array(document, times), "output": add_array(document, values)}
        channel = {"sampler": 0, "target": {"node": 1, "path": "translation"}}
        document["animations"] = [{"channels": [channel], "samplers": [sampler]}]

    budget = SceneBudget(2**30)
    scene = OpenScene(write_square(edit), budget)
    strokes = scene.at(0.5).points_and_lines
    assert strokes is not None
    assert strokes.lines_m.values[0, 0, 0] == 2.0
    before = budget.peak_bytes
    for step in range(20):
        scene.at(step / 20)
    assert budget.peak_bytes <= before


OBJ = """mtllib a.mtl
v 0 0 0
v 1 0 0
v 1 2 0
v 0 1 0
f 1 2 3
usemtl blue
l 1/1 2/1 4
v 5 5 5
usemtl red
p -1 2
"""


def written(folder: Path, text: str) -> Path:
    (folder / "a.mtl").write_text("newmtl blue\nKd 0 0 1\nnewmtl red\nKd 1 0 0\n")
    (folder / "a.obj").write_text(text)
    return folder / "a.obj"


def test_points_and_lines_of_an_obj_stand_at_their_vertices(tmp_path: Path) -> None:
    """In the colour of the material before them; a line of three vertices is two lines."""
    path = written(tmp_path, OBJ)
    strokes = found(path)
    np.testing.assert_array_equal(strokes.points_m.values, [[5, 5, 5], [1, 0, 0]])
    np.testing.assert_array_equal(
        strokes.lines_m.values, [[[0, 0, 0], [1, 0, 0]], [[1, 0, 0], [0, 1, 0]]]
    )
    assert (strokes.point_rgba.values == [1, 0, 0, 1]).all()
    assert (strokes.line_rgba.values == [0, 0, 1, 1]).all()
    assert any("points or lines (4 times)" in line for line in load_scene(path).notices)


@pytest.mark.parametrize("statement", ["l 1 9", "p 0", "p -9", "l 1 x"])
def test_points_and_lines_of_an_obj_that_lead_nowhere_are_refused(
    tmp_path: Path, statement: str
) -> None:
    """A vertex that is not there, or a word for a number, is one sentence."""
    with pytest.raises(UserError, match="line"):
        load_scene(written(tmp_path, f"{OBJ}{statement}\n"))
