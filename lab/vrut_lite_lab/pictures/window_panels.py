"""Every panel of the window on a sheet, each shown whole, also what a window would scroll."""

from datetime import timedelta

import numpy as np
from bruneton_sky.panel import PolarisationPanel
from PIL import Image

from vrut_lite.app.compare.compare_panel import ComparePanel
from vrut_lite.app.compare.sky_disc import SkyDisc
from vrut_lite.app.panels.message_inspector import MessageInspector
from vrut_lite.app.window.shortcut_list import ShortcutList
from vrut_lite.kernel.messages import ChooseSlot, ClockMoved, SetClock
from vrut_lite_lab.pictures.posed_window import Pixels, PosedWindow, seen

# Towards 45 degrees of height in the north: whose spectra are compared.
POINTED = (0.0, 0.7071, -0.7071)
# Panels of one width stand below each other, each column as wide as a dock.
_COLUMNS, _WIDTH_PX, _GAP_PX = 4, 420, 8
_BEHIND = (12, 12, 13)


def trimmed(part: Pixels) -> Pixels:
    """A part without what is empty below it."""
    filled = np.flatnonzero((part != part[-3, 8]).any(axis=-1)[:, 8:-24].any(axis=1))
    filled = filled[filled < len(part) - 3]
    return part[: filled[-1] + 2 * _GAP_PX] if filled.size else part


def sheet(parts: list[Pixels], strip: Pixels) -> Image.Image:
    """The parts in columns, each where least stands yet, and a strip below all of them."""
    columns: list[list[Pixels]] = [[] for _ in range(_COLUMNS)]
    for part in parts:
        lowest = min(columns, key=lambda column: sum(len(other) + _GAP_PX for other in column))
        lowest.append(part)
    height = max(sum(len(part) + _GAP_PX for part in column) for column in columns)
    width = _COLUMNS * (_WIDTH_PX + _GAP_PX) - _GAP_PX
    below = Image.fromarray(strip)
    below = below.resize((width, round(below.height * width / below.width)))
    whole = Image.new("RGB", (width, height + below.height), _BEHIND)
    whole.paste(below, (0, height))
    for n, column in enumerate(columns):
        top = 0
        for part in column:
            picture = Image.fromarray(part)
            if picture.width > _WIDTH_PX:
                shrunk = _WIDTH_PX, round(picture.height * _WIDTH_PX / picture.width)
                picture = picture.resize(shrunk, Image.Resampling.LANCZOS)
            whole.paste(picture, (n * (_WIDTH_PX + _GAP_PX), top))
            top += picture.height + _GAP_PX
    return whole


def later(posed: PosedWindow) -> None:
    """Move the clock by a minute, and wait."""
    clock = posed.session.last(ClockMoved)
    assert clock is not None
    posed.session.send(SetClock(instant=clock.instant + timedelta(minutes=1)))
    posed.rest()


def messages(posed: PosedWindow) -> Pixels:
    """The message inspector with what a move of the clock caused."""
    inspector = posed.window.panels["messages"]
    assert isinstance(inspector, MessageInspector)
    posed.window.show_dock("messages")

    def moves_of_the_sun() -> list[int]:
        rows = inspector.table.messages.shown
        return [row.number for row in rows if row.type_name == "SunMoved"]

    # What came before the engine began to watch is not shown.
    while not moves_of_the_sun():
        later(posed)
    inspector.table.go_to(moves_of_the_sun()[-1])
    return posed.panel("messages")


def profiler(posed: PosedWindow) -> Pixels:
    """The overlay over the picture, while the day passes."""
    actions = posed.window.actions_by_name
    actions["profiler"].trigger()
    actions["play"].trigger()
    posed.until(lambda: len(posed.window.profiler.lines) > 12)
    found = seen(posed.window.profiler)
    actions["play"].trigger()
    actions["profiler"].trigger()
    return found


def dialogs(posed: PosedWindow) -> list[Pixels]:
    """The palette with a word in it, and the list of keys."""
    palette, keys = (
        posed.window.new_palette(),
        ShortcutList(posed.window.menus.specs, posed.window),
    )
    palette.text_field.setText("sun")
    found = []
    for dialog in (palette, keys):
        dialog.show()
        posed.rest()
        found.append(seen(dialog))
        dialog.close()
    return found


def choose_sky(posed: PosedWindow, module: str) -> None:
    """Let a module hold the sky, and wait until it does."""
    posed.session.send(ChooseSlot(slot="sky", module=module))
    posed.until(lambda: posed.session.catalogue.holders["sky"] == module)
    posed.rest()


def polarisation(posed: PosedWindow) -> Pixels:
    """The panel of the sky's polarisation, which a sky computes while it is seen."""
    panel = posed.window.panels["panel bruneton_sky"]
    assert isinstance(panel, PolarisationPanel)
    posed.window.show_dock("panel bruneton_sky")
    posed.until(lambda: panel.shown is not None)
    return posed.panel("panel bruneton_sky")


def all_parts(posed: PosedWindow) -> list[Pixels]:
    """Each panel, in the order of the sheet."""
    parts = [posed.panel(name) for name in ("place", "sun", "picture", "export")]
    for sky in ("dynamic_skylight", "bruneton_sky"):
        choose_sky(posed, sky)
        parts.append(posed.panel("sky"))
    parts += [posed.panel(name) for name in posed.window.docks if name.startswith("module ")]
    parts += [posed.panel("panel light_transport"), polarisation(posed)]
    posed.window.show_dock("compare")
    posed.rest()
    compare = posed.window.panels["compare"]
    assert isinstance(compare, ComparePanel)
    seen_spectra: list[object] = []
    compare.comparison.spectra_seen.connect(seen_spectra.append)
    # An atmosphere of twelve wavelengths is solved for it.
    compare.findChildren(SkyDisc)[0].pointed.emit(POINTED)
    posed.until(lambda: bool(seen_spectra))
    posed.rest()
    parts += [posed.panel("compare"), posed.panel("modules"), messages(posed)]
    return [trimmed(part) for part in [*parts, profiler(posed), *dialogs(posed)]]
