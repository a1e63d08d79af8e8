"""Files of others lie on their side, are in centimetres, and name textures as Windows does."""

from pathlib import Path

import numpy as np
import pytest
import trimesh
from loaded_scenes import WriteScene
from scene_files import png_bytes

from vrut_lite.errors import UserError
from vrut_lite.messages.placement import PlacedFile, Placement
from vrut_lite.scene.loading import load_scene

AS_IT_IS = np.eye(4)


def _write(path: Path, *meshes: trimesh.Trimesh, matrix: np.ndarray = AS_IT_IS) -> Path:
    """The meshes, which stand along +Y, as an OBJ file under a matrix."""
    joined = trimesh.util.concatenate([mesh.copy() for mesh in meshes])
    joined.apply_transform(matrix)
    path.write_text(trimesh.exchange.obj.export_obj(joined, include_normals=False))
    return path


def _box(size: tuple[float, float, float], low: tuple[float, float, float]) -> trimesh.Trimesh:
    lower = np.array(low)
    return trimesh.creation.box(bounds=[lower, lower + size])


def _house() -> list[trimesh.Trimesh]:
    """A house of 8 x 6 x 10 m on a plot of 20 x 24 m."""
    return [_box((20, 0.1, 24), (-10, -0.1, -12)), _box((8, 6, 10), (-4, 0, -5))]


Z_UP = np.array([[1, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1.0]])


def test_a_house_that_lies_on_its_side_is_put_upright(tmp_path: Path) -> None:
    """A Z-up house stands on its plot, is told so, and may be said to lie all the same."""
    upright = load_scene(_write(tmp_path / "y.obj", *_house()))
    path = _write(tmp_path / "z.obj", *_house(), matrix=Z_UP)
    turned = load_scene(path)
    assert upright.notices == ()
    np.testing.assert_allclose(turned.lower_m, upright.lower_m)
    np.testing.assert_allclose(turned.upper_m, upright.upper_m)
    assert len(turned.notices) == 1
    assert "stand along +Z" in turned.notices[0]
    lying = load_scene(path, placement=Placement(up="y"))
    assert lying.notices == ()
    np.testing.assert_allclose(lying.upper_m[2], 6)


def test_land_that_lies_on_its_side_is_put_upright(tmp_path: Path) -> None:
    """Hills have no floor: they are known as a sheet that faces up, along either axis."""
    x, y = np.meshgrid(np.linspace(0.0, 200.0, 21), np.linspace(0.0, 200.0, 21))
    hills = np.stack([x, 9.0 + 9.0 * np.sin(0.1 * x) * np.cos(0.07 * y), -y], axis=-1)
    first = (21 * np.arange(20)[:, None] + np.arange(20)).ravel()
    faces = np.concatenate(
        [first[:, None] + [0, 1, 21], first[:, None] + [1, 22, 21]],
    )
    land = trimesh.Trimesh(hills.reshape(-1, 3), faces, process=False)
    for matrix, up in ((AS_IT_IS, "y"), (Z_UP, "z")):
        scene = load_scene(_write(tmp_path / "land.obj", land, matrix=matrix))
        assert scene.placement.up == up
        assert scene.upper_m[1] - scene.lower_m[1] == pytest.approx(18.0, abs=0.5)


def test_a_room_open_to_its_front_stays_upright(tmp_path: Path) -> None:
    """A back wall is no floor where there is a floor: Cornell's box stands as it is."""
    box = trimesh.creation.box(bounds=[[0, 0, 0], [3, 3, 3]])
    box.update_faces(box.face_normals[:, 2] < 0.5)
    assert load_scene(_write(tmp_path / "cornell.obj", box)).placement.up == "y"


def test_a_wall_and_a_statue_stay_upright(tmp_path: Path) -> None:
    """A flat scene, or one on a small foot, says nothing of its axis; a flat one, which may be a
    floor of a program whose axis is Z, has a notice."""
    wall = load_scene(_write(tmp_path / "a.obj", _box((9, 4, 0.1), (0, 0, 0))))
    assert wall.notices == ("flat and upright (else --up z, or Up in the Scene panel)",)
    np.testing.assert_allclose(wall.upper_m, [9, 4, 0.1])
    for panel in (_box((0, 2, 2), (1, 0, 0)), _box((2, 2, 0), (0, 0, 0))):
        assert load_scene(_write(tmp_path / "a.obj", panel)).notices == ()
    statue = trimesh.creation.icosphere(subdivisions=2)
    assert load_scene(_write(tmp_path / "a.obj", statue)).notices == ()
    lying = load_scene(tmp_path / "a.obj", placement=Placement(up="y"))
    assert lying.notices == ()


