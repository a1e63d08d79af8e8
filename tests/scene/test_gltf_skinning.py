"""Morph targets, skins and instances: the rest that a file describes is what is shown."""

from typing import Any

import numpy as np
import pytest
from loaded_scenes import WriteScene, add_array, face_normals, give
from scene_files import SQUARE

from vrut_lite.errors import UserError
from vrut_lite.scene.loading import LoadedScene, OpenScene, load_scene

# Khronos' SimpleSkin and SimpleMorph in small: a sheet with two joints, a square with two targets.
UP = np.array([[0, 0, 1]] * 4, "<f4")


def _skinned(document: dict[str, Any], *, with_inverse: bool = True) -> None:
    """The square hangs on two joints, its lower edge on the first and its upper on the second.

    The joints stood at (0, 0) and (0, 1) when it was bound; the second has been turned since, by 90
    degrees about Z, and the node that places the mesh stands far away, which must not matter.
    """
    joints = np.zeros((4, 4), "u1")
    joints[2:, 0] = 1
    weights = np.zeros((4, 4), "<f4")
    weights[:, 0] = 1
    give(document, JOINTS_0=add_array(document, joints), WEIGHTS_0=add_array(document, weights))
    inverse = np.stack([np.eye(4), np.eye(4)]).astype("<f4")
    inverse[1, 1, 3] = -1
    stored = np.ascontiguousarray(inverse.swapaxes(1, 2)).reshape(2, 16)
    document["skins"] = [{"joints": [1, 2]}]
    if with_inverse:
        number = add_array(document, stored[:, :1], type="MAT4")
        data = stored.tobytes()
        document["bufferViews"][-1]["byteLength"] = len(data)
        _replace_buffer(document, data)
        document["skins"][0]["inverseBindMatrices"] = number
    half = np.sqrt(0.5)
    document["nodes"] = [
        {"mesh": 0, "skin": 0, "translation": [100, 200, 300]},
        {"children": [2], "name": "root"},
        {"translation": [0, 1, 0], "rotation": [0, 0, half, half], "name": "elbow"},
    ]
    document["scenes"][0]["nodes"] = [0, 1]


def _replace_buffer(document: dict[str, Any], data: bytes) -> None:
    import base64

    uri = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
    document["buffers"][-1] = {"uri": uri, "byteLength": len(data)}


def _vertices(scene: LoadedScene) -> np.ndarray:
    corners = [place.world_triangles().reshape(-1, 3) for place in scene.meshes]
    return np.unique(np.concatenate(corners).round(6), axis=0)


def test_a_skin_stands_as_its_joints_do(write_square: WriteScene) -> None:
    """Vertices follow their joints; the node of a skinned mesh moves nothing (SimpleSkin)."""
    scene = load_scene(write_square(_skinned))
    # About (0, 1) by 90 degrees: (1, 1) -> (0, 2), and (0, 1) stays.
    expected = np.unique([[0, 0, 0], [1, 0, 0], [0, 2, 0], [0, 1, 0]], axis=0)
    np.testing.assert_allclose(_vertices(scene), expected, atol=1e-6)
    assert scene.notices == ()


def test_normals_bend_with_the_skin(write_square: WriteScene) -> None:
    """A joint that is turned about X turns the normals of its vertices too."""

    def edit(document: dict[str, Any]) -> None:
        _skinned(document)
        give(document, NORMAL=add_array(document, UP))
        half = np.sqrt(0.5)
        document["nodes"][2]["rotation"] = [half, 0, 0, half]

    normals = load_scene(write_square(edit)).meshes[0].mesh.normals
    np.testing.assert_allclose(normals[:2], [[0, 0, 1]] * 2, atol=1e-6)
    np.testing.assert_allclose(normals[2:], [[0, -1, 0]] * 2, atol=1e-6)


def test_a_mirrored_skeleton_keeps_its_outside(write_square: WriteScene) -> None:
    """Joints below a mirroring node turn triangles inside out, and they are wound back."""

    def edit(document: dict[str, Any]) -> None:
        _skinned(document)
        document["nodes"][2]["rotation"] = [0, 0, 0, 1]
        document["nodes"][1]["scale"] = [-1, 1, 1]

    np.testing.assert_allclose(face_normals(load_scene(write_square(edit))), [[0, 0, 1]] * 2)


def test_joints_outside_the_scene_are_told(write_square: WriteScene) -> None:
    """A skin whose joints nothing places cannot be posed: the mesh stands where its node does."""

    def edit(document: dict[str, Any]) -> None:
        _skinned(document)
        document["scenes"][0]["nodes"] = [0]

    scene = load_scene(write_square(edit))
    assert scene.notices == ("skin whose joints are not in the scene: unbent",)
    np.testing.assert_allclose(scene.lower_m, [100, 200, 300])


