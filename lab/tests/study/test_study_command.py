"""`vrut-lite study`: what it writes, and what it says to bad input."""

import csv
import re
from dataclasses import dataclass

import numpy as np
import pytest
from click.testing import CliRunner

from vrut_lite.errors import UserError
from vrut_lite_lab.study.command import study
from vrut_lite_lab.study.framework.atmosphere import STUDY
from vrut_lite_lab.study.framework.colour_scales import error_scale
from vrut_lite_lab.study.framework.directions import COUNT
from vrut_lite_lab.study.framework.errors import rmse
from vrut_lite_lab.study.framework.fisheye import pixels
from vrut_lite_lab.study.framework.interpolant import interpolate
from vrut_lite_lab.study.framework.spectra import WAVELENGTHS_NM
from vrut_lite_lab.study.models.rules import PUBLISHED
from vrut_lite_lab.study.report import study as study_parts
from vrut_lite_lab.study.report.choices import ModelSet, chosen_set, model_by_name, usual_sets
from vrut_lite_lab.study.report.figures import MomentSkies, figures
from vrut_lite_lab.study.report.folder import study_folder
from vrut_lite_lab.study.report.moments import Moment, moments
from vrut_lite_lab.study.report.panels import TILE
from vrut_lite_lab.study.report.scores import score, table_two
from vrut_lite_lab.study.report.skies import StudySky, directional_radiance, measured_sky, model_sky
from vrut_lite_lab.study.report.study import StudyPlan, write_study
from vrut_lite_lab.study.rules.airs import clear_air


@dataclass(frozen=True)
class GreySky:
    """As bright as the sun's spectrum over 1e5 sr, times a factor, everywhere."""

    factor: float = 1.0
    name: str = "grey"
    title: str = "Grey"

    def sky_radiance(self, sun_zenith_rad, view_zenith_rad, relative_azimuth_rad):
        """Radiance (n, 40)."""
        return np.outer(np.ones_like(view_zenith_rad), self.factor * 1e-5 * STUDY.solar_irradiance)

    def sun_irradiance(self, sun_zenith_rad):
        """Irradiance (40,)."""
        return STUDY.solar_irradiance


def measured_moment(factor: float = 1.0) -> Moment:
    radiance = np.outer(np.full(COUNT, factor * 1e-5), STUDY.solar_irradiance)
    return Moment("11:45", 0.465, 2.4, radiance)


def test_hours_become_places_of_the_sun() -> None:
    """06:00 and 07:00 are the evaluation's sunrise steps: zenith 86.62 and 76.32 degrees."""
    early, later = moments(["06:00", " 07:00"], [])
    assert np.degrees(early.sun_zenith_rad) == pytest.approx(86.62, abs=0.005)
    assert np.degrees(later.sun_zenith_rad) == pytest.approx(76.32, abs=0.005)
    assert early.title == "06:00, sun 86.6°"


def test_models_are_found_by_name() -> None:
    """Every name that a model bears calls that model, the rules at any samples included."""
    for each in usual_sets(quick=False):
        for model in each.models:
            assert model_by_name(model.name).title == model.title
    assert model_by_name("trapezoid-8x128-published").quirks == PUBLISHED
    assert model_by_name("gauss-legendre-8").samples == 8


def test_score_of_a_sky_twice_as_bright() -> None:
    """Twice the reference: relative error 1 everywhere, RMSE that of the reference itself."""
    moment = measured_moment()
    got = score(GreySky(2.0), [moment, moment], np.stack([moment.measured] * 2))
    assert got.bias == pytest.approx(1.0)
    assert got.rms == pytest.approx(1.0)
    of_reference = 1e3 * rmse(moment.measured, np.zeros_like(moment.measured))
    assert got.each_mw == pytest.approx([of_reference] * 2)
    assert got.rmse_mw == pytest.approx(of_reference)


def test_a_pixel_shows_the_direction_it_is_in() -> None:
    """A rule's picture holds the rule's own radiance at the pixel's zenith angle and azimuth."""
    at, moment = pixels(16), Moment("08:00", 1.1, 1.6)
    model = model_by_name("simpson-16x8")
    sky = model_sky(model, moment, at)
    pixel = 17
    relative = at.azimuth_rad[[pixel]] - moment.sun_azimuth_rad
    alone = model.sky_radiance(moment.sun_zenith_rad, at.zenith_rad[[pixel]], relative)
    expected = StudySky(alone, np.zeros((1, 3)))
    assert sky.luminance[pixel] == pytest.approx(_luminance(expected.radiance)[0], rel=1e-9)
    np.testing.assert_allclose(sky.radiance, directional_radiance(model, moment))


def test_measurements_are_interpolated_before_or_after_their_colour() -> None:
    """Both are linear: colours of interpolated spectra are interpolated colours."""
    at, air = pixels(16), np.random.default_rng(3).uniform(0.5, 1.5, (COUNT, WAVELENGTHS_NM.size))
    seen = measured_sky(air, at)
    spectra = interpolate(air, at.zenith_rad, at.azimuth_rad)
    np.testing.assert_allclose(seen.luminance, _luminance(spectra), rtol=1e-10)


def _luminance(radiance):
    from vrut_lite_lab.study.framework.colour import luminance

    return luminance(radiance)


