"""The Bruneton sky of an hour, as `SkyModule` asks for it."""

from dataclasses import dataclass, field, replace
from typing import ClassVar

from bruneton_sky.air_volume import air_is_seen, air_volume
from bruneton_sky.air_volume.gpu import air_volume_job
from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.background import (
    Surroundings,
    albedo_rgb,
    ambient_coefficients,
    background_cube,
    ground_cube,
    surroundings,
)
from bruneton_sky.polarised_sky import HIGHEST_M, polarised_cube
from bruneton_sky.settings import BrunetonSkySettings, atmosphere_at, spectral_atmosphere_of
from bruneton_sky.sky_view.gpu import cube_scale, sky_view_job, view_shader
from bruneton_sky.sky_view.table import coarse_view
from bruneton_sky.sky_view.table_on_card import table_cube_job, table_on_card, table_view_shader
from bruneton_sky.solver import SourceField
from bruneton_sky.solver_rungs import SolverRung
from bruneton_sky.spectrum import SPECTRUM_NM, sky_spectra, sky_spectrum
from bruneton_sky.sun_light import haze_layers, limb_darkening_rgb
from bruneton_sky.tolerance import TABLES, BrunetonQuality
from bruneton_sky.unseen_moves import altitude_step_m, sun_step_rad
from vrut_lite.atmosphere.ground_reflectance import GroundReflectance
from vrut_lite.atmosphere.haze_layer import HAZE_NM
from vrut_lite.kernel.work_counters import WorkCounters
from vrut_lite.messages.air import AirVolume
from vrut_lite.messages.gpu_job import GpuJob, TexelFormat
from vrut_lite.messages.gpu_texture import GpuTexture
from vrut_lite.messages.haze import SetHaze
from vrut_lite.messages.sky import ViewShader
from vrut_lite.numeric_types import Float32Array, FloatArray, Vector
from vrut_lite.sky.sky_of_hour import (
    AIR_JOB,
    CUBE_JOB,
    Background,
    MotionThreshold,
    Sky,
    SkyInputs,
    SkySpectra,
    Spectrum,
    SunDisc,
)

NAME = "bruneton_sky"
# Factor on the scale of a cube aloft: its coarse table may lack the brightest node, and mirrored
# skies are in half precision.
ROOM_ALOFT = 8.0


@dataclass(frozen=True)
class ScatteringInputs:
    """All inputs of scattered light, for any sun and observer."""

    settings: BrunetonSkySettings
    ground_altitude_m: float
    rung: SolverRung
    haze: SetHaze
    ground: GroundReflectance

    def air_at(self, wavelength_nm: tuple[float, ...]) -> Atmosphere:
        """The atmosphere at given wavelengths, in nm."""
        where = self.settings, self.ground_altitude_m, self.haze, self.ground
        return atmosphere_at(wavelength_nm, *where)

    def spectral_air(self) -> Atmosphere:
        """The same atmosphere each 5 nm, for light that costs next to nothing."""
        where = self.settings, self.ground_altitude_m, self.haze, self.ground
        return spectral_atmosphere_of(*where)


class SurroundingsMemo:
    """The latest surroundings; the next ones reuse their unchanged parts."""

    def __init__(self, counters: WorkCounters):
        self._counters = counters
        self._made: tuple[BrunetonLight, Surroundings] | None = None

    def of(self, light: "BrunetonLight", view_on_card: bool = False) -> Surroundings:
        """The surroundings in a light; that on the scene is kept where only the eye moved.

        `view_on_card` as for `surroundings`, where they are made.
        """
        known = None
        if self._made is not None:
            before, around = self._made
            if before == light:
                return around
            if before.on_scene() == light.on_scene():
                self._counters.skip("light on the scene: only the observer moved")
                known = around
        if self._made is None or self._made[0].solved is not light.solved:
            for what, count in light.solved.skipped.items():
                if count:
                    self._counters.skip(f"{what} of the atmosphere: zero or too small")
        made = surroundings(
            light.solved,
            light.eye_height_m,
            light.sun_direction,
            light.visible_disc_fraction,
            light.of.spectral_air(),
            known,
            TABLES[light.table],
            view_on_card,
        )
        self._made = (light, made)
        self._counters.did("sky-view table")
        return made


