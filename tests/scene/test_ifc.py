"""IFC: shapes with their openings cut, colours, glass, units, storeys, place, and broken files."""

import math
import zipfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from ifc_files import house_ifc

from vrut_lite.errors import UserError
from vrut_lite.geometry.colour import srgb_decode
from vrut_lite.geometry.frames import enu_from_world
from vrut_lite.messages.place import SetPlace
from vrut_lite.project import load_project, project_of_path
from vrut_lite.scene.budget import SceneBudget
from vrut_lite.scene.ifc_site import place_of_ifc, stated_place
from vrut_lite.scene.loading import LoadedScene, load_scene

_CLEAR = "IFCSURFACESTYLERENDERING(#65,0.75,$,$,$,$,$,$,.GLASS.)"


def _write(folder: Path, data: bytes, name: str = "house.ifc") -> Path:
    (folder / name).write_bytes(data)
    return folder / name


def _need_library() -> None:
    pytest.importorskip("ifcopenshell", reason="the package ifcopenshell is not installed")


def _volume(scene: LoadedScene, name: str) -> float:
    """Volume of the closed meshes of a name, by the divergence theorem."""
    corners = np.concatenate([p.world_triangles() for p in scene.meshes if p.name == name])
    a, b, c = np.moveaxis(corners, 1, 0)
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6.0)


@pytest.mark.parametrize("schema", ["IFC2X3", "IFC4", "IFC4_ADD2", "IFC4X3", "IFC4X3_ADD2"])
def test_a_wall_has_its_hole_its_colour_and_its_storey(tmp_path: Path, schema: str) -> None:
    """Millimetres along Z become metres along Y; the opening is cut and neither it nor the space is
    drawn; a colour is sRGB."""
    _need_library()
    scene = load_scene(_write(tmp_path, house_ifc(schema)))
    np.testing.assert_allclose([scene.lower_m, scene.upper_m], [[0, 0, -0.3], [4, 3, 0]])
    assert {place.name for place in scene.meshes} == {"Ground/Wall", "Ground/Window"}
    assert _volume(scene, "Ground/Wall") == pytest.approx((4 * 3 - 2 * 1.5) * 0.3)
    wall = next(place.mesh for place in scene.meshes if place.name == "Ground/Wall")
    assert wall.material.name == "plaster"
    np.testing.assert_allclose(wall.material.baseColorFactor[:3], srgb_decode([0.5, 0.25, 0.0]))
    assert not wall.material.terms.transmits


@pytest.mark.parametrize("schema", ["IFC2X3", "IFC4"])
def test_a_transparent_style_is_glass_of_its_colour(tmp_path: Path, schema: str) -> None:
    """Of white behind it a program shows 0.75 and a quarter of the colour; that is the glass's
    tint, and its box is a body of two sides. The frame beside it stays opaque."""
    _need_library()
    scene = load_scene(_write(tmp_path, house_ifc(schema, pane_style=_CLEAR)))
    materials = {p.mesh.material.name: p.mesh.material for p in scene.meshes}
    pane = materials["F1"]
    np.testing.assert_allclose(pane.baseColorFactor, [0.75, 1.0, 0.75, 1.0])
    assert pane.terms.transmits
    assert not pane.terms.is_pane
    assert pane.alphaMode == "OPAQUE"
    assert not materials["default"].terms.transmits
    assert any("glass of its colour" in line for line in scene.notices)


def test_a_window_without_glass_has_its_flat_pane_guessed(tmp_path: Path) -> None:
    """A thin plate of a window without a transparent style is clear glass, its bar is not, and a
    notice says so."""
    _need_library()
    scene = load_scene(_write(tmp_path, house_ifc()))
    glass = [p for p in scene.meshes if p.mesh.material.terms.transmits]
    assert [p.mesh.material.name for p in glass] == ["glass"]
    corners = glass[0].world_triangles().reshape(-1, 3)
    np.testing.assert_allclose(np.ptp(corners, axis=0), [1.8, 1.3, 0.02], atol=1e-9)
    assert any("clear double glazing" in line for line in scene.notices)


