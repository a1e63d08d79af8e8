"""A scene and its sky written as one GLB are the same when they are opened again."""

import json
import struct
import sys
from base64 import b64encode
from pathlib import Path

import numpy as np
import pytest
from command_output import output_of
from photo_sky.module import PhotoSky
from photo_sky.read_panorama import read_panorama
from scene_files import SQUARE, TRIANGLES, glb_bytes, png_bytes, square_document

from vrut_lite import cli
from vrut_lite.commands.export import export
from vrut_lite.geometry.colour import LUMENS_PER_WATT, luminance
from vrut_lite.geometry.encoding import decode_float16
from vrut_lite.geometry.panorama import lat_long_directions, sample_sky
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import ChooseSlot, Demand, SetSetting
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.sun import KeyLightChanged, SunMoved
from vrut_lite.project import Project
from vrut_lite.scene.loading import load_scene
from vrut_lite.scene.packing import packed
from vrut_lite.studio.scene_kernel import SceneKernel

AT, PLACE = "2026-06-21T16:30Z", "50.08,14.44"
HEIGHT_PX = 128
PUNCTUAL = "KHR_lights_punctual"
TERMS = {
    "KHR_materials_ior": {"ior": 1.7},
    "KHR_materials_specular": {"specularFactor": 0.4, "specularColorFactor": [0.9, 0.5, 0.2]},
    "KHR_materials_clearcoat": {"clearcoatFactor": 0.3, "clearcoatRoughnessFactor": 0.2},
    "KHR_materials_sheen": {"sheenColorFactor": [0.1, 0.2, 0.3], "sheenRoughnessFactor": 0.5},
    "KHR_materials_anisotropy": {"anisotropyStrength": 0.6, "anisotropyRotation": 0.7},
    "KHR_materials_transmission": {"transmissionFactor": 0.8},
    "KHR_materials_volume": {
        "thicknessFactor": 0.05, "attenuationDistance": 0.2, "attenuationColor": [0.3, 0.6, 0.9],
    },
    "KHR_materials_iridescence": {"iridescenceFactor": 0.5, "iridescenceIor": 1.4},
    "KHR_materials_emissive_strength": {"emissiveStrength": 40.0},
}  # fmt: skip


def scene_bytes():
    """Squares that are mirrored, sheared and shared, of a material with every term, and lamps."""
    uv = np.array([[0, 0], [2.5, 0], [2.5, 1], [0, 1]], "<f4")
    colours = np.array([[1, 0.5, 0.25, 1]] * 4, "<f4")
    parts = [SQUARE, TRIANGLES, uv, colours]
    document = square_document(b"".join(part.tobytes() for part in parts))
    del document["buffers"][0]["uri"]
    document["bufferViews"] += [
        {"buffer": 0, "byteOffset": 60, "byteLength": 32},
        {"buffer": 0, "byteOffset": 92, "byteLength": 64},
    ]
    document["accessors"] += [
        {"bufferView": 2, "componentType": 5126, "count": 4, "type": "VEC2"},
        {"bufferView": 3, "componentType": 5126, "count": 4, "type": "VEC4"},
    ]
    document["meshes"][0]["primitives"][0]["attributes"] |= {"TEXCOORD_0": 2, "COLOR_0": 3}
    document["images"] = [{"uri": "data:image/png;base64," + b64encode(png_bytes()).decode()}]
    document["samplers"] = [{"wrapS": 33071, "wrapT": 33648, "magFilter": 9728}]
    document["textures"] = [{"source": 0, "sampler": 0}]
    document["materials"] = [
        {
            "name": "coat",
            "pbrMetallicRoughness": {
                "baseColorFactor": [0.8, 0.4, 0.2, 0.5], "metallicFactor": 0.3,
                "roughnessFactor": 0.7, "baseColorTexture": {"index": 0},
            },
            "normalTexture": {"index": 0, "scale": 0.6},
            "emissiveFactor": [0.5, 1.0, 0.25],
            "alphaMode": "MASK", "alphaCutoff": 0.25, "doubleSided": True,
            "extensions": TERMS,
        }
    ]  # fmt: skip
    turn = [0.0, 0.0, np.sin(0.4), np.cos(0.4)]
    document["nodes"] = [
        {"mesh": 0, "translation": [3.0, 1.0, -2.0], "rotation": turn, "scale": [2.0, 2.0, 2.0]},
        {"mesh": 0, "scale": [-1.0, 1.0, 1.0], "translation": [-4.0, 0.0, 0.0]},
        {"scale": [3.0, 1.0, 1.0], "children": [3]},
        {"mesh": 0, "rotation": turn},
        {"translation": [0, 3, 0], "extensions": {PUNCTUAL: {"light": 0}}},
        {
            "translation": [1, 2, 3], "rotation": [0.5, 0.5, -0.5, 0.5],
            "extensions": {PUNCTUAL: {"light": 1}},
        },
    ]  # fmt: skip
    document["scenes"] = [{"nodes": [0, 1, 2, 4, 5]}]
    spot = {"innerConeAngle": 0.2, "outerConeAngle": 0.6}
    document["extensions"] = {
        PUNCTUAL: {
            "lights": [
                {"type": "point", "name": "bulb", "intensity": 800.0, "color": [1.0, 0.8, 0.5]},
                {"type": "spot", "name": "beam", "intensity": 90.0, "spot": spot},
            ]
        }
    }
    return glb_bytes(document, b"".join(part.tobytes() for part in parts))


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """The scene's file and the exported one."""
    folder = tmp_path_factory.mktemp("export")
    source, target = folder / "scene.glb", folder / "scene_and_sky.glb"
    source.write_bytes(scene_bytes())
    output_of(
        export, source, "-o", target, "--at", AT, "--place", PLACE, "--size", HEIGHT_PX,
        "--north-offset", 30,
    )  # fmt: skip
    return source, target


