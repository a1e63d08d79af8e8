"""The command `vrut-lite share`: its file, and one line for bad input."""

import base64
import gzip
import json
import re
import struct
from pathlib import Path

import msgspec
import numpy as np
import pytest
from click.testing import CliRunner
from share import light_maps, page_file
from share.command import share
from share.light_maps import traced
from share.page_file import packed, page_text

from vrut_lite.errors import UserError
from vrut_lite.scene.loading import load_scene
from vrut_lite.scene.packing import packed as packed_scene

ROOM = Path(__file__).parents[2] / "scenes" / "work" / "room.glb"


def run(*arguments):
    found = CliRunner().invoke(share, [str(a) for a in arguments], catch_exceptions=False)
    assert found.exit_code == 0
    return found.output


def test_a_name_that_is_no_pages_is_refused(tmp_path):
    with pytest.raises(UserError, match=r"a page's name ends with \.html"):
        run(ROOM, "-o", tmp_path / "room.png")


def test_a_missing_script_is_refused_with_what_to_install(tmp_path, monkeypatch):
    monkeypatch.setattr(page_file, "SCRIPT", tmp_path / "none.js")
    with pytest.raises(UserError, match=r"install Node\.js with npm"):
        run(ROOM, "-o", tmp_path / "room.html")


@pytest.fixture(scope="module")
def room():
    return packed_scene(load_scene(ROOM))


def test_a_scene_without_surfaces_is_refused(room):
    with pytest.raises(UserError, match="the scene has no surfaces"):
        traced(msgspec.structs.replace(room, triangles=0), 0.1, None)


def test_a_light_map_too_large_for_a_page_is_refused_before_rays_are_traced(room, monkeypatch):
    """With the option that reduces it."""
    monkeypatch.setattr(light_maps, "MOST_VALUES", 200)
    with pytest.raises(UserError, match=r"more than the 200 that fit .* --texels"):
        traced(room, 0.1, 1500)


def test_arrays_lie_where_the_header_says():
    """At multiples of eight bytes, as typed arrays of a browser need."""
    arrays = {"a": np.arange(5, dtype=np.uint8), "b": np.arange(6, dtype=np.float32).reshape(2, 3)}
    content = packed({"title": "x"}, arrays)
    (length,) = struct.unpack_from("<I", content)
    header = json.loads(content[4 : 4 + length])
    for name, array in arrays.items():
        section = header["sections"][name]
        assert section["offset"] % 8 == 0
        found = np.frombuffer(content, array.dtype, array.size, section["offset"])
        assert np.array_equal(found.reshape(section["shape"]), array)


def test_a_page_fetches_nothing_and_escapes_its_title(tmp_path, monkeypatch):
    """No address of a script, style or picture: it opens from disk without a network."""
    script = tmp_path / "page.js"
    script.write_text("const end = '</script>';")
    (tmp_path / "LICENSES.txt").write_text("three: MIT\n")
    monkeypatch.setattr(page_file, "SCRIPT", script)
    monkeypatch.setattr(page_file, "LICENCES", tmp_path / "LICENSES.txt")
    text = page_text("<b>&", {}, {"a": np.zeros(3, np.uint8)}, b"glb", [("noon", b"webp")])
    assert "<title>&lt;b&gt;&amp;</title>" in text
    assert "'</script>'" not in text
    assert "three: MIT" in text
    assert not re.search(r"(src|href)=\"(?!data:)", text)
    scene = re.search(r'id="scene">([^<]*)<', text)[1]
    assert gzip.decompress(base64.b64decode(scene)) == b"glb"
