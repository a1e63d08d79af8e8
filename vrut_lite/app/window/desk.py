"""What every part of the window may use."""

from dataclasses import dataclass, field

from vrut_lite.app.engine.day_scout import DayScout
from vrut_lite.app.engine.session import Session
from vrut_lite.app.panels.presets import PresetStore
from vrut_lite.app.view.sun_path import SunPath
from vrut_lite.app.view.viewport import Viewport


@dataclass
class Desk:
    """One window's session, and what listens to it on behalf of all panels."""

    session: Session
    scout: DayScout
    sun_path: SunPath
    viewport: Viewport
    presets: PresetStore = field(default_factory=PresetStore)
