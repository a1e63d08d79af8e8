"""The bundled scenes are valid, and mangled ones are refused."""

import contextlib
import shutil
from pathlib import Path

import numpy as np
import pytest
from light_transport.rays.trace import first_hits
from light_transport.rays.tree import tree_over
from loaded_scenes import front_cosines

from vrut_lite.errors import UserError
from vrut_lite.scene.ground import has_own_ground
from vrut_lite.scene.loading import LoadedScene, load_scene

ROOT = Path(__file__).resolve().parents[2]
SCENES = ROOT / "scenes"
NAMES = ["sundial.glb", "street.obj", "spheres.glb", "pavilion.gltf"]
# About the pavilion's radius with its trees: rays are traced in single precision.
_PAVILION_M = 20.0
ASSETS = {".glb", ".gltf", ".bin", ".obj", ".mtl", ".png"}


def assets() -> list[Path]:
    """All committed files."""
    return sorted(path for path in SCENES.iterdir() if path.suffix in ASSETS)


@pytest.fixture(params=NAMES)
def scene(request: pytest.FixtureRequest) -> LoadedScene:
    """Each of the scenes."""
    return load_scene(SCENES / request.param)


def test_files_are_small() -> None:
    """Each is below 300 kB."""
    assert max(path.stat().st_size for path in assets()) < 300_000


def test_scene_stands_on_level_zero(scene: LoadedScene) -> None:
    """The floor is at height 0; foundations reach at most 25 cm below."""
    assert -0.25 < scene.lower_m[1] <= 0.0
    assert scene.upper_m[1] > 0.9


def test_scene_is_of_real_size(scene: LoadedScene) -> None:
    """Sizes are between those of a garden table and a street, in metres."""
    assert np.all(scene.upper_m - scene.lower_m < 60.0)


def test_scene_leaves_the_horizon_to_the_host(scene: LoadedScene) -> None:
    """No scene has a ground of its own up to the horizon."""
    assert not has_own_ground(scene)


def test_albedo_is_below_nine_tenths(scene: LoadedScene) -> None:
    """No surface reflects more than 90 %, the albedo of fresh snow."""
    for place in scene.meshes:
        material = place.mesh.material
        texture = material.baseColorTexture
        peak = 1.0
        if texture is not None:
            encoded = np.asarray(texture).max() / 255.0
            peak = ((encoded + 0.055) / 1.055) ** 2.4
        assert material.baseColorFactor[:3].max() * peak <= 0.9, material.name


def test_normals_agree_with_the_winding(scene: LoadedScene) -> None:
    """Every vertex normal is on the front side of its triangle: none is inside out."""
    for place in scene.meshes:
        assert front_cosines(place.mesh).min() > 0.1, place.name


def test_cameras_look_at_their_scene() -> None:
    """Each glTF has a level camera at standing height with the middle in view."""
    for name in NAMES:
        scene = load_scene(SCENES / name)
        if name.endswith(".obj"):
            assert scene.camera is None
            continue
        assert scene.camera is not None
        pose = scene.camera.world_from_camera
        np.testing.assert_allclose(pose[:3, :3] @ pose[:3, :3].T, np.eye(3), atol=1e-6)
        assert abs(pose[1, 0]) < 1e-6
        assert 1.5 < pose[1, 3] < 3.0
        ahead = -pose[:3, 2]
        middle = np.array([0.0, 1.0, 0.0]) - pose[:3, 3]
        angle_rad = np.arccos(ahead @ middle / np.linalg.norm(middle))
        assert angle_rad < scene.camera.vertical_field_of_view_rad / 2


def test_sundial_can_be_measured() -> None:
    """An upright gnomon of 1 m at the origin, on a plain plate six times as wide, north at -Z."""
    scene = load_scene(SCENES / "sundial.glb")
    named = {place.name: place.world_triangles().reshape(-1, 3) for place in scene.meshes}
    tip = named["gnomon"][np.argmax(named["gnomon"][:, 1])]
    np.testing.assert_allclose(tip, [0.0, 1.0, 0.0], atol=1e-6)
    on_top = named["plate"][named["plate"][:, 1] == 0.0]
    assert np.hypot(on_top[:, 0], on_top[:, 2]).max() == pytest.approx(6.0)
    red = next(p for p in scene.meshes if p.mesh.material.name == "red enamel")
    middle = red.world_triangles().reshape(-1, 3).mean(axis=0)
    assert middle[2] < -6.0
    assert abs(middle[0]) < 0.1
    for place in scene.meshes:
        if place.name in ("ring", "letters"):
            corners = place.world_triangles().reshape(-1, 3)
            assert np.hypot(corners[:, 0], corners[:, 2]).min() > 5.9