def test_figures_have_a_tile_for_each_sky() -> None:
    """Rows are moments, columns models, physics and measurements; errors are from the latter."""
    at, moment = pixels(32), measured_moment()
    models = tuple(model_sky(GreySky(factor), moment, at) for factor in (1.0, 2.0))
    row = MomentSkies(
        moment, models, model_sky(GreySky(3.0), moment, at), measured_sky(moment.measured, at)
    )
    made = {figure.name: figure.image for figure in figures(["a", "b"], "c", [row, row], at)}
    assert sorted(made) == [
        "figure2_fisheye", "figure3_luminance", "figure4_relative_luminance",
        "figure5_chromaticity", "figure6_relative_error",
    ]  # fmt: skip
    pitch = made["figure2_fisheye"].shape[1] - made["figure6_relative_error"].shape[1]
    assert pitch > TILE
    # The middles of the three tiles: 0, 100 and 200 % too bright.
    left = made["figure6_relative_error"].shape[1] - 3 * pitch
    for column, step in enumerate((20, 30, 40)):
        image = made["figure6_relative_error"]
        middle = image[TILE // 2 + 30, left + column * pitch + TILE // 2]
        np.testing.assert_array_equal(middle, error_scale()[step])


def test_table_two_has_the_papers_lines() -> None:
    """Ours beside the published 32.2, 33.7 and 31.3 mW of the low case."""
    lines = table_two([measured_moment()], [(16, 8)])
    assert [line.published_mw for line in lines] == [32.2, 33.7, 31.3]
    assert all(line.ours_mw != line.whole_share_mw for line in lines)


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    """A small study, and what it told."""
    told: list[str] = []
    moment = measured_moment(1.1)
    plan = StudyPlan(
        sets=[ModelSet("some", "Some models", (GreySky(), model_by_name("preetham")))],
        moments=[moment, Moment("06:00", 1.51, 1.1)],
        scored=[moment],
        physics=GreySky(1.2, "physics", "Physics"),
        size=32,
        table_two=((16, 8),),
        suns_deg=(25.0,),
        timed_suns_deg=(),
    )
    target = tmp_path_factory.mktemp("study") / "made" / "here"
    with pytest.MonkeyPatch.context() as patch, study_folder(target) as folder:
        # Of the rules two wavelengths are enough here; test_study_rules.py has all.
        patch.setattr(
            study_parts, "spectral_airs", lambda: {"A": clear_air(np.array([450.0, 600.0]))}
        )
        write_study(plan, folder, told.append)
        steps = plan.steps()
    return steps, target, told


def test_page_names_only_files_that_are_there(written) -> None:
    """Every picture and table of the page lies beside it, and nothing else was left behind."""
    _, target, _ = written
    page = (target / "index.html").read_text(encoding="utf-8")
    named = set(re.findall(r'(?:src|href)="([^"]+)"', page))
    assert {path.name for path in target.iterdir()} == named | {"index.html"}
    assert {"figure2_fisheye_some.png", "rules.png", "models.csv", "table_2.csv"} <= named


def test_progress_is_told_to_its_end(written) -> None:
    """As many steps are told as were announced."""
    steps, _, told = written
    assert len(told) == steps


def test_table_of_models_is_the_score(written) -> None:
    """The CSV holds the numbers in full: a sky a tenth darker than measured errs by -1/11."""
    _, target, _ = written
    with (target / "models.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [row["model"] for row in rows] == ["Grey", "Preetham 1999", "Physics"]
    assert float(rows[0]["mean error in %"]) == pytest.approx(-100 / 11)
    assert float(rows[2]["rms error in %"]) == pytest.approx(100 / 11)


def test_older_results_stay_until_new_ones_are_whole(tmp_path) -> None:
    """A study that fails leaves the folder as it was, other files included."""
    (tmp_path / "index.html").write_text("old")
    (tmp_path / "mine.txt").write_text("mine")

    def fail() -> None:
        with study_folder(tmp_path) as folder:
            folder.content("index.html", b"new")
            raise UserError("the study broke")

    with pytest.raises(UserError, match="broke"):
        fail()
    assert (tmp_path / "index.html").read_text() == "old"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["index.html", "mine.txt"]
    with study_folder(tmp_path) as folder:
        folder.content("index.html", b"new")
    assert (tmp_path / "index.html").read_text() == "new"
    assert (tmp_path / "mine.txt").read_text() == "mine"


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--models", "preethan"], "there is no model 'preethan'"),
        (["--models", "simpson-15x8"], "must be even"),
        (["--models", "oneil,oneil"], "twice"),
        (["--times", "6.30"], "'6.30' is no hour"),
        (["--times", "03:00"], "below the horizon"),
        (["--measurements", "nowhere.npz"], "there are no measurements"),
        (["-o", "taken"], "cannot write taken"),
    ],
)
def test_bad_input_is_refused_in_one_sentence(arguments, said: str, tmp_path, monkeypatch) -> None:
    """Before any work, and with nothing written."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "taken").write_text("a file")
    result = CliRunner().invoke(study, arguments)
    assert isinstance(result.exception, UserError)
    assert said in str(result.exception)
    assert "\n" not in str(result.exception)
    assert [path.name for path in tmp_path.iterdir()] == ["taken"]


def test_help_shows_an_example() -> None:
    """Whoever asks for help sees a line to type."""
    assert "Example: vrut-lite study --quick" in CliRunner().invoke(study, ["--help"]).output


def test_chosen_models_make_one_set() -> None:
    """The order asked for is the order of the columns."""
    chosen = chosen_set(["oneil", " midpoint-32x16"])
    assert [model.name for model in chosen.models] == ["oneil", "midpoint-32x16"]
