"""Names of the headless host for commands of modules. Provisional until 1.0.

A command is a `click.Command` of the group `vrut_lite.commands`.

* Options as other commands have them: `daylight_options` and `scene_options` add them,
  `with_options` and `with_scene_options` apply them to the `Project` of `project_of_path`;
  `worker_options` and `workers_of` for many scenes; `FiniteRange` is a type of numbers.
* A kernel with all installed modules: `open_kernel`, with `SceneManager` added by
  `kernel.add_module` where a scene is opened. `setting_inputs`, `daylight_inputs` and `view_inputs`
  are a project's inputs; `FaultCollector` raises what modules raised; `require_sun` asks for a sun.
* The terminal: `busy_with`, `tracked` and `tell_notices`; `write_png` for pictures.
* Stills of a project by `ScenePlan.open`, drawn as `render` draws them; `display_numbers` are those
  of the tone map.
"""

from vrut_lite.commands.options import daylight_options, with_options
from vrut_lite.commands.scene_options import scene_options, with_scene_options
from vrut_lite.daylight_kernel import FaultCollector
from vrut_lite.pictures.display import display_numbers
from vrut_lite.pictures.image_files import write_png
from vrut_lite.project import (
    Project,
    daylight_inputs,
    project_of_path,
    setting_inputs,
    view_inputs,
)
from vrut_lite.scene.manager import SceneManager
from vrut_lite.studio.number_types import FiniteRange
from vrut_lite.studio.open_kernel import open_kernel, require_sun
from vrut_lite.studio.pictures import tell_notices
from vrut_lite.studio.progress import busy_with, tracked
from vrut_lite.studio.scene_pictures import ScenePlan
from vrut_lite.studio.workers import worker_options, workers_of

__all__ = [
    "FaultCollector",
    "FiniteRange",
    "Project",
    "SceneManager",
    "ScenePlan",
    "busy_with",
    "daylight_inputs",
    "daylight_options",
    "display_numbers",
    "open_kernel",
    "project_of_path",
    "require_sun",
    "scene_options",
    "setting_inputs",
    "tell_notices",
    "tracked",
    "view_inputs",
    "with_options",
    "with_scene_options",
    "worker_options",
    "workers_of",
    "write_png",
]
