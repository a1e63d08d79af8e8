"""Draw the pictures of docs/polarisation.md.

python -m vrut_lite_lab.pictures.polarisation [FOLDER]

writes polarisation.jpg, fisheyes of the degree, and polariser.jpg, scenes through a polariser.
"""

import sys
from collections.abc import Iterator
from pathlib import Path

import msgspec
import numpy as np
from bruneton_sky.polarisation_picture import polarisation_picture

from vrut_lite.daylight_kernel import daylight_kernel
from vrut_lite.kernel.messages import Demand, SetClock
from vrut_lite.messages.sky import SkyPolarisationChanged
from vrut_lite.messages.sky_light import SkyLightChanged
from vrut_lite.messages.sun import SunMoved
from vrut_lite.project import CameraView, Project, daylight_inputs, setting_inputs
from vrut_lite_lab.checkout import ROOT
from vrut_lite_lab.pictures.drawing import Captioned, scene_project, sheet, shots

_SLOTS = {"sky": "bruneton_sky"}
# Hours in Prague by the sun's height in degrees.
_SUNS = {"55": "15:00", "23": "18:30", "0.3": "21:10"}
_DISC, _SCENE = (280, 280), (373, 210)
_FILTERS = {"no filter": None, "0 deg": 0.0, "90 deg": 90.0}
_PAVILION = scene_project(
    "pavilion.gltf",
    at="2026-06-21T18:30",
    slots=_SLOTS,
    camera=CameraView(
        eye_m=(0.0, 1.7, 14.0), target_m=(0.0, 6.0, -10.0), vertical_field_of_view_deg=75.0
    ),
)
_LAKE = scene_project("large/terrain.toml", at="2026-06-28T11:30", slots=_SLOTS)
_STREET = scene_project("street.toml", at="2026-06-21T18:00", slots=_SLOTS)


def discs() -> Iterator[Captioned]:
    """The polarisation over Prague by the sun's height."""
    kernel, _ = daylight_kernel()
    project = Project(slots=_SLOTS)
    for message in (*setting_inputs(project, kernel), *daylight_inputs(project)):
        kernel.inject(message)
    for kind in (SkyLightChanged, SkyPolarisationChanged):
        kernel.inject(Demand(consumer="picture", message=kind.__name__))
    for sun, time in _SUNS.items():
        at = msgspec.structs.replace(project, at=f"2026-06-21T{time}").instant()
        kernel.inject(SetClock(instant=at))
        kernel.pump_until_idle()
        light, moved = kernel.last(SkyLightChanged), kernel.last(SunMoved)
        assert light is not None
        assert moved is not None
        picture = polarisation_picture(light, moved, 0.0)
        yield f"sun {sun} deg; brightest {picture.largest:.0%}", picture.pixels
    kernel.close()


def filtered() -> Iterator[Captioned]:
    """Scenes without a filter and through one, at one exposure."""
    for project in (_PAVILION, _LAKE, _STREET):
        exposure = project.exposure
        for name, angle in _FILTERS.items():
            seen = msgspec.structs.replace(project, polariser_deg=angle, exposure=exposure)
            (shot,) = shots(seen, [project.at])
            exposure = msgspec.structs.replace(exposure, mode="manual", ev100=shot.picture.ev100)
            yield name, np.asarray(shot.picture.display)


def main() -> None:
    """Draw both sheets."""
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "docs" / "pictures"
    sheet(list(discs()), len(_SUNS), _DISC).save(folder / "polarisation.jpg", quality=82)
    sheet(list(filtered()), len(_FILTERS), _SCENE).save(folder / "polariser.jpg", quality=82)


if __name__ == "__main__":
    main()
