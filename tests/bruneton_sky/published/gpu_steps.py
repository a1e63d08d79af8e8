"""Every table that the GPU's precomputation makes on its way, by the twin's names."""

import numpy as np
from bruneton_sky import Atmosphere
from bruneton_sky.published.gpu_pipeline import GpuPipeline
from bruneton_sky.published.gpu_pipeline.passes import Pass
from bruneton_sky.published.gpu_pipeline.tables import read_flat, read_scattering
from numpy.typing import NDArray

Steps = dict[tuple[str, int], NDArray[np.float64]]


def gpu_steps(pipeline: GpuPipeline, atmosphere: Atmosphere, orders: int) -> Steps:
    """Arrays by name and order, as `run_pipeline` tells its observer; up to four wavelengths."""
    count, steps = len(atmosphere.wavelength_nm), {}

    def keep(step: Pass) -> None:
        for name, texture in step.results.items():
            steps[name, step.order] = _read(pipeline, texture, count)

    for tables in pipeline.run_on_gpu(atmosphere, orders, observe=keep):
        tables.release()
    steps["transmittance", 0] = np.exp(-steps.pop(("optical_depth", 0)))
    return steps


def _read(pipeline, texture, count):
    if len(texture.size) == 3:
        return read_scattering(texture, pipeline.sizes, count)
    return read_flat(texture, count)
