"""Smooth surfaces of a page mirror the things around them, not the sky alone."""

import base64
import io
import json
import struct

import numpy as np
import pytest
import trimesh
from browser import Browser, chromium
from click.testing import CliRunner
from light_transport.public import quality_for
from PIL import Image
from share.command import share
from share.glb import glb_of
from share.light_maps import traced
from share.page_file import SCRIPT
from share.scene_mesh import groups_of
from trimesh.visual.material import PBRMaterial

from vrut_lite.scene.loading import load_scene
from vrut_lite.scene.packing import packed


def slab(size, place, colour, roughness, metallic):
    found = trimesh.creation.box(size)
    found.apply_translation(place)
    found.visual = trimesh.visual.TextureVisuals(
        material=PBRMaterial(
            name=f"{roughness}-{metallic}",
            baseColorFactor=[*colour, 1.0],
            roughnessFactor=roughness,
            metallicFactor=metallic,
        )
    )
    return found


@pytest.fixture(scope="module")
def scene(tmp_path_factory):
    """A mirror that faces a red wall three metres south of it, on a grey floor."""
    parts = trimesh.Scene(
        {
            "floor": slab((8, 0.2, 8), (0, -0.1, 0), (0.3, 0.3, 0.3), 1.0, 0.0),
            "wall": slab((6, 3, 0.2), (0, 1.5, 3), (0.6, 0.02, 0.02), 1.0, 0.0),
            "mirror": slab((3, 2, 0.05), (0, 1.2, 0), (0.9, 0.9, 0.9), 0.1, 1.0),
        }
    )
    path = tmp_path_factory.mktemp("mirror") / "mirror.glb"
    parts.export(path)
    return path


@pytest.fixture(scope="module")
def shared(scene):
    """The opened scene with what `traced` returns."""
    opened = packed(load_scene(scene))
    return opened, *traced(opened, 0.1, 1500)


def test_a_pages_light_map_has_four_times_the_rays_of_the_programs(shared):
    """Half its noise, which shows as blotches on even walls."""
    assert shared[1].rays == 4 * quality_for(0.1).rays


def test_a_mirror_is_a_group_of_its_own_that_names_its_cube_map(shared):
    """The page's hours are lit without it, for the page draws what the mirror sees."""
    opened, transport, mirrors = shared
    assert transport.mirrors is None
    assert mirrors is not None
    groups = groups_of(opened, transport.layout_message, {int(mirrors.parts.part[0]): 0})
    (own,) = [group for group in groups if group.mirror is not None]
    assert np.ptp(own.positions_m, axis=0) == pytest.approx([3.0, 2.0, 0.05], abs=1e-5)
    content = glb_of(groups, opened.materials.all(), (0.1, 0.1, 0.1))
    (length,) = struct.unpack_from("<I", content, 12)
    nodes = json.loads(content[20 : 20 + length])["nodes"]
    assert [node.get("extras", {}).get("mirror") for node in nodes] == [
        group.mirror for group in groups
    ]


@pytest.mark.long
def test_a_mirror_shows_the_red_wall_that_it_faces(scene, tmp_path):
    """As the program's frame does; without its image it is grey by the sky and a mean of things."""
    if chromium() is None or not SCRIPT.is_file():
        pytest.skip("needs a browser (Debian: chromium) and the page's script")
    page = tmp_path / "mirror.html"
    done = CliRunner().invoke(
        share,
        [str(scene), "-o", str(page), "--texels", "1500", "--no-stills"],
        catch_exceptions=False,
    )
    assert done.exit_code == 0
    browser = Browser(tmp_path)
    try:
        browser.open(f"{page.as_uri()}#2026-06-21T12:30")
        for shown in (True, False):
            script = """(() => {
                const page = window.daylight, view = page.view;
                const sky = view.fineCubes.mirrored.texture;
                if (!SHOWN) for (const { meshes } of view.mirrors)
                    for (const mesh of meshes) view.showMirror(mesh, sky, 0);
                view.camera.position.set(0, 1.6, 2.6);
                view.camera.lookAt(0, 1.2, 0);
                view.camera.updateMatrixWorld(true);
                view.stillCount = 0;
                view.draw(true);
                return page.canvas.toDataURL();
            })()""".replace("SHOWN", str(shown).lower())
            png = base64.b64decode(browser.value(script).partition(",")[2])
            pixels = np.asarray(Image.open(io.BytesIO(png)).convert("RGB"), float)
            height, width = pixels.shape[:2]
            red, green, _ = pixels[height // 2, width // 2]
            assert bool(red > 1.5 * green) is shown
        assert browser.errors == []
    finally:
        browser.close()