def test_a_name_of_glass_is_glass_though_opaque(tmp_path: Path) -> None:
    """Programs that know no transparency name the style; there the colour is not believed."""
    _need_library()
    opaque = house_ifc(pane_style="IFCSURFACESTYLERENDERING(#65,0.,$,$,$,$,$,$,.FLAT.)")
    scene = load_scene(_write(tmp_path, opaque.replace(b"'F1'", b"'Verglasung'")))
    glass = [p.mesh.material for p in scene.meshes if p.mesh.material.terms.transmits]
    assert [one.name for one in glass] == ["Verglasung"]
    np.testing.assert_allclose(glass[0].baseColorFactor[:3], 1.0)


@pytest.mark.parametrize(
    ("unit", "scale"), [("$", 1.0), (".CENTI.", 100.0), ("FOOT", 1.0 / 0.3048)]
)
def test_units_of_shapes_and_of_the_sites_height(tmp_path: Path, unit: str, scale: float) -> None:
    """A unit holds for lengths and for the elevation, the foot of a conversion too."""
    data = house_ifc(
        unit="$" if unit == "FOOT" else unit, scale=scale, elevation=f"{520.0 * scale:.9f}"
    )
    if unit == "FOOT":
        foot = b"#92=IFCCONVERSIONBASEDUNIT(#91,.LENGTHUNIT.,'FOOT',#93);\n"
        foot += b"#91=IFCDIMENSIONALEXPONENTS(1,0,0,0,0,0,0);\n"
        foot += b"#93=IFCMEASUREWITHUNIT(IFCLENGTHMEASURE(0.3048),#1);\n#2=IFCUNIT"
        data = data.replace(b"#2=IFCUNIT", foot).replace(b"T((#1))", b"T((#92))")
    place = stated_place(data)
    assert place is not None
    assert place.altitude_m == pytest.approx(520.0, abs=1e-3)
    _need_library()
    scene = load_scene(_write(tmp_path, data))
    np.testing.assert_allclose(scene.upper_m, [4, 3, 0], atol=1e-6)


def test_a_unit_that_is_not_stated_is_guessed_as_an_objs(tmp_path: Path) -> None:
    """3,000 units high is in centimetres; a notice says so."""
    _need_library()
    scene = load_scene(
        _write(
            tmp_path,
            house_ifc().replace(b"(#6),#2)", b"(#6),$)").replace(b".LENGTHUNIT.", b".USERDEFINED."),
        )
    )
    assert scene.placement.metres_per_unit == 0.01
    assert any("taken to be in centimetres" in line for line in scene.notices)


def test_the_sites_place_and_true_north_are_the_scenes(tmp_path: Path) -> None:
    """Degrees, minutes, seconds and millionths; true north (0.5, 0.866) in the file's plane is 30
    degrees right of its +Y, and our north lies there."""
    path = _write(tmp_path, house_ifc())
    place = place_of_ifc(path)
    assert place is not None
    assert place.latitude_deg == pytest.approx(48 + 8 / 60 + 24.36 / 3600)
    assert place.longitude_deg == pytest.approx(11 + 34 / 60 + 12 / 3600)
    assert place.altitude_m == 520.0
    # The file's (0.5, 0.866, 0) stands in the world at x 0.5, z -0.866.
    north = [0.5, 0.0, -math.sqrt(0.75)]
    np.testing.assert_allclose(enu_from_world(north, place.north_offset_rad), [0, 1, 0], atol=1e-9)
    project = project_of_path(str(path))
    assert project.where().latitude_deg == pytest.approx(place.latitude_deg, abs=1e-4)
    assert project.north_offset_deg == pytest.approx(-30.0)
    (tmp_path / "p.toml").write_text('scene = "house.ifc"\n')
    assert load_project(tmp_path / "p.toml").north_offset_deg == pytest.approx(-30.0)
    (tmp_path / "p.toml").write_text('scene = "house.ifc"\nplace = "50,14,0"\n')
    assert load_project(tmp_path / "p.toml").where().latitude_deg == 50.0
    assert load_project(tmp_path / "p.toml").north_offset_deg == 0.0


