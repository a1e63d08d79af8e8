"""Engines that draw instead of OpenGL: modules after `vrut_lite/scene_engine.py`, by `--engine`."""

from collections.abc import Callable
from typing import Any

import click
import msgspec

from vrut_lite.daylight_kernel import FaultCollector, daylight_kernel
from vrut_lite.discovery import discover
from vrut_lite.errors import UserError
from vrut_lite.kernel.messages import Demand, Input, SetSetting
from vrut_lite.kernel.module import Module
from vrut_lite.messages.sky import SkyRadianceChanged
from vrut_lite.messages.sky_light import SkyLightChanged
from vrut_lite.pictures.picture import Picture
from vrut_lite.project import Project, setting_inputs
from vrut_lite.scene.backend import SceneView
from vrut_lite.scene.manager import SceneManager
from vrut_lite.scene.scene_state import SceneState
from vrut_lite.studio.compile_message import tell_of_compilation
from vrut_lite.studio.open_kernel import tell
from vrut_lite.studio.progress import advancing_bar

# Edge (texels) of the cube maps of skylight and of clouds.
_SKY_SIZE = 256

GL = "gl"


def engine_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add --engine and --spp."""
    engines = [f"{name} ({module.manifest.title}), without air" for name, module in _engines()]
    for option in (
        click.option("--spp", metavar="N", help="Samples per pixel of an engine that is not gl."),
        click.option("--engine", metavar="NAME", default=GL, show_default=True,
                     help=f"What draws: {', or '.join([GL, *engines])}."),
    ):  # fmt: skip
        command = option(command)
    return command


def with_engine(project: Project, options: dict[str, Any]) -> tuple[Project, str]:
    """The project with --spp applied, and the engine; removes their keys from `options`.

    Raises:
        UserError: there is no such engine, or it takes no samples.
    """
    engine, samples = options.pop("engine"), options.pop("spp")
    if engine == GL:
        if samples is not None:
            able = " or ".join(f"--engine {name}" for name, _ in _engines()) or "other engines"
            raise UserError(f"--spp is for {able}: OpenGL takes no samples")
        return project, engine
    if project.shows != "picture":
        raise UserError(f"--show is for OpenGL: {engine} draws no false colours")
    name = _module_of(engine).manifest.name
    settings = {module: dict(values) for module, values in project.settings.items()}
    if samples is not None:
        settings.setdefault(name, {})["spp"] = samples
    # Engines draw no air, so that none is computed.
    return msgspec.structs.replace(project, settings=settings, air=False), engine


class EngineHost:
    """A kernel and a scene manager whose `backend` is an engine's: no OpenGL anywhere."""

    def __init__(self, engine: str, project: Project):
        tell_of_compilation()
        self.kernel, failures = daylight_kernel()
        tell(failures)
        self._faults = FaultCollector(self.kernel)
        try:
            self._open(_module_of(engine), project)
        except BaseException:
            self.close()
            raise

    def _open(self, module: Any, project: Project) -> None:
        name = module.manifest.name
        self.inject(*setting_inputs(project, self.kernel))
        self.kernel.pump()
        settings: Any = self.kernel.check_module(name).settings
        self.samples: int = settings.spp
        self._traced: Callable[[int], None] = lambda samples: None
        self._backend = module.open_engine(settings, lambda samples: self._traced(samples))
        self._view = SceneView(self.kernel, self._backend)
        self.inject(SetSetting(module=SceneManager.manifest.name, name="air", value=False))
        self.kernel.add_module(SceneManager, view=self._view, lights_surfaces=False)
        # Clouds are seen in the sky that lights.
        for kind in (SkyLightChanged, SkyRadianceChanged):
            self.inject(Demand(consumer=name, message=kind.__name__, size=_SKY_SIZE))
        self.settle()

    @property
    def state(self) -> SceneState:
        """The present state of the scene."""
        return self._view.state

    def inject(self, *messages: Input) -> None:
        """Queue inputs; `settle` or `draw` delivers them."""
        for message in messages:
            self.kernel.inject(message)

    def settle(self) -> None:
        """Act on all inputs.

        Raises:
            UserError: an input was invalid.
            ModuleFailed: a module raised something else.
        """
        self.kernel.pump_until_idle()
        self._faults.raise_first()

    def draw(self) -> Picture:
        """Deliver all inputs and draw; a terminal shows the progress."""
        self.settle()
        with advancing_bar("samples", self.samples) as self._traced:
            picture: Picture = self._backend.draw(self.state)
        return picture

    def close(self) -> None:
        """End background jobs."""
        self.kernel.close()


def _module_of(engine: str) -> type[Module]:
    modules = dict(_engines())
    if engine not in modules:
        raise UserError(f"there is no engine '{engine}': there are {', '.join([GL, *modules])}")
    return modules[engine]


def _engines() -> list[tuple[str, type[Module]]]:
    """The engines of the installed modules by name."""
    return [(name, module) for module in discover()[0] if (name := module.manifest.engine)]
