"""Path-traced pictures, kept on disk: the frame changes often, the truth does not.

A file is named by all that it depends on, except the sky's and the tracer's own code: after a
change of these its folder is to be emptied.
"""

import os
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from path_tracer.settings import PathTracerSettings, SurfaceModel
from path_tracer.subject import Subject
from path_tracer.tracer import Tracer

from vrut_lite.scene.scene_state import SceneState
from vrut_lite_lab.path_traced.cases import Case
from vrut_lite_lab.pictures.darkness import no_ambient, no_background, no_sun, relit

Light = Literal["all", "sun", "sky"]
Picture = NDArray[np.float32]
Arrays = dict[str, NDArray]
FOLDER = Path(tempfile.gettempdir()) / "truth"
# So far apart begin the samples of two seeds.
_SEED_STEP = 2**20


@dataclass(frozen=True)
class Recipe:
    """How a picture is traced; by default all light on the frame's own surfaces."""

    light: Light = "all"
    surfaces: SurfaceModel = "layered"
    sun: Literal["disc", "sharp"] = "disc"
    max_bounces: int | None = None
    seed: int = 0

    @property
    def name(self) -> str:
        """Of files."""
        bounces = "all" if self.max_bounces is None else self.max_bounces
        return f"{self.light}-{self.surfaces}-{self.sun}-{bounces}-seed{self.seed}"


TRUTH, OTHER_TRUTH = Recipe(), Recipe(seed=1)
# Light that met one surface, and of it the sun's; and that without coats and half shadows.
DIRECT, SUN = Recipe(max_bounces=1), Recipe(light="sun", max_bounces=1)
BARE_SUN = Recipe(light="sun", surfaces="bare", sun="sharp", max_bounces=1)
DIRECT_SAMPLES = 24


def truth(case: Case, state: SceneState, recipe: Recipe, samples: int) -> Picture:
    """The mean radiance (h, w, 3) of so many samples, from disk if it was traced before."""
    name = _name(recipe, samples)
    return kept(case, name, lambda: {"radiance": traced(state, recipe, samples)})["radiance"]


def known_truth(case: Case, recipe: Recipe, samples: int) -> Picture | None:
    """The same if it is on disk."""
    found = known(case, _name(recipe, samples))
    return None if found is None else found["radiance"]


def kept(case: Case, name: str, make: Callable[[], Arrays]) -> Arrays:
    """Arrays from disk, or made and written there whole."""
    found = known(case, name)
    if found is None:
        path = _path(case, name)
        path.parent.mkdir(parents=True, exist_ok=True)
        begun = path.with_name(f"{path.stem}.{os.getpid()}.begun.npz")
        found = make()
        np.savez(begun, allow_pickle=False, **found)
        begun.replace(path)
    return found


def known(case: Case, name: str) -> Arrays | None:
    """Arrays from disk, or None."""
    path = _path(case, name)
    if not path.exists():
        return None
    with np.load(path) as found:
        return {key: found[key] for key in found.files}


def traced(state: SceneState, recipe: Recipe, samples: int) -> Picture:
    """The mean radiance (h, w, 3) of so many samples."""
    settings = PathTracerSettings(
        spp=samples,
        max_bounces=recipe.max_bounces,
        sun=recipe.sun,
        surfaces=recipe.surfaces,
    )
    tracer = Tracer(Subject(lit_by(state, recipe.light)), settings)
    picture = tracer.trace(recipe.seed * _SEED_STEP, samples)
    assert picture is not None
    return picture


def lit_by(state: SceneState, light: Light) -> SceneState:
    """The state with sun or sky alone, or as it is."""
    if light == "sun":
        return relit(state, background=no_background(), ambient=no_ambient())
    return relit(state, key_light=no_sun()) if light == "sky" else state


def _name(recipe: Recipe, samples: int) -> str:
    return f"{recipe.name}-{samples}"


def _path(case: Case, name: str) -> Path:
    return FOLDER / f"{case.name}-{case.content}-{name}.npz"
