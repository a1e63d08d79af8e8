"""Extensions of glTF's materials: their numbers, in the units of `SurfaceTerms`."""

from typing import Any

import numpy as np
import pytest
from loaded_scenes import WriteScene

from vrut_lite.errors import UserError
from vrut_lite.messages.scene_content import Material
from vrut_lite.messages.surface_terms import SurfaceTerms, as_row, from_row
from vrut_lite.scene.loading import load_scene
from vrut_lite.scene.packing import packed


def read(write_square: WriteScene, extensions: dict[str, Any], **more: Any) -> Material:
    """The material of a square that has these extensions."""

    def edit(document: dict[str, Any]) -> None:
        named = {f"KHR_materials_{name}": value for name, value in extensions.items()}
        document["materials"][0] = {"extensions": named, **more}
        document["extensionsRequired"] = list(named)

    loaded = load_scene(write_square(edit))
    # Nothing is left out; each changed number has a notice.
    assert all(line.endswith(" is outside 0 to 1: clipped") for line in loaded.notices)
    return packed(loaded).materials.all()[0]


def test_a_material_without_extensions_has_the_defaults(write_square: WriteScene) -> None:
    """glTF's core: an index of 1.5, and nothing that passes through."""
    assert read(write_square, {}).terms == SurfaceTerms()
    np.testing.assert_allclose(SurfaceTerms().f0_rgb, 0.04)


def test_rows_keep_every_number() -> None:
    """What a message carries is what the file said."""
    row = np.arange(len(as_row(SurfaceTerms())), dtype=float)
    np.testing.assert_array_equal(as_row(from_row(row)), row)


def test_glass_has_its_index_its_thickness_and_its_colour(write_square: WriteScene) -> None:
    """What leaves a colour after a distance takes minus its logarithm by that distance."""
    terms = read(
        write_square,
        {
            "ior": {"ior": 1.4},
            "transmission": {"transmissionFactor": 0.75},
            "volume": {
                "thicknessFactor": 0.3,
                "attenuationDistance": 2.0,
                "attenuationColor": [0.5, 1.0, 1.0],
            },
        },
    ).terms
    assert (terms.ior, terms.transmission, terms.thickness_m) == (1.4, 0.75, 0.3)
    np.testing.assert_allclose(terms.extinction_per_m, [np.log(2.0) / 2.0, 0.0, 0.0], atol=1e-12)


def test_emission_is_multiplied_and_other_factors_kept(write_square: WriteScene) -> None:
    """A lamp of 5000 cd/m2 shines as such, where core glTF ends at 1."""
    strength = {"emissive_strength": {"emissiveStrength": 5000.0}}
    found = read(write_square, strength, emissiveFactor=[1.0, 0.5, 0.0])
    np.testing.assert_allclose(found.emission_rgb, [5000.0, 2500.0, 0.0])


@pytest.mark.parametrize("wild", [1e300, -1e300, 1e-300])
def test_wild_numbers_come_inside_their_ranges(write_square: WriteScene, wild: float) -> None:
    """Whatever a file says, all numbers are finite and shares lie between 0 and 1."""
    terms = read(
        write_square,
        {
            "ior": {"ior": wild},
            "clearcoat": {"clearcoatFactor": wild, "clearcoatRoughnessFactor": wild},
            "sheen": {"sheenColorFactor": [wild] * 3, "sheenRoughnessFactor": wild},
            "anisotropy": {"anisotropyStrength": wild, "anisotropyRotation": wild},
            "transmission": {"transmissionFactor": wild},
            "volume": {"thicknessFactor": wild, "attenuationDistance": wild},
            "specular": {"specularFactor": wild, "specularColorFactor": [wild] * 3},
        },
    ).terms
    assert np.isfinite(as_row(terms)).all()
    for share in (terms.clearcoat, terms.transmission, terms.anisotropy, *terms.f0_rgb):
        assert 0.0 <= share <= 1.0


def test_an_extension_of_a_wrong_type_is_refused_in_a_line(write_square: WriteScene) -> None:
    """A damaged file is named, without a traceback."""
    with pytest.raises(UserError, match="an extension of a material in it is not valid"):
        read(write_square, {"ior": {"ior": "glass"}})
