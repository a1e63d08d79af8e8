"""Writes docs/who_hears_what.md: each message, who posts it, who handles it.

    python -m tools.who_hears_what

Who handles is read from the code: handlers of modules, frame parts, and what the window listens to.
Who posts is seen in a session on the real kernel with every installed module: a day, a night with
an aurora, clouds, each sky, light between surfaces. What the session does not show, as work on a
GPU, is posted by the modules that construct it.
"""

import re
from collections import defaultdict
from collections.abc import Iterator
from datetime import UTC, datetime, timedelta
from pathlib import Path

from vrut_lite.daylight_kernel import daylight_kernel
from vrut_lite.discovery import discover
from vrut_lite.installed_parts import frame_parts
from vrut_lite.kernel.messages import (
    KERNEL_MESSAGES,
    ChooseSlot,
    Demand,
    Derived,
    EnableModule,
    Input,
    JobResult,
    Message,
    SetClock,
    SetSetting,
)
from vrut_lite.kernel.module import Module
from vrut_lite.messages.camera import MoveCamera
from vrut_lite.messages.picture import Resize
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.scene import LoadScene
from vrut_lite.messages.sky import LookAlong, LookAround
from vrut_lite.messages.vocabulary import DAYLIGHT_MESSAGES
from vrut_lite.render.gl_jobs import GlJobs
from vrut_lite.scene.manager import SceneManager
from vrut_lite.sky.sky_sum import SkySum

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs" / "who_hears_what.md"
_LISTENS = re.compile(r"\.listen\(\s*(\w+)")
_NIGHT = datetime(2026, 12, 9, 21, tzinfo=UTC)
_HEAD = """# Who hears what

Made by `python -m tools.who_hears_what`. Inputs come from outside: the user, commands, the clock,
results of jobs. A frame part hears by the scene manager (`scene`). *Posted by* is what a session
with all modules showed.
"""


def skies() -> list[str]:
    """Names of the installed skies; the first module of the `sun` last, which holds it too."""
    found, _ = discover()
    manifests = [module.manifest for module in found if "sky" in module.manifest.provides]
    return [each.name for each in sorted(manifests, key=lambda each: "sun" in each.provides)]


def session() -> Iterator[tuple[Input, ...]]:
    """Inputs, one gesture each."""
    yield (SetPlace(latitude_deg=60.0, longitude_deg=10.0),)
    yield (Resize(width_px=48, height_px=32),)
    for kind in ("SurfaceLightChanged", "MoonPathChanged"):
        yield (Demand(consumer="page", message=kind, size=16),)
    for name, value in (("quality", "draft"), ("texel_m", 1.0)):
        yield (SetSetting(module="light_transport", name=name, value=value),)
    yield (LoadScene(path=str(ROOT / "scenes" / "sundial.glb")),)
    yield (SetClock(instant=_NIGHT - timedelta(hours=10)),)
    for sky in skies():
        yield (ChooseSlot(slot="sky", module=sky),)
        yield (
            LookAlong(direction=(0.0, 1.0, 0.0)),
            LookAround(wavelength_nm=(450.0, 550.0, 650.0), size=2),
        )
    yield (SetSetting(module="clouds", name="coverage", value=0.5),)
    yield (SetSetting(module="scene", name="section", value="x"),)
    yield (MoveCamera(eye_m=(3.0, 2.0, 3.0), target_m=(0.0, 1.0, 0.0)),)
    yield (Demand(consumer="page", message="ViewLightChanged"),)
    yield (SetSetting(module="aurora", name="on", value=True),)
    yield (SetClock(instant=_NIGHT),)
    yield (EnableModule(module="light_transport", enabled=False),)


def posted() -> dict[str, set[str]]:
    """Names of modules by the type that they posted in the session."""
    found: dict[str, set[str]] = defaultdict(set)

    def note(message: Message, sender: str) -> None:
        if isinstance(message, Derived):
            found[type(message).__name__].add(sender)

    kernel, _ = daylight_kernel()
    kernel.add_module(SceneManager)
    kernel.tap(note)
    for inputs in session():
        kernel.inject(*inputs)
        kernel.pump_until_idle()
    kernel.close()
    for kind in message_types():
        if issubclass(kind, Derived) and kind.__name__ not in found:
            found[kind.__name__] = set(_constructing(kind.__name__))
    return found


def _constructing(name: str) -> Iterator[str]:
    """Names of modules with a file that constructs a type of message."""
    for folder in sorted((ROOT / "modules").iterdir()):
        if any(f" {name}(" in path.read_text() for path in folder.rglob("*.py")):
            yield folder.name


def module_types() -> list[type[Module]]:
    """All installed modules, and the host's."""
    return [*discover()[0], SkySum, SceneManager, GlJobs]


def message_types() -> list[type[Message]]:
    """All types of messages, by name."""
    own = [kind for module in module_types() for kind in module.speaks]
    kinds = {*KERNEL_MESSAGES, *DAYLIGHT_MESSAGES, *own}
    return sorted(kinds, key=lambda kind: kind.__name__)


def handled() -> dict[str, set[str]]:
    """Names of modules, and "window", by the type that they handle."""
    found: dict[str, set[str]] = defaultdict(set)
    for kind in KERNEL_MESSAGES:
        if issubclass(kind, Input) and kind not in (Demand, JobResult):
            found[kind.__name__].add("host")
    for module in module_types():
        for kind, _ in module.handlers():
            found[kind.__name__].add(module.manifest.name)
    for name, part in frame_parts().items():
        for kind in part.hears:
            found[kind.__name__].add(f"{name} (frame part)")
    for folder in (ROOT / "vrut_lite" / "app", ROOT / "modules"):
        for path in folder.rglob("*.py"):
            for name in _LISTENS.findall(path.read_text()):
                found[name].add("window")
    return found


def page() -> str:
    """The page's text."""
    by, hears = posted(), handled()
    kinds = message_types()
    lines = [_HEAD]
    for title, base in (("Inputs", Input), ("Messages of modules", Derived)):
        posts = "" if base is Input else " posted by |"
        heads = f"| message | imported from |{posts} handled by |"
        lines += [f"## {title}", "", heads, re.sub(r"[^|]+", "---", heads)]
        for kind in kinds:
            if issubclass(kind, base):
                cells = [f"`{kind.__name__}`", f"`{kind.__module__}`"]
                if base is Derived:
                    cells.append(", ".join(sorted(by[kind.__name__])))
                cells.append(", ".join(sorted(hears[kind.__name__])))
                lines.append(f"| {' | '.join(cells)} |")
        lines.append("")
    return "\n".join(lines)


if __name__ == "__main__":
    PAGE.write_text(page())
