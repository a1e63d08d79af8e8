"""The module on the bus: progress, cancelling, demand, and what may go wrong."""

import threading
import time
from datetime import UTC, datetime

import numpy as np
import pytest
import trimesh
from dynamic_skylight.module import DynamicSkyLight
from light_messages import light_messages
from path_tracer import library
from path_tracer import module as path_tracer_module
from path_tracer.messages import PathTracedPicture
from path_tracer.module import PathTracer
from path_tracer.subject import Subject
from path_tracer.tracer import Tracer
from path_tracer_here import mitsuba_or_skip

from vrut_lite.array import Array
from vrut_lite.errors import UserError
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import Demand, Fault, Input, JobResult, SetClock, SetSetting
from vrut_lite.kernel.module import Manifest, Module, handles
from vrut_lite.messages.camera import MoveCamera
from vrut_lite.messages.gpu_job import GpuJob, GpuTexture
from vrut_lite.messages.picture import Resize
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.renderer import RendererTried
from vrut_lite.messages.scene import LoadScene
from vrut_lite.messages.sky import BackgroundChanged
from vrut_lite.scene.manager import SceneManager
from vrut_lite.sky.sky_sum import SkySum

mitsuba_or_skip()
WANT = Demand(consumer="test", message="PathTracedPicture")
NO_MORE = Demand(consumer="test", message="PathTracedPicture", size=0)
DEADLINE_S = 30.0


class Shine(Input, frozen=True, kw_only=True):
    """Let the sky and the sun be so bright."""

    radiance: float
    irradiance: float = 0.0


class Sky(Module):
    """Posts a uniform sky and a sun overhead."""

    manifest = Manifest(name="sky", title="Sky", version="1", provides=("sky",))

    @handles(Shine)
    def on_shine(self, message: Shine) -> None:
        cube = np.full((6, 8, 8, 3), message.radiance)
        for post in light_messages(cube, sun_irradiance=(message.irradiance,) * 3):
            self.link.post(post)


@pytest.fixture
def stage(tmp_path):
    """A kernel with the tracer and a scene, and all messages that were delivered."""
    path = tmp_path / "box.glb"
    trimesh.creation.box((2, 2, 2)).export(path)
    kernel, heard = Kernel(), []
    kernel.tap(lambda message, sender: heard.append(message))
    for module in (Sky, PathTracer):
        kernel.add_module(module)
    kernel.add_module(SceneManager)
    for message in (
        SetSetting(module="path_tracer", name="spp", value=8),
        Resize(width_px=24, height_px=16),
        LoadScene(path=str(path)),
        Shine(radiance=2.0),
    ):
        kernel.inject(message)
    kernel.pump_until_idle()
    yield kernel, heard
    kernel.close()


def play(stage, *inputs):
    kernel, heard = stage
    heard.clear()
    for message in inputs:
        kernel.inject(message)
    kernel.pump_until_idle()
    return heard


def pictures(heard):
    return [message for message in heard if isinstance(message, PathTracedPicture)]


def counters(stage):
    return stage[0].seats["path_tracer"].module.counters


def demands_of_the_tracer(kernel):
    return kernel.lifecycle.demands.of_consumer("path_tracer")


def test_nothing_is_traced_without_demand(stage):
    """Scene and light came, and no sample was taken, no light demanded, no job started."""
    kernel, heard = stage
    assert pictures(heard) == []
    assert not demands_of_the_tracer(kernel)
    assert (counters(stage).done["picture begun"], counters(stage).done["sample"]) == (0, 0)


def test_a_late_demand_gets_the_present_view(stage):
    """A camera that was moved after the scene came, before anybody wanted a picture, is kept."""
    kernel, heard = stage
    kernel.inject(MoveCamera(eye_m=(0.0, 50.0, 0.1), target_m=(0.0, 90.0, 0.0)))
    kernel.pump_until_idle()
    kernel.inject(WANT)
    kernel.pump_until_idle()
    picture = [message for message in heard if isinstance(message, PathTracedPicture)][-1]
    # The uniform sky above, and nothing of the box.
    np.testing.assert_allclose(picture.radiance.values, 2.0, rtol=0.02)


