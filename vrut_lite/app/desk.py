"""What every part of the window may use."""

from dataclasses import dataclass, field

from vrut_lite.app.day_scout import DayScout
from vrut_lite.app.presets import PresetStore
from vrut_lite.app.project_keeper import ProjectKeeper
from vrut_lite.app.session import Session
from vrut_lite.app.sun_path import SunPath
from vrut_lite.app.viewport import Viewport


@dataclass
class Desk:
    """One window's session, and what listens to it on behalf of all panels."""

    session: Session
    scout: DayScout
    keeper: ProjectKeeper
    sun_path: SunPath
    viewport: Viewport
    presets: PresetStore = field(default_factory=PresetStore)
