"""The lamps of a scene at its sensors, in groups with their controls and zones."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from daylight_numbers.lamps.lamp_light import LampsAtSensors, lamps_at_sensors
from daylight_numbers.lamps.lamp_places import PlacedLuminaires, placed_luminaires
from daylight_numbers.work import DaylightWork
from vrut_lite.errors import UserError
from vrut_lite.messages.lighting import LampPlacement, LightingControl
from vrut_lite.messages.scene import SceneOpened
from vrut_lite.numeric_types import BoolArray, FloatArray, Vector

# Illuminance (lx) by a lumen at the brightest sensor below which lamps are taken for shut off; in a
# hall 30 m high it is ten times that.
_DARK_LX_OF_LUMEN = 3e-5


@dataclass(frozen=True, eq=False)
class Lighting:
    """Luminaires, their light at sensors (P) by groups (G), and the control of each group."""

    lamps: PlacedLuminaires
    light: LampsAtSensors
    controls: tuple[LightingControl, ...]

    @property
    def maintained_lux(self) -> FloatArray:
        """Illuminance (P, G) of groups at full output when they are aged."""
        return self.light.total * [control.maintenance_factor for control in self.controls]

    @property
    def zones(self) -> BoolArray:
        """Which sensors (G, P) each group is controlled by: those whose brightest group it is, or
        its brightest sensor alone where others outshine it everywhere."""
        lux = self.light.total
        found = (np.argmax(lux, axis=1) == np.arange(lux.shape[1])[:, None]) & (lux.T > 0.0)
        for group in np.flatnonzero(~found.any(axis=1)):
            found[group, np.argmax(lux[:, group])] = True
        return found

    def warnings(self) -> list[str]:
        """A sentence for each group that no sensor sees, or whose power is not known."""
        groups = self.lamps.groups
        flux_lm = np.bincount(self.lamps.group, self.lamps.flux_lm, len(groups))
        dark = self.light.total.max(axis=0) <= _DARK_LX_OF_LUMEN * flux_lm
        return [
            f"the lamps of '{groups[n]}' light no sensor: do they stand in a wall, or face away?"
            for n in np.flatnonzero(dark)
        ] + [
            f"the lamps of '{groups[n]}' have no power in their files: give watts for their energy"
            for n in np.flatnonzero(self.lamps.group_watts == 0.0)
        ]


def lighting_of(
    work: DaylightWork,
    scene: SceneOpened,
    placements: Mapping[str, LampPlacement],
    controls: Mapping[str, LightingControl],
    ground_albedo_rgb: Vector,
) -> Lighting:
    """The light of placed lamps; groups without a control are on in occupied hours.

    Raises:
        UserError: a luminaire cannot be read or placed, or a control is of no group.
    """
    lamps = placed_luminaires(placements, scene.lamps)
    for name in controls:
        if name not in lamps.groups:
            there = ", ".join(lamps.groups)
            raise UserError(f"lighting: no lamps are of the group '{name}'; groups are {there}")
    light = lamps_at_sensors(work, lamps, ground_albedo_rgb)
    told = tuple(controls.get(name, LightingControl()) for name in lamps.groups)
    return Lighting(lamps, light, told)
