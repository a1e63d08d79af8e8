"""The docks of the window: the host's own, and those of the modules.

A module may bring a panel: the entry point of its name in the group `vrut_lite.panels` names a
QWidget class with a `title` and, for a shortcut, `keys`; it is called with the `Session`. One with
a `file_entry`, a title, has an entry in the menu File, which calls its `ask_for_file`. One that is
`advanced` stands under View, Advanced. Further ones are named `module.panel`. They are imported
when the window is ready, so that the rest of a module needs no Qt.
"""

from collections.abc import Callable
from functools import partial
from typing import NamedTuple

from PySide6.QtCore import QEvent, QObject, QSize, Qt
from PySide6.QtWidgets import QFrame, QScrollArea, QWidget

from vrut_lite.app.compare.compare_panel import ComparePanel
from vrut_lite.app.engine.module_catalogue import ModuleCatalogue
from vrut_lite.app.engine.session import Session
from vrut_lite.app.panels.export_panel import ExportPanel
from vrut_lite.app.panels.message_inspector import MessageInspector
from vrut_lite.app.panels.module_manager import ModuleManager
from vrut_lite.app.panels.module_panel import ModulePanel
from vrut_lite.app.panels.picture_panel import PicturePanel
from vrut_lite.app.panels.place_panel import PlacePanel
from vrut_lite.app.panels.scene_panel import ScenePanel
from vrut_lite.app.panels.sky_panel import SHOWN_SLOT, SkyPanel
from vrut_lite.app.panels.sun_panel import SunPanel
from vrut_lite.app.panels.time_panel import TimePanel
from vrut_lite.app.window.panel_context import PanelContext
from vrut_lite.errors import UserError
from vrut_lite.foreign_errors import sentence_of
from vrut_lite.interrupts import pass_interrupt
from vrut_lite.package_facts import load_fitting, usable_points
from vrut_lite.scene.settings import SCENE

PANEL_GROUP = "vrut_lite.panels"
Area = Qt.DockWidgetArea
# A panel that needs more than this is scrolled sideways: it must not widen the window.
_WIDEST_PX = 330


class DockSpec(NamedTuple):
    """A dock: docks of one `group` share a place as tabs, in this order.

    A dock that is not `scrolled` is as high as its content. `keys` is its shortcut. The menu opens
    an `advanced` one, for developers, by View, Advanced. File has a `file_entry`.
    """

    name: str
    title: str
    group: str
    make: Callable[[PanelContext], QWidget]
    shown: bool = True
    scrolled: bool = True
    keys: str = ""
    advanced: bool = False
    file_entry: str = ""


# The groups from top to bottom.
GROUPS: dict[str, Area] = {
    "where and when": Area.RightDockWidgetArea,
    "light": Area.RightDockWidgetArea,
    "time": Area.BottomDockWidgetArea,
    "tools": Area.LeftDockWidgetArea,
}

DOCKS: list[DockSpec] = [
    DockSpec("place", "Place", "where and when", lambda desk: _place_panel(desk)),
    DockSpec("sun", "Sun", "where and when", lambda desk: SunPanel(desk.session, desk.scout)),
    DockSpec("picture", "Picture", "where and when", lambda desk: PicturePanel(desk.session)),
    DockSpec("export", "Export", "where and when",
             lambda desk: ExportPanel(desk.session, desk.scout)),
    DockSpec("sky", "Sky", "light", lambda desk: SkyPanel(desk.session, desk.presets)),
    DockSpec("compare", "Compare skies", "tools",
             lambda desk: ComparePanel(desk.session, desk.viewport), shown=False),
    DockSpec("time", "Time", "time", lambda desk: TimePanel(desk.session, desk.scout),
             scrolled=False),
    DockSpec("modules", "Modules", "tools", lambda desk: ModuleManager(desk.session),
             shown=False),
    DockSpec("messages", "Messages", "tools", lambda desk: MessageInspector(desk.session),
             shown=False, advanced=True),
]  # fmt: skip


def _place_panel(desk: PanelContext) -> QWidget:
    panel = PlacePanel(desk.session)
    # Single keys work as soon as the place is found.
    panel.found_place.connect(desk.viewport.setFocus)
    return panel


class ModulePanels(NamedTuple):
    """The docks of the modules, and a sentence for each panel that cannot be shown."""

    docks: list[DockSpec]
    failures: list[str]


def module_docks(catalogue: ModuleCatalogue) -> ModulePanels:
    """A dock for the settings of each module, and one for each panel that a module brings.

    The dock of the sky shows the settings of the modules that provide it.
    """
    docks = [
        DockSpec(
            f"module {module.name}",
            module.title,
            "light",
            partial(_settings_panel, module.name),
            shown=not module.auxiliary,
        )
        for module in catalogue.modules.values()
        if module.specs and SHOWN_SLOT not in module.provides
    ]
    failures = []
    for point in usable_points(PANEL_GROUP):
        if point.name.partition(".")[0] in catalogue.modules:
            try:
                docks.append(_own_dock(point.name, load_fitting(point)))
            except BaseException as error:
                pass_interrupt(error)
                failures.append(f"the panel of module {point.name} failed: {sentence_of(error)}")
    return ModulePanels(docks, failures)


class _Scrolled(QScrollArea):
    """As wide as its panel needs, up to `_WIDEST_PX`, whatever font the panel is written in."""

    def minimumSizeHint(self) -> QSize:
        """Room for the panel's width and the bar."""
        hint, panel = super().minimumSizeHint(), self.widget()
        if panel is None:
            return hint
        bar_px = self.verticalScrollBar().sizeHint().width()
        width_px = min(panel.minimumSizeHint().width() + bar_px, _WIDEST_PX)
        return QSize(width_px, hint.height())

    def eventFilter(self, panel: QObject, event: QEvent) -> bool:
        """Qt asks for the least width once; rows come to panels later."""
        if event.type() == QEvent.Type.LayoutRequest:
            self.updateGeometry()
        return super().eventFilter(panel, event)


def scrolled(panel: QWidget) -> QScrollArea:
    """An area that scrolls a panel up and down, and sideways where it is wider than its dock."""
    area = _Scrolled()
    area.setWidgetResizable(True)
    area.setFrameShape(QFrame.Shape.NoFrame)
    area.setWidget(panel)
    return area


def _own_dock(module: str, panel: Callable[[Session], QWidget]) -> DockSpec:
    title, keys, entry = (getattr(panel, name, "") for name in ("title", "keys", "file_entry"))
    if not (title and all(isinstance(text, str) for text in (title, keys, entry))):
        raise UserError("its class needs a `title`, a text, and may have `keys`, a shortcut")
    advanced = bool(getattr(panel, "advanced", False))
    return DockSpec(
        f"panel {module}",
        title,
        "tools",
        lambda desk: panel(desk.session),
        shown=False,
        keys=keys,
        advanced=advanced,
        file_entry=entry,
    )


def _settings_panel(module: str, desk: PanelContext) -> QWidget:
    make = ScenePanel if module == SCENE else ModulePanel
    return make(desk.session, module, desk.presets)
