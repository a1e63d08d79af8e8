"""An atmosphere: molecules, aerosol, an absorber, fog, and the ground below."""

import math
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Literal, NamedTuple, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bruneton_sky.atmosphere_numbers import (
    LAYERS,
    LENGTHS_M,
    NO_NUMBERS,
    SERIES,
    SPECTRAL,
    MiePhaseForm,
    as_series,
    as_tuple,
    check_numbers,
    per_wavelength,
)
from vrut_lite.arguments import as_flag, as_number, as_numbers
from vrut_lite.atmosphere.aerosol import (
    ANGSTROM_EXPONENT,
    ASYMMETRY,
    SCALE_HEIGHT_M,
    SINGLE_SCATTERING_ALBEDO,
)
from vrut_lite.atmosphere.aerosols import AerosolOptics, PhaseTable
from vrut_lite.atmosphere.aerosols.optics import ALOFT_HEIGHT_M, AerosolLayer
from vrut_lite.atmosphere.aerosols.stratosphere import HALF_WIDTH_M, PEAK_M
from vrut_lite.atmosphere.exponential_layers import ExponentialLayers
from vrut_lite.atmosphere.slant_path import tent
from vrut_lite.numeric_types import FloatArray

_ANGSTROM_WAVELENGTH_NM = 550.0
# Optical depth of the meteorological visibility, at which 2 % of contrast are left: -log(0.02).
KOSCHMIEDER = 3.912


class Scatterer(NamedTuple):
    """A scatterer: scale height, and coefficients (C,) at altitude zero in 1/m; its name.

    With a peak at the altitude `peak_m` its density is a tent of half width `scale_height_m`, and
    coefficients are those at the peak. With `layers` these are its density, and `scale_height_m`
    is the lowest layer's.
    """

    scale_height_m: float
    extinction: NDArray[np.float64]
    scattering: NDArray[np.float64]
    name: Literal["molecules", "aerosol", "aloft", "fog", "stratosphere"]
    peak_m: float | None = None
    layers: ExponentialLayers | None = None

    @property
    def exponentials(self) -> ExponentialLayers:
        """The density of a scatterer without a peak."""
        return self.layers or ExponentialLayers.of(self.scale_height_m)

    @property
    def kinks_m(self) -> tuple[float, ...]:
        """Altitudes between which a tent is linear; none of an exponential."""
        if self.peak_m is None:
            return ()
        return tuple(self.peak_m + side * self.scale_height_m for side in (-1.0, 0.0, 1.0))

    def density(self, altitude_m: FloatArray) -> FloatArray:
        """Relative density (...,) at altitudes (...,)."""
        if self.peak_m is not None:
            return tent(self.scale_height_m, self.peak_m, altitude_m)
        return self.exponentials.density(altitude_m)

    def column_above(self, altitude_m: FloatArray) -> FloatArray:
        """Integral (...,) of the density over the altitude from altitudes (...,) up, in m."""
        if self.peak_m is None:
            return self.scale_height_m * self.density(altitude_m)
        x = np.clip((altitude_m - self.peak_m) / self.scale_height_m, -1.0, 1.0)
        return np.asarray(self.scale_height_m * (0.5 - x + 0.5 * x * np.abs(x)))


