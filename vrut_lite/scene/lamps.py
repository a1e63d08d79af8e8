"""Lamps as readers of files hand them over, and all of a scene's packed into its message."""

from collections.abc import Mapping
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from vrut_lite.array import Array
from vrut_lite.geometry.colour import LUMENS_PER_WATT, luminance
from vrut_lite.messages.lamps import (
    ALL_AROUND,
    MOST_LAMPS,
    NONE,
    TABLE_SHAPE,
    SceneLamps,
    brightest_first,
)
from vrut_lite.numeric_types import FloatArray
from vrut_lite.scene.photometry import Photometry
from vrut_lite.scene.scene_file_error import SceneFileError

_LONGEST_NAME = 80
_MOST_CANDELA = 1e12
# A lamp's own axis that lies along its light, but for rounding.
_LEVEL = 1e-9


class PlacedLamp(NamedTuple):
    """A lamp where it stands: it shines along -Z of the matrix (4, 4), with X at the angle 0.

    `names`: its own first. `candela` is where cone and photometry are 1; times `colour_rgb`.
    """

    names: tuple[str, ...]
    world_from_lamp: NDArray[np.float64]
    colour_rgb: FloatArray
    candela: float
    cone_cos: tuple[float, float]
    photometry: Photometry | None

    @property
    def name(self) -> str:
        """The first that is not empty."""
        return next(filter(None, self.names), "")

    def checked(self) -> Self:
        """The lamp itself.

        Raises:
            SceneFileError: it has an impossible intensity.
        """
        candela = self.colour_rgb * self.candela
        if not (np.all(candela >= 0.0) and np.all(candela <= _MOST_CANDELA)):
            raise SceneFileError(f"the lamp {_shown(self.name)} has an impossible intensity")
        return self

    def moved(self, matrix: NDArray[np.float64]) -> Self:
        """The lamp under a further matrix (4, 4)."""
        with np.errstate(over="ignore", invalid="ignore"):
            return self._replace(world_from_lamp=matrix @ self.world_from_lamp)

    def with_photometry(self, photometry: Photometry) -> Self:
        """The lamp with the candela of a luminaire, in its own colour."""
        bright = float(luminance(self.colour_rgb))
        return self._replace(
            photometry=photometry,
            candela=photometry.candela / bright if bright > 0.0 else 0.0,
            cone_cos=ALL_AROUND,
        )


def with_luminaires(
    lamps: list[PlacedLamp], luminaires: Mapping[str, Photometry]
) -> list[PlacedLamp]:
    """Lamps, of which those that are named have the luminaire's photometry.

    Raises:
        SceneFileError: no lamp has such a name.
    """
    for name in luminaires:
        if not any(name in lamp.names for lamp in lamps):
            there = ", ".join(_shown(lamp.name) for lamp in lamps[:8]) or "none"
            raise SceneFileError(
                f"the project gives a luminaire to the lamp {_shown(name)}, which it does not "
                f"have; its lamps are {there}"
            )
    named = [next((name for name in lamp.names if name in luminaires), None) for lamp in lamps]
    return [
        lamp if name is None else lamp.with_photometry(luminaires[name])
        for lamp, name in zip(lamps, named, strict=True)
    ]


def packed_lamps(lamps: list[PlacedLamp]) -> SceneLamps | None:
    """The lamps that shine, the brightest first; None without any.

    Raises:
        SceneFileError: they are too many, or one stands nowhere.
    """
    lamps = [lamp for lamp in lamps if lamp.candela * lamp.colour_rgb.max() > 0.0]
    if not lamps:
        return None
    if len(lamps) > MOST_LAMPS:
        raise SceneFileError(f"it has more than {MOST_LAMPS} lamps; remove some")
    for lamp in lamps:
        if not np.all(np.isfinite(lamp.world_from_lamp)):
            raise SceneFileError(f"the lamp {_shown(lamp.name)} stands nowhere; mend its node")
    intensity = np.array([lamp.candela * lamp.colour_rgb for lamp in lamps]) / LUMENS_PER_WATT
    order = brightest_first(intensity)
    lamps = [lamps[number] for number in order]
    tables: dict[bytes, int] = {}
    numbers = [_table_number(lamp.photometry, tables) for lamp in lamps]
    joined = np.frombuffer(b"".join(tables), np.float32).reshape(-1, *TABLE_SHAPE)
    names = "\n".join(" ".join(lamp.name.split())[:_LONGEST_NAME] for lamp in lamps)
    return SceneLamps(
        names=Array(np.frombuffer(names.encode(errors="replace"), np.uint8)),
        position_m=Array(np.array([lamp.world_from_lamp[:3, 3] for lamp in lamps])),
        axes=Array(np.array([_axes(lamp.world_from_lamp) for lamp in lamps])),
        intensity_rgb=Array(intensity[order]),
        cone_cos=Array(np.array([lamp.cone_cos for lamp in lamps])),
        table=Array(np.array(numbers, np.int32)),
        tables=Array(joined),
    )


def _table_number(photometry: Photometry | None, tables: dict[bytes, int]) -> int:
    if photometry is None:
        return NONE
    return tables.setdefault(photometry.table.tobytes(), len(tables))


def _axes(world_from_lamp: NDArray[np.float64]) -> FloatArray:
    """Rows -Z, +X and +Y of a matrix, made unit and upright; downwards where it has no -Z."""
    x, y, z = world_from_lamp[:3, :3].T
    forward = -z / np.linalg.norm(z) if np.any(z) else np.array([0.0, -1.0, 0.0])
    across = x - (x @ forward) * forward
    if not np.linalg.norm(across) > _LEVEL * np.linalg.norm(x):
        helper = np.eye(3)[np.argmin(np.abs(forward))]
        across = helper - (helper @ forward) * forward
    across /= np.linalg.norm(across)
    side = np.cross(across, forward)
    # A mirrored node has mirrored luminaires.
    return np.array([forward, across, -side if side @ y < 0.0 else side])


def _shown(name: str) -> str:
    return ascii(name)[:60]
