"""Fits to synthetic photographs return the parameters they were made with."""

import struct

import numpy as np
import pytest

from vrut_lite.errors import UserError
from vrut_lite.geometry.colour import LUMINANCE_WEIGHTS, luminance
from vrut_lite.geometry.panorama import lat_long_directions
from vrut_lite.pictures.write_exr import write_exr
from vrut_lite_lab.study.photographs.comparison import compare, read_photograph, table_rows
from vrut_lite_lab.study.photographs.fit import (
    MODELS,
    bruneton,
    bruneton_with,
    contrast,
    fit,
    hosek_wilkie,
    pixels_of,
    residual_log10,
)
from vrut_lite_lab.study.photographs.mask import (
    HORIZON_MARGIN_DEG,
    Sun,
    elevations_deg,
    find_azimuth_deg,
    find_disc,
    masks_of,
)

pytestmark = pytest.mark.long

HEIGHT = 128
PIXEL_DEG = 180.0 / HEIGHT
EXPOSURE = 0.05
GAINS = np.array([0.8, 1.0, 1.5]) / (LUMINANCE_WEIGHTS @ [0.8, 1.0, 1.5])
TURBIDITIES = (2.0, 4.0, 6.0)
TREES_DEG, CLOUD = 12.0, (slice(25, 30), slice(90, 97))
HIGH_SUN = Sun(-70.0, 25.0, True)


def photograph(model, turbidity, sun):
    """A sky with trees in half of its columns, a cloud, ground, a clipped disc and noise."""
    direction = lat_long_directions(HEIGHT)
    sky = model(turbidity, sun, direction.reshape(-1, 3)).reshape(direction.shape)
    photo = sky * EXPOSURE * GAINS
    photo *= np.random.default_rng(5).normal(1.0, 0.01, photo.shape)
    photo[CLOUD] *= 1.6
    low = elevations_deg(HEIGHT) < TREES_DEG
    leaves = 0.05 * luminance(photo[5]).mean() * np.array([0.8, 1.0, 0.4])
    photo[:, ::2][low] = leaves
    photo[elevations_deg(HEIGHT) < 0.0] = leaves
    if sun.in_view:
        near = np.degrees(np.arccos(np.clip(direction @ sun.direction(), -1.0, 1.0)))
        photo[near < 3.0] = -1.0
        photo[near < 1.1] = 12.0 * photo.max()
    return photo


@pytest.mark.parametrize("name", MODELS)
def test_a_models_own_sky_is_fitted_exactly(name):
    """Turbidity, exposure and gains are recovered within 1 % and the noise of 1 % (0.0043 in
    log10), although trees, cloud and disc are in the photograph."""
    comparison = compare(photograph(MODELS[name], 4.0, HIGH_SUN), TURBIDITIES)
    found = comparison.fits[name]
    assert found.turbidity == 4.0
    assert found.exposure == pytest.approx(EXPOSURE, rel=0.01)
    assert found.gains == pytest.approx(GAINS, rel=0.01)
    assert found.rms_log10 < 0.006
    assert found.rms_uv < 0.004
    low, high = comparison.as_good[name]
    assert low == high == 4.0


def test_the_disc_is_found_where_it_was_drawn():
    """Within half a pixel, even if the picture's edge cuts the disc in two."""
    for sun in (HIGH_SUN, Sun(180.0, 25.0, True)):
        found = find_disc(photograph(hosek_wilkie, 3.0, sun))
        assert found is not None
        assert found.in_view
        assert found.elevation_deg == pytest.approx(sun.elevation_deg, abs=PIXEL_DEG / 2)
        apart = (found.azimuth_deg - sun.azimuth_deg + 180.0) % 360.0 - 180.0
        assert apart == pytest.approx(0.0, abs=PIXEL_DEG / 2)


def test_no_disc_is_found_in_a_sky_without_one():
    """A twilight glow, without a pixel brighter than its neighbours, is not taken for the disc."""
    assert find_disc(photograph(hosek_wilkie, 2.0, Sun(30.0, -4.0, False))) is None


def test_the_mask_drops_everything_but_sky():
    """Every pixel of tree, ground, cloud and disc is masked; of the clear sky above 20 deg and
    away from the sun at least nine tenths are kept."""
    photo = photograph(hosek_wilkie, 3.0, HIGH_SUN)
    usable = masks_of(photo, HIGH_SUN).usable
    elevation = elevations_deg(HEIGHT)
    assert not usable[elevation < TREES_DEG].any()
    assert not usable[elevation < HORIZON_MARGIN_DEG].any()
    assert not usable[CLOUD].any()
    assert not usable[(photo <= 0.0).any(axis=-1)].any()
    angle = np.degrees(np.arccos(lat_long_directions(HEIGHT) @ HIGH_SUN.direction()))
    clear = (elevation > 20.0)[:, None] & (angle > 15.0)
    assert usable[clear].mean() > 0.9


def test_wires_and_sky_between_clouds_are_left_out():
    """A wire 8 % darker than the sky is found by its neighbourhood, and the 4 deg of sky
    between two clouds are masked; the same sky 15 deg further up is kept."""
    photo = photograph(hosek_wilkie, 3.0, HIGH_SUN)
    wire, gap, above = (slice(40, 41), slice(130, 230)), (slice(25, 30), slice(97, 100)), 14
    photo[wire] *= 0.92
    photo[25:30, 100:107] *= 1.6
    usable = masks_of(photo, HIGH_SUN).usable
    assert usable[wire].mean() < 0.3
    assert not usable[gap].any()
    assert usable[above, gap[1]].all()


