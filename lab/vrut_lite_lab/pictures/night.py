"""Pictures of the night: a night over a street, Orion, the moon's phases, the eclipse of 2026.

    python -m vrut_lite_lab.pictures.night FOLDER

Writes night.webp and night_illuminance.png.
"""

import sys
from datetime import UTC, datetime, timedelta
from pathlib import Path

import astronomy
import numpy as np
from night_sky.moon import moon_at
from night_sky.sky_axes import body_km, refracted, watch
from numpy.typing import NDArray
from PIL import Image

from vrut_lite.daylight_kernel import daylight_kernel, demand_light
from vrut_lite.geometry.colour import LUMENS_PER_WATT, luminance
from vrut_lite.geometry.spherical_harmonics import evaluate_irradiance
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import ChooseSlot, SetClock
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.sky_light import SkyLightChanged
from vrut_lite.numeric_types import FloatArray
from vrut_lite.project import CameraView, Exposure, Project, parse_place
from vrut_lite_lab.pictures.drawing import Captioned, scene_project, sheet, shots

WIDTH_PX = 1400
PRAGUE, BURGOS = "50.0755,14.4378,200", "42.34,-3.70,850"
LISBON, XIAN = "38.7,-9.1,50", "34.3,108.9,400"
# The moon rises two hours after sunset.
NIGHT = {
    "sunset": "2026-04-04T19:30",
    "nautical twilight": "2026-04-04T20:25",
    "moonrise": "2026-04-04T23:15",
    "deep night": "2026-04-12T01:00",
    "dawn": "2026-04-05T05:30",
}
# One lunation, and the exposure of each.
PHASES = {
    "2026-01-22T18:30": 9.0,
    "2026-01-26T20:00": 11.0,
    "2026-01-29T21:00": 12.0,
    "2026-02-01T23:00": 13.0,
    "2026-02-05T03:00": 12.0,
    "2026-02-09T05:00": 11.0,
    "2026-02-12T06:15": 9.0,
}
# Noon before a full moon, a half moon, midsummer, no moon.
DAYS = [
    datetime(2026, month, day, 12, tzinfo=UTC)
    for month, day in ((1, 3), (3, 26), (6, 14), (10, 10))
]
# The sun on the horizon, and the exposure of each.
LOW_SUNS = {"2026-06-21T21:08": 17.0, "2026-06-21T21:12": 15.0, "2026-06-21T21:14": 14.0}
# The moon in the Earth's shadow: 28 August 2026 over Lisbon, 31 December 2028 over Xi'an.
UMBRA = (
    ("2026-08-28T03:55", 12.0, 2.0),
    ("2026-08-28T05:13", 4.0, 2.0),
    ("2029-01-01T00:52", 3.0, 4.0),
    ("2029-01-01T00:52", 1.0, 2.0),
    ("2029-01-01T00:52", -3.0, 0.0),
)
# Light between surfaces adds little by night, and takes long.
OPEN_SKY = {"light_transport": {"on": False}}
_EYE_M = (0.0, 60.0, 0.0)


def street() -> list[Captioned]:
    """One night, exposed automatically."""
    camera = CameraView(
        eye_m=(-1.2, 1.7, 16.0), target_m=(0.2, 6.2, -2.0), vertical_field_of_view_deg=64.0
    )
    project = scene_project(
        "street.toml", size=(280, 210), camera=camera, place=PRAGUE, settings=OPEN_SKY
    )
    taken = shots(project, list(NIGHT.values()))
    return [
        (f"{name}, EV {shot.picture.ev100:.1f}", shot.picture.display)
        for name, shot in zip(NIGHT, taken, strict=True)
    ]


def orion_and_eclipse() -> list[Captioned]:
    """Orion over the pavilion by starlight; the sun minutes before totality, and in it."""
    beside = CameraView(
        eye_m=(-1.0, 1.6, -15.0), target_m=(3.0, 8.6, 15.0), vertical_field_of_view_deg=66.0
    )
    stars = scene_project(
        "pavilion.gltf", size=(700, 460), camera=beside, place=PRAGUE, at="2026-01-15T22:00",
        exposure=Exposure(mode="manual", ev100=-7.5), settings=OPEN_SKY,
    )  # fmt: skip
    (taken,) = shots(stars, [stars.at])
    west = CameraView(
        eye_m=(10.0, 1.6, 3.5), target_m=(-15.0, 6.5, -2.0), vertical_field_of_view_deg=60.0
    )
    total = scene_project(
        "pavilion.gltf",
        size=(700, 460),
        camera=west,
        place=BURGOS,
        at="2026-08-12T20:29:10",
        settings=OPEN_SKY,
    )
    (dark,) = shots(total, [total.at])
    return [
        ("Orion over the pavilion, starlight, EV -7.5", taken.picture.display),
        (f"12 August 2026, Burgos, totality, EV {dark.picture.ev100:.1f}", dark.picture.display),
    ]


def moons() -> list[Captioned]:
    """The moon through a long lens, the right way up for Prague, and the eclipsed sun."""
    pictures = [_moon(PRAGUE, at, ev) for at, ev in PHASES.items()]
    return [*pictures, _moon(BURGOS, "2026-08-12T20:21", 27.5)]


