"""A luminaire of a file: its flux, power and opening, against integrals and the formats' tables."""

from pathlib import Path

import numpy as np
import pytest
from luminaire_files import panel_ies, spot_ldt

from vrut_lite.errors import UserError
from vrut_lite.scene.ies_file import read_ies
from vrut_lite.scene.luminaire import LuminousOpening
from vrut_lite.scene.luminaire_file import read_luminaire, read_luminaire_file
from vrut_lite.scene.scene_file_error import SceneFileError

SCENES = Path(__file__).parents[2] / "scenes" / "work"


def test_a_lambertian_panel_has_its_flux_and_intensity():
    """I = flux / pi cos(gamma), in full precision at the file's angles; -1 lumens is absolute."""
    panel = read_luminaire(panel_ies().encode())
    assert panel.lamp_lm is None
    assert panel.watts == 25.0
    assert panel.flux_lm == pytest.approx(3000.0, rel=1e-4)
    directions = [[1.0, 0.0, 0.0], [0.5, np.sqrt(0.75), 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]
    expected = np.array([1.0, 0.5, 0.0, 0.0]) * 3000.0 / np.pi
    np.testing.assert_allclose(panel.intensity_cd(directions), expected, rtol=1e-8, atol=1e-6)


def test_a_spot_of_eulumdat_has_its_flux_and_intensity():
    """I = flux (n + 1) / 2 pi cos^n; a width of 0 is a circle."""
    spot = read_luminaire(spot_ldt().encode())
    assert spot.flux_lm == pytest.approx(800.0, rel=2e-3)
    assert (spot.lamp_lm, spot.watts) == (800.0, 9.0)
    assert spot.opening == LuminousOpening(0.06, 0.06, 0.0, True)
    peak = 800.0 * 9.0 / (2.0 * np.pi)
    assert spot.intensity_cd([1.0, 0.0, 0.0]) == pytest.approx(peak, rel=1e-8)
    lines = spot_ldt().split("\n")
    lines[26] = "-1"
    assert read_luminaire("\n".join(lines).encode()).lamp_lm is None


def test_intensity_is_linear_between_the_files_own_angles():
    """Half a degree from the axis of a beam that falls within one degree: no table blurs it."""
    text = panel_ies().split("TILT")[0] + (
        "TILT=NONE\n1 -1 1 4 2 1 2 0 0 0\n1 1 5\n0 0.5 1 90\n0 90\n1000 400 0 0\n1000 200 0 0\n"
    )
    beam = read_ies(text.encode())
    half = np.radians(0.5)
    for phi, expected in ((0.0, 400.0), (np.pi / 2, 200.0), (np.pi, 400.0), (np.pi / 4, 300.0)):
        local = [np.cos(half), np.sin(half) * np.cos(phi), np.sin(half) * np.sin(phi)]
        assert beam.intensity_cd(local) == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize(
    ("size", "opening"),
    [
        ((0.0, 0.0, 0.0), LuminousOpening(0.0, 0.0, 0.0, False)),
        ((0.6, 1.2, 0.0), LuminousOpening(0.6, 1.2, 0.0, False)),
        ((0.6, 1.2, 0.1), LuminousOpening(0.6, 1.2, 0.1, False)),
        ((-0.5, 0.0, 0.0), LuminousOpening(0.5, 0.5, 0.0, True)),
        ((-0.5, -0.5, 0.0), LuminousOpening(0.5, 0.5, 0.0, True)),
        ((-0.5, -0.8, 0.0), LuminousOpening(0.5, 0.8, 0.0, True)),
        ((-0.5, -0.5, 0.3), LuminousOpening(0.5, 0.5, 0.3, True)),
        ((-0.5, -0.5, -0.5), LuminousOpening(0.5, 0.5, 0.5, True)),
        ((0.0, 1.2, -0.1), LuminousOpening(0.1, 1.2, 0.1, False)),
        ((-0.1, 1.2, -0.1), LuminousOpening(0.1, 1.2, 0.1, False)),
    ],
)
def test_the_opening_is_that_of_any_edition(size, opening):
    """Point, rectangle, box, circles of 1995 and 2002, ellipse, cylinders, sphere: a recessed
    downlight with a width of -0.5 and no length is a circle, not an error."""
    assert read_ies(panel_ies(size_m=size).encode()).opening == pytest.approx(opening)
    in_feet = tuple(v / 0.3048 for v in size)
    found = read_ies(panel_ies(size_m=in_feet, unit=1).encode()).opening
    assert found == pytest.approx(opening, rel=1e-5)


def test_factors_are_linear():
    """Multiplier and ballast factor scale candela once."""
    text = panel_ies().replace("1 -1 1 91", "2 500 3 91").replace("1 1 25", "0.8 1 25")
    lamp = read_ies(text.encode())
    assert lamp.lamp_lm == 1000.0
    assert lamp.flux_lm == pytest.approx(0.8 * 3 * 3000.0, rel=1e-4)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("\n20 21", "\n2o 21", "damaged in line 9: '2o' is no number"),
        ("\n20 21", "\n21 20", "do not rise in line 9"),
        ("\n20 21", "\nnan 21", "not finite in line 9"),
        ("\n0\n954.9", "\n0\n-954.9", "impossible candela in line 18"),
        ("91 1 1 2", "91 1 4 2", "photometry of type 4 in line 5"),
        ("91 1 1 2", "0 1 1 2", "0 x 1 angles in line 5"),
    ],
)
def test_a_damaged_ies_file_is_refused_with_its_line(tmp_path, old, new, said):
    text = panel_ies()
    assert old in text
    path = tmp_path / "panel.ies"
    path.write_text(text.replace(old, new, 1))
    with pytest.raises(UserError, match=f"cannot read the luminaire .*panel.ies: .*{said}"):
        read_luminaire_file(path)


def test_a_damaged_eulumdat_file_is_refused_with_its_line():
    lines = spot_ldt().split("\n")
    lines[60] = "x"
    with pytest.raises(SceneFileError, match="damaged in line 61: 'x' is no number"):
        read_luminaire("\n".join(lines).encode())


def test_a_missing_luminaire_is_refused(tmp_path):
    with pytest.raises(UserError, match="cannot read the luminaire"):
        read_luminaire_file(tmp_path / "none.ies")


def test_luminaires_of_the_example_are_what_they_say():
    """An idealised panel, I = 3000 lm / pi cos, and a spot, I = 800 lm 9 / 2 pi cos^8."""
    panel = read_luminaire_file(SCENES / "lambertian_panel.ies")
    spot = read_luminaire_file(SCENES / "cosine_spot.ldt")
    cosine = np.cos(np.radians(panel.gamma_deg)).clip(0.0)
    np.testing.assert_allclose(panel.candela[:, 0], 3000.0 / np.pi * cosine, atol=1e-5)
    np.testing.assert_allclose(spot.candela[:, 0], 3600.0 / np.pi * cosine**8, atol=1e-5)
    assert panel.opening == LuminousOpening(0.3, 1.2, 0.0, False)
