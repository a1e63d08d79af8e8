"""Air made by hand: volumes whose light can be worked out on paper."""

import numpy as np
from air_phases import lobe

from vrut_lite.array import Array
from vrut_lite.messages.air import AirChanged, AirVolume

EARTH_M, TOP_M = 6.36e6, 6e4
ISOTROPIC = lobe(angles=2)


def volume_of(extinction, shaded, direct=0.0, aerosol=0.0, **changes):
    """A volume of nodes (slices, rows, columns, 3); extinction has no columns."""
    nodes = {"slices": 8, "rows_above": 6, "rows_below": 5, "columns": 4}
    nodes |= {name: changes.pop(name) for name in list(changes) if name in nodes}
    rows = nodes["rows_above"] + nodes["rows_below"]
    shape = (nodes["slices"], rows, nodes["columns"], 3)
    light = np.stack([np.broadcast_to(part, shape) for part in (shaded, direct, aerosol)])
    extinction = np.broadcast_to(extinction, (shape[0], rows, 3))

    known = {
        "radiance_scale": 1.0,
        "aerosol_phase": ISOTROPIC,
        "reach_m": 2e5,
        "observer_altitude_m": 1.7,
        "ground_radius_m": EARTH_M,
        "top_altitude_m": TOP_M,
        "sun_direction": (0.6, 0.8, 0.0),
    }
    return AirVolume(
        light=Array(light.astype(np.float16)),
        extinction=Array(extinction.astype(np.float32)),
        columns=nodes["columns"],
        rows_above=nodes["rows_above"],
        rows_below=nodes["rows_below"],
        **(known | changes),
    )


def air_of(volume):
    """The message."""
    return AirChanged(volume=volume, source="test")