def horizon_and_umbra() -> list[Captioned]:
    """The sun on the horizon, and the moon in the Earth's shadow by Danjon's scale."""
    pictures: list[Captioned] = []
    for at, ev in LOW_SUNS.items():
        here = watch(Project(place=PRAGUE, at=at).instant(), *parse_place(PRAGUE))
        sun = here.world @ body_km(astronomy.Body.Sun, here)
        sun = refracted(sun / np.linalg.norm(sun))
        height = np.degrees(np.arcsin(sun[1]))
        pictures.append((f"sun {height:.2f}°, EV {ev:g}", _aimed(sun, PRAGUE, at, ev)))
    for at, ev, danjon in UMBRA:
        seen = _moon(LISBON if at < "2028" else XIAN, at, ev, danjon)[1]
        pictures.append((f"{at[:10]}, L = {danjon:g}, EV {ev:g}", seen))
    return pictures


def terrain() -> list[Captioned]:
    """The same night over a valley under Bruneton's sky, exposed automatically."""
    project = scene_project(
        "large/terrain.toml", size=(280, 210), place=PRAGUE, settings=OPEN_SKY,
        slots={"sky": "bruneton_sky"},
    )  # fmt: skip
    taken = shots(project, list(NIGHT.values()))
    return [
        (f"{name}, EV {shot.picture.ev100:.1f}", shot.picture.display)
        for name, shot in zip(NIGHT, taken, strict=True)
    ]


def _moon(place: str, at: str, ev100: float, danjon: float = 2.0) -> Captioned:
    """A picture of 1 deg around the moon."""
    moon = moon_at(watch(Project(place=place, at=at).instant(), *parse_place(place)))
    seen = _aimed(moon.direction, place, at, ev100, danjon)
    return f"{at[5:10]}, {moon.lit_fraction:.0%} lit", seen


def _aimed(
    direction: FloatArray, place: str, at: str, ev100: float, danjon: float = 2.0
) -> NDArray[np.uint8]:
    target = tuple((np.add(_EYE_M, 1000.0 * direction)).tolist())
    project = scene_project(
        "pavilion.gltf",
        size=(175, 175),
        camera=CameraView(eye_m=_EYE_M, target_m=target, vertical_field_of_view_deg=1.0),
        place=place,
        at=at,
        exposure=Exposure(mode="manual", ev100=ev100),
        settings={**OPEN_SKY, "night_sky": {"danjon": danjon}},
    )
    (taken,) = shots(project, [at])
    return taken.picture.display


def illuminance(path: Path) -> None:
    """Level ground over 24 hours of four days, by both skies."""
    from matplotlib import pyplot

    figure, axes = pyplot.subplots(1, 4, figsize=(14.0, 3.2), sharey=True)
    for sky, line in (("dynamic_skylight", "k-"), ("bruneton_sky", "b--")):
        kernel, _ = daylight_kernel()
        kernel.inject(ChooseSlot(slot="sky", module=sky))
        kernel.inject(SetPlace(latitude_deg=50.0755, longitude_deg=14.4378))
        demand_light(kernel, "figure", 16)
        for panel, day in zip(axes, DAYS, strict=True):
            hours = np.arange(0.0, 24.01, 1.0 / 6.0)
            lux = [_lux(kernel, day + timedelta(hours=hour)) for hour in hours]
            panel.semilogy(hours + 12.0, lux, line, lw=1.0)
            panel.set_title(f"{day:%d %B %Y}", fontsize=9)
            panel.set_xlabel("UTC from noon to noon, h", fontsize=8)
            panel.set_xticks(range(12, 37, 4))
            panel.grid(alpha=0.3)
        kernel.close()
    axes[0].set_ylabel("lx", fontsize=9)
    figure.tight_layout()
    figure.savefig(path, dpi=70, bbox_inches="tight")


def _lux(kernel: Kernel, instant: datetime) -> float:
    kernel.inject(SetClock(instant=instant))
    kernel.pump_until_idle()
    light = kernel.last(SkyLightChanged)
    assert light is not None
    key = light.key_light
    sky = evaluate_irradiance(light.ambient.irradiance_sh_rgb.values, (0.0, 1.0, 0.0))
    lit = np.asarray(key.irradiance_rgb) * max(key.direction[1], 0.0) + sky
    return float(luminance(lit)) * LUMENS_PER_WATT


def main(folder: Path) -> None:
    """Draw figure and sheet."""
    folder.mkdir(parents=True, exist_ok=True)
    illuminance(folder / "night_illuminance.png")
    rows = [
        sheet(street(), 5),
        sheet(terrain(), 5),
        sheet(orion_and_eclipse(), 2),
        sheet(moons(), 8),
        sheet(horizon_and_umbra(), 8),
    ]
    paper = Image.new("RGB", (WIDTH_PX, sum(row.height for row in rows)))
    top = 0
    for row in rows:
        paper.paste(row, (0, top))
        top += row.height
    paper.save(folder / "night.webp", quality=82, method=6)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