@pytest.fixture(scope="module")
def light(files):
    """The light that the scene had when it was exported."""
    project = Project(scene=str(files[0]), at=AT, place=PLACE, north_offset_deg=30.0)
    kernel = SceneKernel(project, "test", HEIGHT_PX, 16)
    found = kernel.light
    kernel.close()
    return found


@pytest.fixture(scope="module")
def scenes(files):
    """The message of both scenes."""
    return [packed(load_scene(path)) for path in files]


def document_of(path):
    data = path.read_bytes()
    (length,) = struct.unpack_from("<I", data, 12)
    return json.loads(data[20 : 20 + length])


def test_triangles_stand_where_they_stood(scenes):
    """Mirrored and sheared places too, outsides outside."""
    before, after = scenes
    assert after.geometry.part_mesh.shape == before.geometry.part_mesh.shape == (3,)
    for part in range(3):
        expected = before.geometry.world_triangles(part)
        assert after.geometry.world_triangles(part) == pytest.approx(expected, abs=1e-6)
    for name in ("lower_m", "upper_m"):
        assert getattr(after, name) == pytest.approx(getattr(before, name), abs=1e-6)
    first, same = before.geometry.mesh(0), after.geometry.mesh(0)
    assert same.uv == pytest.approx(first.uv, abs=1e-6)
    assert same.colours_rgba == pytest.approx(first.colours_rgba)
    assert same.normals == pytest.approx(first.normals, abs=1e-6)


def test_a_mesh_that_stands_in_many_places_is_written_once(tmp_path, files):
    """Only the mirrored and the sheared instance get separate meshes."""
    assert len(document_of(files[1])["meshes"]) == 3


def test_materials_keep_every_number_and_texel(scenes):
    (before,), (after,) = (scene.materials.all() for scene in scenes)
    for name in ("metallic", "roughness", "alpha_cutoff", "normal_scale", "alpha_mode", "name"):
        assert getattr(after, name) == getattr(before, name)
    assert after.double_sided
    assert after.base_colour_rgba == pytest.approx(before.base_colour_rgba)
    assert after.emission_rgb == pytest.approx([20.0, 40.0, 10.0])
    for name, expected in before.terms._asdict().items():
        assert getattr(after.terms, name) == pytest.approx(expected), name
    assert set(after.maps) == set(before.maps) == {"base_colour", "normal"}
    for name, found in after.maps.items():
        assert np.array_equal(found.texels, before.maps[name].texels)
        assert found.sampler == before.maps[name].sampler == ("clamp", "mirror", True)


