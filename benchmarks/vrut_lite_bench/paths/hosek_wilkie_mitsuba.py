"""Mitsuba's sunsky on the directions of a cube map, of its sky or all, in a process of its own.

    python -m vrut_lite_bench.paths.hosek_wilkie_mitsuba SIZE...

Prints JSON: the variant, CPU seconds by size on one thread, for the sky texels and for every
texel, and the errors of the smallest map's sky. llvm_ad_rgb needs an LLVM that drjit takes
(Debian's libllvm19); with others it aborts the process, which is why it has its own.
"""

import importlib
import json
import os
import subprocess
import sys
import time
from typing import Any

ROUNDS = 60
# Mitsuba divides RGB by the integral of CIE Y; our radiance is not normalised so.
CIE_Y_NORMALISATION = 106.7502593994140625
_LLVM_PLACES = ("/usr/lib/x86_64-linux-gnu/libLLVM.so.19.1", "/usr/lib/libLLVM.so.19.1")


def measure(sizes: tuple[int, ...]) -> dict[str, Any]:
    """The figures of a process that uses LLVM, or of one without LLVM if that one fails."""
    command = [sys.executable, "-m", "vrut_lite_bench.paths.hosek_wilkie_mitsuba", *map(str, sizes)]
    for library in (*filter(os.path.exists, _LLVM_PLACES), ""):
        environment = {**os.environ, "DRJIT_LIBLLVM_PATH": library}
        answer = subprocess.run(
            command, env=environment, capture_output=True, text=True, check=False
        )
        if answer.returncode == 0:
            return dict(json.loads(answer.stdout.splitlines()[-1]))
    return {"variant": "not installed", "sky": {}, "all": {}, "errors": []}


def _main(sizes: list[int]) -> dict[str, Any]:
    from vrut_lite.geometry.cube_map import texel_directions
    from vrut_lite_bench.bench_path import relative_errors
    from vrut_lite_bench.paths.hosek_wilkie_formats import SKY, SUN, exact_radiance, sky_directions

    mitsuba: Any = importlib.import_module("mitsuba")
    vectorised = bool(os.environ.get("DRJIT_LIBLLVM_PATH"))
    mitsuba.set_variant("llvm_ad_rgb" if vectorised else "scalar_rgb")
    emitter = mitsuba.load_dict(
        {
            "type": "sunsky",
            "sun_direction": [SUN[0], -SUN[2], SUN[1]],
            "turbidity": SKY.turbidity,
            "albedo": float(SKY.albedo),
            "sun_scale": 0.0,
        }
    )
    run = _vectorised if vectorised else _one_by_one

    def spent(d: Any) -> float:
        return run(mitsuba, emitter, _towards(d))

    directions = sky_directions(min(sizes))

    return {
        "variant": mitsuba.variant(),
        "errors": relative_errors(
            _values(mitsuba, emitter, _towards(directions)), exact_radiance(SKY, directions)
        ),
        "sky": {size: spent(sky_directions(size)) for size in sizes},
        "all": {size: spent(texel_directions(size).reshape(-1, 3)) for size in sizes},
    }


def _towards(directions: Any) -> Any:
    """World directions as the emitter has them, which looks along -wi, east, north, up."""
    return -directions[:, [0, 2, 1]] * (1.0, -1.0, 1.0)


def _values(mitsuba: Any, emitter: Any, towards: Any) -> Any:
    """Radiance (n, 3) in W m^-2 sr^-1."""
    import numpy as np

    if "scalar" not in mitsuba.variant():
        drjit: Any = importlib.import_module("drjit")
        interaction = drjit.zeros(mitsuba.SurfaceInteraction3f, len(towards))
        interaction.wi = mitsuba.Vector3f(*towards.T.astype("f4"))
        return CIE_Y_NORMALISATION * np.array(emitter.eval(interaction)).T
    interaction, values = mitsuba.SurfaceInteraction3f(), []
    interaction.time = 0.0
    for direction in towards:
        interaction.wi = mitsuba.Vector3f(*map(float, direction))
        values.append(list(emitter.eval(interaction)))
    return CIE_Y_NORMALISATION * np.array(values)


def _vectorised(mitsuba: Any, emitter: Any, towards: Any) -> float:
    drjit: Any = importlib.import_module("drjit")
    drjit.set_thread_count(1)
    interaction = drjit.zeros(mitsuba.SurfaceInteraction3f, len(towards))
    interaction.wi = mitsuba.Vector3f(*towards.T.astype("f4"))
    drjit.eval(interaction)
    drjit.sync_thread()
    least = float("inf")
    for _ in range(ROUNDS):
        start = time.process_time()
        drjit.eval(emitter.eval(interaction))
        drjit.sync_thread()
        least = min(least, time.process_time() - start)
    return least


def _one_by_one(mitsuba: Any, emitter: Any, towards: Any) -> float:
    """A sample of the directions, scaled up: the Python loop is part of it."""
    sample = towards[:: max(1, len(towards) // 2000)]
    interaction = mitsuba.SurfaceInteraction3f()
    interaction.time = 0.0
    start = time.process_time()
    for direction in sample:
        interaction.wi = mitsuba.Vector3f(*map(float, direction))
        emitter.eval(interaction)
    return (time.process_time() - start) / len(sample) * len(towards)


if __name__ == "__main__":
    print(json.dumps(_main([int(size) for size in sys.argv[1:]])))
