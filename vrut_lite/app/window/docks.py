"""Which docks the window has: one line each. A new panel is a line more."""

from collections.abc import Callable
from functools import partial
from typing import NamedTuple

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QWidget

from vrut_lite.app.compare.compare_panel import ComparePanel
from vrut_lite.app.engine.roster import ModuleInfo, Roster
from vrut_lite.app.panels.export_panel import ExportPanel
from vrut_lite.app.panels.message_inspector import MessageInspector
from vrut_lite.app.panels.module_manager import ModuleManager
from vrut_lite.app.panels.module_panel import ModulePanel
from vrut_lite.app.panels.picture_panel import PicturePanel
from vrut_lite.app.panels.place_panel import PlacePanel
from vrut_lite.app.panels.sky_panel import SHOWN_SLOT, SkyPanel
from vrut_lite.app.panels.sun_panel import SunPanel
from vrut_lite.app.panels.time_panel import TimePanel
from vrut_lite.app.panels.traced_panel import TracedPanel
from vrut_lite.app.window.desk import Desk

Area = Qt.DockWidgetArea


class DockSpec(NamedTuple):
    """A dock: docks of one `group` share a place as tabs, in this order.

    A dock that is not `scrolled` is as high as its content.
    """

    name: str
    title: str
    group: str
    make: Callable[[Desk], QWidget]
    shown: bool = True
    scrolled: bool = True


# Where each group stands, from top to bottom.
GROUPS: dict[str, Area] = {
    "where and when": Area.RightDockWidgetArea,
    "light": Area.RightDockWidgetArea,
    "time": Area.BottomDockWidgetArea,
    "tools": Area.LeftDockWidgetArea,
}

DOCKS: list[DockSpec] = [
    DockSpec("place", "Place", "where and when", lambda desk: PlacePanel(desk.session)),
    DockSpec("sun", "Sun", "where and when", lambda desk: SunPanel(desk.session, desk.scout)),
    DockSpec("picture", "Picture", "where and when", lambda desk: PicturePanel(desk.session)),
    DockSpec(
        "export",
        "Export",
        "where and when",
        lambda desk: ExportPanel(desk.session, desk.scout, desk.keeper),
    ),
    DockSpec("sky", "Sky", "light", lambda desk: SkyPanel(desk.session, desk.presets)),
    DockSpec(
        "compare",
        "Compare skies",
        "tools",
        lambda desk: ComparePanel(desk.session, desk.viewport),
        shown=False,
    ),
    DockSpec(
        "traced",
        "Path-traced picture",
        "tools",
        lambda desk: TracedPanel(desk.session),
        shown=False,
        scrolled=False,
    ),
    DockSpec(
        "time", "Time", "time", lambda desk: TimePanel(desk.session, desk.scout), scrolled=False
    ),
    DockSpec(
        "modules",
        "Modules",
        "tools",
        lambda desk: ModuleManager(desk.session),
        shown=False,
        scrolled=False,
    ),
    DockSpec(
        "messages",
        "Messages",
        "tools",
        lambda desk: MessageInspector(desk.session),
        shown=False,
        scrolled=False,
    ),
]

# Modules that few people look at wait in the menu.
_HIDDEN = {"path_tracer", "zenoh_bridge"}


def module_docks(roster: Roster) -> list[DockSpec]:
    """A dock for each module that has settings, but for those whose panel the sky's dock shows."""
    return [
        DockSpec(
            f"module {module.name}",
            module.title,
            "light",
            partial(_module_panel, module),
            shown=module.name not in _HIDDEN,
        )
        for module in roster.modules.values()
        if module.specs and SHOWN_SLOT not in module.provides
    ]


def _module_panel(module: ModuleInfo, desk: Desk) -> QWidget:
    return ModulePanel(desk.session, module, desk.presets)
