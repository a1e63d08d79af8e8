"""Colours that a file states arrive as they are meant; every change has a notice."""

from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from loaded_scenes import WriteScene, add_array, give, material_of

from vrut_lite.scene.loading import LoadedScene, load_scene

SQUARE = ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0))
COLOURS = ((1.0, 0.0, 0.0), (0.0, 0.5, 0.0), (0.2, 0.2, 0.2), (0.8, 0.1, 0.9))
GREY = "mesh without material: matt grey of 0.5 instead"
UNFLAGGED = "COLOR_0 of whole numbers without `normalized`: as if they had it"
CLIPPED = "vertex colours outside 0 to 1: clipped"


def linear(encoded: Any) -> np.ndarray:
    """Decodes sRGB by IEC 61966-2-1, independently of the code under test."""
    c = np.asarray(encoded, float)
    return np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)


def reflectances(scene: LoadedScene) -> np.ndarray:
    """Base colour times vertex colour at the square's corners (4, 3), in SQUARE's order."""
    mesh = scene.meshes[0].mesh
    rgb = np.tile(mesh.material.baseColorFactor[:3], (len(mesh.vertices), 1))
    if mesh.colours is not None:
        rgb = rgb * mesh.colours[:, :3]
    at = [int(np.argmin(np.abs(mesh.vertices - corner).sum(axis=1))) for corner in SQUARE]
    return np.asarray(rgb[at])


def coloured_vertices(colours: Any) -> str:
    return "\n".join(
        f"v {x} {y} {z} {r} {g} {b}" for (x, y, z), (r, g, b) in zip(SQUARE, colours, strict=True)
    )


def unbound(document: dict[str, Any]) -> None:
    del document["meshes"][0]["primitives"][0]["material"]


@pytest.mark.parametrize("dtype", ["<f4", "<u1", "<u2"])
@pytest.mark.parametrize("flagged", [True, False])
def test_gltf_vertex_colours_without_a_material(
    write_square: WriteScene, dtype: str, flagged: bool
) -> None:
    """They are the reflectance: white times them, linear; whole numbers are shares, told or not."""
    whole = dtype != "<f4"
    top = np.iinfo(dtype).max if whole else 1
    values = np.ones((4, 4))
    values[:, :3] = COLOURS
    stored = np.round(values * top).astype(dtype) if whole else values.astype(dtype)

    def edit(document: dict[str, Any]) -> None:
        unbound(document)
        number = add_array(document, stored, type="VEC4", normalized=whole and flagged)
        give(document, COLOR_0=number)

    scene = load_scene(write_square(edit))
    np.testing.assert_allclose(reflectances(scene), COLOURS, atol=0.51 / top if whole else 1e-6)
    assert material_of(scene).metallicFactor == 0.0
    assert scene.notices == ((UNFLAGGED,) if whole and not flagged else ())


def test_a_gltf_mesh_that_states_no_colour_is_told(write_square: WriteScene) -> None:
    """glTF's default is a white metal: grey in its place is a change."""
    scene = load_scene(write_square(unbound))
    np.testing.assert_allclose(reflectances(scene), 0.5)
    assert scene.notices == (GREY,)


def test_points_of_bytes_have_their_colours(write_square: WriteScene) -> None:
    """Clouds of points most often have bytes: they are no white cloud."""
    stored = np.round(np.array([[*c, 1.0] for c in COLOURS]) * 255).astype("<u1")

    def edit(document: dict[str, Any]) -> None:
        unbound(document)
        document["meshes"][0]["primitives"].append({"attributes": {"POSITION": 0}, "mode": 0})
        number = add_array(document, stored, type="VEC4")
        document["meshes"][0]["primitives"][1]["attributes"]["COLOR_0"] = number

    scene = load_scene(write_square(edit))
    assert scene.points_and_lines is not None
    rgba = scene.points_and_lines.point_rgba.values
    np.testing.assert_allclose(rgba[:, :3], COLOURS, atol=0.003)
    assert UNFLAGGED in scene.notices


def test_factors_outside_their_range_are_told(write_square: WriteScene) -> None:
    """A reflectance above 1 would make light: it is clipped, and said so, extensions too."""

    def edit(document: dict[str, Any]) -> None:
        document["materials"][0] = {
            "pbrMetallicRoughness": {"baseColorFactor": [1.5, 0.5, 0.5, 1.0], "metallicFactor": -1},
            "extensions": {"KHR_materials_clearcoat": {"clearcoatFactor": 3.0}},
        }

    scene = load_scene(write_square(edit))
    np.testing.assert_allclose(reflectances(scene)[0], [1.0, 0.5, 0.5])
    assert set(scene.notices) == {
        f"material whose {name} is outside 0 to 1: clipped"
        for name in ("base colour", "metalness", "clearcoat")
    }


