"""An atmosphere: molecules, aerosol, an absorber, fog, and the ground below."""

import math
from collections.abc import Iterable
from dataclasses import dataclass, fields, replace
from typing import Literal, NamedTuple, Self, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vrut_lite.arguments import as_flag, as_number, as_numbers, check_choice
from vrut_lite.daylight.aerosol import (
    ANGSTROM_EXPONENT,
    ASYMMETRY,
    SCALE_HEIGHT_M,
    SINGLE_SCATTERING_ALBEDO,
)
from vrut_lite.daylight.aerosols import AerosolOptics, PhaseTable
from vrut_lite.numeric_types import FloatArray

# Fields of an atmosphere with a number for each wavelength; those of layers may be left out.
SPECTRAL_FIELDS = (
    "solar_irradiance",
    "rayleigh_scattering",
    "mie_scattering",
    "mie_extinction",
    "absorption_extinction",
    "ground_albedo",
)
_LAYERS = ("aloft_scattering", "aloft_extinction", "fog_scattering", "fog_extinction")
_SPECTRAL = (*SPECTRAL_FIELDS, *_LAYERS)
_SERIES = (
    "wavelength_nm",
    "absorber_altitude_m",
    "absorber_density",
    "rayleigh_more",
    "rayleigh_more_scale_height_m",
)
_POSITIVE = (
    "ground_radius_m",
    "top_altitude_m",
    "rayleigh_scale_height_m",
    "mie_scale_height_m",
    "fog_scale_height_m",
    "aloft_scale_height_m",
    "sun_angular_radius_rad",
)
# Accepted lengths: squares of shorter and longer ones lose digits or overflow.
_LENGTHS, _LENGTHS_M = _POSITIVE[:6], (1e-3, 1e12)
_SCALAR = (*_POSITIVE, "mie_g", "mu_s_min")
_ANGSTROM_WAVELENGTH_NM = 550.0
# Optical depth of the meteorological visibility, at which 2 % of contrast are left: -log(0.02).
KOSCHMIEDER = 3.912
_TABLES = ("mie_table", "aloft_table", "fog_table")
_NO_NUMBERS = ("mie_phase", *_TABLES)
# Where a density of several exponentials is looked at.
_PLACES = 241
_NEGATIVE = "must leave a density above zero at all altitudes"
MiePhaseForm = Literal["cornette-shanks", "henyey-greenstein"]


class Scatterer(NamedTuple):
    """A scatterer: scale height, and coefficients (C,) at altitude zero in 1/m; its name.

    Molecules may be several, whose sum they are; one of them may be negative.
    """

    scale_height_m: float
    extinction: NDArray[np.float64]
    scattering: NDArray[np.float64]
    name: Literal["molecules", "aerosol", "aloft", "fog"]


