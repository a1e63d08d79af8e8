"""The registry of actions: entries of the menus, of the command palette and of the list of keys."""

from collections.abc import Callable
from functools import partial
from typing import Any, Literal, NamedTuple, Protocol

from vrut_lite.app.panels.picture_panel import PicturePanel
from vrut_lite.app.panels.time_panel import TimePanel
from vrut_lite.app.view.hand import CameraMode
from vrut_lite.app.view.profiler_overlay import ProfilerOverlay
from vrut_lite.app.view.section_switch import SectionSwitch
from vrut_lite.app.window.files import Files
from vrut_lite.app.window.panel_context import PanelContext
from vrut_lite.kernel.messages import SetSetting
from vrut_lite.scene.scene_state import Shown

# Titles of the action `vr`, by whether a headset shows the scene.
ENTER_VR, LEAVE_VR = "Enter VR", "Leave VR"


class ActionSpec(NamedTuple):
    """Calls `act` when triggered; a `checkable` action passes its new state.

    Exactly one checkable action of a `group` is on. An `advanced` one, for developers, stands in a
    submenu of that name.
    """

    name: str
    menu: str
    title: str
    keys: str
    act: Callable[..., Any]
    checkable: bool = False
    group: str = ""
    advanced: bool = False


class Window(Protocol):
    """Functions of the window that actions call."""

    @property
    def time(self) -> TimePanel:
        """The time bar's panel."""

    @property
    def picture(self) -> PicturePanel:
        """The panel of exposure and tone map."""

    def show_dock(self, name: str) -> None:
        """Show a dock, as the front tab of its group."""

    def toggle_dock(self, name: str) -> None:
        """Hide a visible dock; show a hidden one."""

    def go_to_dock(self, name: str) -> None:
        """Show a dock, and give the keys to its first control."""

    def type_time(self, field: Literal["clock", "date"]) -> None:
        """Give the keys to the field of the hour, or of the date."""

    def show_palette(self) -> None:
        """Open the command palette."""

    def show_keys(self) -> None:
        """Open the list of keys."""

    def look_at_sun(self) -> None:
        """Turn the camera to the sun, or say why not."""

    def look_at_moon(self) -> None:
        """Turn the camera to the moon, or say why not."""

    def show_manual(self) -> None:
        """Open the manual in the browser, or in a window."""

    def show_about(self) -> None:
        """Open the dialog of versions, graphics and folders."""

    def toggle_vr(self) -> None:
        """Show the scene in a headset, or no more."""

    def undo(self) -> None:
        """Undo the last change."""

    def redo(self) -> None:
        """Redo the change that was undone last."""

    def close_soon(self) -> None:
        """Close, after the event that asked for it."""


