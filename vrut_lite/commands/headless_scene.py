"""The host's own modules for sessions without a window: a scene that is opened, never drawn."""

from vrut_lite.discovery import discover
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.module import Module
from vrut_lite.recording.entry import Setup
from vrut_lite.recording.replay import HEADLESS
from vrut_lite.scene.manager import SceneManager
from vrut_lite.studio.open_kernel import tell


def add_headless_scene(kernel: Kernel) -> None:
    """Load the scene manager, with nothing that draws."""
    kernel.add_module(_scene_manager())


def modules_for(setup: Setup) -> list[type[Module]]:
    """Modules that a replay of this setup may load: installed ones, and the host's that it needs.

    A stand-in takes the place of the runner of GPU jobs; the journal holds their results.
    """
    modules, failures = discover()
    tell(failures)
    modules += HEADLESS
    if all(wanted.name != "scene" for wanted in setup.modules):
        return modules
    return [*modules, _scene_manager()]


def _scene_manager() -> type[Module]:
    return SceneManager