def test_a_sky_on_the_card_is_computed_again_as_numbers(tmp_path):
    """With "auto" on a card the sky is a texture; who wants a traced picture gets it from the
    processor, without a fault, and when nobody does the card's serves again."""
    path = tmp_path / "box.glb"
    trimesh.creation.box((2, 2, 2)).export(path)
    kernel, heard = Kernel(), []
    kernel.tap(lambda message, sender: heard.append(message))
    for module in (DynamicSkyLight, SkySum, PathTracer, SceneManager):
        kernel.add_module(module)

    def tell(*inputs):
        heard.clear()
        for message in inputs:
            kernel.inject(message)
            kernel.pump_until_idle()
        # The card's part is played here.
        for job in [message for message in heard if isinstance(message, GpuJob)]:
            texture = GpuTexture(size=job.size, format=job.format, recipe=job.recipe)
            kernel.inject(JobResult(module=job.module, job=job.job, value=texture))
            kernel.pump_until_idle()

    tell(
        RendererTried(renderer="a card", trial_ns=0.1),
        Demand(consumer="gpu", message="GpuJob"),
        SetSetting(module="path_tracer", name="spp", value=2),
        Resize(width_px=24, height_px=16),
        LoadScene(path=str(path)),
        SetPlace(latitude_deg=50.0, longitude_deg=14.0),
        SetClock(instant=datetime(2026, 6, 21, 11, tzinfo=UTC)),
    )
    assert isinstance(kernel.last(BackgroundChanged).cube, GpuTexture)
    tell(WANT)
    assert faults(heard) == []
    assert pictures(heard)[-1].samples == 2
    assert isinstance(kernel.last(BackgroundChanged).cube, Array)
    tell(NO_MORE)
    assert isinstance(kernel.last(BackgroundChanged).cube, GpuTexture)
    kernel.close()


def test_a_picture_grows_in_passes_that_double(stage):
    """1, 2, 4 and 8 samples of 8; each picture is the mean of all so far, radiance 2 or less."""
    found = pictures(play(stage, WANT))
    assert [picture.samples for picture in found] == [1, 2, 4, 8]
    assert {(p.samples_wanted, p.width_px, p.height_px) for p in found} == {(8, 24, 16)}
    assert found[-1].radiance.shape == (16, 24, 3)
    # The sky is 2, and a box of grey paint under it darker.
    values = found[-1].radiance.values
    np.testing.assert_allclose(values[0], 2.0, rtol=1e-5)
    assert 0.1 < values[8, 12].max() < 1.5
    kernel = stage[0]
    assert any("8 of 8 samples" in record.text for record in trace(kernel))


def trace(kernel):
    return [record for record in kernel.trace.remarks() if record.kind == "progress"]


def test_the_same_input_gives_the_same_picture(stage):
    """A journal must replay to the byte: begun anew, all passes are equal."""
    first = pictures(play(stage, WANT))
    play(stage, NO_MORE)
    second = pictures(play(stage, WANT))
    assert [p.radiance.digest for p in first] == [p.radiance.digest for p in second]


def test_one_change_of_all_light_begins_one_picture(stage):
    """Background, sun and ambient change together: three messages, one start."""
    play(stage, WANT)
    before = counters(stage).done["picture begun"]
    heard = play(stage, Shine(radiance=1.0, irradiance=5.0))
    assert counters(stage).done["picture begun"] == before + 1
    assert [picture.samples for picture in pictures(heard)] == [1, 2, 4, 8]


