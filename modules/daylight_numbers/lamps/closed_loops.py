"""Closed loops of lamps: the least power that brings every zone to its target.

With output d and a switch u of each group, min sum P (p u + (1 - p) (d - m u) / (1 - m)) subject to
A d >= b and m u <= d <= u. For given switches it is a linear program, whose optimum is a vertex:
some groups are off, at the least or at full output, and the others follow from as many zones that
just reach their target. Few groups have so few vertices that all are tried for all times together;
more are solved time by time as a mixed-integer program. A zone that full output of all leaves too
dark is as bright as that makes it.
"""

import itertools
from typing import NamedTuple

import numpy as np
from scipy.optimize import Bounds, LinearConstraint, milp
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import connected_components

from vrut_lite.errors import UserError
from vrut_lite.messages.lighting import LightingControl
from vrut_lite.numeric_types import BoolArray, FloatArray, IntArray

# Groups in light of each other of which all vertices are tried: some thousands of five.
_MOST_TRIED = 5
# Light of another group, a share of the target, that is no coupling.
_APART = 1e-4
# Share of the target by which a vertex may miss it, by rounding.
_ROUNDING = 1e-9
_SINGULAR = 1e-9
# Relative gap at which a program is solved.
_GAP = 1e-6
_TIMES_AT_ONCE = 2048


class ClosedLoops(NamedTuple):
    """Groups (G) in closed loops: controls, full power (G,), and maintained lux (G, G) that a group
    (column) at full output brings to the zone of a group (row)."""

    controls: tuple[LightingControl, ...]
    watts: FloatArray
    lux: FloatArray

    def output(self, other_lx: FloatArray, occupied: BoolArray) -> FloatArray:
        """Output (G, T) at times.

        Args:
            other_lx: (G, T), daylight and other lamps in the zones.
            occupied: (G, T), groups that are off otherwise, and zones that need no light.
        """
        found = np.zeros(other_lx.shape)
        light = self.lux / self._targets[:, None]
        count, part = connected_components(csr_matrix(light > _APART), directed=False)
        for number in range(count):
            here = np.flatnonzero(part == number)
            loops = ClosedLoops(
                tuple(self.controls[n] for n in here),
                self.watts[here],
                self.lux[np.ix_(here, here)],
            )
            # Weak light of groups apart is of other rooms: it is not counted on.
            found[here] = loops._together(other_lx[here], occupied[here])
        return found

    @property
    def _targets(self) -> FloatArray:
        return np.array([control.target_lx for control in self.controls])

    @property
    def _least(self) -> FloatArray:
        return np.array([control.min_dimming for control in self.controls])

    @property
    def _costs(self) -> tuple[FloatArray, FloatArray]:
        """Power (G,) at the least output, and its slope (G,) above, as shares of all power."""
        least = self._least
        p = np.array([control.min_power for control in self.controls])
        # A group without power costs a little: its output would be any.
        share = self.watts / max(self.watts.sum(), 1e-12) + 1e-6
        slope = np.divide(1.0 - p, 1.0 - least, out=np.zeros(len(p)), where=least < 1.0)
        return share * np.where(least < 1.0, p, 1.0), share * slope

    def _together(self, other_lx: FloatArray, occupied: BoolArray) -> FloatArray:
        """Output (G, T) of groups that all depend on each other."""
        light = self.lux / self._targets[:, None]
        missing = np.where(occupied, 1.0 - other_lx / self._targets[:, None], 0.0)
        missing = np.clip(missing, 0.0, light @ occupied)
        found = np.zeros(missing.shape)
        needs = np.flatnonzero((missing > 0.0).any(axis=0))
        if not len(needs):
            return found
        states = np.concatenate([missing[:, needs], occupied[:, needs]])
        kinds, which = np.unique(states, axis=1, return_inverse=True)
        wanted, may_shine = kinds[: len(light)], kinds[len(light) :] > 0.0
        if len(light) <= _MOST_TRIED:
            solved = self._by_vertices(light, wanted, may_shine)
        else:
            pairs = zip(wanted.T, may_shine.T, strict=True)
            solved = np.array([self.by_program(light, *pair) for pair in pairs]).T
        found[:, needs] = solved[:, which.ravel()]
        return found

    def _by_vertices(
        self, light: FloatArray, wanted: FloatArray, may_shine: BoolArray
    ) -> FloatArray:
        """Output (G, K) by the best of all vertices."""
        vertices = _vertices(light, self._least)
        fixed_cost, slope = self._costs
        parts = []
        for first in range(0, wanted.shape[1], _TIMES_AT_ONCE):
            some = slice(first, first + _TIMES_AT_ONCE)
            need, may = wanted[:, some], may_shine[:, some]
            best, cost = np.ones(need.shape) * may, np.full(need.shape[1], np.inf)
            for vertex in vertices:
                tried = vertex.output(light, need)
                on = tried > 0.0
                least = self._least[:, None]
                # Rounding may bring outputs that follow from zones just beyond a bound.
                tried = np.where(on, np.clip(tried, least - _ROUNDING, 1.0 + _ROUNDING), 0.0)
                fits = (light @ tried >= need - _ROUNDING).all(axis=0) & (may | ~on).all(axis=0)
                tried = np.where(on, np.clip(tried, least, 1.0), 0.0)
                power = fixed_cost @ on + slope @ np.where(on, tried - least, 0.0)
                better = fits & (power < cost)
                best[:, better], cost[better] = tried[:, better], power[better]
            parts.append(best)
        return np.concatenate(parts, axis=1)

    def by_program(self, light: FloatArray, wanted: FloatArray, may_shine: BoolArray) -> FloatArray:
        """Output (G,) at one time by the mixed-integer program.

        Args:
            light: (G, G), shares of the zones' targets.
            wanted: (G,), shares of them that are missing, which full output brings.
            may_shine: (G,), groups that are not off.
        """
        count, least = len(wanted), self._least
        fixed_cost, slope = self._costs
        eye, none = np.eye(count), np.zeros((count, count))
        switched = np.vstack([np.hstack([eye, -eye]), np.hstack([-eye, least * eye])])
        result = milp(
            np.concatenate([slope, fixed_cost - slope * least]),
            integrality=np.repeat([0, 1], count),
            bounds=Bounds(0.0, np.tile(may_shine.astype(float), 2)),
            constraints=[
                LinearConstraint(np.hstack([light, none]), wanted - _ROUNDING, np.inf),
                LinearConstraint(switched, -np.inf, 0.0),
            ],
            options={"mip_rel_gap": _GAP},
        )
        if result.x is None:
            raise UserError(f"closed loops of lamps have no solution: {result.message}")
        on = result.x[count:] > 0.5
        return np.where(on, np.clip(result.x[:count], least, 1.0), 0.0)


