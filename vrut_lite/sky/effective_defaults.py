"""Effective values of unset settings, and presets that a module offers.

A settings class may define both, for panels that show them: a method `left_open(haze)` gives the
effective value of each unset setting by its name, from the present preset and the place's haze; a
class variable `presets` holds a `Preset` by its name. A sky's unset `turbidity` and `albedo` are
the place's.
"""

from typing import Any, NamedTuple

import msgspec

from vrut_lite.atmosphere.ground_reflectance import GroundReflectance
from vrut_lite.messages.ground import OWN_ALBEDOS
from vrut_lite.messages.haze import OWN_HAZE, SetHaze

Values = dict[str, Any]


class Preset(NamedTuple):
    """Settings that a module offers together, with their purpose in one line."""

    line: str
    values: Values


def left_open(settings: msgspec.Struct, haze: SetHaze, ground: GroundReflectance) -> Values:
    """Values of the unset settings, as far as they are known."""
    said = getattr(settings, "left_open", None)
    known: Values = {OWN_HAZE: haze.turbidity} | dict.fromkeys(OWN_ALBEDOS, ground.albedo)
    if said is not None:
        known |= said(haze)
    now = msgspec.structs.asdict(settings)
    return {name: value for name, value in known.items() if name in now and now[name] is None}


def presets_of(settings_type: type[msgspec.Struct]) -> dict[str, Preset]:
    """The presets by name, in the order in which they are offered."""
    return dict(getattr(settings_type, "presets", {}))
