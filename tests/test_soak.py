"""No leaks after a day in fast motion and after many scenes."""

import ctypes
import gc
import sys
import time
from pathlib import Path

import pytest

from vrut_lite.daylight_kernel import FaultCollector, daylight_kernel, demand_light
from vrut_lite.kernel.messages import SetClockRate, Tick
from vrut_lite.messages.sky import BackgroundChanged
from vrut_lite.project import Project, daylight_inputs, view_inputs

ROOT = Path(__file__).parents[1]
SCENES = sorted(
    path
    for folder in ("scenes", "scenes/work", "tests/data/models")
    for path in (ROOT / folder).iterdir()
    if path.suffix in {".glb", ".gltf", ".obj"}
)
# Rounds of all scenes after which caches and memory arenas have their final size.
WARM_UP_ROUNDS = 2
# The heap varies by 30 MB from one round of scenes to the next.
MOST_GROWTH_BYTES = 40e6
PAGE_BYTES = 4096
# Drivers give objects rising names; these numbers far exceed what a scene needs.
FIRST_NAMES, NAMES_A_SCENE = 4000, 120
TICKS_A_MINUTE = 3600
WARM_UP_TICKS = 100


@pytest.fixture
def kernel():
    kernel, _ = daylight_kernel()
    yield kernel
    kernel.close()


@pytest.mark.long
def test_play_leaves_nothing_behind(kernel, request):
    """The clock plays at 60 Hz, 24 times as fast as the sun: an hour of play is a day.

    Memory and receivers at the end as at the start (within 2,000 blocks: caches of a few
    hours' light); no fault; a few seconds by default, as many minutes as --soak-minutes says.
    """
    faults, skies = FaultCollector(kernel), []
    kernel.tap(lambda message, _: skies.append(1) if type(message) is BackgroundChanged else None)
    demand_light(kernel, "soak", 16)
    for message in [*daylight_inputs(Project(at="2026-06-21T00:00")), SetClockRate(rate=24.0)]:
        kernel.inject(message)
    kernel.pump()

    def play(ticks):
        for _ in range(ticks):
            kernel.inject(Tick(elapsed_s=1 / 60))
            kernel.pump()
        gc.collect()

    # Memory grows by design until the trace's ring is full.
    ring = kernel.trace.deliveries
    play(WARM_UP_TICKS)
    ring.extend(
        (*ring[-1][:-2], time.perf_counter_ns(), n)
        for n in range(10**6, 10**6 + 2 * (ring.maxlen or 0))
    )
    play(WARM_UP_TICKS)
    blocks = sys.getallocatedblocks()
    methods = {name: seat.methods for name, seat in kernel.seats.items()}
    skies.clear()
    play(int(request.config.getoption("--soak-minutes") * TICKS_A_MINUTE))
    assert faults.faults == []
    assert {name: seat.methods for name, seat in kernel.seats.items()} == methods
    # The test's own list of skies does not count.
    assert sys.getallocatedblocks() - blocks < 2000
    assert skies


def gl_objects(highest_name):
    """Number of GL objects of each kind; call it on the GL thread."""
    from OpenGL import GL

    kinds = (GL.glIsTexture, GL.glIsBuffer, GL.glIsVertexArray, GL.glIsFramebuffer,
             GL.glIsRenderbuffer, GL.glIsProgram, GL.glIsShader, GL.glIsQuery)  # fmt: skip
    return {kind.__name__: sum(map(bool, map(kind, range(1, highest_name)))) for kind in kinds}


def resident_bytes():
    """Resident memory after the C library has returned unused memory."""
    gc.collect()
    ctypes.CDLL(None).malloc_trim(0)
    return int(Path("/proc/self/statm").read_text().split()[1]) * PAGE_BYTES


@pytest.mark.long
@pytest.mark.gl
def test_scenes_come_and_go_in_one_host(request):
    """After all scenes in turn no GL object or scene is left over; memory grows below 40 MB.

    From file to picture, at another hour each time; whole rounds, so that the last scene is
    the first measurement's. --scene-cycles says how many.
    """
    from vrut_lite.host import Host
    from vrut_lite.render.pyrender_scene import PyrenderScene
    from vrut_lite.scene.loading import LoadedScene

    def scenes_alive():
        return sum(isinstance(thing, LoadedScene | PyrenderScene) for thing in gc.get_objects())

    def round_of_scenes(host, number):
        for place, scene in enumerate(SCENES):
            hour = 6 + (number + place) % 14
            project = Project(scene=str(scene), at=f"2026-06-21T{hour:02d}:00", size=(48, 32))
            host.inject(*daylight_inputs(project), *view_inputs(project))
            host.draw()

    rounds = max(1, request.config.getoption("--scene-cycles") // len(SCENES))
    highest = FIRST_NAMES + NAMES_A_SCENE * len(SCENES) * (WARM_UP_ROUNDS + rounds)
    with Host(cube_size=16) as host:
        for number in range(WARM_UP_ROUNDS):
            round_of_scenes(host, number)
        objects, memory = host.gl.call(lambda _: gl_objects(highest)), resident_bytes()
        alive = scenes_alive()
        assert objects["glIsBuffer"] > 0
        for number in range(rounds):
            round_of_scenes(host, number)
        assert host.gl.call(lambda _: gl_objects(highest)) == objects
        assert resident_bytes() - memory < MOST_GROWTH_BYTES
        assert scenes_alive() == alive > 0
