"""A journal whose GPU jobs another processor prepares otherwise, by a last digit."""

import io

import msgspec
import numpy as np
import pytest

from vrut_lite.array import Array
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import Derived, JobResult, Tick
from vrut_lite.kernel.module import Manifest, Module, handles
from vrut_lite.message_codec import to_plain
from vrut_lite.messages.gpu_job import GpuJob, GpuTexture
from vrut_lite.recording.journal_reader import Journal
from vrut_lite.recording.recipes import recipe_of_plain
from vrut_lite.recording.recorder import Recorder
from vrut_lite.recording.replay import Replay


class Drawn(Derived, frozen=True, kw_only=True):
    """The texture that came, and whether it was awaited."""

    cube: GpuTexture
    awaited: bool


class Painter(Module):
    """Asks for a texture by an hour, and shows the one that it asked for last."""

    manifest = Manifest(name="painter", title="Painter", version="1")
    speaks = (Drawn,)
    factor = 1.0

    @handles(Tick)
    def on_tick(self, message: Tick) -> None:
        self.job = GpuJob(
            module="painter",
            job="cube",
            compute_shader="void main() {}",
            uniforms={"sun": (message.elapsed_s * self.factor, 0.5), "size": 4},
            output="cube",
            size=4,
            buffers=((1, Array(np.arange(3.0, dtype=np.float32))),),
        )
        self.link.post(self.job)

    @handles(JobResult)
    def on_result(self, message: JobResult) -> None:
        texture = GpuTexture.of(message.value)
        self.link.post(Drawn(cube=texture, awaited=texture.recipe == self.job.recipe))


def journal_of(folder, *hours):
    """A session in which each job is answered, and a first one once more: too late."""
    stream, kernel, jobs = io.BytesIO(), Kernel(), []
    kernel.add_module(Painter)
    kernel.tap(lambda message, _: jobs.append(message) if isinstance(message, GpuJob) else None)
    recorder = Recorder(kernel, stream)
    for hour in hours:
        kernel.inject(Tick(elapsed_s=hour))
        kernel.pump()
        for job in (jobs[-1], jobs[0]):
            texture = GpuTexture(size=4, format=job.format, recipe=job.recipe)
            kernel.inject(JobResult(module="painter", job="cube", value=texture))
            kernel.pump()
    recorder.close()
    path = folder / "gpu.mcap"
    path.write_bytes(stream.getvalue())
    return Journal(path), jobs


@pytest.mark.parametrize(
    ("version", "factor", "equal"),
    [("1", 1.0, True), ("2", 1.0, True), ("2", 1.0 + 1e-7, True), ("2", 1.001, False)],
)
def test_textures_of_jobs_that_are_equal_by_value_are_equal(tmp_path, version, factor, equal):
    """The recorded texture is awaited here too, though its recipe has another last digit."""
    journal, _ = journal_of(tmp_path, 1.0, 2.5, 7.0)

    class Here(Painter):
        manifest = Manifest(name="painter", title="Painter", version=version)

    Here.factor = factor
    outcome = Replay(journal, [Here]).run()
    assert outcome.by_value == (version == "2")
    assert (outcome.difference is None) == equal


def test_a_jobs_recipe_can_be_told_from_its_entry(tmp_path):
    """An entry holds all that makes it: none of the buffers' contents is needed."""
    journal, jobs = journal_of(tmp_path, 1.0, 2.5)
    plain = [entry.message for entry in journal.entries() if entry.type_name == "GpuJob"]
    assert [recipe_of_plain(job) for job in plain] == [job.recipe for job in jobs]
    bare = msgspec.structs.replace(jobs[0], buffers=())
    assert recipe_of_plain(to_plain(bare)) == bare.recipe


@pytest.mark.parametrize("field", ["buffers", "uniforms"])
def test_a_forged_job_has_no_recipe(field):
    """A journal from a stranger may hold anything under the name of a job."""
    assert recipe_of_plain({"compute_shader": "", field: [[1]]}) is None