def test_lamps_keep_their_candela_and_cones(scenes):
    before, after = (scene.lamps for scene in scenes)
    for name in ("position_m", "intensity_rgb", "cone_cos"):
        expected = getattr(before, name).values
        assert getattr(after, name).values == pytest.approx(expected, abs=1e-6), name
    assert after.axes.values[:, 0] == pytest.approx(before.axes.values[:, 0], abs=1e-6)


def test_the_panorama_comes_back_with_its_radiance(files, light):
    """Within 2e-4 where it is brighter than a hundredth of its brightest, 16 bits of sRGB."""
    found = read_panorama(files[1])
    cube = decode_float16(light.lighting.cube.values, light.lighting.radiance_scale)
    expected = sample_sky(cube, lat_long_directions(HEIGHT_PX)) * LUMENS_PER_WATT
    read = found.pixels * found.cd_m2_per_unit
    bright = expected > 0.01 * expected.max()
    assert bright.mean() > 0.5
    assert np.abs(read / expected - 1.0)[bright].max() < 2e-4
    assert np.abs(read - expected).max() < 2e-5 * expected.max()


def test_the_texture_lies_as_the_extension_says(files, light):
    """Its middle is +Z, the middle of its left half +X: the glow lies below the sun."""
    document = document_of(files[1])
    sky = document["extensions"]["OMI_environment_sky"]["skies"][0]
    assert sky["type"] == "panorama"
    assert document["scenes"][0]["extensions"]["OMI_environment_sky"] == {"sky": 0}
    stored = np.roll(read_panorama(files[1]).pixels, HEIGHT_PX, axis=1)
    row, column = np.unravel_index(np.argmax(stored[:64].sum(axis=-1)), (64, 256))
    # From the middle to the left +Z turns to +X.
    around = (0.5 - (column + 0.5) / 256.0) * 2.0 * np.pi
    x, _, z = light.key_light.direction
    assert np.cos(around - np.arctan2(x, z)) > np.cos(np.radians(3.0))
    assert row > 20


def test_the_sun_keeps_its_lux_and_its_direction(files, light):
    """Within 1e-4, as the file states them and as the sky of the file shines."""
    key = light.key_light
    sun = read_panorama(files[1]).sun
    lux = LUMENS_PER_WATT * np.array(key.irradiance_rgb)
    assert sun.direction == pytest.approx(key.direction, abs=1e-4)
    assert sun.illuminance_lx == pytest.approx(lux, rel=1e-4)
    (light_of_file,) = (
        one
        for one in document_of(files[1])["extensions"][PUNCTUAL]["lights"]
        if one["type"] == "directional"
    )
    assert light_of_file["extras"]["illuminance_lx"] == pytest.approx(float(luminance(lux)))
    kernel = Kernel()
    kernel.add_module(PhotoSky)
    for kind in (SunMoved, KeyLightChanged):
        kernel.inject(Demand(consumer="test", message=kind.__name__, size=16))
    kernel.inject(SetPlace(latitude_deg=50.0, longitude_deg=14.0, north_offset_rad=0.5))
    kernel.inject(SetSetting(module="photo_sky", name="photo", value=str(files[1])))
    for slot in ("sun", "sky"):
        kernel.inject(ChooseSlot(slot=slot, module="photo_sky"))
    kernel.pump_until_idle()
    shining = kernel.last(KeyLightChanged)
    kernel.close()
    assert shining.direction == pytest.approx(key.direction, abs=1e-4)
    assert shining.irradiance_rgb == pytest.approx(key.irradiance_rgb, rel=1e-4)


def test_the_loader_tells_how_the_files_own_sky_is_shown(files):
    told = load_scene(files[1]).notices
    assert any("OMI_environment_sky" in line and "photograph" in line for line in told)


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("scene.glb", "-o", "scene.obj"), "ends with .glb"),
        (("missing.glb", "-o", "scene_2.glb"), "missing.glb"),
    ],
)
def test_bad_input_gets_one_sentence(monkeypatch, capsys, files, arguments, says):
    """Exit code 2, one line, and no file."""
    monkeypatch.chdir(files[0].parent)
    monkeypatch.setattr(sys, "argv", ["vrut-lite", "export", *arguments])
    with pytest.raises(SystemExit) as end:
        cli.main()
    said = capsys.readouterr().err
    assert end.value.code == 2
    assert said.count("\n") == 1
    assert says in said
    assert not Path(arguments[-1]).exists()
