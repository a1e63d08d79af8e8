"""Our own skies as peers: the solver's, its tables, and the models that we have too."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np
from bruneton_sky import TableSizes, earth_spectral, precompute
from bruneton_sky.background import background_cube, surroundings
from bruneton_sky.solver_job import solve_air
from bruneton_sky.solver_rungs import SolverRung
from dynamic_skylight import HosekWilkieSky

from vrut_lite.atmosphere.aerosol import turbidity_of_optical_depth
from vrut_lite.atmosphere.equal_haze import equal_sky
from vrut_lite.geometry.colour import SKYLIGHT_NM, integration_matrix
from vrut_lite.geometry.panorama import lat_long_directions, sample_sky
from vrut_lite.numeric_types import FloatArray
from vrut_lite_lab.study.framework.spectra import WAVELENGTHS_NM
from vrut_lite_lab.study.models.preetham import Preetham
from vrut_lite_lab.study.peers.airs import DEPTH, GROUND_ALBEDO, air, continental
from vrut_lite_lab.study.peers.peer import PeerAir, PeerShot
from vrut_lite_lab.study.peers.truth import seen_rgb
from vrut_lite_lab.study.peers.views import (
    HEIGHT,
    ON_GROUND,
    SPACE_M,
    TIMED,
    SkyViewpoint,
    of_picture,
    rays,
    whole,
)

_CUBE = 256


def cpu(work: Callable[[], FloatArray], rounds: int = 1) -> tuple[FloatArray, float]:
    """What is computed, and the least CPU seconds of some rounds."""
    least = float("inf")
    for _ in range(rounds):
        start = time.process_time()
        found = work()
        least = min(least, time.process_time() - start)
    return found, least


@dataclass
class OursPicture:
    """The product's picture: four wavelengths, a table for the observer, a cube."""

    air: str = "continental"
    name: str = "ours"
    title: str = "ours, usual"
    cannot: str = "polarisation; refraction of the air"
    grey: bool = False
    _prepared_s: float = np.nan

    def shots(self, views: Sequence[SkyViewpoint]) -> dict[SkyViewpoint, PeerShot]:
        """From the ground and 10 km; the ground below is no part of the comparison."""
        of_product = continental(SKYLIGHT_NM)
        solve_air(of_product)
        start = time.process_time()
        source = solve_air(of_product)
        self._prepared_s = time.process_time() - start
        directions = lat_long_directions(HEIGHT)

        def picture(view: SkyViewpoint) -> FloatArray:
            around = surroundings(source, view.altitude_m, view.sun_direction)
            return sample_sky(background_cube(around, _CUBE), directions)

        found = {}
        for view in views:
            if view.altitude_m < SPACE_M:
                seen, spent_s = cpu(partial(picture, view), 3)
                found[view] = PeerShot(of_picture(seen, view), spent_s)
        return found

    def prepared_s(self) -> float:
        """Solving the air."""
        return self._prepared_s


@dataclass
class OursRays:
    """The solver's light along each ray, at a rung, in an air of any peer."""

    air: str
    rung: SolverRung = "fine"
    cannot: str = "polarisation; refraction of the air"
    grey: bool = False
    _prepared_s: float = np.nan

    @property
    def name(self) -> str:
        """As in `ours-fine-genssky`."""
        return f"ours-{self.rung}-{self.air}"

    @property
    def title(self) -> str:
        """Its rung."""
        return f"ours, {self.rung}, ray by ray"

    def shots(self, views: Sequence[SkyViewpoint]) -> dict[SkyViewpoint, PeerShot]:
        """All views."""
        here = self._air()
        solve_air(here.atmosphere, rung="draft")
        start = time.process_time()
        source = solve_air(here.atmosphere, rung=self.rung)
        self._prepared_s = time.process_time() - start
        found = {}
        for view in views:
            half, spent_s = cpu(partial(seen_rgb, source, here, view))
            # The other half is its mirror image; rays cost alike.
            whole_s = spent_s * (HEIGHT * HEIGHT) / half[..., 0].size
            found[view] = PeerShot(whole(half), whole_s if view == TIMED else np.nan)
        return found

    def prepared_s(self) -> float:
        """Solving the air."""
        return self._prepared_s

    def _air(self) -> PeerAir:
        return air(self.air)