@pytest.mark.parametrize("size", [(8, 6, 10), (14, 6, 18)])
def test_a_skirt_hides_no_floor(tmp_path: Path, size: tuple[float, float, float]) -> None:
    """A Z-up house on land with a skirt of a metre has no face at its lowest end but sides; the
    largest level area is its floor all the same. So upright ones stay."""
    skirt = _box((20, 1, 24), (-10, -1, -12))
    skirt.update_faces(skirt.face_normals[:, 1] > -0.5)
    house = _box(size, (-size[0] / 2, 0, -size[2] / 2))
    for matrix, up in ((AS_IT_IS, "y"), (Z_UP, "z")):
        scene = load_scene(_write(tmp_path / "a.obj", skirt, house, matrix=matrix))
        assert scene.placement.up == up
        np.testing.assert_allclose([scene.lower_m[1], scene.upper_m[1]], [-1, 6])


def test_a_tower_and_a_facade_without_ground_stay_upright(tmp_path: Path) -> None:
    """A wall larger than every floor is no floor, where there are floors."""
    floors = [_box((10, 0.3, 10), (0, 3.0 * k, 0)) for k in range(30)]
    back = _box((10, 90, 0.3), (0, 0, 0))
    assert load_scene(_write(tmp_path / "a.obj", *floors, back)).placement.up == "y"


def test_a_glb_that_lies_on_its_side_has_a_hint(tmp_path: Path) -> None:
    """glTF is +Y up by its standard and stays so; a floor across Z has a notice."""
    for matrix, count in ((AS_IT_IS, 0), (Z_UP, 1)):
        joined = trimesh.util.concatenate(_house())
        joined.apply_transform(matrix)
        (tmp_path / "a.glb").write_bytes(joined.export(file_type="glb"))
        scene = load_scene(tmp_path / "a.glb")
        assert scene.placement.up == "y"
        hints = [line for line in scene.notices if "largest level area" in line]
        assert len(hints) == count


