"""Writes the whole study into one folder, part by part."""

from collections.abc import Callable, Iterator, Sequence
from itertools import pairwise
from typing import NamedTuple

from bruneton_sky.published.classical_rules import RULES as TEXTBOOK

from vrut_lite.errors import UserError
from vrut_lite.numeric_types import FloatArray
from vrut_lite_lab.study.framework.day import KIDER, MeasuredDay
from vrut_lite_lab.study.framework.fisheye import pixels
from vrut_lite_lab.study.models.model import SkyModel
from vrut_lite_lab.study.report.by_angle import EDGES_DEG, errors_by_angle, plot_by_angle
from vrut_lite_lab.study.report.choices import ModelSet
from vrut_lite_lab.study.report.figures import MomentSkies, figures
from vrut_lite_lab.study.report.folder import PAGE, Folder
from vrut_lite_lab.study.report.moments import Moment
from vrut_lite_lab.study.report.page import Page, in_text
from vrut_lite_lab.study.report.plots import errors_by_sun, run_time_against_error
from vrut_lite_lab.study.report.scores import references, score, table_two
from vrut_lite_lab.study.report.skies import StudySky, measured_sky, model_sky
from vrut_lite_lab.study.rules.against_truth import (
    FINEST,
    NODES,
    RULES,
    SAMPLES,
    SUN_ZENITHS_DEG,
    RuleError,
    fewest_nodes,
    rule_errors,
)
from vrut_lite_lab.study.rules.airs import rgb_airs, spectral_airs
from vrut_lite_lab.study.rules.run_times import RunTime, cpu_run_times
from vrut_lite_lab.study.rules.shader_run_times import shader_run_times

Tell = Callable[[str], None]
# The last but one is the finest that Mesa's software renderer can do, the last for cards.
_SHADER_SAMPLES = ((16, 8), (32, 16), (64, 32), (128, 64), (232, 116), (512, 256))
TIMED_SUNS_DEG = (25.0, 87.0)
_INTRODUCTION = (
    "The air is that of Bruneton's evaluation of 2016 with this aerosol; zenith in the middle, "
    "north at the bottom, east right; a red cross is the sun, dots are the 81 directions of the "
    "scans. RMSE is in mW m⁻² sr⁻¹ nm⁻¹, 360 to 720 nm."
)


class StudyPlan(NamedTuple):
    """The parts of the study to make.

    Attributes:
        sets: of models, a set of figures for each.
        moments: the rows of the figures.
        scored: the moments of the tables.
        physics: the computed reference.
        size: edge in pixels of what is computed of a round picture.
        table_two: the samples of the paper's table 2 that are repeated; needs measurements.
        suns_deg, timed_suns_deg: zenith angles at which rules are held against truth, and timed.
        changes: skies of the same model in changed air, the unchanged one first.
    """

    sets: list[ModelSet]
    moments: list[Moment]
    scored: list[Moment]
    physics: SkyModel
    size: int
    table_two: tuple[tuple[int, int], ...]
    day: MeasuredDay = KIDER
    suns_deg: tuple[float, ...] = SUN_ZENITHS_DEG
    timed_suns_deg: tuple[float, ...] = TIMED_SUNS_DEG
    changes: tuple[SkyModel, ...] = ()

    @property
    def measured(self) -> bool:
        """Whether the tables' references are measurements."""
        return all(moment.measured is not None for moment in self.scored)

    def steps(self) -> int:
        """Number of steps that `write_study` names."""
        models = sum(len(each.models) for each in self.sets)
        table_two = len(TEXTBOOK) * len(self.table_two)
        rules = len(spectral_airs()) * len(self.suns_deg) + 2 * len(self.timed_suns_deg)
        scored = models + len(self.changes) + (2 if self.measured else 1)
        return (models + 1) * len(self.moments) + scored + table_two + rules


def write_study(plan: StudyPlan, folder: Folder, tell: Tell) -> None:
    """Write everything; `tell` is called with the name of each step before it begins."""
    page = Page("Integration rules and sky models against truth and measurements")
    page.paragraph(plan.day.in_words)
    page.paragraph(_INTRODUCTION)
    _write_scores(plan, folder, page, tell)
    if plan.table_two:
        _write_table_two(plan, folder, page, tell)
    _write_rules(plan, folder, page, tell)
    if plan.timed_suns_deg:
        _write_run_times(plan, folder, page, tell)
    _write_figures(plan, folder, page, tell)
    folder.content(PAGE, page.html().encode())


