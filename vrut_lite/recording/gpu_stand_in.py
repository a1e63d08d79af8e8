"""The GPU of a replay: jobs are heard and left alone, their results are in the journal."""

from vrut_lite import __version__
from vrut_lite.kernel.module import Manifest, Module, handles
from vrut_lite.messages.gpu_job import GpuJob


class GpuStandIn(Module):
    """Replaces the host's `gl_jobs` where there is no GPU."""

    manifest = Manifest(name="gl_jobs", title="GPU jobs", version=__version__)

    @handles(GpuJob)
    def on_job(self, job: GpuJob) -> None:
        """Count what the recording's GPU has done."""
        self.counters.skip("gpu job: its result is in the journal")