@pytest.mark.parametrize(("depth_m", "count"), [(0.6, 0), (0.9, 1)])
def test_a_board_that_shows_things_has_no_hint(tmp_path: Path, depth_m: float, count: int) -> None:
    """A board of 6 x 8 m with balls in rows before it, as of Khronos's ClearCoatTest, is upright
    though its largest area is across Z; what is deeper than 0.12 of its shorter side may be a
    house. Land as thin keeps its hint."""

    def hints(*meshes: trimesh.Trimesh) -> list[str]:
        joined = trimesh.util.concatenate(list(meshes))
        (tmp_path / "a.glb").write_bytes(joined.export(file_type="glb"))
        return [line for line in load_scene(tmp_path / "a.glb").notices if "level area" in line]

    board = _box((6, 8, 0.05), (0, 0, 0))
    balls = [trimesh.creation.icosphere(1, 0.2) for _ in range(6)]
    for n, ball in enumerate(balls):
        ball.apply_translation([1 + 2 * (n % 3), 2 + 4 * (n // 3), depth_m - 0.2])
    assert len(hints(board, *balls)) == count
    x, y = np.meshgrid(np.linspace(0.0, 6.0, 21), np.linspace(0.0, 8.0, 21))
    hills = np.stack([x, y, depth_m * np.sin(x) * np.sin(0.5 * y)], axis=-1).reshape(-1, 3)
    first = (21 * np.arange(20)[:, None] + np.arange(20)).ravel()
    faces = np.concatenate([first[:, None] + [0, 1, 21], first[:, None] + [1, 22, 21]])
    assert len(hints(trimesh.Trimesh(0.3 * hills * [1, 1, 1], faces, process=False))) == 1


@pytest.mark.parametrize(("units", "name"), [(100, "centimetres"), (1000, "millimetres")])
def test_a_house_that_is_too_high_in_metres(tmp_path: Path, units: float, name: str) -> None:
    """A house of 600 or 6,000 units is one of 6 m, and its Z-up twin too; a unit said outright
    holds."""
    for matrix in (AS_IT_IS, Z_UP):
        scaled = np.diag([units, units, units, 1.0]) @ matrix
        path = _write(tmp_path / "house.obj", *_house(), matrix=scaled)
        scene = load_scene(path)
        np.testing.assert_allclose(scene.upper_m, [10, 6, 12])
        assert any(name in line for line in scene.notices)
    plain = load_scene(path, placement=Placement(metres_per_unit=1.0))
    np.testing.assert_allclose(plain.upper_m, np.array([10, 6, 12]) * units)


def test_a_plot_does_not_hide_the_unit_of_its_house(tmp_path: Path) -> None:
    """A house of 480 on a plot of 2,500 is in centimetres; land as high and wide is in metres."""
    plot = _box((2500, 1, 2000), (-1200, -1, -1000))
    house = load_scene(_write(tmp_path / "house.obj", plot, _box((900, 480, 600), (0, 0, 0))))
    np.testing.assert_allclose(house.upper_m, [13, 4.8, 10])
    assert any("centimetres" in line for line in house.notices)
    land = trimesh.creation.cone(radius=1400, height=480)
    land.apply_transform(trimesh.transformations.rotation_matrix(-np.pi / 2, [1, 0, 0]))
    land = land.subdivide().subdivide().subdivide()
    assert load_scene(_write(tmp_path / "land.obj", land)).upper_m[1] == pytest.approx(480)


def test_terrain_and_towns_keep_their_metres(tmp_path: Path) -> None:
    """What is high but far wider is large, not in centimetres."""
    town = [_box((5000, 1, 5000), (0, -1, 0)), _box((60, 420, 60), (2000, 0, 2000))]
    assert load_scene(_write(tmp_path / "town.obj", *town)).notices == ()


def test_a_gltf_in_centimetres_is_left_and_told(write_square: WriteScene) -> None:
    """glTF is in metres by its standard: a square of 400 m stays, with a line, unless it is said to
    be as high as that."""
    path = write_square(lambda document: document["nodes"][0].update(scale=[400, 400, 400]))
    scene = load_scene(path)
    assert scene.upper_m[1] == 400
    assert scene.notices[0].startswith("400 m high, by the file's own unit")
    assert load_scene(path, placement=Placement(metres_per_unit=1.0)).notices == ()


def test_paths_as_windows_writes_them(tmp_path: Path) -> None:
    """Backslashes part folders, and a path of another machine means the file beside the scene."""
    (tmp_path / "maps").mkdir()
    for name in ("maps/brick.png", "tile.png"):
        (tmp_path / name).write_bytes(png_bytes((8, 4)))
    (tmp_path / "a.mtl").write_text(
        "newmtl brick\nmap_Kd maps\\brick.png\nnewmtl tile\nmap_Kd C:\\my work\\tile.png\n"
    )
    corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n"
    faces = "usemtl brick\nf 1/1 2/2 3/3\nusemtl tile\nf 1/1 2/2 3/3\n"
    (tmp_path / "a.obj").write_text(f"mtllib .\\a.mtl\n{corners}{faces}")
    scene = load_scene(tmp_path / "a.obj")
    sizes = [place.mesh.material.baseColorTexture.size for place in scene.meshes]
    assert sizes == [(8, 4), (8, 4)]
    for path in (r"D:\job\maps\brick.png", r"D:\..\maps\brick.png", r"D:\job\brick.png"):
        (tmp_path / "a.mtl").write_text(f"newmtl brick\nmap_Kd {path}\n")
        scene = load_scene(tmp_path / "a.obj")
        found = [place.mesh.material.baseColorTexture is not None for place in scene.meshes]
        assert any(found) == ("maps" in path)
    (tmp_path / "a.mtl").write_text("newmtl brick\nmap_Kd ..\\..\\maps\\brick.png\n")
    scene = load_scene(tmp_path / "a.obj")
    assert any(place.mesh.material.baseColorTexture is not None for place in scene.meshes)


def test_scenes_beside_each_other(tmp_path: Path) -> None:
    """Each file stands where it is placed, turned clockwise and in its own unit; a file that stands
    in two places is read once."""
    house = _write(tmp_path / "house.obj", *_house())
    shed = _write(tmp_path / "shed.obj", _box((200, 300, 600), (0, 0, -600)))

    def stood(x: float, heading_deg: float) -> PlacedFile:
        place = Placement(
            metres_per_unit=0.01, position_m=(x, 0.0, 0.0), heading_deg=heading_deg, up="y"
        )
        return PlacedFile(scene=str(shed), placement=place)

    scene = load_scene(house, beside=(stood(20.0, 0.0), stood(30.0, 90.0)))
    assert scene.triangles == 4 * 12
    meshes = [id(place.mesh) for place in scene.meshes]
    assert meshes[-1] == meshes[-2]
    first, second = (place.world_triangles().reshape(-1, 3) for place in scene.meshes[-2:])
    np.testing.assert_allclose([first.min(0), first.max(0)], [[20, 0, -6], [22, 3, 0]])
    # What pointed north (-Z) points east (+X).
    np.testing.assert_allclose([second.min(0), second.max(0)], [[30, 0, 0], [36, 3, 2]], atol=1e-12)


def test_a_broken_file_beside_is_named(tmp_path: Path) -> None:
    """The sentence names that one of several files which cannot be opened."""
    house = _write(tmp_path / "house.obj", *_house())
    with pytest.raises(UserError, match=r"cannot open the scene .*tree\.glb: there is no such"):
        load_scene(house, beside=(PlacedFile(scene=str(tmp_path / "tree.glb")),))