def _write_scores(plan: StudyPlan, folder: Folder, page: Page, tell: Tell) -> None:
    against = "the measurements" if plan.measured else f"the reference, {plan.physics.title}"
    page.heading(f"Models against {against}")
    page.paragraph(
        "RMSE weighs by brightness: of what is left in a good sky, half comes from the six "
        "directions nearest the sun. The relative error counts all of the 81 directions alike; "
        "mean and root mean square, in percent."
    )
    tell(f"{plan.physics.title}: reference")
    reference = references(plan.scored, plan.physics)
    models = [model for each in plan.sets for model in each.models]
    models += [plan.physics] if plan.measured else []
    header = ["model", "RMSE", "mean error in %", "rms error in %"]
    header += [moment.label for moment in plan.scored]

    def rows(some: Sequence[SkyModel]) -> Iterator[tuple[object, ...]]:
        for model in some:
            tell(f"{model.title}: errors")
            got = score(model, plan.scored, reference)
            yield got.title, got.rmse_mw, 100.0 * got.bias, 100.0 * got.rms, *got.each_mw

    scores = list(rows(models))
    page.table(header, scores, folder.csv("models", header, scores))
    _write_by_angle(plan, models, reference, folder, page)
    if plan.changes:
        page.heading("One change of the air")
        page.paragraph(
            "The aerosol was taken from the day of the scans. Each line changes one thing for "
            "a reason of physics, nothing is fitted."
        )
        changed = list(rows(plan.changes))
        page.table(header, changed, folder.csv("changes", header, changed))


def _write_by_angle(
    plan: StudyPlan, models: Sequence[SkyModel], reference: FloatArray, folder: Folder, page: Page
) -> None:
    page.heading("Relative error by angle from the sun, and by the sun's elevation")
    page.paragraph(
        "Root mean square in percent, each direction counting alike. Instruments themselves err by "
        "3 to 5 %, grey in the figure: what is less than that is agreement."
    )
    errors = [errors_by_angle(model, plan.scored, reference) for model in models]
    picture = folder.content("by_angle.png", plot_by_angle(errors, plan.scored))
    page.figure(picture, "Relative error by angle from the sun and by the sun's elevation")
    spans = [f"{low} to {high}°" for low, high in pairwise(EDGES_DEG)]
    rows = [(each.title, *(100.0 * share for share in each.from_sun)) for each in errors]
    page.table(["model", *spans], rows, folder.csv("by_angle", ["model", *spans], rows))
    suns = [moment.title for moment in plan.scored]
    rows = [(each.title, *(100.0 * share for share in each.of_moments)) for each in errors]
    page.table(["model", *suns], rows, folder.csv("by_sun", ["model", *suns], rows))


def _write_table_two(plan: StudyPlan, folder: Folder, page: Page, tell: Tell) -> None:
    page.heading("Table 2 of Gałaj and Wojciechowski 2019")
    page.paragraph(
        "RMSE of single scattering by each rule: as published, by the rule itself, and with the "
        "whole share of a node in the optical depth before it, as in the same authors' program."
    )
    lines = table_two(plan.scored, plan.table_two, tell)
    header = ["rule", "samples", "published", "the rule itself", "whole share before"]
    header += ["rms error of the rule in %"]
    page.table(header, lines, folder.csv("table_2", header, lines))


def _write_rules(plan: StudyPlan, folder: Folder, page: Page, tell: Tell) -> None:
    page.heading("The rules against the integral")
    errors: list[RuleError] = []
    for name, air in spectral_airs().items():
        for sun in plan.suns_deg:
            tell(f"rules against truth, atmosphere {name}, sun {sun:g} deg")
            errors += rule_errors(name, air, sun)
    page.figure(folder.content("rules.png", errors_by_sun(errors)), "Relative RMSE of the rules")
    header = ["atmosphere", "sun zenith in deg", "rule", *map(in_text, SAMPLES)]
    page.table(header, _by_samples(errors), folder.csv("rules", RuleError._fields, errors))
    page.paragraph("Gauss-Legendre, by nodes per segment; last, how many reach Simpson 512 × 256:")
    header = ["atmosphere", "sun zenith in deg", *map(str, NODES), "enough"]
    rows = _by_nodes(errors)
    page.table(header, rows, folder.csv("gauss_legendre", header, rows))


