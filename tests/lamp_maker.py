"""Makes lamps for tests."""

import numpy as np

from vrut_lite.array import Array
from vrut_lite.messages.lamps import ALL_AROUND, NONE, TABLE_SHAPE, SceneLamps


def lamps_of(*lamps):
    """Lamps of `position_m`, `intensity_rgb`, `axis`, `across`, `cone_rad`, `table`."""
    tables = [lamp["table"] for lamp in lamps if "table" in lamp]
    numbers = np.cumsum([("table" in lamp) for lamp in lamps]) - 1
    made = SceneLamps(
        names=Array(np.frombuffer(b"\n".join(b"lamp" for _ in lamps), np.uint8)),
        position_m=Array(np.array([lamp["position_m"] for lamp in lamps], float)),
        axes=Array(np.array([axes_of(**lamp) for lamp in lamps])),
        intensity_rgb=Array(
            np.array([lamp.get("intensity_rgb", (2.0, 2.0, 2.0)) for lamp in lamps], float)
        ),
        cone_cos=Array(
            np.array(
                [np.cos(lamp["cone_rad"]) if "cone_rad" in lamp else ALL_AROUND for lamp in lamps],
                float,
            )
        ),
        table=Array(
            np.array(
                [
                    number if "table" in lamp else NONE
                    for lamp, number in zip(lamps, numbers, strict=True)
                ],
                np.int32,
            )
        ),
        tables=Array(np.array(tables, np.float32).reshape(-1, *TABLE_SHAPE)),
    )
    made.check()
    made.check_arrays()
    return made


def axes_of(axis=(0.0, -1.0, 0.0), across=(1.0, 0.0, 0.0), **_):
    """Right-handed unit rows, as glTF's -Z, X and Y are."""
    axis = np.array(axis, float) / np.linalg.norm(axis)
    across = np.array(across, float) - np.dot(across, axis) * axis
    across /= np.linalg.norm(across)
    return np.array([axis, across, np.cross(across, axis)])


def spot_table():
    """Light into a lobe that is wider along the angle 0 than along 90 degrees, none behind."""
    theta = np.radians(np.linspace(0.0, 180.0, TABLE_SHAPE[0]))[:, None]
    phi = np.radians(np.linspace(0.0, 360.0, TABLE_SHAPE[1]))[None]
    narrow = 1.0 + 6.0 * np.sin(phi - 0.3) ** 2
    return np.where(theta < np.pi / 2, np.cos(np.minimum(theta, np.pi / 2)) ** narrow, 0.0)