def test_street_hides_much_of_the_sky() -> None:
    """From the middle of the street, at eye height, walls stand above 45 degrees on both sides."""
    scene = load_scene(SCENES / "street.obj")
    corners = np.concatenate([place.world_triangles() for place in scene.meshes]).reshape(-1, 3)
    for side in (-1, 1):
        wall = corners[(corners[:, 0] * side > 4.0) & (np.abs(corners[:, 2]) < 6.0)]
        elevation = np.arctan2(wall[:, 1] - 1.7, np.abs(wall[:, 0]))
        assert np.degrees(elevation.max()) > 45.0


def test_spheres_cover_metal_and_matt() -> None:
    """ReflectionProbes to matt surfaces, metals and non-metals, with an 18 % grey card."""
    scene = load_scene(SCENES / "spheres.glb")
    materials = {p.mesh.material.name: p.mesh.material for p in scene.meshes}
    assert materials["mirror"].roughnessFactor == 0.0
    assert materials["mirror"].metallicFactor == 1.0
    grey = materials["18 % grey, matt"]
    np.testing.assert_allclose(grey.baseColorFactor[:3], 0.18)
    assert (grey.roughnessFactor, grey.metallicFactor) == (1.0, 0.0)
    assert {"gold", "copper", "chrome", "white, matt", "red plastic, glossy"} <= set(materials)


def test_pavilion_shares_its_columns() -> None:
    """Eight columns are one mesh in eight places, around a textured floor."""
    scene = load_scene(SCENES / "pavilion.gltf")
    columns = [place for place in scene.meshes if place.name.startswith("column")]
    assert len(columns) == 8
    assert len({id(place.mesh) for place in columns}) == 1
    floor = next(p for p in scene.meshes if p.mesh.material.name == "marble floor")
    assert floor.mesh.material.baseColorTexture.size == (256, 256)


@pytest.mark.parametrize("seed", range(80))
def test_mangled_files_load_or_are_refused(tmp_path: Path, seed: int) -> None:
    """Files with flipped bytes or cut ends open, or are refused in one sentence."""
    rng = np.random.default_rng(seed)
    for path in assets():
        shutil.copy(path, tmp_path)
    name = NAMES[seed % len(NAMES)]
    family = [path.name for path in assets() if path.stem.split("_")[0] == name.split(".")[0]]
    victim = tmp_path / family[rng.integers(len(family))]
    data = bytearray(victim.read_bytes())
    if seed % 3 == 0:
        del data[rng.integers(len(data)) :]
    else:
        # Half of the damage goes to the head, where the structure is.
        reach = len(data) if seed % 2 else min(len(data), 4000)
        for at in rng.integers(reach, size=rng.integers(1, 30)):
            data[at] = rng.integers(256)
    victim.write_bytes(data)
    with contextlib.suppress(UserError):
        scene = load_scene(tmp_path / name)
        assert np.all(np.isfinite([scene.lower_m, scene.upper_m]))
        assert scene.triangles > 0


def test_no_sky_is_seen_between_the_pavilions_ceiling_and_its_ring() -> None:
    """Who stands below sees fronts alone along the rim: a low sun made dots of light there."""
    corners = np.concatenate(
        [place.world_triangles() for place in load_scene(SCENES / "pavilion.gltf").meshes]
    )
    faces = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    tree = tree_over(corners / _PAVILION_M, np.ones(len(corners), np.float32))
    turn, height = np.meshgrid(np.radians(np.linspace(0, 360, 1501)), [4.1493, 4.1507])
    rim = np.stack([2.597 * np.cos(turn), height, 2.597 * np.sin(turn)], axis=-1).reshape(-1, 3)
    for eye in ((0.0, 1.7, 0.0), (1.0, 2.2, 0.5), (-0.7, 1.2, 1.1)):
        towards = (rim - eye) / np.linalg.norm(rim - eye, axis=1, keepdims=True)
        met, _ = first_hits(tree, np.broadcast_to(eye, rim.shape) / _PAVILION_M, towards)
        # Single precision may miss a corner; half of all rays found the gap.
        assert np.mean(np.einsum("ri,ri->r", towards, faces[met]) >= 0.0) < 1e-3
        assert (met >= 0).all()


def test_only_the_planet_brings_its_ground_and_is_as_large_as_one() -> None:
    """Of the scenes in which little is to be done, each below 300 kB; the planet is more than
    2,000 km across and curved as the Earth: 126 km lower at the rim (1 % of that)."""
    paths = list((SCENES / "work").iterdir())
    assert max(path.stat().st_size for path in paths) < 300_000
    scenes = {path.name: load_scene(path) for path in paths if path.suffix == ".glb"}
    assert {name for name, scene in scenes.items() if has_own_ground(scene)} == {"planet.glb"}
    planet = scenes["planet.glb"]
    assert planet.upper_m[0] - planet.lower_m[0] > 2e6
    rim_m = 6.36e6 * (1.0 - np.cos(0.2))
    np.testing.assert_allclose(-planet.lower_m[1], rim_m, rtol=0.01)