@dataclass(frozen=True, kw_only=True)
class Atmosphere:
    """A spherical atmosphere: exponential molecules, aerosol and fog, a piecewise linear absorber,
    and aerosol of the stratosphere in a tent.

    Spectral values are tuples, one number per wavelength; a single number is repeated for all.
    Coefficients are those at altitude zero (of absorber and stratosphere: where the density is 1),
    in 1/m.

    Attributes:
        wavelength_nm: increasing or decreasing, in nm.
        solar_irradiance: above the atmosphere, W m^-2 nm^-1.
        absorber_altitude_m, absorber_density: nodes between which the absorber's relative
            density is linear; it is zero below the first and above the last.
        rayleigh_scale_height_m: of the molecules' density, from the ground up.
        rayleigh_above_m, rayleigh_above_scale_height_m: altitudes above which their scale height is
            another, and those; none where there is one altitude of 0.
        rayleigh_depolarisation: ratio rho of the molecules for natural light, from 0 to 1: 0.0285
            in real air. It depolarises their light and makes their phase function more even;
            scattering coefficients contain King's factor already. The published pipeline
            leaves it out.
        gas_absorption: by gases that are mixed as the molecules, such as nitrogen dioxide.
        pair_absorption: by pairs of oxygen molecules, as the square of the molecules' density;
            scattered light takes them as mixed like the molecules, with the same column.
        water_vapour_cm: precipitable water over altitude 0, of scale height 2 km, whose lines dim
            the direct sun.
        refractivity: n - 1 of the molecules at altitude 0, by which the direct sun's rays bend.
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
        stratosphere_scattering, stratosphere_extinction: aerosol whose density falls linearly from
            1 at `stratosphere_peak_m` to 0 over `stratosphere_half_width_m`, down and up; none
            where the extinction is zero.
        stratosphere_table: its phase function, a row for each wavelength; none is the aerosol's.

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
    rayleigh_above_m: tuple[float, ...] = (0.0,)
    rayleigh_above_scale_height_m: tuple[float, ...] = (8000.0,)
    rayleigh_depolarisation: float = 0.0
    gas_absorption: tuple[float, ...] = (0.0,)
    pair_absorption: tuple[float, ...] = (0.0,)
    water_vapour_cm: float = 0.0
    refractivity: float = 0.0
    mie_phase: MiePhaseForm = "cornette-shanks"
    mie_table: PhaseTable | None = None
    aloft_scattering: tuple[float, ...] = (0.0,)
    aloft_extinction: tuple[float, ...] = (0.0,)
    aloft_scale_height_m: float = ALOFT_HEIGHT_M
    aloft_table: PhaseTable | None = None
    fog_scattering: tuple[float, ...] = (0.0,)
    fog_extinction: tuple[float, ...] = (0.0,)
    fog_scale_height_m: float = 100.0
    fog_table: PhaseTable | None = None
    stratosphere_scattering: tuple[float, ...] = (0.0,)
    stratosphere_extinction: tuple[float, ...] = (0.0,)
    stratosphere_peak_m: float = PEAK_M
    stratosphere_half_width_m: float = HALF_WIDTH_M
    stratosphere_table: PhaseTable | None = None

    def __post_init__(self) -> None:
        for name in self._numeric():
            object.__setattr__(self, name, as_series(name, getattr(self, name)))
        for name in LAYERS:
            # `replace` may change the number of wavelengths: no layer fits any.
            if not any(as_tuple(getattr(self, name))):
                object.__setattr__(self, name, 0.0)
        if not any(as_tuple(self.rayleigh_above_m)):
            object.__setattr__(self, "rayleigh_above_m", 0.0)
            object.__setattr__(self, "rayleigh_above_scale_height_m", 8000.0)
        count = len(as_tuple(self.wavelength_nm))
        for name in SERIES:
            object.__setattr__(self, name, as_tuple(getattr(self, name)))
        for name in SPECTRAL:
            object.__setattr__(self, name, per_wavelength(name, getattr(self, name), count))
        check_numbers(vars(self))

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
        """This atmosphere with another aerosol optical depth; layers and albedos stay.

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
            stratosphere_extinction=tuple(factor * self.stratosphere_extinction),
            stratosphere_scattering=tuple(factor * self.stratosphere_scattering),
            mie_g=self.mie_g if mie_g is None else mie_g,
            mie_table=self.mie_table if mie_g is None else None,
            aloft_table=self.aloft_table if mie_g is None else None,
        )

    def with_optics(self, optics: AerosolOptics, optical_depth_550: float | None = None) -> Self:
        """This atmosphere with a measured or tabulated aerosol in its troposphere instead.

        Its layers thin out exponentially, each with its own column, albedo and phase function.

        Args:
            optics: optical properties of the aerosol.
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

    def with_stratosphere(self, layer: AerosolLayer) -> Self:
        """This atmosphere with a tent of aerosol in its stratosphere instead.

        Raises:
            ValueError: the layer is exponential.
        """
        if layer.peak_m is None:
            raise ValueError("aerosol of the stratosphere needs the altitude of its peak")
        nm = self.wavelength_nm
        extinction = layer.depth_at(nm) / layer.height_m
        return replace(
            self,
            stratosphere_extinction=tuple(extinction),
            stratosphere_scattering=tuple(extinction * layer.albedo_at(nm)),
            stratosphere_peak_m=layer.peak_m,
            stratosphere_half_width_m=layer.height_m,
            stratosphere_table=layer.phase_at(nm) if extinction.any() else None,
        )

    def in_one_layer(self, scale_height_m: float) -> Self:
        """This atmosphere with all aerosol of its troposphere in one layer of a scale height.

        The column up to the air's top stays; albedo and phase function are the mean of both
        layers'.
        """
        heights_m = self.mie_scale_height_m, self.aloft_scale_height_m
        one_m, *layers_m = (
            ExponentialLayers.of(height_m).column_m(self.top_altitude_m)
            for height_m in (scale_height_m, *heights_m)
        )
        columns = [layer_m / one_m for layer_m in layers_m]
        extinction = np.array([self.mie_extinction, self.aloft_extinction])
        scattering = np.array([self.mie_scattering, self.aloft_scattering])
        weight = np.array(columns)[:, None] * scattering
        table = self.mie_table
        if table is not None and self.aloft_table is not None and weight.any():
            table = PhaseTable.mixed([table, self.aloft_table], weight)
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
        function, a row for each wavelength; without it the aerosol's is used.

        Raises:
            ValueError: a length is not from 1e-3 to 1e12 m.
        """
        visibility_m = as_number("visibility_m", visibility_m, *LENGTHS_M, "m")
        scale_height_m = as_number("scale_height_m", scale_height_m, *LENGTHS_M, "m")
        order = np.argsort(self.wavelength_nm)
        particles = np.asarray(self.mie_extinction) + np.asarray(self.aloft_extinction)
        clear = self.molecule_extinction + particles
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
        """Molecules, aerosol and, where there are any, aerosol aloft, fog and aerosol of the
        stratosphere, in that order."""
        molecules, extinction = np.asarray(self.rayleigh_scattering), self.molecule_extinction
        haze = np.asarray(self.mie_extinction), np.asarray(self.mie_scattering)
        all_of_it = [
            Scatterer(
                self.rayleigh_scale_height_m,
                extinction,
                molecules,
                "molecules",
                layers=self.molecule_layers,
            ),
            Scatterer(self.mie_scale_height_m, *haze, "aerosol"),
        ]
        if self.has_aloft:
            aloft = np.asarray(self.aloft_extinction), np.asarray(self.aloft_scattering)
            all_of_it.append(Scatterer(self.aloft_scale_height_m, *aloft, "aloft"))
        if self.foggy:
            fog = np.asarray(self.fog_extinction), np.asarray(self.fog_scattering)
            all_of_it.append(Scatterer(self.fog_scale_height_m, *fog, "fog"))
        if self.has_stratosphere:
            extinction = np.asarray(self.stratosphere_extinction)
            scattering = np.asarray(self.stratosphere_scattering)
            shape = self.stratosphere_half_width_m, self.stratosphere_peak_m
            high = Scatterer(shape[0], extinction, scattering, "stratosphere", shape[1])
            all_of_it.append(high)
        return tuple(all_of_it)

    def particles(self) -> tuple[Scatterer, ...]:
        """The scatterers that are no molecules."""
        return tuple(each for each in self.scatterers() if each.name != "molecules")

    @cached_property
    def molecule_layers(self) -> ExponentialLayers:
        """The molecules' density."""
        above = zip(self.rayleigh_above_m, self.rayleigh_above_scale_height_m, strict=True)
        return ExponentialLayers.of(
            self.rayleigh_scale_height_m, [layer for layer in above if layer[0] > 0.0]
        )

    @property
    def molecule_extinction(self) -> FloatArray:
        """Extinction (C,) at altitude 0 by molecules and gases mixed like them, 1/m."""
        mixed = np.asarray(self.rayleigh_scattering) + np.asarray(self.gas_absorption)
        if any(self.pair_absorption):
            mixed += self.pair_column_m / self.column_m * np.asarray(self.pair_absorption)
        return mixed

    @property
    def column_m(self) -> float:
        """Integral of the molecules' relative density over the altitude."""
        return self.molecule_layers.column_m()

    @property
    def pair_column_m(self) -> float:
        """The same of its square."""
        return self.molecule_layers.column_m(power=2.0)

    @property
    def rayleigh_anisotropy(self) -> float:
        """Share (1 - rho) / (1 + rho / 2) of the molecules' light that is scattered as by dipoles;
        the rest is even and not polarised (Hansen and Travis 1974, equation 2.15)."""
        return (1.0 - self.rayleigh_depolarisation) / (1.0 + 0.5 * self.rayleigh_depolarisation)

    def molecules(self, altitude_m: ArrayLike) -> NDArray[np.float64]:
        """Relative density (...,) of the molecules at altitudes (...,)."""
        return self.molecule_layers.density(as_numbers("altitude_m", altitude_m))

    def aerosol_depth(self) -> NDArray[np.float64]:
        """Vertical optical depth (C,) of all layers of aerosol."""
        depth = self.mie_scale_height_m * np.asarray(self.mie_extinction)
        depth = depth + self.aloft_scale_height_m * np.asarray(self.aloft_extinction)
        high = self.stratosphere_half_width_m * np.asarray(self.stratosphere_extinction)
        return np.asarray(depth + high)

    @property
    def has_aloft(self) -> bool:
        """Whether there is aerosol in a second layer."""
        return any(self.aloft_extinction)

    @property
    def has_stratosphere(self) -> bool:
        """Whether there is aerosol in the stratosphere."""
        return any(self.stratosphere_extinction)

    @property
    def foggy(self) -> bool:
        """Whether there is fog."""
        return any(self.fog_extinction)

    @property
    def has_published_molecules(self) -> bool:
        """Whether molecules scatter as Rayleigh's dipoles, and no gas absorbs but the absorber."""
        absorbs = any(self.gas_absorption) or any(self.pair_absorption)
        return self.rayleigh_depolarisation == 0.0 and not absorbs

    @property
    def has_droplets(self) -> bool:
        """Whether there is fog with a separate phase function."""
        return self.foggy and self.fog_table is not None

    @property
    def mixed(self) -> bool:
        """Whether particles of several phase functions lie at different altitudes."""
        aloft = self.has_aloft and self.aloft_table is not None
        high = self.has_stratosphere and self.stratosphere_table is not None
        return self.has_droplets or aloft or high

    @property
    def kinks_m(self) -> tuple[float, ...]:
        """Altitudes inside the air, rising, where a density has a kink."""
        kinks = {*self.absorber_altitude_m, *(m for k in self.particles() for m in k.kinks_m)}
        return tuple(sorted(m for m in kinks if 0.0 < m < self.top_altitude_m))

    def table_of(self, name: str) -> PhaseTable | None:
        """The phase table of "aerosol", "aloft", "fog" or "stratosphere", its own or the
        aerosol's; none of a closed form."""
        own = {
            "aloft": self.aloft_table,
            "fog": self.fog_table,
            "stratosphere": self.stratosphere_table,
        }
        return own.get(name) or self.mie_table

    def absorber(self, altitude_m: ArrayLike) -> NDArray[np.float64]:
        """Relative density (...,) of the absorber at altitudes (...,)."""
        height = as_numbers("altitude_m", altitude_m)
        return np.interp(
            height, self.absorber_altitude_m, self.absorber_density, left=0.0, right=0.0
        )

    @classmethod
    def _numeric(cls) -> list[str]:
        return [field.name for field in fields(cls) if field.name not in NO_NUMBERS]
