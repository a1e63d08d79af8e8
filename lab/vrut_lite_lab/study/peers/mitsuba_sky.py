"""mitsuba's sunsky without its sun: Hosek and Wilkie's model in another program."""

import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from path_tracer.library import load_mitsuba

from vrut_lite.atmosphere.equal_haze import equal_sky
from vrut_lite.errors import UserError
from vrut_lite.geometry.panorama import lat_long_directions
from vrut_lite.numeric_types import FloatArray
from vrut_lite_lab.study.peers.airs import DEPTH, GROUND_ALBEDO
from vrut_lite_lab.study.peers.peer import NotHere, PeerShot
from vrut_lite_lab.study.peers.views import HEIGHT, ON_GROUND, WIDTH, SkyViewpoint, of_picture


@dataclass
class Sunsky:
    """All pixels at once by llvm, of one thread."""

    name: str = "mitsuba"
    title: str = "mitsuba 3, sunsky (Hosek-Wilkie)"
    air: str = "continental"
    cannot: str = "a sun below 0°; observers aloft; ozone, aerosols, layers"
    grey: bool = False

    def shots(self, views: Sequence[SkyViewpoint]) -> dict[SkyViewpoint, PeerShot]:
        """From the ground, the sun up; the second of two pictures is timed, as code is kept."""
        try:
            mitsuba = load_mitsuba("llvm")
        except UserError as error:
            raise NotHere(str(error).replace("the path tracer", "sunsky")) from None
        import drjit

        drjit.set_thread_count(1)
        found = {}
        for view in (each for each in views if each in ON_GROUND and each.sun_deg >= 0.0):
            least = float("inf")
            for _ in range(2):
                start = time.process_time()
                seen = _picture(mitsuba, drjit, view)
                least = min(least, time.process_time() - start)
            found[view] = PeerShot(of_picture(seen, view), least)
        return found

    def prepared_s(self) -> float:
        """Nothing."""
        return 0.0


def _picture(mitsuba: Any, drjit: Any, view: SkyViewpoint) -> FloatArray:
    sun = view.sun_direction
    emitter = mitsuba.load_dict(
        {
            "type": "sunsky",
            "sun_direction": [sun[0], -sun[2], max(sun[1], 1e-4)],
            "turbidity": equal_sky(DEPTH, float(np.radians(view.sun_deg))).turbidity,
            "albedo": GROUND_ALBEDO,
            "sun_scale": 0.0,
        }
    )
    # The emitter looks along -wi, in east, north, up.
    towards = -lat_long_directions(HEIGHT).reshape(-1, 3)[:, [0, 2, 1]] * (1.0, -1.0, 1.0)
    interaction = drjit.zeros(mitsuba.SurfaceInteraction3f, len(towards))
    interaction.wi = mitsuba.Vector3f(*towards.T.astype("f4"))
    seen = np.array(emitter.eval(interaction)).T
    return seen.reshape(HEIGHT, WIDTH, 3).astype(float)