@pytest.mark.parametrize(
    "change",
    [
        Shine(radiance=1.0),
        MoveCamera(eye_m=(3.0, 2.0, 3.0), target_m=(0.0, 0.0, 0.0)),
        Resize(width_px=16, height_px=16),
        SetSetting(module="path_tracer", name="max_bounces", value=1),
    ],
)
def test_a_changed_view_restarts_the_picture(stage, change):
    """Light, camera, size and settings: from the first sample again."""
    play(stage, WANT)
    assert [picture.samples for picture in pictures(play(stage, change))] == [1, 2, 4, 8]


def test_a_section_cuts_the_picture(stage):
    """A plane below the box takes all of it away, and the uniform sky or ground shows."""

    def middle(*inputs):
        return pictures(play(stage, *inputs))[-1].radiance.values[8, 12]

    def say(name, value):
        return SetSetting(module="scene", name=name, value=value)

    whole = middle(WANT)
    cut = middle(say("section_at", 0.0), say("section", "y"))
    assert np.abs(cut - whole).max() > 0.1
    np.testing.assert_array_equal(middle(say("section", "off")), whole)


def test_another_scene_is_opened(stage, tmp_path):
    """The new file's picture, not the old one's."""
    before = pictures(play(stage, WANT))[-1]
    path = tmp_path / "ball.glb"
    trimesh.creation.icosphere(2).export(path)
    after = pictures(play(stage, LoadScene(path=str(path))))[-1]
    assert after.samples == 8
    assert np.abs(after.radiance.values - before.radiance.values).max() > 0.1


class Gate:
    """Lets a tracer start a batch, and stops it there until it is opened."""

    def __init__(self, monkeypatch):
        self.entered, self.opened = threading.Event(), threading.Event()
        self.subjects = []
        trace = Tracer.trace

        def gated(tracer, first, count, cancelled, traced):
            self.subjects.append(tracer._subject)
            self.entered.set()
            assert self.opened.wait(DEADLINE_S)
            return trace(tracer, first, count, cancelled, traced)

        monkeypatch.setattr(Tracer, "trace", gated)


def test_a_sun_that_changes_during_a_render_begins_it_anew(stage, monkeypatch):
    """The render under the old sun is cancelled and never shown."""
    kernel, heard = stage
    gate = Gate(monkeypatch)
    heard.clear()
    kernel.inject(WANT)
    kernel.pump()
    assert gate.entered.wait(DEADLINE_S)
    kernel.inject(Shine(radiance=0.0, irradiance=5.0))
    kernel.pump()
    gate.opened.set()
    kernel.pump_until_idle()
    found = pictures(heard)
    assert [picture.samples for picture in found] == [1, 2, 4, 8]
    suns = [subject.sun.irradiance_rgb[0] for subject in gate.subjects]
    assert suns[0] == 0.0
    assert set(suns[1:]) == {5.0}
    # Under the new light the sky is black: nothing of the old, bright one is in the picture.
    assert found[0].radiance.values[0].max() == 0.0


def test_a_render_without_demand_stops(stage, monkeypatch):
    """Cancelled amid a pass: no picture follows, and the kernel is idle."""
    kernel, heard = stage
    gate = Gate(monkeypatch)
    heard.clear()
    kernel.inject(WANT)
    kernel.pump()
    assert gate.entered.wait(DEADLINE_S)
    kernel.inject(NO_MORE)
    kernel.pump()
    assert not kernel.jobs.busy
    gate.opened.set()
    kernel.pump_until_idle()
    assert pictures(heard) == []
    assert not demands_of_the_tracer(kernel)


def test_tracing_stops_between_batches(stage, monkeypatch):
    """No batch begins after the cancellation."""
    play(stage, WANT)
    monkeypatch.setattr("path_tracer.tracer._PATHS_A_BATCH", 1)
    subject = Subject(stage[0].seats["scene"].module.state)
    batches = []
    tracer = Tracer(subject, path_tracer_module.PathTracerSettings())
    assert tracer.trace(0, 64, lambda: len(batches) == 3, batches.append) is None
    assert batches == [1, 1, 1]