def _cases(errors: list[RuleError]) -> list[list[RuleError]]:
    keys = dict.fromkeys((each.air, each.sun_zenith_deg) for each in errors)
    return [[each for each in errors if (each.air, each.sun_zenith_deg) == key] for key in keys]


def _by_samples(errors: list[RuleError]) -> list[tuple[object, ...]]:
    return [
        (case[0].air, case[0].sun_zenith_deg, rule, *(e.rms for e in case if e.rule == rule))
        for case in _cases(errors)
        for rule in RULES
    ]


def _by_nodes(errors: list[RuleError]) -> list[tuple[object, ...]]:
    rows: list[tuple[object, ...]] = []
    for case in _cases(errors):
        enough = fewest_nodes(case, "simpson")
        ours = (each.rms for each in case if each.rule == "gauss-legendre")
        last = enough.samples if enough else "more"
        rows.append((case[0].air, case[0].sun_zenith_deg, *ours, last))
    return rows


def _write_run_times(plan: StudyPlan, folder: Folder, page: Page, tell: Tell) -> None:
    page.heading("Run time against error")
    air, times, said = rgb_airs()["A"], list[RunTime](), ""
    for sun in plan.timed_suns_deg:
        tell(f"run times on the CPU, sun {sun:g} deg")
        times += cpu_run_times(air, sun)
    for sun in plan.timed_suns_deg:
        tell(f"run times of the shader, sun {sun:g} deg")
        try:
            said, rows = shader_run_times(air, sun, _SHADER_SAMPLES)
            times += rows
        except UserError as error:
            said = f"no shader was timed: {error}"
    page.paragraph(
        "Atmosphere A at three wavelengths. CPU: compiled, float64, one thread, the 81 "
        f"directions. Shader: float32, a cube map's upper face; {said}."
    )
    _tell_of_finest(times, page)
    picture = folder.content("run_times.png", run_time_against_error(times))
    page.figure(picture, "Nanoseconds per ray against relative RMSE")
    page.table(RunTime._fields, times, folder.csv("run_times", RunTime._fields, times))


def _tell_of_finest(times: list[RunTime], page: Page) -> None:
    for sun in dict.fromkeys(each.sun_zenith_deg for each in times):
        some = [t for t in times if (t.device, t.sun_zenith_deg) == ("CPU", sun)]
        (simpson,) = (t for t in some if (t.rule, t.samples) == ("simpson", FINEST))
        ours = (t for t in some if t.rule == "gauss-legendre" and t.rms <= simpson.rms)
        first = next(ours, None)
        if first:
            page.paragraph(
                f"Sun {sun:g}° from the zenith: Simpson 512 × 256 errs by {simpson.rms:.1e} and "
                f"takes {simpson.ns_per_ray:,.0f} ns; Gauss-Legendre with {first.samples} nodes "
                f"errs by {first.rms:.1e} and takes {first.ns_per_ray:,.0f} ns."
            )


def _write_figures(plan: StudyPlan, folder: Folder, page: Page, tell: Tell) -> None:
    at = pixels(plan.size)
    references: list[tuple[StudySky, StudySky | None]] = []
    for moment in plan.moments:
        tell(f"{plan.physics.title}: {moment.title}")
        seen = None if moment.measured is None else measured_sky(moment.measured, at)
        references.append((model_sky(plan.physics, moment, at), seen))
    for each in plan.sets:
        page.heading(each.title)
        rows = []
        for moment, (physics, seen) in zip(plan.moments, references, strict=True):
            skies = []
            for model in each.models:
                tell(f"{model.title}: {moment.title}")
                skies.append(model_sky(model, moment, at))
            rows.append(MomentSkies(moment, tuple(skies), physics, seen))
        titles = [model.title for model in each.models]
        for figure in figures(titles, plan.physics.title, rows, at):
            name = folder.picture(f"{figure.name}_{each.name}", figure.image)
            page.figure(name, figure.title)
