"""How the cost of a light map grows with the number of triangles.

    python -m vrut_lite_lab.light_map_growth [TRIANGLES ...]

Hills with boxes (`scenes.dense`), each baked in a process of its own with the usual texels and
rays. Times are CPU time of one thread: "layout" until the tree stands, "first round" of rays
with its light, "bake" until the last ray, "hour" a new one, the least of three. Memory: what the
bake keeps, and the most that the process took, the scene and the libraries in it.
"""

import argparse
import resource
import tempfile
import time
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import NamedTuple

import numpy as np
from light_transport.hour.illumination import Illumination
from light_transport.jobs import first_rays
from light_transport.layout.layout import lay_out
from light_transport.surfaces.surfaces import surfaces_of
from light_transport.tolerance import TransportQuality, quality_for
from light_transport.transport import SceneTransport

from vrut_lite.geometry.spherical_harmonics import irradiance_coefficients
from vrut_lite.messages.tolerance import DEFAULT_TOLERANCE
from vrut_lite.scene.loading import load_scene
from vrut_lite.scene.packing import packed
from vrut_lite_lab.scenes.dense import build

_SIZES = (125_000, 250_000, 500_000, 1_000_000)
_SMALL = 5_000
_SKY = np.ones((6, 64, 64, 3), np.float32)
_HOUR = Illumination(
    sky=_SKY,
    ground_radiance_rgb=(0.2,) * 3,
    ground_albedo_rgb=(0.2,) * 3,
    key_direction=(0.0, 0.8, 0.6),
    key_irradiance_rgb=(3.0,) * 3,
    open_sky=irradiance_coefficients(_SKY),
)


class GrowthCosts(NamedTuple):
    """Of one scene; see the file's head."""

    triangles: int
    texels: int
    layout_s: float
    first_s: float
    bake_s: float
    hour_s: float
    kept_mb: float
    most_mb: float


def costs_of(path: str, quality: TransportQuality) -> GrowthCosts:
    """Bake a scene."""
    scene = packed(load_scene(path))
    begin = time.process_time()
    surfaces = surfaces_of(scene)
    layout = lay_out(scene, surfaces, None, quality.texels)
    transport = SceneTransport(surfaces, layout, 1, quality.patch_texels, quality.bounces_left)
    laid = time.process_time()
    transport.add_rays(min(first_rays(transport.rows), quality.rays))
    transport.light(_HOUR)
    first = time.process_time()
    while transport.rays < quality.rays:
        transport.add_rays(min(transport.rays, quality.rays - transport.rays))
    transport.light(_HOUR)
    baked = time.process_time()
    hours = []
    for _ in range(3):
        start = time.process_time()
        transport.light(_HOUR)
        hours.append(time.process_time() - start)
    return GrowthCosts(
        scene.triangles,
        len(transport.texels.pixel),
        laid - begin,
        first - begin,
        baked - begin,
        min(hours),
        transport.memory_bytes / 1e6,
        resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3,
    )


def _costs_warm(path: str, small: str) -> GrowthCosts:
    costs_of(small, quality_for(DEFAULT_TOLERANCE)._replace(texels=2_000, rays=16))
    return costs_of(path, quality_for(DEFAULT_TOLERANCE))


def main() -> None:
    """Print a Markdown table."""
    parser = argparse.ArgumentParser(description="What light maps of many triangles cost.")
    parser.add_argument("triangles", nargs="*", type=int, default=_SIZES)
    print("| triangles | texels | layout s | first light s | bake s | µs a triangle | hour ms "
          "| kept MB | process MB |")  # fmt: skip
    print("|---:|---:|---:|---:|---:|---:|---:|---:|---:|")
    with tempfile.TemporaryDirectory() as folder:
        small = Path(folder) / "small.glb"
        small.write_bytes(build(_SMALL))
        for triangles in parser.parse_args().triangles:
            path = Path(folder) / f"{triangles}.glb"
            path.write_bytes(build(triangles))
            # Kernels are loaded, and memory counted, for each scene anew.
            with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
                costs = pool.submit(_costs_warm, str(path), str(small)).result()
            print(
                f"| {costs.triangles:,} | {costs.texels:,} | {costs.layout_s:.2f} "
                f"| {costs.first_s:.2f} | {costs.bake_s:.1f} "
                f"| {1e6 * costs.bake_s / costs.triangles:.0f} | {1e3 * costs.hour_s:.0f} "
                f"| {costs.kept_mb:.0f} | {costs.most_mb:.0f} |",
                flush=True,
            )


if __name__ == "__main__":
    main()