@pytest.mark.parametrize("broken", ["joint", "weights", "matrices"])
def test_a_broken_skin_is_refused(write_square: WriteScene, broken: str) -> None:
    """Joints that are not there, missing weights and missing matrices give one sentence."""

    def edit(document: dict[str, Any]) -> None:
        _skinned(document)
        attributes = document["meshes"][0]["primitives"][0]["attributes"]
        if broken == "joint":
            give(document, JOINTS_0=add_array(document, np.full((4, 4), 7, "u1")))
        elif broken == "weights":
            del attributes["WEIGHTS_0"]
        else:
            document["accessors"][document["skins"][0]["inverseBindMatrices"]]["count"] = 1

    with pytest.raises(UserError, match=r"skin"):
        load_scene(write_square(edit))


def _morphed(document: dict[str, Any]) -> None:
    targets = []
    for axis in (0, 2):
        delta = np.zeros((4, 3), "<f4")
        delta[2:, axis] = 1
        targets.append({"POSITION": add_array(document, delta)})
    document["meshes"][0]["primitives"][0]["targets"] = targets


@pytest.mark.parametrize("holder", ["mesh", "node"])
def test_default_weights_of_morph_targets(write_square: WriteScene, holder: str) -> None:
    """A face that smiles by default smiles; a node's weights go before its mesh's."""

    def edit(document: dict[str, Any]) -> None:
        _morphed(document)
        document["meshes"][0]["weights"] = [0.5, 0.25]
        if holder == "node":
            document["nodes"][0]["weights"] = [0, 2]

    upper = load_scene(write_square(edit)).upper_m
    np.testing.assert_allclose(upper, [1.5, 1, 0.25] if holder == "mesh" else [1, 1, 2])


def test_morphing_turns_computed_normals(write_square: WriteScene) -> None:
    """Without normals in the file, those of the moved triangles are computed."""

    def edit(document: dict[str, Any]) -> None:
        _morphed(document)
        document["meshes"][0]["weights"] = [0, 1]

    mesh = load_scene(write_square(edit)).meshes[0].mesh
    np.testing.assert_allclose(mesh.normals, [[0, -(0.5**0.5), 0.5**0.5]] * 4, atol=1e-6)


def test_instances_stand_where_they_are_listed(write_square: WriteScene) -> None:
    """EXT_mesh_gpu_instancing: one mesh, many places, in the axes of its node, as bytes too."""

    def edit(document: dict[str, Any]) -> None:
        document["extensionsRequired"] = ["EXT_mesh_gpu_instancing"]
        places = np.array([[0, 0, 0], [2, 0, 0], [4, 0, 0]], "<f4")
        turns = np.array([[0, 0, 0, 127], [0, 0, 90, 90], [0, 0, 127, 0]], "<i1")
        attributes = {
            "TRANSLATION": add_array(document, places),
            "ROTATION": add_array(document, turns, normalized=True),
        }
        document["nodes"][0] |= {
            "translation": [0, 0, 5],
            "extensions": {"EXT_mesh_gpu_instancing": {"attributes": attributes}},
        }

    scene = load_scene(write_square(edit))
    assert len({id(place.mesh) for place in scene.meshes}) == 1
    boxes = [place.world_triangles().reshape(-1, 3) for place in scene.meshes]
    lowest = [box.min(axis=0) for box in boxes]
    np.testing.assert_allclose(lowest, [[0, 0, 5], [1, 0, 5], [3, -1, 5]], atol=1e-6)


# --- animations -----------------------------------------------------------------------------


def _animated(interpolation: str, values: np.ndarray, path: str = "translation") -> Any:
    def edit(document: dict[str, Any]) -> None:
        times = np.array([0, 1, 2], "<f4")
        sampler = {
            "input": add_array(document, times),
            "output": add_array(document, values.astype("<f4")),
            "interpolation": interpolation,
        }
        channel = {"sampler": 0, "target": {"node": 0, "path": path}}
        document["animations"] = [{"channels": [channel], "samplers": [sampler]}]

    return edit


ALONG = np.array([[0, 0, 0], [4, 0, 0], [4, 8, 0]])


@pytest.mark.parametrize(
    ("interpolation", "time_s", "expected"),
    [
        ("LINEAR", 0.5, [2, 0, 0]),
        ("LINEAR", 1.75, [4, 6, 0]),
        ("LINEAR", 2.0, [4, 8, 0]),
        ("LINEAR", 2.5, [2, 0, 0]),
        ("STEP", 0.9, [0, 0, 0]),
        ("STEP", 1.0, [4, 0, 0]),
    ],
)
def test_a_node_moves_along_its_keys(
    write_square: WriteScene, interpolation: str, time_s: float, expected: list[float]
) -> None:
    """Between keys the node is where the file says; after the end all begins anew
    (InterpolationTest)."""
    scene = OpenScene(write_square(_animated(interpolation, ALONG)))
    assert scene.duration_s == 2.0
    np.testing.assert_allclose(scene.at(time_s).lower_m, expected, atol=1e-6)


