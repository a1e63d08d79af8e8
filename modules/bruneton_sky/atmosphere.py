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

# Fields of an atmosphere with a number for each wavelength; those of fog may be left out.
SPECTRAL_FIELDS = (
    "solar_irradiance",
    "rayleigh_scattering",
    "mie_scattering",
    "mie_extinction",
    "absorption_extinction",
    "ground_albedo",
)
_FOG = ("fog_scattering", "fog_extinction")
_SPECTRAL = (*SPECTRAL_FIELDS, *_FOG)
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
    "mie_aloft_scale_height_m",
    "sun_angular_radius_rad",
)
# Accepted lengths: squares of shorter and longer ones lose digits or overflow.
_LENGTHS, _LENGTHS_M = _POSITIVE[:6], (1e-3, 1e12)
_SCALAR = (*_POSITIVE, "mie_g", "mie_aloft", "mu_s_min")
_ANGSTROM_WAVELENGTH_NM = 550.0
# Optical depth of the meteorological visibility, at which 2 % of contrast are left: -log(0.02).
KOSCHMIEDER = 3.912
# Where a density of several exponentials is looked at.
_PLACES = 241
_NEGATIVE = "must leave a density above zero at all altitudes"
_NO_NUMBERS = ("mie_phase", "mie_table", "fog_table")
MiePhaseForm = Literal["cornette-shanks", "henyey-greenstein"]


