"""Luminaires placed in a scene, and the controls of their groups, as project files have them."""

import math
from typing import Annotated, Literal

import msgspec

from vrut_lite.messages.glazing import Share

_Place = tuple[float, float, float]
_Hour = Annotated[float, msgspec.Meta(ge=0, le=24)]
_Positive = Annotated[float, msgspec.Meta(gt=0, le=1e9)]
_Watts = Annotated[float, msgspec.Meta(ge=0, le=1e6)]
_Minutes = Annotated[int, msgspec.Meta(ge=0, le=1440)]
Control = Literal["always_on", "on_off", "open_loop", "closed_loop"]


class LampPlacement(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A luminaire at some places of a scene; world axes, y up.

    Attributes:
        file: IES or EULUMDAT; empty: `at` is empty too, and the lamp is the scene's of this name.
        at: a place in metres, or a list of them: the middle of the luminous opening.
        aim: the direction of the luminaire's axis.
        rotation_deg: of its length around the axis, counter-clockwise from behind it. At 0 its
            length lies along +x where it is aimed up or down, else level.
        dimming: share of the full output at which it always runs, and of its power.
        group: that of its control; its own name unless given.
        lumens: luminous flux of the luminaire in place of the file's.
        watts: input power in place of the file's.
    """

    file: str = ""
    at: list[float | _Place] = []
    aim: _Place = (0.0, -1.0, 0.0)
    rotation_deg: Annotated[float, msgspec.Meta(ge=-360, le=360)] = 0.0
    dimming: Annotated[float, msgspec.Meta(gt=0, le=1)] = 1.0
    group: str = ""
    lumens: _Positive | None = None
    watts: _Watts | None = None

    def __post_init__(self) -> None:
        if bool(self.file) != bool(self.at):
            raise ValueError("a lamp with a file needs places in at, one of the scene has neither")
        if not all(math.isfinite(value) for place in self.places for value in place):
            raise ValueError("at holds a number that is not finite")
        if not 0.0 < math.hypot(*self.aim) < math.inf:
            raise ValueError(f"aim is {self.aim}: give a finite vector of some length")

    @property
    def places(self) -> list[_Place]:
        """The places, metres."""
        if any(isinstance(part, tuple) for part in self.at):
            places = [part for part in self.at if isinstance(part, tuple)]
            if len(places) == len(self.at):
                return places
        elif len(self.at) in (0, 3):
            numbers = [part for part in self.at if not isinstance(part, tuple)]
            return [(numbers[0], numbers[1], numbers[2])] if numbers else []
        raise ValueError("at is not [x, y, z] or a list of such places")


class LightingControl(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The control of a group of luminaires.

    Attributes:
        control: `always_on` in occupied hours; `on_off` by the daylight of the group's zone;
            `open_loop` dims by a photosensor that sees daylight alone; `closed_loop` dims so that
            daylight and lamps together reach the target in the zone.
        target_lx: maintained mean illuminance of the zone, with daylight.
        maintenance_factor: share of the full output that aged lamps give.
        occupied_h: from and to, hours of standard time; 18 to 2 goes over midnight.
        weekdays_only: no hour of Saturday and Sunday is occupied; 1 January is a Wednesday.
        delay_min: minutes for which daylight must reach the target before `on_off` switches off.
        min_dimming: the least output but off, a share of the full one.
        min_power: power at the least output, a share of the full one; linear between.
        standby_w: power of the group's controls and drivers while it is off, W.
        photosensor: x, y, z in metres and dx, dy, dz of `open_loop`; outdoors, level and free,
            unless given.
        dark_at_lx: daylight on the photosensor at which `open_loop` reaches the least output.
    """

    control: Control = "always_on"
    target_lx: _Positive = 500.0
    maintenance_factor: Annotated[float, msgspec.Meta(gt=0, le=1)] = 0.8
    occupied_h: tuple[_Hour, _Hour] = (8.0, 18.0)
    weekdays_only: bool = False
    delay_min: _Minutes = 10
    min_dimming: Share = 0.1
    min_power: Share = 0.1
    standby_w: _Watts = 0.0
    photosensor: tuple[float, float, float, float, float, float] | None = None
    dark_at_lx: _Positive | None = None

    def __post_init__(self) -> None:
        if self.occupied_h[0] == self.occupied_h[1]:
            raise ValueError("occupied_h begins and ends at one hour: give two, such as [8, 18]")
        if self.control == "open_loop" and self.dark_at_lx is None:
            raise ValueError(
                "open_loop needs dark_at_lx, the daylight on its photosensor that dims all"
            )
