"""Reflectance and transmittance of coats, looked up as in mesh.frag."""

from typing import Any

import numpy as np

from vrut_lite.geometry.reflection import DIELECTRIC_F0, reflectance_table
from vrut_lite.geometry.sheen import sheen_table
from vrut_lite.geometry.thin_film import film_table

# Slope of the reflectance at grazing angles for surfaces darker than 2 % at normal incidence.
GRAZING_SLOPE = 50.0
COAT_F90 = min(1.0, GRAZING_SLOPE * DIELECTRIC_F0)


def coat(a: Any, b: Any, f0: Any = DIELECTRIC_F0, f90: Any = COAT_F90) -> Any:
    """Share of the light that the coat of a dielectric reflects, all bounces."""
    return (f0 * a + f90 * b) * (1.0 + f0 * (1.0 / (a + b) - 1.0))


def mean_coat(mean: Any, f0: Any, f90: Any) -> Any:
    """The same over all directions, in proportion to the table's `mean`, as mesh.frag has it."""
    more = (f0 - DIELECTRIC_F0 * f90) * (1.0 - mean) / (1.0 - DIELECTRIC_F0)
    return mean * f90 + more


class Shares:
    """Tables of roughness and cosine: of facets' shares of an even sky, and of fibres'."""

    def __init__(self, mi: Any):
        import drjit

        self._mi, self._dr = mi, drjit
        table = np.asarray(reflectance_table())
        self._last = table.shape[0] - 1
        self._facets = mi.Texture2f(mi.TensorXf(table))
        self._fibres = mi.Texture2f(mi.TensorXf(np.asarray(sheen_table())[..., None]))

    def facets(self, mu: Any, roughness: Any) -> Any:
        """Reflectance under a uniform white sky, and a dielectric's mean: `reflectance_table`."""
        return self._facets.eval(self._at(mu, roughness))

    def fibres(self, mu: Any, roughness: float) -> Any:
        """Reflectance of white fibres under a uniform white sky."""
        return self._fibres.eval(self._at(mu, roughness))[0]

    def _at(self, mu: Any, roughness: Any) -> Any:
        at = self._mi.Point2f(self._dr.sqrt(self._dr.clip(mu, 0.0, 1.0)), roughness)
        return (at * self._last + 0.5) / (self._last + 1.0)


class Film:
    """A thin film (KHR_materials_iridescence): `geometry.thin_film`'s table, in the same units."""

    def __init__(self, mi: Any, ior: float, least_nm: float, most_nm: float):
        import drjit

        self._mi, self._dr = mi, drjit
        table = film_table(ior, least_nm, most_nm)
        self._size = [float(size) for size in (table.shape[2], table.shape[1], table.shape[0])]
        self._table = mi.Texture3f(mi.TensorXf(np.asarray(table)))

    def over(self, f0: Any, cosine: Any, share: Any, thickness: Any) -> Any:
        """Schlick's f0 of a surface of which a share lies under the film."""
        mi, dr = self._mi, self._dr
        filmed = []
        for channel in range(3):
            part = dr.sqrt(dr.clip(f0[channel], 0.0, 1.0))
            at = [
                (value * (size - 1.0) + 0.5) / size
                for value, size in zip((cosine, part, thickness), self._size, strict=True)
            ]
            filmed.append(self._table.eval(mi.Point3f(*at))[channel])
        return f0 + (mi.Color3f(*filmed) - f0) * share