class Scatterer(NamedTuple):
    """A scatterer: scale height, and coefficients (C,) at altitude zero in 1/m.

    Where several have one `kind`, it is their sum; one of molecules may be negative.
    """

    scale_height_m: float
    extinction: NDArray[np.float64]
    scattering: NDArray[np.float64]
    kind: Literal["molecules", "aerosol", "fog"]


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
        mie_aloft, mie_aloft_scale_height_m: share of the aerosol at altitude zero that thins out
            over a scale height of its own, that of the free troposphere.
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
    mie_aloft: float = 0.0
    mie_aloft_scale_height_m: float = 8000.0
    fog_scattering: tuple[float, ...] = (0.0,)
    fog_extinction: tuple[float, ...] = (0.0,)
    fog_scale_height_m: float = 100.0
    fog_table: PhaseTable | None = None

    def __post_init__(self) -> None:
        for name in self._numeric():
            object.__setattr__(self, name, _as_numbers(name, getattr(self, name)))
        for name in _FOG:
            # `replace` may change the number of wavelengths: no fog fits any.
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
        """This atmosphere with another aerosol optical depth, in its own layers and of its own
        albedo.

        The vertical optical depth falls as wavelength^-`angstrom_exponent` (Angstrom's law;
        1.3 is his mean); the ratio of scattering to extinction stays, 0.9 where there was no
        aerosol.

        Raises:
            ValueError: the optical depth is not from 0 to 1000, or the exponent not from -10 to 10.
        """
        optical_depth_550 = as_number("optical_depth_550", optical_depth_550, 0.0, 1000.0)
        angstrom_exponent = as_number("angstrom_exponent", angstrom_exponent, -10.0, 10.0)
        ratio = np.asarray(self.wavelength_nm) / _ANGSTROM_WAVELENGTH_NM
        old = np.asarray(self.mie_extinction)
        usual = np.full_like(old, SINGLE_SCATTERING_ALBEDO)
        albedo = np.divide(self.mie_scattering, old, out=usual, where=old > 0)
        extinction = optical_depth_550 * ratio**-angstrom_exponent / self.mie_column_m
        return replace(
            self,
            mie_extinction=tuple(extinction),
            mie_scattering=tuple(extinction * albedo),
            mie_g=self.mie_g if mie_g is None else mie_g,
            mie_table=self.mie_table if mie_g is None else None,
        )

    def with_optics(self, optics: AerosolOptics, optical_depth_550: float | None = None) -> Self:
        """This atmosphere with a measured or tabulated aerosol, in place of its own.

        Its layers thin out exponentially, with the column and the extinction at the ground of the
        aerosol's own; albedo and phase function are those of all of it.

        Args:
            optics: of the aerosol.
            optical_depth_550: another vertical depth at 550 nm than the aerosol's own.

        Raises:
            ValueError: the optical depth is not from 0 to 1000.
        """
        own = optics.optical_depth_550
        depth = own if optical_depth_550 is None else optical_depth_550
        depth = as_number("optical_depth_550", depth, 0.0, 1000.0)
        low, aloft = optics.lower_depth_550, own - optics.lower_depth_550
        at_ground = low / optics.lower_height_m + aloft / optics.upper_height_m
        extinction = optics.depth_at(self.wavelength_nm) * depth / own * (at_ground / own)
        return replace(
            self,
            mie_extinction=tuple(extinction),
            mie_scattering=tuple(extinction * optics.albedo_at(self.wavelength_nm)),
            mie_scale_height_m=optics.lower_height_m,
            mie_aloft=max(aloft, 0.0) / optics.upper_height_m / at_ground,
            mie_aloft_scale_height_m=optics.upper_height_m,
            mie_g=float(optics.phase_at([_ANGSTROM_WAVELENGTH_NM]).mean_cosine()[0]),
            mie_table=optics.phase_at(self.wavelength_nm),
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
        clear = np.add(self.rayleigh_scattering, self.mie_extinction)
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
        low, aloft = (
            [share * part for part in haze] for share in (1.0 - self.mie_aloft, self.mie_aloft)
        )
        all_of_it = [
            *(
                Scatterer(height_m, share * molecules, share * molecules, "molecules")
                for share, height_m in self.rayleigh_terms
            ),
            Scatterer(self.mie_scale_height_m, *low, "aerosol"),
        ]
        if self.mie_aloft > 0.0:
            all_of_it.append(Scatterer(self.mie_aloft_scale_height_m, *aloft, "aerosol"))
        if self.foggy:
            fog = np.asarray(self.fog_extinction), np.asarray(self.fog_scattering)
            all_of_it.append(Scatterer(self.fog_scale_height_m, *fog, "fog"))
        return tuple(all_of_it)

    def by_kind(self, values: Iterable[FloatArray]) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Sums of `values`, one for each of `scatterers`: of molecules, aerosol and fog."""
        sums: dict[str, FloatArray] = {}
        for scatterer, value in zip(self.scatterers(), values, strict=True):
            kind = scatterer.kind
            sums[kind] = sums[kind] + value if kind in sums else value
        molecules = sums["molecules"]
        return molecules, sums["aerosol"], sums.get("fog", np.zeros_like(molecules))

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

    @property
    def mie_column_m(self) -> float:
        """The aerosol above a square metre over its density at altitude zero."""
        aloft = self.mie_aloft * self.mie_aloft_scale_height_m
        return (1.0 - self.mie_aloft) * self.mie_scale_height_m + aloft

    @property
    def foggy(self) -> bool:
        """Whether there is fog."""
        return any(self.fog_extinction)

    @property
    def has_droplets(self) -> bool:
        """Whether there is fog with a phase function of its own."""
        return self.foggy and self.fog_table is not None

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
        for name in ("mie_table", "fog_table"):
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
        share = self.mie_aloft
        _require(0 <= share <= 1, "mie_aloft", f"must lie between 0 and 1, not {share}")
        _require(-1 < self.mie_g < 1, "mie_g", f"must lie between -1 and 1, not {self.mie_g}")
        within = -1 <= self.mu_s_min < 1
        _require(within, "mu_s_min", f"must be a cosine below 1, not {self.mu_s_min}")
        for name in ("mie", "fog"):
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
    low = (1.0 - atmosphere.mie_aloft) * np.exp(-altitude_m / atmosphere.mie_scale_height_m)
    aloft = atmosphere.mie_aloft * np.exp(-altitude_m / atmosphere.mie_aloft_scale_height_m)
    aerosol = low + aloft
    layers, density = _cut_layers(atmosphere, altitude_m)
    return replace(
        atmosphere,
        ground_radius_m=atmosphere.ground_radius_m + altitude_m,
        top_altitude_m=atmosphere.top_altitude_m - altitude_m,
        rayleigh_scattering=tuple(np.asarray(atmosphere.rayleigh_scattering) * molecules),
        rayleigh_more=tuple(share * math.exp(-altitude_m / h) / molecules for share, h in more),
        mie_scattering=tuple(np.asarray(atmosphere.mie_scattering) * aerosol),
        mie_extinction=tuple(np.asarray(atmosphere.mie_extinction) * aerosol),
        mie_aloft=float(aloft / aerosol),
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
