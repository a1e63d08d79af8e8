"""Per-renderer settings: a table, selected by a trial of at most one second.

The same shaders serve a graphics card and a processor (llvmpipe). The user's cache stores the
trial's time by renderer name and driver version.
"""

import json
from contextlib import suppress
from time import perf_counter
from typing import Any, NamedTuple

from vrut_lite.errors import UserError
from vrut_lite.render.shader_files import shader_source
from vrut_lite.render.software_names import is_software
from vrut_lite.write_atomic import atomic_output

_EDGE_PX, _ROUNDS = 256, 3
_TRIAL = """#version 430 core
in vec2 at;
out vec4 colour;
void main() {
    float x = at.x;
    for (int k = 0; k < 60; ++k) x = sin(x) + at.y;
    colour = vec4(x);
}
"""


class Choices(NamedTuple):
    """A row of the table.

    Attributes:
        name: kind of renderer.
        least_trial_ns: least time of a trial pixel; the last row that a renderer reaches applies.
        takes_over: pictures have one sample per pixel: a still is the mean of several, a moving
            picture is antialiased and reuses pixels of the previous one. Otherwise both are one
            multisampled picture.
        expected_s: expected time of a window's picture, until the first is drawn.
    """

    name: str
    least_trial_ns: float
    takes_over: bool
    expected_s: float


# Trial times: 0.1 to 1 ns on a card, 50 to 200 on llvmpipe.
TABLE = (
    Choices("graphics card", 0.0, takes_over=False, expected_s=0.0),
    Choices("processor", 10.0, takes_over=True, expected_s=1.0),
)


class Device(NamedTuple):
    """A renderer, its driver's version, and the trial's nanoseconds a pixel.

    `is_software`: it draws on a processor, by its name; false where the trial's time was given.
    """

    renderer: str
    version: str
    trial_ns: float
    is_software: bool = False

    @property
    def choices(self) -> Choices:
        """The row of this renderer."""
        if self.is_software:
            return TABLE[-1]
        return next(row for row in reversed(TABLE) if self.trial_ns >= row.least_trial_ns)


def device_of(context: Any, trial_ns: float | None = None) -> Device:
    """The context's renderer, timed unless its time is cached or given; on the GL thread."""
    renderer, version = context.info["GL_RENDERER"], context.info["GL_VERSION"]
    if trial_ns is not None:
        return Device(renderer, version, trial_ns)
    key = f"{renderer} | {version}"
    known = _known()
    kept = known.get(key)
    if not isinstance(kept, float):
        kept = _trial_ns(context)
        _keep({**known, key: kept})
    return Device(renderer, version, kept, is_software(renderer))


def _trial_ns(context: Any) -> float:
    size = (_EDGE_PX, _EDGE_PX)
    program = context.program(
        vertex_shader=shader_source("full_screen.vert"), fragment_shader=_TRIAL
    )
    triangle = context.vertex_array(program, [])
    target = context.simple_framebuffer(size)
    target.use()
    rounds_s = []
    # The first round compiles.
    for _ in range(1 + _ROUNDS):
        start_s = perf_counter()
        triangle.render(vertices=3)
        context.finish()
        rounds_s.append(perf_counter() - start_s)
    context.extra.use()
    for thing in (target, triangle, program):
        thing.release()
    return 1e9 * min(rounds_s[1:]) / (size[0] * size[1])


def _file() -> Any:
    from platformdirs import user_cache_path

    return user_cache_path("vrut_lite") / "devices.json"


def _known() -> dict[str, Any]:
    """Trial times by renderer and version; empty if the file is missing or damaged."""
    with suppress(OSError, ValueError):
        content = json.loads(_file().read_text(encoding="utf-8"))
        return content if isinstance(content, dict) else {}
    return {}


def _keep(times: dict[str, Any]) -> None:
    """Store trial times; without a writable folder each start repeats the trial."""
    with suppress(OSError, UserError):
        _file().parent.mkdir(parents=True, exist_ok=True)
        with atomic_output(_file()) as beside:
            beside.write_text(json.dumps(times), encoding="utf-8")
