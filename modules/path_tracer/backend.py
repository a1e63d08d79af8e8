"""A scene backend that traces paths."""

from collections.abc import Callable
from dataclasses import replace

from path_tracer.denoising import can_denoise, without_grain
from path_tracer.guides import guides
from path_tracer.settings import PathTracerSettings
from path_tracer.subject import Subject
from path_tracer.tracer import Tracer
from vrut_lite.errors import GivenUp
from vrut_lite.scene_engine import IsGivenUp, Picture, SceneState, developed

_GUIDE_SAMPLES = 8


class PathTracedBackend:
    """A `SceneBackend`; `traced` is called with the number of new samples after each step.

    Neither air nor clouds are drawn.
    """

    def __init__(
        self, settings: PathTracerSettings, traced: Callable[[int], None] = lambda samples: None
    ):
        self.settings = settings
        self._traced = traced

    def prepare(self, state: SceneState) -> None:
        """Do nothing: scenes are built when they are traced."""

    def draw(
        self, state: SceneState, still: bool = True, is_given_up: IsGivenUp | None = None
    ) -> Picture:
        """Trace a picture.

        Raises:
            RuntimeError: scene, light or camera is still missing.
            GivenUp: `is_given_up()`, called between batches, returned true.
        """
        state.check_drawable()
        subject = Subject(state)
        tracer = Tracer(subject, self.settings)
        radiance = tracer.trace(
            0, self.settings.spp, is_given_up or (lambda: False), traced=self._traced
        )
        if radiance is None:
            raise GivenUp
        shown = radiance
        if self.settings.denoise and can_denoise():
            shown = without_grain(radiance, guides(subject, self.settings, _GUIDE_SAMPLES))
        pixel_rad = subject.camera.pixel_rad(len(radiance))
        picture = developed(shown, state.exposure, pixel_rad, state.white_card)
        return replace(picture, radiance=radiance, shown=shown)
