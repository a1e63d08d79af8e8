"""The thesis's precomputation (Hvezda 2020, algorithms 1 to 7) on the GPU, in single precision.

Each of the algorithms 2 to 7 is a compute shader, shaders/pipeline_*.comp; `pipeline` is
algorithm 1. The package `bruneton_sky.published.pipeline` is their twin in double precision: sample
counts and quadrature rules come from there.
"""

from bruneton_sky.published.gpu_pipeline.pipeline import GpuPipeline
from bruneton_sky.published.gpu_pipeline.tables import GpuTables

__all__ = ["GpuPipeline", "GpuTables"]