def test_a_photograph_of_cut_range_shows_less_contrast():
    """Luminance to the power 0.8 gives a contrast of 0.8, unchanged luminance 1: this tells a
    camera's curve from a wrong sky."""
    photo = photograph(bruneton, 3.0, HIGH_SUN)
    for power in (1.0, 0.8):
        cut = np.where(photo > 0.0, np.abs(photo) ** power, photo)
        pixels = pixels_of(cut, _high_sky())
        found = fit(pixels, bruneton, 3.0, HIGH_SUN)
        residual = residual_log10(pixels, bruneton, found)
        assert contrast(pixels, residual) == pytest.approx(power, abs=0.01)


def test_another_phase_function_is_told_from_the_modules_own():
    """A sky of one lobe with g = 0.8 is fitted within its noise of 0.0043 by that lobe, not by the
    module's own air."""
    sky = bruneton_with(mie_g=0.8)
    pixels = pixels_of(photograph(sky, 3.0, HIGH_SUN), _high_sky())
    assert fit(pixels, sky, 3.0, HIGH_SUN).rms_log10 < 0.006
    assert fit(pixels, bruneton, 3.0, HIGH_SUN).rms_log10 > 0.03


def test_a_sun_below_the_horizon_is_found_by_its_twilight():
    """The azimuth by the sky's mirror symmetry, within two pixels; the depression by the fit,
    on the grid's own value, for the twilight that the photograph was made of."""
    sun = Sun(70.0, -4.0, False)
    photo = photograph(bruneton, 2.0, sun)
    azimuth = find_azimuth_deg(photo, masks_of(photo, None).usable)
    assert azimuth == pytest.approx(70.0, abs=2 * PIXEL_DEG)
    found = compare(photo, (2.0,)).fits["Bruneton"]
    assert found.sun.elevation_deg == -4.0
    assert found.rms_log10 < 0.02


def test_outliers_do_not_move_exposure_and_gains():
    """A twentieth of the pixels ten times too bright, clouds that the mask missed, moves a
    Huber estimate by less than 3 %; a mean of logarithms would move by 12 %."""
    pixels = pixels_of(photograph(hosek_wilkie, 3.0, HIGH_SUN), _high_sky())
    bad = np.random.default_rng(1).random(len(pixels.rgb)) < 0.05
    spoiled = pixels._replace(rgb=np.where(bad[:, None], 10.0 * pixels.rgb, pixels.rgb))
    found = fit(spoiled, hosek_wilkie, 3.0, HIGH_SUN)
    assert found.exposure == pytest.approx(EXPOSURE, rel=0.03)
    assert found.gains == pytest.approx(GAINS, rel=0.03)


def test_the_table_names_what_was_found():
    """The printed rows have each model's fit and, for comparison, the spread of the sky."""
    comparison = compare(photograph(hosek_wilkie, 4.0, HIGH_SUN), (4.0,))
    rows = table_rows("made", comparison)
    assert [row.split("|")[3].strip() for row in rows] == [*comparison.fits, "an even sky"]
    assert rows[0].startswith("| made | 25.1°, -70.1° | Hosek-Wilkie | 4 (4 to 4) | 0.0499 |")
    assert "| {:.2f}, {:.2f}, {:.2f} |".format(*GAINS) in rows[0]


def _high_sky():
    usable = np.zeros((HEIGHT, 2 * HEIGHT), dtype=bool)
    usable[:40] = True
    usable[CLOUD] = False
    angle = np.degrees(np.arccos(lat_long_directions(HEIGHT) @ HIGH_SUN.direction()))
    return usable & (angle > 5.0)


def exr_bytes(folder, radiance):
    write_exr(folder / "whole.exr", np.asarray(radiance, np.float32), {})
    return (folder / "whole.exr").read_bytes()


@pytest.mark.parametrize(
    ("damage", "says"),
    [
        ("missing", "no such file"),
        ("folder", "no such file"),
        ("empty", "no whole picture"),
        ("cut", "no whole picture"),
        ("noise", "no whole picture"),
        ("square", "no lat-long picture"),
        ("huge", "2000000 x 1000000 pixels"),
        ("not finite", "not finite"),
    ],
)
def test_damaged_photographs_are_refused_in_a_sentence(tmp_path, damage, says):
    """The size in the header is checked before memory is taken."""
    whole = exr_bytes(tmp_path, np.ones((4, 8, 3)))
    corners = whole.index(b"dataWindow\0box2i\0") + 21
    huge = struct.pack("<4i", 0, 0, 1_999_999, 999_999)
    broken = np.ones((4, 8, 3))
    broken[1, 2] = np.nan
    contents = {
        "empty": b"", "cut": whole[: len(whole) // 2], "noise": bytes(range(256)),
        "square": exr_bytes(tmp_path, np.ones((4, 4, 3))),
        "huge": whole[:corners] + huge + whole[corners + 16 :],
        "not finite": exr_bytes(tmp_path, broken),
    }  # fmt: skip
    path = tmp_path / "photograph.exr"
    if damage == "folder":
        path.mkdir()
    elif damage != "missing":
        path.write_bytes(contents[damage])
    with pytest.raises(UserError, match=says):
        read_photograph(path)
