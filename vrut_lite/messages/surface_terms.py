"""Terms of a surface from glTF's extensions, beyond metal, roughness and colour.

The numbers are those of KHR_materials_ior, specular, clearcoat, sheen, anisotropy, transmission,
volume, iridescence and unlit, in their units; each default is the extension's own, so that the
defaults together are glTF 2.0's core material.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vrut_lite.numeric_types import FloatArray, Vector

_WHITE, _BLACK = (1.0, 1.0, 1.0), (0.0, 0.0, 0.0)


class SurfaceTerms(NamedTuple):
    """Terms of one surface; colours are linear sRGB.

    `specular` and `specular_rgb` scale the reflectance that `ior` gives at normal incidence, the
    first at grazing angles too. `clearcoat` is the share of the surface under a second coat.
    Anisotropy stretches highlights across the direction that is turned counter-clockwise from the
    first texture coordinate. `transmission` is the share of the light below the coat that passes
    through, not scattered by paint; a body of `thickness_m`, 0 for a pane, refracts it and absorbs
    by `extinction_per_m` (Beer and Lambert). `iridescence` is the share under a thin film of
    `film_ior`, whose map interpolates between both thicknesses. An `unlit` surface shows its colour
    (1 or 0).
    """

    ior: float = 1.5
    specular: float = 1.0
    specular_rgb: Vector = _WHITE
    clearcoat: float = 0.0
    clearcoat_roughness: float = 0.0
    sheen_rgb: Vector = _BLACK
    sheen_roughness: float = 0.0
    anisotropy: float = 0.0
    anisotropy_rad: float = 0.0
    transmission: float = 0.0
    thickness_m: float = 0.0
    extinction_per_m: Vector = _BLACK
    unlit: float = 0.0
    iridescence: float = 0.0
    film_ior: float = 1.3
    film_least_nm: float = 400.0
    film_most_nm: float = 400.0

    @property
    def f0_rgb(self) -> FloatArray:
        """Reflectance (3,) of the dielectric at normal incidence."""
        return dielectric_f0(self, self.specular, self.specular_rgb)

    @property
    def f90(self) -> float:
        """Reflectance of the dielectric at grazing angles."""
        return self.specular

    @property
    def transmits(self) -> bool:
        """Whether light passes through."""
        return self.transmission > 0.0

    @property
    def is_pane(self) -> bool:
        """Whether transmitted light goes straight on: a thin wall, not the side of a body."""
        return self.thickness_m == 0.0


def dielectric_f0(terms: SurfaceTerms, specular: ArrayLike, specular_rgb: ArrayLike) -> FloatArray:
    """Reflectance (..., 3) at normal incidence by `ior`, scaled; KHR_materials_specular."""
    by_ior = ((terms.ior - 1.0) / (terms.ior + 1.0)) ** 2
    tinted = np.minimum(by_ior * np.asarray(specular_rgb, float), 1.0)
    return np.asarray(np.asarray(specular, float) * tinted)


def as_row(terms: SurfaceTerms) -> FloatArray:
    """All numbers (TERM_COLUMNS,), field after field."""
    return np.concatenate([np.atleast_1d(np.asarray(value, float)) for value in terms])


def from_row(row: NDArray[Any]) -> SurfaceTerms:
    """The terms of a row of numbers (TERM_COLUMNS,)."""
    values: list[float | tuple[float, ...]] = []
    at = 0
    for default in SurfaceTerms():
        if isinstance(default, tuple):
            values.append(tuple(float(value) for value in row[at : at + 3]))
            at += 3
        else:
            values.append(float(row[at]))
            at += 1
    return SurfaceTerms(*values)  # type: ignore[arg-type]


TERM_COLUMNS = len(as_row(SurfaceTerms()))