@dataclass
class PublishedTables:
    """Bruneton's tables at their published sizes: four orders, three wavelengths."""

    air: str = "clear"
    name: str = "tables"
    title: str = "Bruneton's published tables"
    cannot: str = "aerosols of a tabulated phase function, fog; a sun below -12°"
    grey: bool = False
    _prepared_s: float = np.nan

    def shots(self, views: Sequence[SkyViewpoint]) -> dict[SkyViewpoint, PeerShot]:
        """All views, three wavelengths in the published colours."""
        atmosphere = earth_spectral()
        start = time.process_time()
        tables = precompute(atmosphere, 4, sizes=TableSizes())
        self._prepared_s = time.process_time() - start
        directions = lat_long_directions(HEIGHT)
        half = HEIGHT // 2
        found = {}
        for view in views:
            eye = np.array([0.0, atmosphere.ground_radius_m + view.altitude_m, 0.0])

            def picture(v: SkyViewpoint = view, e: FloatArray = eye) -> FloatArray:
                # The ground's half is as dear, and not measured but from space.
                part = slice(half, None) if v.altitude_m >= SPACE_M else slice(0, half)
                seen = np.zeros((HEIGHT, 2 * HEIGHT, 3))
                seen[part] = tables.radiance_rgb(
                    e[[0, 2, 1]],
                    directions[part][..., [0, 2, 1]],
                    np.array(v.sun_direction)[[0, 2, 1]],
                )
                return seen

            seen, spent_s = cpu(picture)
            found[view] = PeerShot(of_picture(seen, view), 2.0 * spent_s)
        return found

    def prepared_s(self) -> float:
        """The tables."""
        return self._prepared_s


@dataclass
class OurHosekWilkie:
    """Our Hosek-Wilkie sky, at the turbidity that shows this haze best."""

    air: str = "continental"
    name: str = "hosek-wilkie"
    title: str = "Hosek-Wilkie 2012, ours"
    cannot: str = "a sun below 0°; observers aloft; ozone, aerosols, layers"
    grey: bool = False

    def shots(self, views: Sequence[SkyViewpoint]) -> dict[SkyViewpoint, PeerShot]:
        """From the ground, the sun up."""
        found = {}
        for view in views:
            if view in ON_GROUND and view.sun_deg >= 0.0:
                elevation = float(np.radians(view.sun_deg))

                def picture(e: float = elevation) -> FloatArray:
                    sky = HosekWilkieSky(equal_sky(DEPTH, e).turbidity, GROUND_ALBEDO, e)
                    return sky.radiance_towards(lat_long_directions(HEIGHT)).astype(float)

                seen, spent_s = cpu(picture, 3)
                found[view] = PeerShot(of_picture(seen, view), spent_s)
        return found

    def prepared_s(self) -> float:
        """Nothing."""
        return 0.0


@dataclass
class PreethamSky:
    """Preetham, Shirley and Smits 1999 as published."""

    air: str = "continental"
    name: str = "preetham"
    title: str = "Preetham 1999, ours"
    cannot: str = "a sun below 0°; observers aloft; ozone, aerosols, layers, the ground"
    grey: bool = False
    model: Preetham = field(default_factory=Preetham)

    def shots(self, views: Sequence[SkyViewpoint]) -> dict[SkyViewpoint, PeerShot]:
        """From the ground, the sun up."""
        model = replace(self.model, turbidity=turbidity_of_optical_depth(DEPTH))
        found = {}
        for view in views:
            if view in ON_GROUND and view.sun_deg >= 0.0:
                seen = rays(view)
                half, spent_s = cpu(partial(_preetham, model, view))
                whole_s = spent_s * HEIGHT * HEIGHT / seen.mu.size
                found[view] = PeerShot(whole(half), whole_s)
        return found

    def prepared_s(self) -> float:
        """Nothing."""
        return 0.0


def _preetham(model: Preetham, view: SkyViewpoint) -> FloatArray:
    """Linear RGB (rows, columns, 3) along `rays(view)`."""
    seen = rays(view)
    angles = np.arccos(seen.mu).ravel(), seen.azimuth_rad.ravel()
    radiance = model.sky_radiance(np.radians(90.0 - view.sun_deg), *angles)
    rgb = radiance @ integration_matrix(tuple(WAVELENGTHS_NM))
    return np.asarray(rgb.reshape(*seen.mu.shape, 3))
