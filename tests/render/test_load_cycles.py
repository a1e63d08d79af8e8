"""Scenes come and go: nothing of them stays, neither in memory nor on the GPU."""

import gc
from pathlib import Path

import numpy as np
import pytest
from scene_stage import light, look, square, surface
from stateful_backend import StatefulBackend, opened

from vrut_lite.messages.ground_disc import GroundDisc

pytestmark = pytest.mark.gl
_HIGHEST_NAME = 4000
_WARM_UP = 12
_PAGES_BYTES = 4096


def gl_objects():
    """How many GL objects of each kind there are."""
    from OpenGL import GL

    kinds = (GL.glIsTexture, GL.glIsBuffer, GL.glIsVertexArray, GL.glIsFramebuffer,
             GL.glIsRenderbuffer, GL.glIsProgram, GL.glIsShader, GL.glIsQuery)  # fmt: skip
    return {kind.__name__: sum(map(bool, map(kind, range(1, _HIGHEST_NAME)))) for kind in kinds}


def resident_bytes():
    """The process's resident memory."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * _PAGES_BYTES


@pytest.mark.long
def test_scenes_leave_nothing_behind(gl_owner, tmp_path, request):
    """Load, render, unload, always another scene: no GL object more, memory within 8 MB.

    Eight cycles, or as many as --scene-cycles says; the first few fill the caches of programs.
    """
    from vrut_lite.render.pyrender_backend import PyrenderBackend

    image = np.full((64, 64, 3), 90, np.uint8)
    textured = surface(0.0, 0.6)
    textured["pbrMetallicRoughness"]["baseColorTexture"] = {"index": 0}
    paths = []
    for number in range(4):
        folder = tmp_path / str(number)
        folder.mkdir()
        material, images = (textured, [image]) if number % 2 else (surface(1.0, 0.2), [])
        nodes = [{"mesh": 0, "translation": [0, 0.1 * n, 0]} for n in range(1 + number)]
        paths.append(square(folder, material, images, nodes=nodes))
    backend = StatefulBackend(PyrenderBackend(gl_owner), size_px=(64, 48))

    def cycle(number):
        ground = GroundDisc((0.0, 0.0), -1.0, 50.0) if number % 3 else None
        backend.change(scene=opened(paths[number % 4], ground))
        size = 16 if number % 2 else 48
        light(backend, np.full((6, size, size, 3), 1.0 + 0.1 * (number % 5)))
        look(backend, (0.0, 1.0, 1.0 + 0.01 * number), (0, 0, 0))

    for number in range(_WARM_UP):
        cycle(number)
    gc.collect()
    objects, resident = gl_owner.call(lambda _: gl_objects()), resident_bytes()
    assert objects["glIsTexture"] > 0
    # Whole rounds of scenes, grounds and sky sizes, so that the last is like the first.
    cycles = request.config.getoption("--scene-cycles") // _WARM_UP * _WARM_UP
    for number in range(_WARM_UP, _WARM_UP + cycles):
        cycle(number)
    gc.collect()
    assert gl_owner.call(lambda _: gl_objects()) == objects
    assert resident_bytes() - resident < 8e6
    backend.backend.close()


@pytest.mark.long
def test_a_closed_backend_leaves_nothing_on_the_gpu(gl_owner, tmp_path):
    """Windows come and go in one process: the context outlives them all."""
    from vrut_lite.render.pyrender_backend import PyrenderBackend

    def live():
        scene = opened(square(tmp_path, surface(1.0, 0.3)))
        backend = StatefulBackend(PyrenderBackend(gl_owner), size_px=(32, 32), scene=scene)
        light(backend, np.ones((6, 16, 16, 3)))
        look(backend, (0, 1, 0.1), (0, 0, 0))
        backend.backend.close()
        gc.collect()

    live()
    before = gl_owner.call(lambda _: gl_objects())
    for _ in range(3):
        live()
    assert gl_owner.call(lambda _: gl_objects()) == before
