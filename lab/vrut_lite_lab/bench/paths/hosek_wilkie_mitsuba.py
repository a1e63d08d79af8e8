"""Mitsuba's sunsky on the directions of a cube map, of its sky or all, in a process of its own.

    python -m vrut_lite_lab.bench.paths.hosek_wilkie_mitsuba SIZE...

Prints JSON: CPU seconds by size on one thread, for the sky texels and for every texel, and the
errors of the smallest map's sky. llvm_ad_rgb needs an LLVM that drjit takes (Debian's libllvm19);
with others it aborts the process, which is why it has its own.
"""

import importlib
import json
import os
import sys
import time
from typing import Any

from vrut_lite.geometry.cube_map import texel_directions
from vrut_lite_lab.bench.bench_path import relative_errors
from vrut_lite_lab.bench.own_process import figures_of
from vrut_lite_lab.bench.paths.hosek_wilkie_formats import SKY, SUN, exact_radiance, sky_directions

ROUNDS = 60
# Mitsuba divides RGB by the integral of CIE Y; our radiance is not normalised so.
CIE_Y_NORMALISATION = 106.7502593994140625
_LLVM_PLACES = ("/usr/lib/x86_64-linux-gnu/libLLVM.so.19.1", "/usr/lib/libLLVM.so.19.1")


def llvm_library() -> str:
    """The LLVM for drjit: of the environment, else an installed one; empty where there is none."""
    places = (os.environ.get("DRJIT_LIBLLVM_PATH", ""), *_LLVM_PLACES)
    return next(filter(os.path.exists, places), "")


def measure(sizes: tuple[int, ...]) -> dict[str, Any]:
    """The figures of a new process; ModuleFailed as `figures_of`."""
    return figures_of("mitsuba's sunsky", __name__, *sizes, DRJIT_LIBLLVM_PATH=llvm_library())


def _main(sizes: list[int]) -> dict[str, Any]:
    import msgspec
    import numpy as np

    mitsuba: Any = importlib.import_module("mitsuba")
    mitsuba.set_variant("llvm_ad_rgb")
    drjit: Any = importlib.import_module("drjit")
    drjit.set_thread_count(1)
    emitter = mitsuba.load_dict(
        {
            "type": "sunsky",
            "sun_direction": [SUN[0], -SUN[2], SUN[1]],
            "turbidity": SKY.turbidity,
            "albedo": float(SKY.albedo),
            "sun_scale": 0.0,
        }
    )

    def seen(directions: Any) -> Any:
        """World directions as the emitter takes them: along -wi, east, north, up."""
        towards = -directions[:, [0, 2, 1]] * (1.0, -1.0, 1.0)
        interaction = drjit.zeros(mitsuba.SurfaceInteraction3f, len(towards))
        interaction.wi = mitsuba.Vector3f(*towards.T.astype("f4"))
        drjit.eval(interaction)
        drjit.sync_thread()
        return interaction

    def spent_s(directions: Any) -> float:
        interaction, least = seen(directions), float("inf")
        for _ in range(ROUNDS):
            start_s = time.process_time()
            drjit.eval(emitter.eval(interaction))
            drjit.sync_thread()
            least = min(least, time.process_time() - start_s)
        return least

    directions = sky_directions(min(sizes))
    radiance = CIE_Y_NORMALISATION * np.array(emitter.eval(seen(directions))).T
    errors = relative_errors(radiance, exact_radiance(SKY, directions))
    return {
        "errors": msgspec.structs.astuple(errors),
        "sky": {size: spent_s(sky_directions(size)) for size in sizes},
        "all": {size: spent_s(texel_directions(size).reshape(-1, 3)) for size in sizes},
    }


if __name__ == "__main__":
    print(json.dumps(_main([int(size) for size in sys.argv[1:]])))
