"""Names of the headless host for commands of modules.

A command is a `click.Command` of the group `vrut_lite.commands`.

* Options as other commands have them: `daylight_options` and `scene_options` add them,
  `with_options` and `with_scene_options` apply them to the `Project` of `project_of_path`;
  `worker_options` and `workers_of` for many scenes; `FiniteRange` is a type of numbers.
* `SceneKernel` is a kernel with all installed modules that has opened a project's scene, hour by
  hour; `require_sun` asks it for a sun.
* `Luminaire` with its `LuminousOpening`, read by `read_luminaire_file` from IES and EULUMDAT.
* The terminal: `busy_with`, `tracked` and `tell_notices`; `write_png` for pictures.
* Stills of a project by `ScenePlan.open`, drawn as `render` draws them; `display_numbers` are those
  of the tone map.
"""

from vrut_lite.commands.options import daylight_options, with_options
from vrut_lite.commands.scene_options import scene_options, with_scene_options
from vrut_lite.pictures.display import display_numbers
from vrut_lite.pictures.image_files import write_png
from vrut_lite.project import Project, project_of_path
from vrut_lite.scene.luminaire import Luminaire, LuminousOpening
from vrut_lite.scene.luminaire_file import read_luminaire_file
from vrut_lite.studio.number_types import FiniteRange
from vrut_lite.studio.open_kernel import require_sun
from vrut_lite.studio.pictures import tell_notices
from vrut_lite.studio.progress import busy_with, tracked
from vrut_lite.studio.scene_kernel import SceneKernel
from vrut_lite.studio.scene_pictures import ScenePlan
from vrut_lite.studio.workers import worker_options, workers_of

__all__ = [
    "FiniteRange",
    "Luminaire",
    "LuminousOpening",
    "Project",
    "SceneKernel",
    "ScenePlan",
    "busy_with",
    "daylight_options",
    "display_numbers",
    "project_of_path",
    "read_luminaire_file",
    "require_sun",
    "scene_options",
    "tell_notices",
    "tracked",
    "with_options",
    "with_scene_options",
    "worker_options",
    "workers_of",
    "write_png",
]
