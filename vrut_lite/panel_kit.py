"""Names of the window for panels of modules.

A panel is a QWidget of the group `vrut_lite.panels`, called with the window's `Session`.

* `Session`: `send`, `listen`, `last`, `ask`, `look_up`; `ask` calls a question with the `Stage`, on
  the engine's thread. `present_project()` is the window's state.
* Widgets as the window has them: `Chooser`, `aligned_form`, `faint_label`, `panel_column`,
  `make_timer`.
* Other processes for long work, by `spawn_context`.
* Pictures: `FittedPicture` shows one, `Legend` its false colours; `display_picture` makes
  display values of radiance; `folder_of`, `file_title` and `write_picture` save it.
"""

from vrut_lite.app.engine.session import Session
from vrut_lite.app.engine.session_project import folder_of
from vrut_lite.app.engine.stage import Stage
from vrut_lite.app.fitted_picture import FittedPicture
from vrut_lite.app.legend import Legend
from vrut_lite.app.panels.file_title import file_title
from vrut_lite.app.widgets import (
    Chooser,
    aligned_form,
    faint_label,
    make_timer,
    panel_column,
)
from vrut_lite.pictures.display import display_picture
from vrut_lite.pictures.image_files import write_picture
from vrut_lite.studio.workers import spawn_context

__all__ = [
    "Chooser",
    "FittedPicture",
    "Legend",
    "Session",
    "Stage",
    "aligned_form",
    "display_picture",
    "faint_label",
    "file_title",
    "folder_of",
    "make_timer",
    "panel_column",
    "spawn_context",
    "write_picture",
]