@pytest.mark.long
def test_the_main_thread_goes_on_meanwhile(stage):
    """A pass holds no lock of the interpreter while it traces."""
    kernel, _ = stage
    kernel.inject(SetSetting(module="path_tracer", name="spp", value=64))
    kernel.inject(Resize(width_px=100, height_px=100))
    kernel.inject(WANT)
    turns = 0
    kernel.pump()
    end = time.monotonic() + DEADLINE_S
    while kernel.jobs.busy and time.monotonic() < end:
        kernel.pump()
        time.sleep(1e-3)
        turns += 1
    assert turns > 20
    assert kernel.last(PathTracedPicture).samples == 64


def faults(heard):
    return [message for message in heard if isinstance(message, Fault)]


def test_a_missing_mitsuba_is_one_line_that_names_the_extra(stage, without_mitsuba):
    """Told to the user, and nothing is suspended: it may be installed and tried again."""
    for _ in range(4):
        (fault,) = faults(play(stage, WANT))
        assert fault.for_user
        assert not fault.suspended
        assert fault.error == (
            "the path tracer needs mitsuba: install it with pip install 'vrut-lite[ref]'"
        )
        play(stage, NO_MORE)


@pytest.mark.parametrize(
    ("program", "reason"),
    [
        ("import os; os.abort()", "ends a trial with SIGABRT"),
        ("import sys; sys.exit(1)", "fails in a trial"),
        ("import time; time.sleep(60)", "does not answer within 0.5 s"),
    ],
)
def test_an_llvm_that_aborts_fails_or_hangs_is_one_line(stage, monkeypatch, program, reason):
    """Tried in a process of its own, which may die: this one goes on, and scalar still works."""
    trial = library.probe
    monkeypatch.setattr(library, "probe", lambda path: trial(path, ("-c", program)))
    monkeypatch.setattr(library, "_PROBE_S", 0.5 if "sleep" in program else 30.0)
    monkeypatch.setenv(library.LIBRARY_VARIABLE, "/lib/libLLVM-none.so")
    library.safe_library.cache_clear()
    llvm = SetSetting(module="path_tracer", name="variant", value="llvm")
    (fault,) = faults(play(stage, llvm, WANT))
    library.safe_library.cache_clear()
    assert fault.for_user
    assert reason in fault.error
    assert "leave its variant at scalar" in fault.error
    assert "\n" not in fault.error
    scalar = SetSetting(module="path_tracer", name="variant", value="scalar")
    assert pictures(play(stage, scalar))[-1].samples == 8


def test_a_machine_without_llvm_is_told_so(monkeypatch):
    """Without a library of LLVM the error says that none was found."""
    monkeypatch.delenv(library.LIBRARY_VARIABLE, raising=False)
    monkeypatch.setattr(library, "_PLACES", ())
    library.safe_library.cache_clear()
    with pytest.raises(UserError, match="no LLVM 16 or newer was found"):
        library.safe_library()
    library.safe_library.cache_clear()


def test_candidates_are_newest_first_and_old_ones_are_not_tried(monkeypatch, tmp_path):
    """LLVM 14 and 15 abort; a link to a file that is listed already is no other candidate."""
    for name in ("libLLVM-14.so.1", "libLLVM-15.so", "libLLVM-16.so.1", "libLLVM.so.19.1"):
        (tmp_path / name).touch()
    (tmp_path / "libLLVM-19.so").symlink_to(tmp_path / "libLLVM.so.19.1")
    monkeypatch.delenv(library.LIBRARY_VARIABLE, raising=False)
    monkeypatch.setattr(library, "_PLACES", (f"{tmp_path}/libLLVM*",))
    found = [path.rsplit("/", 1)[1] for path in library.candidates()]
    assert found == ["libLLVM.so.19.1", "libLLVM-16.so.1"]
