"""Choices of the study: models by name, and the sets of models in its figures."""

import re
from collections.abc import Sequence
from dataclasses import fields, replace
from typing import Any, NamedTuple, cast

from bruneton_sky.published.classical_rules import RULES, checked_intervals
from bruneton_sky.published.single_scattering import Rule

from vrut_lite.errors import UserError
from vrut_lite_lab.study.framework.atmosphere import StudyAtmosphere
from vrut_lite_lab.study.framework.day import KIDER, MeasuredDay
from vrut_lite_lab.study.models.bruneton import Bruneton
from vrut_lite_lab.study.models.changes import CHANGES
from vrut_lite_lab.study.models.converged import Converged
from vrut_lite_lab.study.models.measured_aerosol import MeasuredAerosol, measured_air
from vrut_lite_lab.study.models.model import SkyModel
from vrut_lite_lab.study.models.registry import MODELS
from vrut_lite_lab.study.models.rules import PUBLISHED, SingleScattering

_TEXTBOOK = re.compile(rf"({'|'.join(RULES)})-(\d{{1,4}})x(\d{{1,4}})(-published)?")
_GAUSS = re.compile(r"gauss-legendre-([1-9]\d?)")
# These need seconds for a sky.
_SLOW = ("nishita96", "nishita96-published", "haber")
# No figure of it was published: the quirk is that of its authors' program alone.
_UNPUBLISHED = "haber-published"


class ModelSet(NamedTuple):
    """Models that are shown side by side; the name is for files, the title for readers."""

    name: str
    title: str
    models: tuple[SkyModel, ...]


def model_by_name(name: str) -> SkyModel:
    """A model of the registry, or one of the rules, as in `simpson-128x64`.

    Raises:
        UserError: there is none of that name.
    """
    if name in MODELS:
        return MODELS[name]()
    if found := _GAUSS.fullmatch(name):
        return SingleScattering("gauss-legendre", int(found[1]))
    if found := _TEXTBOOK.fullmatch(name):
        quirks = PUBLISHED if found[4] else None
        try:
            intervals = checked_intervals(found[1], (int(found[2]), int(found[3])))
        except ValueError as error:
            raise UserError(f"--models: {name}: {error}") from None
        return SingleScattering(cast(Rule, found[1]), intervals, quirks)
    raise UserError(
        f"--models: there is no model {name!r}: take some of {', '.join(MODELS)}, "
        "gauss-legendre-8, or midpoint-, trapezoid- or simpson-16x8"
    )


def physics() -> SkyModel:
    """The reference where nothing was measured: the converged sky of all orders."""
    return Converged()


def on_day(model: SkyModel, day: MeasuredDay) -> SkyModel:
    """A model in the air of another day; on Kider's it is as published."""
    if day == KIDER:
        return model
    # Every model is a dataclass of its air, or of a turbidity that stands for it.
    changed: Any = model
    has = {field.name for field in fields(changed)}
    study = StudyAtmosphere.of_day(day)
    if isinstance(model, MeasuredAerosol):
        return replace(model, air=measured_air(day=day))
    if "turbidity" in has:
        changed = replace(changed, turbidity=study.turbidity)
    if "air" in has:
        published = isinstance(changed.air, StudyAtmosphere)
        changed = replace(changed, air=study if published else study.bruneton_atmosphere())
    return cast(SkyModel, changed)


def sets_on_day(sets: Sequence[ModelSet], day: MeasuredDay) -> list[ModelSet]:
    """The sets' models in the air of a day."""
    return [
        each._replace(models=tuple(on_day(model, day) for model in each.models)) for each in sets
    ]


def changed_air() -> tuple[SkyModel, ...]:
    """Bruneton's sky, then the same with one change of the air each."""
    return (Bruneton(), *(change.sky() for change in CHANGES.values()))


def chosen_set(names: Sequence[str]) -> ModelSet:
    """One set of the models of these names.

    Raises:
        UserError: one is unknown, or named twice.
    """
    stripped = [name.strip() for name in names]
    if len(set(stripped)) < len(stripped):
        raise UserError("--models: names a model twice")
    return ModelSet("chosen", "Chosen models", tuple(model_by_name(name) for name in stripped))


def usual_sets(quick: bool) -> list[ModelSet]:
    """The published paper's three cases, then the models; the quick ones leave out slow ones."""
    cases = [
        ModelSet(f"case{i}", f"Case {i}, {quality} quality: {n} × {m} samples", _rules(n, m))
        for i, (quality, n, m) in enumerate(
            (("low", 16, 8), ("medium", 128, 64), ("high", 512, 256)), start=1
        )
    ]
    left_out = (physics().name, _UNPUBLISHED, *(_SLOW if quick else ()))
    wanted = [name for name in MODELS if name not in left_out]
    models = ModelSet("models", "Models", tuple(model_by_name(name) for name in wanted))
    return [*cases[: 2 if quick else 3], models]


def _rules(view: int, light: int) -> tuple[SkyModel, ...]:
    return tuple(SingleScattering(cast(Rule, rule), (view, light)) for rule in RULES)
