"""Variants of materials (KHR_materials_variants) are chosen by name or number."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from loaded_scenes import WriteScene

from vrut_lite.errors import UserError
from vrut_lite.messages.scene import LoadScene
from vrut_lite.project import load_project, save_project, view_inputs
from vrut_lite.scene.loading import load_scene
from vrut_lite.scene.packing import packed

NAME = "KHR_materials_variants"


@pytest.fixture
def shoe(write_square: WriteScene) -> Path:
    """A black square, which is red in one variant and blue in two others; a green one beside."""

    def edit(document: dict[str, Any]) -> None:
        colours = ([0, 0, 0, 1], [1, 0, 0, 1], [0, 0, 1, 1], [0, 1, 0, 1])
        document["materials"] = [
            {"pbrMetallicRoughness": {"baseColorFactor": colour}} for colour in colours
        ]
        names = ("beach", "street", "midnight\n blue")
        document["extensions"] = {NAME: {"variants": [{"name": name} for name in names]}}
        (first,) = document["meshes"][0]["primitives"]
        mappings = [{"material": 1, "variants": [0]}, {"material": 2, "variants": [1, 2]}]
        document["meshes"][0]["primitives"] = [
            {**first, "material": 0, "extensions": {NAME: {"mappings": mappings}}},
            {**first, "material": 3},
        ]

    return write_square(edit)


@pytest.mark.parametrize(
    ("asked", "named", "colour"),
    [
        ("", "", (0, 0, 0)),
        ("beach", "beach", (1, 0, 0)),
        ("2", "street", (0, 0, 1)),
        ("midnight blue", "midnight blue", (0, 0, 1)),
    ],
)
def test_a_variant_changes_the_materials_that_it_names(
    shoe: Path, asked: str, named: str, colour: tuple[int, ...]
) -> None:
    """The others stay; the message says which is shown and which there are."""
    scene = packed(load_scene(shoe, variant=asked))
    materials = scene.materials.all()
    parts = [materials[scene.geometry.mesh(n).material] for n in scene.geometry.part_mesh.values]
    found = [part.base_colour_rgba[:3] for part in parts]
    np.testing.assert_array_equal(found, [colour, (0, 1, 0)])
    assert scene.opened is not None
    assert (scene.opened.variant, scene.variants) == (named, ("beach", "street", "midnight blue"))
    assert bool(scene.notices) == (asked == "")


@pytest.mark.parametrize("asked", ["desert", "4", "0"])
def test_a_variant_that_is_not_there_is_refused_by_name(shoe: Path, asked: str) -> None:
    """The sentence names those that are there."""
    with pytest.raises(
        UserError, match=rf"no variant '{asked}': there are 1 \(beach\), 2 \(street\)"
    ):
        load_scene(shoe, variant=asked)


def test_a_project_keeps_its_variant(shoe: Path, tmp_path: Path) -> None:
    """What was chosen is asked for again."""
    path = tmp_path / "shoe.toml"
    path.write_text(f'scene = "{shoe.name}"\nvariant = "beach"\n')
    save_project(path, load_project(path))
    (load,) = [m for m in view_inputs(load_project(path)) if isinstance(m, LoadScene)]
    assert load.variant == "beach"