def test_a_spline_follows_its_tangents(write_square: WriteScene) -> None:
    """Hermite's cubic with tangents of the straight line is the straight line."""
    keys = np.zeros((9, 3))
    keys[1::3, 0] = [0, 3, 6]
    keys[0::3, 0] = keys[2::3, 0] = 3
    scene = OpenScene(write_square(_animated("CUBICSPLINE", keys)))
    np.testing.assert_allclose(scene.at(0.3).lower_m, [0.9, 0, 0], atol=1e-6)


def test_a_turn_takes_the_shorter_way(write_square: WriteScene) -> None:
    """Quaternions of opposite sign are the same turn: half of 90 degrees is 45, not 225."""
    half = np.sqrt(0.5)
    turns = np.array([[0, 0, 0, 1], [0, 0, -half, -half], [0, 0, -half, -half]])
    place = OpenScene(write_square(_animated("LINEAR", turns, "rotation"))).at(0.5).meshes[0]
    np.testing.assert_allclose(place.world_from_model[:2, 0], [half, half], atol=1e-6)


def test_weights_and_joints_move_too(write_square: WriteScene) -> None:
    """A clip may move morph targets and the joints of a skin; the rest comes back afterwards."""

    def edit(document: dict[str, Any]) -> None:
        _morphed(document)
        _animated("LINEAR", np.array([[0, 0], [0, 2], [0, 0]]).reshape(-1, 1), "weights")(document)

    scene = OpenScene(write_square(edit))
    for time_s, depth in ((0.0, 0.0), (1.0, 2.0), (0.5, 1.0), (None, 0.0)):
        assert scene.at(time_s).upper_m[2] == pytest.approx(depth)

    def bent(document: dict[str, Any]) -> None:
        _skinned(document)
        _animated("LINEAR", ALONG)(document)
        document["animations"][0]["channels"][0]["target"]["node"] = 1

    np.testing.assert_allclose(OpenScene(write_square(bent)).at(1.0).lower_m, [4, 0, 0], atol=1e-6)


def test_posing_takes_no_more_memory_each_time(write_square: WriteScene) -> None:
    """A clip may play for hours: what a pose took is given back to the budget."""
    from vrut_lite.scene.budget import SceneBudget

    def edit(document: dict[str, Any]) -> None:
        _skinned(document)
        _morphed(document)
        _animated("LINEAR", np.array([[0, 0], [0, 2], [0, 0]]).reshape(-1, 1), "weights")(document)

    budget = SceneBudget(2**30)
    scene = OpenScene(write_square(edit), budget)
    scene.at(0.5)
    before = budget.peak_bytes
    for step in range(50):
        scene.at(step / 50)
    assert budget.peak_bytes <= before


def test_a_scene_at_rest_says_so(write_square: WriteScene) -> None:
    """An animation that is not played is a notice; one that is played is none."""
    scene = OpenScene(write_square(_animated("LINEAR", ALONG)))
    (line,) = scene.at(None).notices
    assert line.startswith("animations of 2 s: at rest")
    assert scene.at(1.0).notices == ()


def test_a_camera_moves_with_its_node(write_square: WriteScene) -> None:
    """The file's own camera stands where the animation has it, at rest where its node rests."""

    def edit(document: dict[str, Any]) -> None:
        _animated("LINEAR", ALONG)(document)
        document["cameras"] = [{"type": "perspective", "perspective": {"yfov": 1.0, "znear": 0.1}}]
        document["nodes"][0]["camera"] = 0

    scene = OpenScene(write_square(edit))
    for time_s in (None, 0.5, 1.5):
        posed = scene.at(time_s)
        assert posed.camera is not None
        moved = posed.meshes[0].world_from_model
        np.testing.assert_allclose(posed.camera.world_from_camera[:3, 3], moved[:3, 3])
    assert moved[:3, 3].any()


@pytest.mark.parametrize("broken", ["order", "width", "missing", "infinite"])
def test_broken_keys_are_refused(write_square: WriteScene, broken: str) -> None:
    """Keys out of order, of the wrong number, missing or infinite give one sentence."""

    def edit(document: dict[str, Any]) -> None:
        values = np.full((3, 3), np.inf) if broken == "infinite" else ALONG
        _animated("LINEAR", values)(document)
        animation = document["animations"][0]
        if broken == "order":
            animation["samplers"][0]["input"] = add_array(document, np.array([0, 2, 1], "<f4"))
        elif broken == "width":
            animation["channels"][0]["target"]["path"] = "rotation"
        elif broken == "missing":
            animation["samplers"][0]["output"] = 99

    with pytest.raises(UserError):
        load_scene(write_square(edit))


def test_the_square_itself() -> None:
    """The tests above count on it."""
    np.testing.assert_array_equal(SQUARE[2], [1, 1, 0])