@dataclass(frozen=True, kw_only=True)
class Atmosphere:
    """A spherical atmosphere: exponential molecules, aerosol and fog, a piecewise linear absorber.

    Spectral values are tuples, one number per wavelength; a single number is repeated for all.
    Coefficients are those at altitude zero (the absorber's: where its density is 1), in 1/m.

    Attributes:
        wavelength_nm: increasing or decreasing, in nm.
        solar_irradiance: above the atmosphere, W m^-2 nm^-1.
        absorber_altitude_m, absorber_density: nodes between which the absorber's relative
            density is linear; it is zero below the first and above the last.
        rayleigh_more, rayleigh_more_scale_height_m: exponentials of the molecules' density beside
            that of `rayleigh_scale_height_m`: their shares at altitude zero, of which the first one
            has the rest, and their scale heights. Shares may be negative, the density may not.
        mie_g: asymmetry of the aerosol's phase function.
        mu_s_min: cosine of the largest sun zenith angle for which tables are made.
        mie_phase: the form of the aerosol's phase function.
        mie_table: the aerosol's phase function as a table, a row for each wavelength, in place of
            that form; `mie_g` is then its mean cosine at 550 nm.
        aloft_scattering, aloft_extinction, aloft_scale_height_m: more aerosol, that of the free
            troposphere, which reaches higher; none where the extinction is zero.
        aloft_table: its phase function, a row for each wavelength; none is the aerosol's.
        fog_scattering, fog_extinction, fog_scale_height_m: fog, a shallow layer; none where the
            extinction is zero.
        fog_table: the phase function of its droplets, a row for each wavelength; none is the
            aerosol's.

    Raises:
        ValueError: a value is outside its physical range; the sentence names it.
    """

    wavelength_nm: tuple[float, ...]
    solar_irradiance: tuple[float, ...]
    ground_radius_m: float
    top_altitude_m: float
    rayleigh_scattering: tuple[float, ...]
    rayleigh_scale_height_m: float
    mie_scattering: tuple[float, ...]
    mie_extinction: tuple[float, ...]
    mie_scale_height_m: float
    mie_g: float
    absorption_extinction: tuple[float, ...]
    absorber_altitude_m: tuple[float, ...]
    absorber_density: tuple[float, ...]
    ground_albedo: tuple[float, ...]
    sun_angular_radius_rad: float
    mu_s_min: float
    rayleigh_more: tuple[float, ...] = (0.0,)
    rayleigh_more_scale_height_m: tuple[float, ...] = (8000.0,)
    mie_phase: MiePhaseForm = "cornette-shanks"
    mie_table: PhaseTable | None = None
    aloft_scattering: tuple[float, ...] = (0.0,)
    aloft_extinction: tuple[float, ...] = (0.0,)
    aloft_scale_height_m: float = 8000.0
    aloft_table: PhaseTable | None = None
    fog_scattering: tuple[float, ...] = (0.0,)
    fog_extinction: tuple[float, ...] = (0.0,)
    fog_scale_height_m: float = 100.0
    fog_table: PhaseTable | None = None

    def __post_init__(self) -> None:
        for name in self._numeric():
            object.__setattr__(self, name, _as_numbers(name, getattr(self, name)))
        for name in _LAYERS:
            # `replace` may change the number of wavelengths: no layer fits any.
            if not any(_as_tuple(getattr(self, name))):
                object.__setattr__(self, name, 0.0)
        if not any(_as_tuple(self.rayleigh_more)):
            object.__setattr__(self, "rayleigh_more", 0.0)
            object.__setattr__(self, "rayleigh_more_scale_height_m", 8000.0)
        count = len(_as_tuple(self.wavelength_nm))
        for name in _SERIES:
            object.__setattr__(self, name, _as_tuple(getattr(self, name)))
        for name in _SPECTRAL:
            object.__setattr__(self, name, _per_wavelength(name, getattr(self, name), count))
        self._check()

    @classmethod
    def earth(cls, ozone: bool = True) -> Self:
        """Bruneton's 2017 demonstration atmosphere at 680, 550 and 440 nm.

        Its aerosol is thin: optical depth 0.0053 at every wavelength.
        """
        ozone = as_flag("ozone", ozone)
        return cls(
            wavelength_nm=(680.0, 550.0, 440.0),
            solar_irradiance=(1.474, 1.8504, 1.91198),
            ground_radius_m=6_360_000.0,
            top_altitude_m=60_000.0,
            rayleigh_scattering=(5.80234e-6, 1.355776e-5, 3.310001e-5),
            rayleigh_scale_height_m=8000.0,
            mie_scattering=(3.996e-6,) * 3,
            mie_extinction=(4.44e-6,) * 3,
            mie_scale_height_m=SCALE_HEIGHT_M,
            mie_g=ASYMMETRY,
            absorption_extinction=(6.497e-7, 1.8809e-6, 8.502e-8) if ozone else (0.0,) * 3,
            absorber_altitude_m=(10_000.0, 25_000.0, 40_000.0),
            absorber_density=(0.0, 1.0, 0.0),
            ground_albedo=(0.1,) * 3,
            sun_angular_radius_rad=0.004675,
            mu_s_min=math.cos(math.radians(102.0)),
        )

    def with_aerosol(
        self,
        optical_depth_550: float,
        angstrom_exponent: float = ANGSTROM_EXPONENT,
        mie_g: float | None = None,
    ) -> Self:
        """This atmosphere with another aerosol optical depth, in its own layers and of their own
        albedos.

        The vertical optical depth falls as wavelength^-`angstrom_exponent` (Angstrom's law;
        1.3 is his mean); the ratio of scattering to extinction stays, 0.9 where there was no
        aerosol.

        Raises:
            ValueError: the optical depth is not from 0 to 1000, or the exponent not from -10 to 10.
        """
        optical_depth_550 = as_number("optical_depth_550", optical_depth_550, 0.0, 1000.0)
        angstrom_exponent = as_number("angstrom_exponent", angstrom_exponent, -10.0, 10.0)
        ratio = np.asarray(self.wavelength_nm) / _ANGSTROM_WAVELENGTH_NM
        wanted, old = optical_depth_550 * ratio**-angstrom_exponent, self.aerosol_depth()
        factor = np.divide(wanted, old, out=np.zeros_like(old), where=old > 0)
        # Where there was none, all of it lies low.
        added = np.where(old > 0, 0.0, wanted) / self.mie_scale_height_m
        usual = SINGLE_SCATTERING_ALBEDO * added
        return replace(
            self,
            mie_extinction=tuple(factor * self.mie_extinction + added),
            mie_scattering=tuple(factor * self.mie_scattering + usual),
            aloft_extinction=tuple(factor * self.aloft_extinction),
            aloft_scattering=tuple(factor * self.aloft_scattering),
            mie_g=self.mie_g if mie_g is None else mie_g,
            mie_table=self.mie_table if mie_g is None else None,
            aloft_table=self.aloft_table if mie_g is None else None,
        )

    def with_optics(self, optics: AerosolOptics, optical_depth_550: float | None = None) -> Self:
        """This atmosphere with a measured or tabulated aerosol, in place of its own.

        Its layers thin out exponentially, each with its own column, albedo and phase function.

        Args:
            optics: of the aerosol.
            optical_depth_550: another vertical depth at 550 nm than the aerosol's own.

        Raises:
            ValueError: the optical depth is not from 0 to 1000.
        """
        own, nm = optics.optical_depth_550, self.wavelength_nm
        depth = own if optical_depth_550 is None else optical_depth_550
        share = as_number("optical_depth_550", depth, 0.0, 1000.0) / own
        lower, upper = (layer.depth_at(nm) * share / layer.height_m for layer in optics.layers)
        low, aloft = optics.layers
        return replace(
            self,
            mie_extinction=tuple(lower),
            mie_scattering=tuple(lower * low.albedo_at(nm)),
            mie_scale_height_m=low.height_m,
            mie_g=float(optics.phase_at([_ANGSTROM_WAVELENGTH_NM]).mean_cosine()[0]),
            mie_table=low.phase_at(nm),
            aloft_extinction=tuple(upper),
            aloft_scattering=tuple(upper * aloft.albedo_at(nm)),
            aloft_scale_height_m=aloft.height_m,
            aloft_table=aloft.phase_at(nm) if upper.any() else None,
        )

    def in_one_layer(self, scale_height_m: float) -> Self:
        """This atmosphere with all its aerosol in one layer of a scale height.

        What lies above a square metre up to the air's top stays; albedo and phase function are the
        mean of both layers'.
        """
        heights_m = self.mie_scale_height_m, self.aloft_scale_height_m
        one_m = _column_m(scale_height_m, self.top_altitude_m)
        columns = [_column_m(height_m, self.top_altitude_m) / one_m for height_m in heights_m]
        extinction = np.array([self.mie_extinction, self.aloft_extinction])
        scattering = np.array([self.mie_scattering, self.aloft_scattering])
        weight = np.array(columns)[:, None] * scattering
        table = self.mie_table
        if table is not None and self.aloft_table is not None and weight.any():
            both = np.stack([table.values, self.aloft_table.values])
            table = PhaseTable((weight[..., None] * both).sum(axis=0))
        return replace(
            self,
            mie_extinction=tuple(np.array(columns) @ extinction),
            mie_scattering=tuple(np.array(columns) @ scattering),
            mie_scale_height_m=scale_height_m,
            mie_table=table,
            aloft_extinction=(0.0,),
            aloft_scattering=(0.0,),
            aloft_table=None,
        )

    def with_fog(
        self, visibility_m: float, scale_height_m: float, phase: PhaseTable | None = None
    ) -> Self:
        """This air with grey fog of a visibility on the ground.

        Visibility is the meteorological optical range, at which a black object has 2 % contrast
        with the horizon: 3.912 over the extinction of all the air at 550 nm (Koschmieder 1924).
        Air that is already hazier gets no fog. Droplets are far larger than light's wavelengths:
        their extinction is grey, and they absorb nothing that is visible. `phase` is their phase
        function, a row for each wavelength; the aerosol's where there is none.

        Raises:
            ValueError: a length is not from 1e-3 to 1e12 m.
        """
        visibility_m = as_number("visibility_m", visibility_m, *_LENGTHS_M, "m")
        scale_height_m = as_number("scale_height_m", scale_height_m, *_LENGTHS_M, "m")
        order = np.argsort(self.wavelength_nm)
        clear = np.sum(
            [self.rayleigh_scattering, self.mie_extinction, self.aloft_extinction], axis=0
        )
        at_550 = np.interp(
            _ANGSTROM_WAVELENGTH_NM, np.take(self.wavelength_nm, order), np.take(clear, order)
        )
        fog = (max(KOSCHMIEDER / visibility_m - float(at_550), 0.0),) * order.size
        return replace(
            self,
            fog_scattering=fog,
            fog_extinction=fog,
            fog_scale_height_m=scale_height_m,
            fog_table=phase,
        )

    def scatterers(self) -> tuple[Scatterer, ...]:
        """Molecules, aerosol and, where there is any, aerosol aloft and fog, in that order."""
        molecules = np.asarray(self.rayleigh_scattering)
        haze = np.asarray(self.mie_extinction), np.asarray(self.mie_scattering)
        all_of_it = [
            *(
                Scatterer(height_m, share * molecules, share * molecules, "molecules")
                for share, height_m in self.rayleigh_terms
            ),
            Scatterer(self.mie_scale_height_m, *haze, "aerosol"),
        ]
        if self.has_aloft:
            aloft = np.asarray(self.aloft_extinction), np.asarray(self.aloft_scattering)
            all_of_it.append(Scatterer(self.aloft_scale_height_m, *aloft, "aloft"))
        if self.foggy:
            fog = np.asarray(self.fog_extinction), np.asarray(self.fog_scattering)
            all_of_it.append(Scatterer(self.fog_scale_height_m, *fog, "fog"))
        return tuple(all_of_it)

    def particles(self) -> tuple[Scatterer, ...]:
        """The scatterers that are no molecules."""
        return tuple(each for each in self.scatterers() if each.name != "molecules")

    def by_name(self, values: Iterable[FloatArray]) -> dict[str, FloatArray]:
        """Sums of `values`, one for each of `scatterers`, over those of one name."""
        sums: dict[str, FloatArray] = {}
        for scatterer, value in zip(self.scatterers(), values, strict=True):
            name = scatterer.name
            sums[name] = sums[name] + value if name in sums else value
        return sums

    @property
    def rayleigh_terms(self) -> tuple[tuple[float, float], ...]:
        """Shares and scale heights (m) of the exponentials that are the molecules' density."""
        pairs = zip(self.rayleigh_more, self.rayleigh_more_scale_height_m, strict=True)
        more = [(share, height_m) for share, height_m in pairs if share]
        return ((1.0 - sum(self.rayleigh_more), self.rayleigh_scale_height_m), *more)

    def molecules(self, altitude_m: ArrayLike) -> NDArray[np.float64]:
        """Relative density (...,) of the molecules at altitudes (...,)."""
        height = as_numbers("altitude_m", altitude_m)
        return sum(
            (share * np.exp(-height / scale_m) for share, scale_m in self.rayleigh_terms),
            np.zeros(height.shape),
        )

    def aerosol_depth(self) -> NDArray[np.float64]:
        """Vertical optical depth (C,) of both layers of aerosol."""
        lower = self.mie_scale_height_m * np.asarray(self.mie_extinction)
        return np.asarray(lower + self.aloft_scale_height_m * np.asarray(self.aloft_extinction))

    @property
    def has_aloft(self) -> bool:
        """Whether there is aerosol in a second layer."""
        return any(self.aloft_extinction)

    @property
    def foggy(self) -> bool:
        """Whether there is fog."""
        return any(self.fog_extinction)

    @property
    def has_droplets(self) -> bool:
        """Whether there is fog with a phase function of its own."""
        return self.foggy and self.fog_table is not None

    @property
    def mixed(self) -> bool:
        """Whether particles of several phase functions lie at different altitudes."""
        return self.has_droplets or (self.has_aloft and self.aloft_table is not None)

    def absorber(self, altitude_m: ArrayLike) -> NDArray[np.float64]:
        """Relative density (...,) of the absorber at altitudes (...,)."""
        height = as_numbers("altitude_m", altitude_m)
        return np.interp(
            height, self.absorber_altitude_m, self.absorber_density, left=0.0, right=0.0
        )

    @classmethod
    def _numeric(cls) -> list[str]:
        return [field.name for field in fields(cls) if field.name not in _NO_NUMBERS]

    def _check(self) -> None:
        check_choice("mie_phase of the atmosphere", self.mie_phase, get_args(MiePhaseForm))
        for name in _TABLES:
            table, rows = getattr(self, name), len(self.wavelength_nm)
            if table is not None:
                _require(isinstance(table, PhaseTable), name, "must be a PhaseTable")
                fits = len(table.values) == rows
                _require(fits, name, f"needs {rows} rows, one per wavelength")
        for name in _SCALAR:
            _require(isinstance(getattr(self, name), float), name, "must be a single number")
        for name in _POSITIVE:
            _require(getattr(self, name) > 0, name, f"must be positive, not {getattr(self, name)}")
        for name in _LENGTHS:
            as_number(f"{name} of the atmosphere", getattr(self, name), *_LENGTHS_M, "m")
        for name in ("wavelength_nm", *_SPECTRAL, "absorber_density"):
            least = min(getattr(self, name))
            _require(least >= 0, name, f"must not be negative, but holds {least}")
        steps = np.diff(self.wavelength_nm)
        ordered = bool(np.all(steps > 0) or np.all(steps < 0))
        _require(ordered, "wavelength_nm", "must increase or decrease throughout")
        _require(min(self.wavelength_nm) > 0, "wavelength_nm", "must be positive")
        most = max(self.ground_albedo)
        _require(most <= 1, "ground_albedo", f"must lie between 0 and 1, but holds {most}")
        more = self.rayleigh_more_scale_height_m
        _require(len(more) == len(self.rayleigh_more), "rayleigh_more", "needs as many heights")
        _require(min(more) > 0, "rayleigh_more_scale_height_m", "must be positive")
        places = np.linspace(0.0, self.top_altitude_m, _PLACES)
        _require(bool((self.molecules(places) >= 0.0).all()), "rayleigh_more", _NEGATIVE)
        _require(-1 < self.mie_g < 1, "mie_g", f"must lie between -1 and 1, not {self.mie_g}")
        within = -1 <= self.mu_s_min < 1
        _require(within, "mu_s_min", f"must be a cosine below 1, not {self.mu_s_min}")
        for name in ("mie", "aloft", "fog"):
            scattering = getattr(self, f"{name}_scattering")
            pairs = zip(scattering, getattr(self, f"{name}_extinction"), strict=True)
            # Rounding of scattering = albedo * extinction may pass the extinction by one unit.
            bounded = all(s <= e * (1 + 1e-12) for s, e in pairs)
            _require(bounded, f"{name}_scattering", f"must not exceed {name}_extinction")
        heights = self.absorber_altitude_m
        rising = len(heights) >= 2 and all(np.diff(heights) > 0) and heights[0] >= 0
        _require(rising, "absorber_altitude_m", "must hold two or more rising altitudes")
        same = len(heights) == len(self.absorber_density)
        _require(same, "absorber_density", "must have one value per absorber_altitude_m")


