"""A picture, some samples at a time: the only file that makes mitsuba trace.

Sun and sky are traced apart and added, for light is additive: a path that had to choose between
them would find the sun every other time, and sunlit ground would be grainy.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import msgspec
import numpy as np
from numpy.typing import NDArray

from path_tracer.camera import sensor
from path_tracer.eye_rays import Cut, cut_of, past_unseen, sees
from path_tracer.guided_path import guided_path
from path_tracer.lamps import lamp_emitters
from path_tracer.library import load_mitsuba
from path_tracer.openings import WORTH_PATHS, learn, survey
from path_tracer.settings import PathTracerSettings
from path_tracer.shapes import glowing_shapes, matter
from path_tracer.sky_map import darkness, radiance_cube, sky_emitter
from path_tracer.subject import Subject
from path_tracer.sun import sun_emitter
from path_tracer.surfaces import model_of
from vrut_lite.geometry.cube_map import reduce_cube

# Between two questions whether to go on: a second or less on one core.
_PATHS_A_BATCH = 2**18
# From here on dim paths are ended by chance, and the others weigh more for it.
_ROULETTE_DEPTH = 8

# Two seeds a sample: one of the sun's, one of all else's.
_SEEDS_A_SAMPLE = 2
# Share of a sky by which another may differ and pass for it.
_UNSEEN = 0.01

Ask = Callable[[], bool]
Tell = Callable[[int], None]


class Tracer:
    """Traces one subject; scenes and trees are built with the first samples."""

    def __init__(self, subject: Subject, settings: PathTracerSettings):
        self._subject = subject
        self._settings = settings
        self._scenes: list[_Addend] | None = None
        # Number of scenes (sun, sky) whose paths are guided to openings, once something is traced.
        self.guided = 0

    def trace(
        self,
        first: int,
        count: int,
        cancelled: Ask = lambda: False,
        traced: Tell = lambda samples: None,
    ) -> NDArray[np.float32] | None:
        """The mean radiance (h, w, 3) of samples number `first` to `first + count` of a pixel.

        The same numbers give the same samples. None if it was `cancelled`, which is asked
        between batches; `traced` hears how many samples each batch brought.

        Raises:
            UserError: mitsuba, or the variant that is set, is not there.
        """
        mitsuba = load_mitsuba(self._settings.variant)
        width_px, height_px = self._subject.state.size_px
        total = np.zeros((height_px, width_px, 3))
        at_once = max(1, _PATHS_A_BATCH // (width_px * height_px))
        for start in range(first, first + count, at_once):
            if cancelled():
                return None
            if self._scenes is None:
                self._scenes = _scenes(mitsuba, self._subject, self._settings)
                self.guided = sum(addend.is_guided for addend in self._scenes)
            samples = min(at_once, first + count - start)
            for scene, integrator, _, number, sign in self._scenes:
                seed = _SEEDS_A_SAMPLE * start + number
                batch = mitsuba.render(scene, integrator=integrator, spp=samples, seed=seed)
                total += sign * samples * np.asarray(batch, dtype=np.float64)
            traced(samples)
        return (total / count).astype(np.float32)


class _Addend(NamedTuple):
    """A scene of mitsuba, what integrates it, and the sign that its picture is added with.

    Equal numbers have equal rays.
    """

    scene: Any
    integrator: Any
    is_guided: bool
    number: int
    sign: float = 1.0


def _scenes(mitsuba: Any, subject: Subject, settings: PathTracerSettings) -> list[_Addend]:
    """One scene lit by the sun and one by all else, without those that are dark.

    A sky seen from aloft does not light the scene: the visible part of the lighting sky is
    subtracted, and that of the eye's sky is added.
    """
    model = model_of(settings, mitsuba)
    there = matter(mitsuba, subject, model)
    backs, cut = there.one_sided, cut_of(subject, there.ground)
    farthest = subject.reach_units()
    scenes = []
    if any(subject.sun.irradiance_rgb):
        sun, distance = sun_emitter(mitsuba, subject.sun, settings.sun == "disc", farthest)
        lights = {"sun": sun, "sky": darkness()}
        scenes.append(
            _Addend(
                *_scene(
                    mitsuba, subject, settings, {**there.shapes, **lights}, backs, cut, distance
                ),
                0,
            )
        )
    seen, cube = radiance_cube(subject.background), radiance_cube(subject.light)
    is_low = _alike(seen, cube)
    if is_low:
        cube = seen
    bright = bool(np.any(cube > 0.0))
    shining = glowing_shapes(mitsuba, subject, model)
    lamps = shining.shapes | lamp_emitters(mitsuba, subject)
    glowing = [*backs, *shining.one_sided]
    if bright or lamps:
        lights = {"sky": sky_emitter(mitsuba, cube) if bright else darkness(), **lamps}
        scenes.append(
            _Addend(
                *_scene(
                    mitsuba, subject, settings, {**there.shapes, **lights}, glowing, cut, farthest
                ),
                1,
            )
        )
    if not is_low:
        alone = msgspec.structs.replace(settings, max_bounces=0)
        for sky, sign in ((seen, 1.0), (cube, -1.0)):
            light = {"sky": sky_emitter(mitsuba, sky) if np.any(sky > 0.0) else darkness()}
            scene = _scene(mitsuba, subject, alone, {**there.shapes, **light}, backs, cut, farthest)
            scenes.append(_Addend(*scene, 1, sign))
    return scenes


def _alike(seen: NDArray[np.float32], light: NDArray[np.float32]) -> bool:
    """Whether two cubes differ by what nobody sees: an eye near the ground sees what lights."""
    edge = min(seen.shape[1], light.shape[1])
    seen_means, light_means = reduce_cube(seen, edge), reduce_cube(light, edge)
    return bool(np.abs(seen_means - light_means).mean() <= _UNSEEN * light_means.mean())


def _scene(
    mitsuba: Any,
    subject: Subject,
    settings: PathTracerSettings,
    content: dict[str, Any],
    backs: list[Any],
    cut: Cut | None,
    farthest: float,
) -> tuple[Any, Any, bool]:
    """A scene as mitsuba has it, what integrates it, and whether its paths are guided."""
    bounces = settings.max_bounces
    integrator: dict[str, Any] = {
        # The latter seeks light through what lets it straight on, which costs.
        "type": "volpath" if _lets_light_on(subject) else "path",
        "max_depth": -1 if bounces is None else bounces + 1,
        "rr_depth": _ROULETTE_DEPTH,
    }
    camera = sensor(mitsuba, subject, farthest)
    scene = mitsuba.load_dict(
        {"type": "scene", "integrator": integrator, "camera": camera, **content}
    )
    guided = _guided(mitsuba, scene, integrator, settings.spp * int(np.prod(subject.state.size_px)))
    inner = guided or scene.integrator()
    if mitsuba.variant().startswith("scalar") or not backs or not sees(mitsuba, scene, backs):
        backs = []
    if not backs and cut is None:
        return scene, inner, guided is not None
    return scene, past_unseen(mitsuba, inner, backs, cut), guided is not None


def _guided(mitsuba: Any, scene: Any, integrator: dict[str, Any], paths: int) -> Any:
    """An integrator guided to the openings of a scene, for a picture of so many paths.

    None if there are no openings, or if so few paths do not repay the learning.
    """
    is_scalar = mitsuba.variant().startswith("scalar")
    if is_scalar or paths < WORTH_PATHS or 0 <= integrator["max_depth"] <= 1:
        return None
    found = survey(mitsuba, scene)
    if not found.has_openings:
        return None
    passes = integrator["type"] == "volpath"
    table = learn(mitsuba, scene, found, passes, paths)
    return guided_path(mitsuba, table, passes, integrator["max_depth"], integrator["rr_depth"])


def _lets_light_on(subject: Subject) -> bool:
    """Whether something in the scene is a pane, is cut out or is blended."""
    materials = subject.scene.materials.all()
    return any(m.alpha_mode != "OPAQUE" or m.terms.transmits for m in materials)