class _Vertex(NamedTuple):
    """Outputs (G,) of groups that are fixed, 0 for the others; the others' numbers (k,), the zones
    (k,) that they just light, and the inverse (k, k) of their light in these."""

    fixed: FloatArray
    free: IntArray
    zones: IntArray
    inverse: FloatArray

    def output(self, light: FloatArray, wanted: FloatArray) -> FloatArray:
        """Output (G, K) for needs (G, K)."""
        found = np.repeat(self.fixed[:, None], wanted.shape[1], axis=1)
        if len(self.free):
            left = wanted[self.zones] - (light[self.zones] @ self.fixed)[:, None]
            found[self.free] = self.inverse @ left
        return found


def _vertices(light: FloatArray, least: FloatArray) -> list[_Vertex]:
    """All vertices of groups with light (G, G)."""
    count, found = len(least), []
    for levels in itertools.product(("off", "least", "full", "free"), repeat=count):
        free = np.array([n for n, level in enumerate(levels) if level == "free"], np.int64)
        fixed = np.array(
            [{"least": least[n], "full": 1.0}.get(level, 0.0) for n, level in enumerate(levels)]
        )
        for chosen in itertools.combinations(range(count), len(free)):
            zones = np.array(chosen, np.int64)
            part = light[np.ix_(zones, free)]
            if len(free) and abs(np.linalg.det(part)) < _SINGULAR * np.abs(part).max() ** len(free):
                continue
            found.append(_Vertex(fixed, free, zones, np.linalg.inv(part).astype(float)))
    return found