def action_specs(
    window: Window, desk: PanelContext, files: Files, profiler: ProfilerOverlay
) -> list[ActionSpec]:
    """The actions; they look up panels when triggered, since panels are made later."""
    viewport, session, dots = desk.viewport, desk.session, "\N{HORIZONTAL ELLIPSIS}"

    def camera(name: str, title: str, key: str, mode: CameraMode) -> ActionSpec:
        def set_mode(on: bool) -> None:
            viewport.set_mode(mode)

        return ActionSpec(name, "Camera", title, key, set_mode, True, "camera")

    def show(shown: Shown, title: str, advanced: bool = False) -> ActionSpec:
        def ask(on: bool) -> None:
            session.send(SetSetting(module="scene", name="shows", value=shown))

        return ActionSpec(f"show {shown}", "View", title, "", ask, True, "shown", advanced)

    return [
        ActionSpec("open", "File", f"Open scene or project{dots}", "Ctrl+O", files.ask_to_open),
        ActionSpec("weather", "File", f"Open weather{dots}", "", files.ask_for_weather),
        ActionSpec("save", "File", "Save project", "Ctrl+S", files.save_or_ask),
        ActionSpec("save as", "File", f"Save project as{dots}", "Ctrl+Shift+S",
                   files.ask_to_save),
        ActionSpec("export", "File", f"Export pictures and films{dots}", "Ctrl+E",
                   partial(window.go_to_dock, "export")),
        ActionSpec("screenshot", "File", "Screenshot of the picture", "F12",
                   files.save_screenshot),
        ActionSpec("quit", "File", "Quit", "Ctrl+Q", window.close_soon),
        ActionSpec("undo", "Edit", "Undo", "Ctrl+Z", window.undo),
        ActionSpec("redo", "Edit", "Redo", "Ctrl+Shift+Z", window.redo),
        camera("orbit", "Turn around the scene", "1", CameraMode.ORBIT),
        camera("fly", "Fly", "2", CameraMode.FLY),
        camera("space", "From the ground to space", "3", CameraMode.SPACE),
        ActionSpec("frame", "Camera", "See the whole scene", "F", viewport.frame_scene),
        ActionSpec("keep view", "Camera", f"Keep this view{dots}", "Ctrl+D",
                   files.ask_to_keep_view),
        ActionSpec("lock exposure", "Camera", "Lock the exposure", "L",
                   lambda on: window.picture.set_locked(on), True),
        ActionSpec("meter exposure", "Camera", "Meter the exposure now", "M",
                   session.meter_exposure),
        ActionSpec("play", "Time", "Play or pause", "Space", lambda: window.time.toggle_play()),
        ActionSpec("now", "Time", "Now", "N", lambda: window.time.go_to_now()),
        ActionSpec("hour", "Time", "Type an hour", "H", lambda: window.type_time("clock")),
        ActionSpec("date", "Time", "Type a date", "Shift+H", lambda: window.type_time("date")),
        ActionSpec("day before", "Time", "A day earlier", "Ctrl+PgUp",
                   lambda: window.time.step_days(-1)),
        ActionSpec("day after", "Time", "A day later", "Ctrl+PgDown",
                   lambda: window.time.step_days(1)),
        ActionSpec("sun path", "View", "Sun paths of day and solstices", "P",
                   desk.sun_path.show, True),
        ActionSpec("compass", "View", "Compass", "K", desk.compass.show, True),
        ActionSpec("section", "View", "Section through the scene", "X",
                   SectionSwitch(session).cut, True),
        ActionSpec("look at sun", "View", "Look at the sun", "O", window.look_at_sun),
        ActionSpec("look at moon", "View", "Look at the moon", "Shift+O", window.look_at_moon),
        show("picture", "Picture"),
        show("illuminance", "Illuminance in false colours"),
        show("texels", "Light map's texels in false colours", advanced=True),
        show("noise", "Light map's noise in false colours", advanced=True),
        ActionSpec("vr", "View", ENTER_VR, "", window.toggle_vr),
        ActionSpec("compare", "View", "Compare two skies", "C",
                   partial(window.toggle_dock, "compare")),
        ActionSpec("profiler", "View", "Profiler", "F3", profiler.setVisible, True,
                   advanced=True),
        ActionSpec("modules", "View", "Modules", "F4", partial(window.toggle_dock, "modules")),
        ActionSpec("messages", "View", "Messages and journals", "F5",
                   partial(window.toggle_dock, "messages"), advanced=True),
        ActionSpec("find place", "View", "Find a place", "G",
                   partial(window.go_to_dock, "place")),
        ActionSpec("picture focus", "View", "Keys to the picture", "Esc", viewport.setFocus),
        ActionSpec("manual", "Help", "Manual", "", window.show_manual),
        ActionSpec("palette", "Help", f"Find a command{dots}", "Ctrl+K, Ctrl+Shift+P",
                   window.show_palette),
        ActionSpec("keys", "Help", "Keys", "F1", window.show_keys),
        ActionSpec("about", "Help", "About vrut_lite", "", window.show_about),
    ]  # fmt: skip
