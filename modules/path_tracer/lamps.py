"""The scene's lamps as an emitter of mitsuba: points whose light a cone and a table shape.

Mitsuba's own spots fade linearly by angle, and it knows no luminaires; glTF's fade by the square of
cosines (KHR_lights_punctual). Python is called for each path in scalar variants, as for few lamps
it may be.
"""

from typing import Any

import numpy as np

from path_tracer.plugins import register
from path_tracer.subject import Subject
from vrut_lite.messages.lamps import NONE, TABLE_SHAPE, SceneLamps

PLUGIN = "vrut_lite_lamp"
_SHARPEST_RAMP = 1e-3


def lamp_emitters(mitsuba: Any, subject: Subject) -> dict[str, Any]:
    """Emitters by name, one for each lamp of the scene."""
    lamps = subject.scene.lamps
    if lamps is None:
        return {}
    register(mitsuba, PLUGIN, "emitter", _lamp)
    return {
        f"lamp_{number}": _emitter(mitsuba, subject, lamps, number) for number in range(lamps.count)
    }


def _emitter(mitsuba: Any, subject: Subject, lamps: SceneLamps, number: int) -> dict[str, Any]:
    place = subject.units_from_world() @ [*lamps.position_m.values[number], 1.0]
    inner, outer = lamps.cone_cos.values[number]
    table = int(lamps.table.values[number])
    axes = lamps.axes.values[number]
    return {
        "type": PLUGIN,
        "place": [float(value) for value in place[:3]],
        "axis": [float(value) for value in axes[0]],
        "across": [float(value) for value in axes[1]],
        "side": [float(value) for value in axes[2]],
        # Irradiance is intensity over the square of a distance, which here is in units.
        "intensity": [
            float(value) for value in lamps.intensity_rgb.values[number] * subject.units_per_m**2
        ],
        "outer_cos": float(outer),
        "ramp": float(1.0 / max(inner - outer, _SHARPEST_RAMP)),
        "table": _texture(mitsuba, None if table == NONE else lamps.tables.values[table]),
    }


def _texture(mitsuba: Any, table: Any) -> dict[str, Any]:
    """A table as a texture whose middles of texels are its nodes."""
    values = np.ones((2, 2), np.float32) if table is None else np.asarray(table)
    return {
        "type": "bitmap",
        "bitmap": mitsuba.Bitmap(values[:, :, None].copy()),
        "raw": True,
        "wrap_mode": "clamp",
    }


def _lamp(mi: Any) -> Any:
    """The emitter's class, which must descend from the variant's own."""
    import drjit

    dr: Any = drjit
    rows, columns = TABLE_SHAPE
    is_scalar = mi.variant().startswith("scalar")

    class Lamp(mi.Emitter):
        """A point; nothing of it is seen."""

        def __init__(self, properties: Any):
            super().__init__(properties)
            self.place = mi.Point3f(properties["place"])
            self.axis = mi.Vector3f(properties["axis"])
            self.across = mi.Vector3f(properties["across"])
            self.side = mi.Vector3f(properties["side"])
            # The variants here are of RGB: a spectrum is a colour.
            self.intensity = mi.Color3f(properties["intensity"])
            self.table = properties.get_texture("table")
            self.outer_cos = properties["outer_cos"]
            self.ramp = properties["ramp"]
            self.m_flags = mi.EmitterFlags.DeltaPosition

        def _towards(self, d: Any, active: Any) -> Any:
            """Intensity into a direction of the world."""
            cosine = dr.dot(d, self.axis)
            share = dr.square(dr.clip((cosine - self.outer_cos) * self.ramp, 0.0, 1.0))
            row = dr.safe_acos(cosine) * (1.0 / dr.pi)
            around = dr.atan2(dr.dot(d, self.side), dr.dot(d, self.across)) * (0.5 / dr.pi)
            around -= dr.floor(around)
            at = mi.SurfaceInteraction3f()
            # From nodes, which are the middles of texels, to the texture's corners.
            at.uv = mi.Point2f(
                (around * (columns - 1) + 0.5) / columns, (row * (rows - 1) + 0.5) / rows
            )
            return self.intensity * share * self.table.eval_1(at, active)

        def sample_direction(self, it: Any, sample: Any, active: Any = True) -> Any:
            ds = mi.DirectionSample3f()
            ds.p, ds.uv = self.place, mi.Point2f(0.0)
            ds.time, ds.delta, ds.pdf = it.time, True, 1.0
            ds.emitter = self if is_scalar else mi.EmitterPtr(self)
            away = self.place - it.p
            squared = dr.squared_norm(away)
            ds.dist = dr.sqrt(squared)
            ds.d = away * dr.rcp(ds.dist)
            ds.n = -ds.d
            return ds, self._towards(-ds.d, active) / squared

        def pdf_direction(self, it: Any, ds: Any, active: Any = True) -> Any:
            return 0.0

        def eval_direction(self, it: Any, ds: Any, active: Any = True) -> Any:
            return self._towards(-ds.d, active) / dr.square(ds.dist)

        def eval(self, si: Any, active: Any = True) -> Any:
            return 0.0

        def bbox(self) -> Any:
            return mi.ScalarBoundingBox3f(mi.ScalarPoint3f(0.0), mi.ScalarPoint3f(0.0))

        def to_string(self) -> str:
            return "Lamp[]"

    return Lamp
