"""The eye looks through backs of single-sided surfaces, in llvm, and through what is cut off."""

import numpy as np
import pytest
from light_messages import light_messages
from path_tracer.backend import PathTracedBackend
from path_tracer.library import safe_library
from path_tracer.settings import PathTracerSettings
from path_tracer_here import mitsuba_or_skip
from scene_stage import look, square, surface
from stateful_backend import StatefulBackend, opened

from vrut_lite.errors import UserError
from vrut_lite.messages.ground_disc import GroundDisc
from vrut_lite.messages.section import section_of

mitsuba_or_skip()


def seen_from(path, height, variant="llvm", ground=None, **parts):
    """Mean radiance of the square from so high above it, under a sky of 1 without a sun."""
    settings = PathTracerSettings(spp=32, variant=variant, sun="sharp")
    backend = StatefulBackend(PathTracedBackend(settings), size_px=(4, 4), **parts)
    sun = {"sun_direction": (0.0, 1.0, 1e-6), "sun_irradiance": (0.0,) * 3}
    background, key_light, ambient = light_messages(np.ones((6, 8, 8, 3)), **sun)
    backend.change(
        scene=opened(path, ground), background=background, key_light=key_light, ambient=ambient
    )
    return look(backend, (0.0, height, 1e-3), (0.0, 0.0, 0.0), 0.05).radiance.mean()


def llvm_or_skip():
    try:
        safe_library()
    except UserError as error:
        pytest.skip(str(error))


@pytest.mark.parametrize("instanced", [False, True])
@pytest.mark.parametrize("double_sided", [False, True])
def test_the_eye_looks_through_the_back_of_what_is_single_sided(tmp_path, double_sided, instanced):
    """Black from its front; from behind the sky shows unless the file says double-sided."""
    llvm_or_skip()
    black = {**surface(0.0, 1.0, 0.0), "doubleSided": double_sided}
    nodes = [{"mesh": 0}] + [{"mesh": 0, "translation": [5, 0, 0]}] * instanced
    path = square(tmp_path, black, nodes=nodes)
    assert seen_from(path, 3.0) < 0.1
    below = seen_from(path, -3.0)
    assert below < 0.1 if double_sided else below > 0.99


@pytest.mark.parametrize("double_sided", [False, pytest.param(True, marks=pytest.mark.long)])
def test_behind_a_blended_front_no_back_is_seen(tmp_path, double_sided):
    """A black box, half of it to be seen through: from above a front takes half of the sky below;
    its bottom, whose back is turned to the eye, takes half again if it is double-sided alone."""
    llvm_or_skip()
    black = {**surface(0.0, 1.0, 0.0), "doubleSided": double_sided, "alphaMode": "BLEND"}
    black["pbrMetallicRoughness"] |= {"baseColorFactor": [0.0, 0.0, 0.0, 0.5]}
    top, bottom = {"mesh": 0, "translation": [0, 0.01, 0]}, {"mesh": 0, "rotation": [1, 0, 0, 0]}
    shown = seen_from(square(tmp_path, black, nodes=[top, bottom]), 3.0)
    assert shown == pytest.approx(0.25 if double_sided else 0.5, abs=0.08)


@pytest.mark.parametrize("variant", ["scalar", "llvm"])
def test_a_section_takes_a_roof_away_and_leaves_its_shadow(tmp_path, variant):
    """From above, a black roof is black; cut off it shows the white floor, as dark as a floor
    whose sky is hidden: the light is not cut. A plane below both shows what lies behind."""
    if variant == "llvm":
        llvm_or_skip()
    floor = {"mesh": 0, "scale": [0.2, 1.0, 0.2]}
    roof = {"mesh": 0, "translation": [0.0, 0.02, 0.0]}
    white = {**surface(0.0, 1.0, 0.8), "doubleSided": True}
    path = square(tmp_path, white, nodes=[floor, roof])
    covered = seen_from(path, 3.0, variant, section=section_of("y", 0.01, "below"))
    open_floor = seen_from(square(tmp_path, white, nodes=[floor]), 3.0, variant)
    assert open_floor > 0.7
    assert 0.0 < covered < 0.4 * open_floor
    path = square(tmp_path, white, nodes=[floor, roof])
    nothing = section_of("y", -0.05, "below")
    assert seen_from(path, 3.0, variant, section=nothing) == pytest.approx(1.0, rel=1e-5)


def test_a_section_spares_the_ground_as_in_the_frame(tmp_path):
    """A square on the ground is cut off, and black ground is seen where it was."""
    path = square(tmp_path, surface(0.0, 1.0, 0.8))
    ground = GroundDisc(centre_xz_m=(0.0, 0.0), height_m=-0.01, radius_m=5.0)
    parts = {"ground": ground, "ground_albedo_rgb": (0.0, 0.0, 0.0)}
    nothing = section_of("y", -1.0, "below")
    assert seen_from(path, 3.0, "scalar", section=nothing, **parts) < 1e-6
    assert seen_from(path, 3.0, "scalar", **parts) > 0.5


BOX = """v -1 -1 -1
v 1 -1 -1
v 1 -1 1
v -1 -1 1
v -1 0 -1
v 1 0 -1
v 1 0 1
v -1 0 1
f 1 2 3 4
f 1 5 6 2
f 2 6 7 3
f 3 7 8 4
f 4 8 5 1
"""


@pytest.mark.parametrize("variant", ["scalar", pytest.param("llvm", marks=pytest.mark.long)])
def test_a_body_that_is_opened_has_the_light_of_its_outside(tmp_path, variant):
    """The bottom of a box under an even sky is as bright from inside as from below; without a lid
    the box is no body, and light from above alone reaches its inside."""
    if variant == "llvm":
        llvm_or_skip()
    path = tmp_path / "box.obj"
    path.write_text(BOX + "f 5 8 7 6\n")
    cut = section_of("y", -0.5, "below")
    outside = seen_from(path, -3.0, variant)
    assert outside > 0.2
    assert seen_from(path, 3.0, variant, section=cut) == pytest.approx(outside, rel=0.05)
    path.write_text(BOX)
    inside = seen_from(path, 3.0, variant)
    assert inside < 0.8 * outside
    assert seen_from(path, 3.0, variant, section=cut) == pytest.approx(inside, rel=0.1)
