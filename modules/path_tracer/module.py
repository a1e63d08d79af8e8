"""The path tracer on the bus: a picture that grows while nothing changes.

It keeps its own `SceneState` from the messages of scene manager and sky. It traces only while
`PathTracedPicture` is demanded.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from path_tracer.backend import PathTracedBackend
from path_tracer.library import load_mitsuba
from path_tracer.messages import PathTracedPicture, PictureOutdated
from path_tracer.settings import PathTracerSettings
from path_tracer.subject import Subject
from path_tracer.tracer import Tracer
from vrut_lite import __version__
from vrut_lite.array import Array
from vrut_lite.kernel.job import JobControl
from vrut_lite.kernel.messages import Demand, JobResult
from vrut_lite.kernel.module import Link, Manifest, Module, handles
from vrut_lite.messages.camera import MoveCamera
from vrut_lite.messages.gpu_texture import GpuTexture
from vrut_lite.messages.picture import Resize
from vrut_lite.messages.scene import SceneOpened
from vrut_lite.messages.section import SectionChanged
from vrut_lite.messages.sky import AmbientChanged, BackgroundChanged, SkyRadianceChanged
from vrut_lite.messages.sky_light import LIGHT, SkyLightChanged
from vrut_lite.messages.sun import KeyLightChanged
from vrut_lite.scene_engine import SceneState

NAME = "path_tracer"
JOB = "samples"
# Cube map edge to ask for, as the GL frame does.
SKY_SIZE = 256
# The first pictures come soon; later ones bring enough to be worth a message.
_MOST_A_PASS = 16


class PathTracer(Module):
    """Traces what the scene manager shows, in passes that double.

    The counters count "picture begun", "sample" and "scene guided": sun and sky apart, where paths
    are guided to openings.
    """

    manifest = Manifest(
        name=NAME,
        title="Path tracer (Mitsuba)",
        version=__version__,
        auxiliary=True,
        engine="path-tracer",
    )
    speaks = (PathTracedPicture, PictureOutdated)
    settings_type = PathTracerSettings
    settings: PathTracerSettings

    @staticmethod
    def open_engine(
        settings: PathTracerSettings, traced: Callable[[int], None]
    ) -> PathTracedBackend:
        """A backend to draw with; `traced` hears of each step's samples.

        Raises:
            UserError: mitsuba, or the variant that is set, is not there.
        """
        load_mitsuba(settings.variant)
        return PathTracedBackend(settings, traced)

    def __init__(self, link: Link, settings: PathTracerSettings):
        super().__init__(link, settings)
        self._state = SceneState()
        self._wanted = False
        self._tracer: Tracer | None = None
        self._total: NDArray[np.float64] | None = None
        self._samples = 0

    # --- who wants a picture ------------------------------------------------------------

    @handles(Demand)
    def on_demand(self, message: Demand) -> None:
        """Begin when the first asks for a picture, and end when the last no longer does."""
        wanted = self.link.wanted(PathTracedPicture) is not None
        if message.message != PathTracedPicture.__name__ or wanted == self._wanted:
            return
        self._wanted = wanted
        for kind in (*LIGHT, SkyLightChanged, SkyRadianceChanged):
            self.link.demand(kind, SKY_SIZE if wanted else 0, "float16" if wanted else "")
        if wanted:
            self._outdated()
        else:
            self._end()

    # --- the scene and its light --------------------------------------------------------

    @handles(SceneOpened)
    def on_scene(self, message: SceneOpened) -> None:
        """Another scene, through its own camera."""
        self._see(replace(self._state, scene=message, moved_camera=None))

    @handles(MoveCamera)
    def on_camera(self, message: MoveCamera) -> None:
        """Look from there."""
        self._see(replace(self._state, moved_camera=message))

    @handles(Resize)
    def on_resize(self, message: Resize) -> None:
        """Trace pictures of this size."""
        self._see(replace(self._state, size_px=(message.width_px, message.height_px)))

    @handles(SectionChanged)
    def on_section(self, message: SectionChanged) -> None:
        """Leave out what another plane takes away."""
        self._see(replace(self._state, section=message.section))

    @handles(BackgroundChanged)
    def on_background(self, message: BackgroundChanged) -> None:
        """Another sky; one on the GPU is followed by the array that this module demands."""
        on_gpu = isinstance(message.cube, GpuTexture)
        self._see(self._state.with_light(background=None if on_gpu else message))

    @handles(KeyLightChanged)
    def on_key_light(self, message: KeyLightChanged) -> None:
        """Another light that casts shadows."""
        self._see(self._state.with_light(key_light=message))

    @handles(AmbientChanged)
    def on_ambient(self, message: AmbientChanged) -> None:
        """Other light on the ground, of which its albedo is known."""
        self._see(self._state.with_light(ambient=message))

    @handles(SkyLightChanged)
    def on_sky_light(self, message: SkyLightChanged) -> None:
        """Another sky, or other layers before it."""
        if not isinstance(message.background.cube, GpuTexture):
            self._see(replace(self._state, sky_light=message))

    def settings_changed(self, name: str) -> None:
        """Restart the picture with the new settings."""
        self._outdated()

    def _see(self, state: SceneState) -> None:
        self._state = state
        self._outdated()

    # --- tracing ------------------------------------------------------------------------

    def _outdated(self) -> None:
        """Stop at once, and begin when all that changes now has been heard."""
        if self._wanted:
            self._end()
            self.link.post(PictureOutdated())

    def _end(self) -> None:
        self.link.cancel_job(JOB)
        self._tracer = self._total = None

    @handles(PictureOutdated)
    def begin(self, message: PictureOutdated) -> None:
        """Trace the present state, from the first sample."""
        if not self._wanted or self._state.missing:
            return
        self._end()
        self._tracer = Tracer(Subject(self._state), self.settings)
        self._samples = 0
        self.counters.did("picture begun")
        self._next_pass()

    def _next_pass(self) -> None:
        count = min(max(1, self._samples), _MOST_A_PASS, self.settings.spp - self._samples)
        if self._tracer is not None and count > 0:
            wanted = self.settings.spp
            self.link.start_job(JOB, trace_pass, self._tracer, self._samples, count, wanted)

    @handles(JobResult)
    def on_samples(self, result: JobResult) -> None:
        """Add a pass to the picture, post it, and go on; the kernel posts a Fault for a failed
        one."""
        if self._tracer is None or result.error:
            self._end()
            return
        first, count, radiance = result.value
        share = radiance.values.astype(np.float64) * count
        self._total = share if self._total is None else self._total + share
        self._samples = first + count
        self.counters.did("sample", count)
        if first == 0:
            self.counters.did("scene guided", self._tracer.guided)
        mean = (self._total / self._samples).astype(np.float32)
        self.link.post(
            PathTracedPicture(
                radiance=Array(mean),
                width_px=mean.shape[1],
                height_px=mean.shape[0],
                samples=self._samples,
                samples_wanted=self.settings.spp,
                pixel_rad=Subject(self._state).camera.pixel_rad(len(mean)),
            )
        )
        self._next_pass()


def trace_pass(
    tracer: Tracer, first: int, count: int, wanted: int, control: JobControl
) -> tuple[int, int, Array] | None:
    """Some samples of a picture, in the background: their first, their number, their mean."""
    done = first

    def traced(samples: int) -> None:
        nonlocal done
        done += samples
        control.progress(done / wanted, f"{done} of {wanted} samples")

    radiance = tracer.trace(first, count, control.cancelled, traced)
    return None if radiance is None else (first, count, Array(radiance))