def test_a_place_south_and_west_and_one_without_north() -> None:
    """All parts of an angle share its sign; without true north +Y is north, or the map's grid."""
    south = house_ifc(site_place="(-33,-51,-30),(-70,-40,0)", north="(0.,1.)")
    place = stated_place(south)
    assert place is not None
    assert (place.latitude_deg, place.longitude_deg) == pytest.approx((-33.858333, -70.666667))
    assert place.north_offset_rad == 0.0
    grid = south.replace(b"#5,#3);", b"#5,$);").replace(
        b"ENDSEC;\nEND", b"#99=IFCMAPCONVERSION(#6,#1,1.,2.,3.,0.,1.,$);\nENDSEC;\nEND"
    )
    turned = stated_place(grid)
    assert turned is not None
    # Local +X is the map's north: north is the file's +X, a quarter turn right of +Y.
    assert turned.north_offset_rad == pytest.approx(-math.pi / 2)


@pytest.mark.parametrize(
    ("system", "scale"),
    [
        ("'EPSG:32760','EPSG:32760 - WGS 84 / UTM zone 60S','WGS 84',$,$,$,#1", 1000.0),
        ("'EPSG:32760',$,$,$,$,$,$", 1000.0),
        ("'EPSG:32760',$,$,$,$,$,$", 1.0),
        ("'WGS84_UTM-60S',$,$,$,$,$,#98", 1.0),
        ("'local',$,'WGS84',$,'UTM','60S',#98", 1.0),
    ],
)
def test_a_place_on_a_map_of_utm_is_the_scenes(system: str, scale: float) -> None:
    """Without a site's latitude; by EPSG's code or a zone in words, in the map's unit, the
    project's, or metres where the project's cannot be meant. Grid north is not true north there:
    the numbers are those of Snyder's series (tests/scene/test_utm.py)."""
    origin = ",".join(f"{scale * metres:.6f}" for metres in (729013.3488, 9063992.6847, 1.3))
    said = f"#97=IFCPROJECTEDCRS({system});\n#98=IFCSIUNIT(*,.LENGTHUNIT.,$,.METRE.);\n"
    said += f"#99=IFCMAPCONVERSION(#6,#97,{origin},0.5,0.8660254,$);\nENDSEC;\nEND"
    data = house_ifc(site_place="$,$").replace(b"#5,#3);", b"#5,$);")
    place = stated_place(data.replace(b"ENDSEC;\nEND", said.encode()))
    assert place is not None
    assert (place.latitude_deg, place.longitude_deg) == pytest.approx((-8.462200, 179.080147))
    assert place.altitude_m == pytest.approx(1.3)
    assert math.degrees(place.north_offset_rad) == pytest.approx(-60.3062, abs=1e-3)


@pytest.mark.parametrize("system", ["'EPSG:2056'", "'UTM'", "'EPSG:32799'", "'UTM zone 320N'", "$"])
def test_a_map_that_is_not_known_gives_no_place(system: str) -> None:
    """A guess would be a place elsewhere on Earth."""
    said = f"#97=IFCPROJECTEDCRS({system},$,$,$,$,$,$);\n"
    said += "#99=IFCMAPCONVERSION(#6,#97,7.3E8,5.3E9,0.,1.,0.,$);\nENDSEC;\nEND"
    data = house_ifc(site_place="$,$").replace(b"ENDSEC;\nEND", said.encode())
    assert stated_place(data) is None


def test_a_site_that_stands_at_its_elevation_is_not_raised_twice() -> None:
    """Where the site's placement holds its elevation, height 0 is the sea's level."""
    raised = house_ifc().replace(
        b"#8=IFCCARTESIANPOINT((0.0,0.0,0.))", b"#8=IFCCARTESIANPOINT((0.,0.,520000.))"
    )
    place = stated_place(raised)
    assert place is not None
    assert place.altitude_m == 0.0


