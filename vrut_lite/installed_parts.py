"""The installed frame parts: found by entry point, queried together by scene and renderer."""

import logging
from collections.abc import Callable, Mapping
from functools import cache
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from vrut_lite.errors import UserError
from vrut_lite.foreign_errors import sentence_of
from vrut_lite.frame_part import D, FramePart, Heard, Hit, IsFree, Size, are_same, latest
from vrut_lite.interrupts import pass_interrupt
from vrut_lite.kernel.messages import Derived
from vrut_lite.messages.camera import MoveCamera
from vrut_lite.messages.scene import SceneOpened
from vrut_lite.messages.sky import AmbientChanged
from vrut_lite.numeric_types import FloatArray, Vector
from vrut_lite.package_facts import load_fitting, usable_points

GROUP = "vrut_lite.frame_parts"
# GLSL of parts, which `//!include HOOK.glsl` brings: of one installed part, or of several.
HOOKS_OF_ONE, HOOKS_OF_SEVERAL = ("irradiance", "through_air"), ("sun_factor", "extra_lights")
# Messages of each part that is switched on, by its name.
PartsHeard = Mapping[str, Heard]
_log = logging.getLogger(__name__)


class FoundParts(NamedTuple):
    """Parts by the names of their entry points, and a sentence for each that cannot be used."""

    parts: dict[str, type[FramePart]]
    left_out: dict[str, str]


@cache
def find_parts() -> FoundParts:
    """Load the installed parts, once for each process."""
    found = FoundParts({}, {})
    for point in usable_points(GROUP):
        try:
            part = load_fitting(point)
            if not (isinstance(part, type) and issubclass(part, FramePart)):
                raise UserError("it names no subclass of FramePart")
            for hook in HOOKS_OF_ONE:
                if getattr(part, hook) and (other := part_with(hook, found.parts)):
                    raise UserError(f"the frame part {other} has the hook {hook} already")
            found.parts[point.name] = part
        except BaseException as error:
            pass_interrupt(error)
            found.left_out[point.name] = sentence_of(error)
            _log.warning("the frame part %s is left out: %s", point.name, sentence_of(error))
    return found


def frame_parts() -> dict[str, type[FramePart]]:
    """Parts by the names of their entry points."""
    return find_parts().parts


def parts_left_out() -> dict[str, str]:
    """A sentence for each installed part that cannot be used, by its name."""
    return find_parts().left_out


def part_with(hook: str, parts: Mapping[str, type[FramePart]]) -> str:
    """Name of the part that has the GLSL of a hook, or an empty text."""
    return next((name for name, part in parts.items() if getattr(part, hook)), "")


def heard_by_parts() -> tuple[type[Derived], ...]:
    """Types of all messages that parts hear, but for the scene, which the manager posts."""
    kinds = dict.fromkeys(kind for part in frame_parts().values() for kind in part.hears)
    return tuple(kind for kind in kinds if kind is not SceneOpened)


def all_parts() -> PartsHeard:
    """All installed parts, switched on, before they hear anything."""
    return MappingProxyType(dict.fromkeys(frame_parts(), MappingProxyType({})))


def heard_with(parts: PartsHeard, message: Derived) -> PartsHeard:
    """The parts after a message that arrives; the same object if none shows it."""
    changed: dict[str, Heard] = {}
    for name, heard in parts.items():
        part = frame_parts()[name]
        if type(message) in part.hears:
            after = part.hear(heard, message)
            if not are_same(heard, after):
                changed[name] = MappingProxyType(dict(after))
    return MappingProxyType({**parts, **changed}) if changed else parts


def heard_without(parts: PartsHeard, is_dropped: Callable[[type[Derived]], bool]) -> PartsHeard:
    """The parts without messages of some types; the same object if none has such a message."""
    if not any(is_dropped(kind) for heard in parts.values() for kind in heard):
        return parts
    return MappingProxyType(
        {
            name: MappingProxyType({k: heard[k] for k in heard if not is_dropped(k)})
            for name, heard in parts.items()
        }
    )


def changed_kinds(before: PartsHeard, now: PartsHeard) -> set[type[Derived]]:
    """Types of messages whose instances differ from those before."""
    none: Heard = {}
    return {
        kind
        for name in before.keys() | now.keys()
        for old, new in [(before.get(name, none), now.get(name, none))]
        for kind in old.keys() | new.keys()
        if old.get(kind) is not new.get(kind)
    }


def shown_by_parts(parts: PartsHeard, kind: type[D]) -> D | None:
    """The latest message of a type that parts hear, or None."""
    found = (latest(heard, kind) for heard in parts.values())
    return next((message for message in found if message is not None), None)


def part_reach_m(parts: PartsHeard, camera: MoveCamera) -> float:
    """Distance from the eye up to which parts draw things in the air."""
    reach_m = (part.reach_m(heard, camera) for part, heard in _on(parts))
    return max(reach_m, default=0.0)


def sun_share(parts: PartsHeard, point_m: Vector, direction: Vector) -> float:
    """Share of the sun in a direction that parts let reach a point."""
    share = 1.0
    for part, heard in _on(parts):
        share *= part.sun_share(heard, point_m, direction)
    return share


def extra_irradiance(
    parts: PartsHeard,
    camera: MoveCamera,
    point_m: FloatArray,
    normal: FloatArray,
    is_free: IsFree,
) -> FloatArray:
    """Irradiance (3,), W m^-2, of all parts' lights on a plane."""
    total = np.zeros(3)
    for part, heard in _on(parts):
        total += part.extra_irradiance(heard, camera, point_m, normal, is_free)
    return total


def irradiance_at(parts: PartsHeard, hit: Hit, sky: AmbientChanged) -> FloatArray | None:
    """Irradiance (3,) that a part gives a surface, or None: the open sky lights it."""
    found = (part.irradiance_at(heard, hit, sky) for part, heard in _on(parts))
    return next((irradiance for irradiance in found if irradiance is not None), None)


def finishes_still(parts: PartsHeard, camera: MoveCamera, size_px: Size) -> bool:
    """Whether a part has the light of a finished still from here."""
    return any(part.finishes(heard, camera, size_px) for part, heard in _on(parts))


def may_reuse_surfaces(before: PartsHeard, now: PartsHeard, hour_moved: bool) -> bool:
    """Whether all parts let moving pictures reuse surfaces that were drawn before."""
    return all(
        part.may_reuse(before.get(name, {}), now.get(name, {}), hour_moved)
        for name, part in frame_parts().items()
    )


def _on(parts: PartsHeard) -> list[tuple[type[FramePart], Heard]]:
    return [(frame_parts()[name], heard) for name, heard in parts.items()]