def raise_ground(atmosphere: Atmosphere, altitude_m: float) -> Atmosphere:
    """The same air above a ground at `altitude_m`; altitudes are then measured from there.

    A plateau cuts off the air below it, a basin below sea level is filled with more. The
    exponential profiles keep their form: their coefficients are those at the new ground.

    Raises:
        ValueError: the ground would lie above the air, or below the planet's centre.
    """
    altitude_m = as_number("altitude_m of the ground", altitude_m)
    if not -atmosphere.ground_radius_m < altitude_m < atmosphere.top_altitude_m:
        raise ValueError(
            f"a ground at {altitude_m:g} m lies outside the planet's air, "
            f"whose top is at {atmosphere.top_altitude_m:g} m"
        )
    molecules = float(atmosphere.molecules(altitude_m))
    more = zip(atmosphere.rayleigh_more, atmosphere.rayleigh_more_scale_height_m, strict=True)
    aerosol = np.exp(-altitude_m / atmosphere.mie_scale_height_m)
    aloft = np.exp(-altitude_m / atmosphere.aloft_scale_height_m)
    layers, density = _cut_layers(atmosphere, altitude_m)
    return replace(
        atmosphere,
        ground_radius_m=atmosphere.ground_radius_m + altitude_m,
        top_altitude_m=atmosphere.top_altitude_m - altitude_m,
        rayleigh_scattering=tuple(np.asarray(atmosphere.rayleigh_scattering) * molecules),
        rayleigh_more=tuple(share * math.exp(-altitude_m / h) / molecules for share, h in more),
        mie_scattering=tuple(np.asarray(atmosphere.mie_scattering) * aerosol),
        mie_extinction=tuple(np.asarray(atmosphere.mie_extinction) * aerosol),
        aloft_scattering=tuple(np.asarray(atmosphere.aloft_scattering) * aloft),
        aloft_extinction=tuple(np.asarray(atmosphere.aloft_extinction) * aloft),
        absorber_altitude_m=layers,
        absorber_density=density,
    )