@pytest.mark.parametrize("site_place", ["$,$", "(95,0,0),(11,0,0)", "(48),$", "'x',(1)", "(*),(2)"])
def test_a_site_without_a_possible_place_gives_none(tmp_path: Path, site_place: str) -> None:
    """Then the scene opens at the usual place, and a notice says that the file states none."""
    path = _write(tmp_path, house_ifc(site_place=site_place))
    assert place_of_ifc(path) is None
    assert project_of_path(str(path)).north_offset_deg == 0.0


def test_coordinates_of_a_map_are_moved_to_the_origin(tmp_path: Path) -> None:
    """Single precision holds 600 km to 6 cm: the house is moved, and a notice says from where."""
    _need_library()
    scene = load_scene(_write(tmp_path, house_ifc(east_north=(6.9e8, 5.3e9))))
    assert np.abs([scene.lower_m, scene.upper_m]).max() < 10.0
    assert any("690000, 5300000 m of a map" in line for line in scene.notices)
    assert _volume(scene, "Ground/Wall") == pytest.approx((4 * 3 - 2 * 1.5) * 0.3, rel=1e-6)


def test_ifc_zip_is_unpacked(tmp_path: Path) -> None:
    """IFC-ZIP is a ZIP with one .ifc in it."""
    with zipfile.ZipFile(tmp_path / "a.ifczip", "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("a.ifc", house_ifc())
    assert place_of_ifc(tmp_path / "a.ifczip") == stated_place(house_ifc())
    _need_library()
    assert load_scene(tmp_path / "a.ifczip").triangles > 40


@pytest.mark.parametrize(
    ("data", "said"),
    [
        (b"", "does not begin with ISO-10303-21"),
        (b"noise", "does not begin with ISO-10303-21"),
        (b"PK\3\4 no archive", "archive is damaged"),
        (house_ifc()[:-20], "ends without END-ISO-10303-21"),
        (house_ifc("IFC9"), "schema is IFC9"),
        (house_ifc("IFC4X1"), "schema is IFC4X1"),
        (house_ifc().decode().encode("utf-16"), "text in UTF-16"),
        (house_ifc().replace(b"FILE_SCHEMA", b"FILE_SCHEME"), "names no FILE_SCHEMA"),
        (house_ifc("IFC4")[:400] + b"ENDSEC;\nEND-ISO-10303-21;\n", "no triangles"),
    ],
)
def test_broken_files_end_in_one_sentence(tmp_path: Path, data: bytes, said: str) -> None:
    """The sentence names the fault, without a traceback."""
    _need_library()
    with pytest.raises(UserError, match=said) as fault:
        load_scene(_write(tmp_path, data))
    assert "\n" not in str(fault.value)


def test_reading_ends_at_the_memory_limit(tmp_path: Path) -> None:
    """A file that needs more than is left ends in a sentence that names the limit."""
    _need_library()
    points = (b"#%d=IFCCARTESIANPOINT((0.,0.,%d.));\n" % (n, n) for n in range(1000, 700_000))
    many = house_ifc().replace(b"ENDSEC;\nEND", b"".join(points) + b"ENDSEC;\nEND")
    path = _write(tmp_path, many)
    assert load_scene(path, SceneBudget(2**29 + 60.0 * len(many))).triangles > 40
    with pytest.raises(UserError, match="left of the limit"):
        load_scene(path, SceneBudget(2**29 + 2.6 * len(many)))
    with pytest.raises(UserError, match="above the limit") as fault:
        load_scene(path, SceneBudget(2**29))
    assert "damaged" not in str(fault.value)


@settings(max_examples=200, deadline=None, suppress_health_check=list(HealthCheck))
@given(
    at=st.integers(0, len(house_ifc())),
    gone=st.integers(0, 40),
    put=st.binary(max_size=20) | st.sampled_from([b"(", b")", b"'", b";", b"$", b"#9", b"1E999"]),
)
def test_any_damage_leaves_a_place_or_none(at: int, gone: int, put: bytes) -> None:
    """The reader of the site raises nothing and never gives an impossible place."""
    whole = house_ifc()
    place = stated_place(whole[:at] + put + whole[at + gone :])
    assert place is None or isinstance(place, SetPlace)
    if place is not None:
        place.check()
