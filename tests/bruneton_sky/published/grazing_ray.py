"""Light scattered once by aerosol along rays that graze the ground, where its table is steepest.

In haze the table's node at the horizon holds e^-200 and its neighbour e^-10: on the way down
to the ground's tangent point the neighbour's weight must be exactly nothing. Here it is, because
all is told by the distance t from that point: the tangent's length is |t|, and the ray up is
shorter than the longest by 0 before the point and by 2 t beyond it.
"""

import numpy as np
from bruneton_sky import Atmosphere
from bruneton_sky.published.pipeline.first_order import transmittance
from bruneton_sky.published.pipeline.setting import RAY_INTERVALS, Setting, densities
from bruneton_sky.tables.look_ups import transmittance_to_sun
from bruneton_sky.tables.ray_lengths import tangent
from bruneton_sky.tables.sizes import TableSizes


def single_mie(air: Atmosphere, sizes: TableSizes, altitude: int, nu: int, mu_s: int):
    """The table's value (C,) at the horizon's node, of the parametrisation of 2017."""
    setting = Setting(air, sizes, "2017")
    table, nodes = transmittance(setting), setting.nodes()
    h, sun = nodes.altitude_m.ravel()[altitude], nodes.mu_s.ravel()[mu_s]
    angle = np.broadcast_to(nodes.nu, sizes.scattering_shape)[altitude, -1, nu, mu_s]
    before, whole = tangent(air, h), tangent(air, air.top_altitude_m)
    step, light = (before + whole) / RAY_INTERVALS, 0.0
    for i in range(RAY_INTERVALS + 1):
        t = i * step - before
        there = _altitude(air, abs(t))
        mu_there = ((air.ground_radius_m + h) * sun + i * step * angle) / (
            air.ground_radius_m + there
        )
        clear = np.minimum(_to_top(air, table, before, 0.0) / _to_top(air, table, abs(t), t), 1.0)
        clear *= transmittance_to_sun(air, table, there, mu_there)
        light += clear * densities(air, there)[1] * step * (0.5 if i in (0, RAY_INTERVALS) else 1)
    return light * air.solar_irradiance * air.mie_scattering


def _altitude(air, rho):
    ground = air.ground_radius_m
    return min(rho * rho / (ground + np.hypot(ground, rho)), air.top_altitude_m)


def _to_top(air, table, rho, t):
    """Transmittance (C,) where the tangent has the length rho."""
    whole = tangent(air, air.top_altitude_m)
    room = rho + whole - (air.top_altitude_m - _altitude(air, rho))
    column, far = _place(max(2.0 * t, 0.0) / room, table.shape[1])
    row, above = _place(rho / whole, table.shape[0])
    from_horizon = table[:, ::-1]
    low, high = (
        (1.0 - far) * from_horizon[r, column] + far * from_horizon[r, column + 1]
        for r in (row, row + 1)
    )
    return (1.0 - above) * low + above * high


def _place(unit, size):
    place = min(unit, 1.0) * (size - 1)
    before = min(int(place), size - 2)
    return before, place - before
