"""The objects that the parts of a window share."""

from dataclasses import dataclass, field

from vrut_lite.app.engine.session import Session
from vrut_lite.app.engine.sun_day_finder import SunDayFinder
from vrut_lite.app.panels.presets import PresetStore
from vrut_lite.app.view.compass import Compass
from vrut_lite.app.view.sun_path import SunPath
from vrut_lite.app.view.viewport import Viewport


@dataclass
class PanelContext:
    """A window's session, and the objects that several panels use."""

    session: Session
    scout: SunDayFinder
    sun_path: SunPath
    compass: Compass
    viewport: Viewport
    presets: PresetStore = field(default_factory=PresetStore)
