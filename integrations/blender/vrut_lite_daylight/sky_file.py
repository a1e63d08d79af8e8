"""A sky as vrut_lite exports it: the command's words, and what the file beside it tells."""

import json
import math
from dataclasses import dataclass, field
from pathlib import Path

# Blender's +Y is north and +X east if the map's middle looks east.
MIDDLE_AZIMUTH_DEG = 90.0


@dataclass(frozen=True)
class Hour:
    """A place, an instant in its local time, and the air.

    Attributes:
        date: as 2026-06-21.
        hour: 0 to 24, local time.
        sky: a module's name.
        haze: optical depth at 550 nm.
        albedo: of the ground.
        rows: height of the map in pixels.
        clouds: genera by the setting of the module clouds, as {"genus": "Cu"}.
        stars: also draw stars, planets and the moon's disc.
    """

    latitude_deg: float
    longitude_deg: float
    altitude_m: float
    date: str
    hour: float
    sky: str
    haze: float
    albedo: float
    rows: int
    clouds: dict[str, str] = field(default_factory=dict)
    stars: bool = False

    def words(self, path):
        """The command that writes this sky, and its facts beside it."""
        minutes = min(round(self.hour * 60.0), 24 * 60 - 1)
        clouds = [f"clouds.{setting}={genus}" for setting, genus in self.clouds.items()]
        return [
            *("sky", "-o", str(path), "--sidecar", "--rotate", f"{MIDDLE_AZIMUTH_DEG:g}"),
            *("--place", f"{self.latitude_deg:.6f},{self.longitude_deg:.6f},{self.altitude_m:.1f}"),
            *("--at", f"{self.date}T{minutes // 60:02d}:{minutes % 60:02d}"),
            *("--sky", self.sky, "--haze", f"{self.haze:.4f}", "--albedo", f"{self.albedo:.4f}"),
            *("--size", str(self.rows)),
            *(word for layer in clouds for word in ("--set", layer)),
            *(["--stars"] if self.stars else []),
        ]


@dataclass(frozen=True)
class SunLamp:
    """The sun, or by night the moon, as a lamp of Blender.

    Attributes:
        rotation: Euler angles (x, y, z) in radians of a lamp that shines along its -Z.
        strength: irradiance of a surface that faces it, in W m^-2, of the brightest channel.
        colour: linear sRGB, at most 1.
        angle: of the disc's diameter, in radians.
        caption: the sun's height, for the panel.
    """

    rotation: tuple[float, float, float]
    strength: float
    colour: tuple[float, float, float]
    angle: float
    caption: str


def sun_lamp(path, stars=False):
    """The sun of a sky that was written to `path`; with stars the map has the moon's light."""
    facts = json.loads(Path(f"{path}.json").read_text(encoding="utf-8"))
    moon = facts["keyLight"] == "moon"
    irradiance = [0.0 if moon and stars else max(value, 0.0) for value in facts["sunIrradianceRgb"]]
    strength = max(irradiance)
    east, up, south = facts["sunDirection"]
    zenith_angle_rad, azimuth_rad = math.acos(up), math.atan2(east, -south)
    return SunLamp(
        rotation=(zenith_angle_rad, 0.0, math.pi - azimuth_rad),
        strength=strength,
        colour=tuple(value / strength for value in irradiance) if strength else (1.0, 1.0, 1.0),
        angle=2.0 * math.radians(facts["sunAngularRadiusDeg"]),
        caption=f"{facts['time']}: sun {facts['sunElevationDeg']:.1f}\N{DEGREE SIGN} high"
        + (", moonlight" if moon else ""),
    )