@dataclass(frozen=True)
class BrunetonLight(Sky):
    """Sky, sun, ground and air around an eye, `of` a solved air; the sun is the apparent one."""

    # Timed on llvmpipe: 0.25 to 0.43 trial pixels a texel, 9e4 a volume. A table takes 2e4 to 9e4
    # more, 4 % of a cube of 1024².
    cube_trials: ClassVar[float] = 0.4
    air_trials: ClassVar[float] = 9e4

    of: ScatteringInputs
    solved: SourceField
    sun_direction: Vector
    visible_disc_fraction: float
    eye_height_m: float
    table: str
    memo: SurroundingsMemo = field(compare=False, repr=False)

    def on_scene(self) -> "BrunetonLight":
        """The scene's light, which does not depend on the observer."""
        return replace(self, eye_height_m=0.0)

    def ground_albedo_rgb(self) -> FloatArray:
        """That of the atmosphere's ground, in sunlight's colours."""
        return albedo_rgb(self.of.spectral_air())

    def unseen(self, hour: SkyInputs, quality: BrunetonQuality) -> MotionThreshold:
        """Steps measured for such an atmosphere (`unseen_moves`)."""
        atmosphere = self.solved.atmosphere
        step_m = altitude_step_m(self.eye_height_m, atmosphere)
        return MotionThreshold(
            sun_step_rad(hour.sun.apparent_elevation_rad, atmosphere.mie_g, quality.sun_change),
            quality.altitude_steps * step_m,
        )

    def background(self, size: int) -> Background:
        """The sky-view table as a cube map."""
        return background_with(self._around, background_cube(self._around, size))

    def background_on_ground(self, size: int) -> Background:
        """The table of an observer on the ground, as for the ambient light."""
        around = self._around
        return Background(ground_cube(around, size), around.ground_radiance_rgb)

    def gpu_background(self, size: int, format: TexelFormat) -> tuple[GpuJob, Background]:
        """The same cube map by the GPU, which makes the table too; in half precision the processor
        makes it, as journals say that have such cubes."""
        if format == "rgba16f":
            around = self.memo.of(self)
            where = around.view, size, around.ground_radiance_rgb
            job, scale = sky_view_job(*where, NAME, CUBE_JOB)
            texture = GpuTexture(size=size, format=job.format, recipe=job.recipe)
            return job, background_with(around, texture, scale)
        around = self.memo.of(self, view_on_card=True)
        table = table_on_card(self.solved, around.altitude_m, around.sun_direction, around.finer)
        ground, disc = around.ground_radiance_rgb, around.disc
        if disc is None:
            scale, view = cube_scale(around.standing, ground), None
        else:
            coarse = coarse_view(self.solved, around.altitude_m, around.sun_direction)
            scale, view = ROOM_ALOFT * cube_scale(coarse, ground), table_view_shader(table, disc)
        job = table_cube_job(table, size, ground, scale, NAME, CUBE_JOB)
        texture = GpuTexture(size=size, format=job.format, recipe=job.recipe)
        return job, background_of(around, texture, scale, view)

    def sun(self) -> SunDisc:
        """The sun as the scene's light."""
        radius_rad = self.solved.atmosphere.sun_angular_radius_rad
        sun, haze = self._around.sun_irradiance_rgb, haze_layers(self.of.air_at(HAZE_NM))
        return SunDisc(sun, radius_rad, limb_darkening_rgb(), haze=haze)

    def ambient(self) -> Float32Array:
        """Harmonics of the irradiance on the ground."""
        return ambient_coefficients(self._around)

    def polarisation(self, size: int) -> Float32Array | None:
        """Q and U of all orders along a grid of 168 rays of 0.15 ms; unknown from high above."""
        if self.eye_height_m > HIGHEST_M:
            return None
        return polarised_cube(self.solved, self.eye_height_m, self.sun_direction, size)

    def air(self, eye_height_m: float, reach_m: float) -> AirVolume | None:
        """All orders of scattering along every ray."""
        in_air_m = self._reach_in_air_m(reach_m)
        if not in_air_m:
            return None
        return air_volume(self.solved, eye_height_m, self.sun_direction, in_air_m)

    def gpu_air(self, eye_height_m: float, reach_m: float) -> tuple[GpuJob, AirVolume] | None:
        """Rows by the CPU, the light of all their columns by the GPU."""
        in_air_m = self._reach_in_air_m(reach_m)
        if not in_air_m:
            return None
        where = self.solved, eye_height_m, self.sun_direction, in_air_m
        return air_volume_job(*where, NAME, AIR_JOB)

    def spectrum(self, direction: Vector) -> Spectrum:
        """Spectrum of the same atmosphere solved at twelve wavelengths; empty for the ground."""
        if direction[1] <= 0.0:
            return Spectrum()
        seen = sky_spectrum(
            self.of.air_at(SPECTRUM_NM),
            self.of.settings.orders,
            self.eye_height_m,
            direction,
            self.sun_direction,
        )
        return Spectrum(SPECTRUM_NM, tuple(seen.radiance.tolist()))

    def spectra(self, size: int, wavelength_nm: tuple[float, ...]) -> SkySpectra:
        """Spectra of the same atmosphere solved at these wavelengths."""
        return sky_spectra(
            self.of.air_at(wavelength_nm),
            self.of.settings.orders,
            self.sun_direction,
            self.visible_disc_fraction,
            size,
        )

    @property
    def _around(self) -> Surroundings:
        return self.memo.of(self)

    def _reach_in_air_m(self, reach_m: float) -> float:
        """Length of a ray in the air; 0 where no air is visible."""
        atmosphere = self.solved.atmosphere
        # Above the air the first part of the ray is empty.
        in_air_m = reach_m - max(self.eye_height_m - atmosphere.top_altitude_m, 0.0)
        return in_air_m if air_is_seen(atmosphere, self.eye_height_m, in_air_m) else 0.0


def background_with(
    around: Surroundings, cube: Float32Array | GpuTexture, scale: float = 1.0
) -> Background:
    """The surroundings of an eye as a `Background` with this cube."""
    disc = around.disc
    return background_of(
        around, cube, scale, view_shader(around.view, disc) if disc is not None else None
    )


def background_of(
    around: Surroundings,
    cube: Float32Array | GpuTexture,
    scale: float,
    view: ViewShader | None,
) -> Background:
    """The same with this shader, None for an eye on the ground."""
    disc = around.disc
    return Background(
        cube,
        around.ground_radiance_rgb,
        scale,
        ground_through_air=disc is not None,
        view=view,
        seen_sun_rgb=disc.seen_rgb if disc is not None else None,
    )