def test_obj_vertex_colours_are_srgb(write_obj: WriteScene) -> None:
    """Those who write them write what a display shows; without Kd they are all the colour."""
    for mtl in (None, "newmtl paint\nNs 0\n"):
        scene = load_scene(write_obj(mtl, vertices=coloured_vertices(COLOURS)))
        np.testing.assert_allclose(reflectances(scene), linear(COLOURS), atol=1e-6)
    stated = load_scene(
        write_obj("newmtl paint\nKd 0.5 0.5 0.5\n", vertices=coloured_vertices(COLOURS))
    )
    np.testing.assert_allclose(reflectances(stated), 0.5 * linear(COLOURS), atol=1e-6)


def test_obj_vertex_colours_in_bytes(write_obj: WriteScene) -> None:
    """0 to 255 is not white."""
    bytes_ = np.round(np.array(COLOURS) * 255)
    scene = load_scene(write_obj(vertices=coloured_vertices(bytes_)))
    np.testing.assert_allclose(reflectances(scene), linear(bytes_ / 255), atol=1e-6)
    assert "vertex colours up to 255 in the OBJ: divided by 255" in scene.notices


@pytest.mark.parametrize("long", [False, True])
def test_colours_of_some_vertices_are_told(write_obj: WriteScene, long: bool) -> None:
    """They cannot be drawn with the others, which have none: not in silence, in long files too."""
    lines = coloured_vertices(COLOURS).splitlines()
    lines[-1] = "v 0 1 0"
    filler = "\n" + "# filler\n" * 60_000 if long else ""
    scene = load_scene(write_obj(vertices="\n".join(lines) + filler))
    assert "vertex colours of only some vertices of the OBJ: left out" in scene.notices


@pytest.mark.parametrize(
    ("statements", "alpha", "told"),
    [
        ("Tr 1", 1.0, "material of `Tr 1` without `d`: opaque, as MeshLab means it"),
        ("Tr 1\nd 0.25", 0.25, None),
        ("d 0.25\nTr 0", 0.25, None),
        ("d 1\nTr 1", 1.0, None),
        ("Tr 0.4", 0.6, None),
        ("Tr 0", 1.0, None),
        ("d 0", 0.0, "material of `d 0`: not seen"),
    ],
)
def test_transparency_of_mtl(
    write_obj: WriteScene, statements: str, alpha: float, told: str | None
) -> None:
    """`Tr 1` alone made models invisible; d goes before Tr, in whatever order they stand."""
    scene = load_scene(write_obj(f"newmtl paint\nKd 0.5 0.5 0.5\n{statements}\n"))
    material = material_of(scene)
    assert material.baseColorFactor[3] == pytest.approx(alpha)
    assert material.alphaMode == ("OPAQUE" if alpha == 1.0 else "BLEND")
    assert scene.notices == (() if told is None else (told,))


@pytest.mark.parametrize(
    ("statement", "told"),
    [
        ("Kd 2 0.5 0.5", "material whose Kd is outside 0 to 1: clipped"),
        ("Kd -1 0.5 0.5", "material whose Kd is outside 0 to 1: clipped"),
        ("Kd spectral paint.rfl 1", "material whose Kd is no RGB: as without Kd"),
        ("Kd 0.5 0.5 0.5\nPm 7", "material whose Pm is outside 0 to 1: clipped"),
    ],
)
def test_what_mtl_states_and_is_changed_is_told(
    write_obj: WriteScene, statement: str, told: str
) -> None:
    """A reflectance is never changed in silence."""
    assert load_scene(write_obj(f"newmtl paint\n{statement}\n")).notices == (told,)


@settings(
    max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(
    values=st.lists(
        st.floats(-2.0, 3.0, width=32) | st.sampled_from([np.nan, np.inf, 0.0, 1.0]),
        min_size=12,
        max_size=12,
    )
)
def test_any_vertex_colours_are_reflectances(write_square: WriteScene, values: Any) -> None:
    """Finite and in [0, 1]; unchanged where they were so, and told where not."""
    stored = np.array(values, "<f4").reshape(4, 3)

    def edit(document: dict[str, Any]) -> None:
        unbound(document)
        give(document, COLOR_0=add_array(document, stored, type="VEC3"))

    scene = load_scene(write_square(edit))
    found = reflectances(scene)
    assert np.isfinite(found).all()
    assert 0.0 <= found.min() <= found.max() <= 1.0
    inside = np.isfinite(stored).all() and bool(((stored >= 0.0) & (stored <= 1.0)).all())
    if inside:
        np.testing.assert_allclose(found, stored, rtol=1e-6)
        assert scene.notices == ()
    elif not (np.abs(found - stored) < 2e-3).all():
        assert scene.notices == (CLIPPED,)