def _cut_layers(
    atmosphere: Atmosphere, altitude_m: float
) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Altitudes and densities of the absorber's nodes above the new ground."""
    above = np.asarray(atmosphere.absorber_altitude_m) - altitude_m
    density = np.asarray(atmosphere.absorber_density)
    if above[0] >= 0:
        return tuple(above), tuple(density)
    kept = above > 0
    at_ground = float(np.interp(0.0, above, density, right=0.0))
    if kept.any():
        return (0.0, *above[kept]), (at_ground, *density[kept])
    # All of the absorber lies below the ground.
    return (0.0, atmosphere.top_altitude_m - altitude_m), (0.0, 0.0)


def _column_m(scale_height_m: float, top_m: float) -> float:
    """Matter above a square metre, up to the top, over the density on the ground."""
    return -scale_height_m * math.expm1(-top_m / scale_height_m)


def _as_tuple(value: float | tuple[float, ...]) -> tuple[float, ...]:
    return value if isinstance(value, tuple) else (value,)


def _as_numbers(name: str, value: ArrayLike) -> float | tuple[float, ...]:
    """A float, or a tuple of floats: hashable, so that an atmosphere can key a cache."""
    array = as_numbers(f"{name} of the atmosphere", value)
    _require(array.size > 0, name, "must not be empty")
    return float(array) if array.ndim == 0 else tuple(float(v) for v in array.ravel())


def _per_wavelength(name: str, value: float | tuple[float, ...], count: int) -> tuple[float, ...]:
    values = value if isinstance(value, tuple) else (value,) * count
    _require(len(values) == count, name, f"needs {count} values, one per wavelength")
    return values


def _require(holds: bool, name: str, demand: str) -> None:
    if not holds:
        raise ValueError(f"{name} of the atmosphere {demand}")
