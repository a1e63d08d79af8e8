"""An hour's light between surfaces on the card, as work that is timed and read."""

from collections.abc import Callable
from typing import Any

import numpy as np
from light_transport.drawing.hour_on_card import HourOnCard
from light_transport.hour.illumination import Illumination
from light_transport.transport import SceneTransport
from numpy.typing import NDArray

from vrut_lite.kernel.work_counters import WorkCounters
from vrut_lite.render.frame_parts import PartRenderer
from vrut_lite.render.tiles import Patience
from vrut_lite_lab.bench.gl import GlWork, gl_owner, on_close


class LightOnCard(GlWork):
    """The light map and the mirrors of an hour: inputs uploaded, all computed and written.

    If it is the bake's `first` hour, each run uploads the tables too, in pieces as between
    pictures; the programs are compiled once.
    """

    def __init__(self, transport: SceneTransport, hour: Illumination, first: bool = False):
        self._hour, self._first = transport.card_hour(hour), first
        super().__init__(self._prepare)
        on_close(lambda: gl_owner().call(lambda _: self._card.release()))

    def _prepare(self, context: Any) -> Callable[[], None]:
        counters = WorkCounters()
        gl = PartRenderer(context, counters, Patience(counters), lambda *why: None)
        self._card = HourOnCard(gl)
        height, width = self._hour.tables.shown.shape
        self._map = context.texture((width, height), 4, dtype="f4")
        target = self._hour.tables.target
        self._cubes = [
            context.texture_cube((cube.shape[1],) * 2, 4, dtype="f4")
            for cube in (() if target is None else target)
        ]

        def work() -> None:
            # Equal inputs that are other objects are computed again.
            hour = self._hour._replace(inputs=self._hour.inputs._replace())
            if self._first:
                self._card.release()
            while not self._card.compute(hour, most_pieces=1 if self._first else None):
                pass
            self._card.write_map(self._map)
            for number, cube in enumerate(self._cubes):
                self._card.write_mirror(number, cube)

        return work

    def read(self) -> dict[str, NDArray[np.float32]]:
        """`texels` (height, width, 4), and `mirrors` (C, 6, e, e, 4) where there are any."""
        return gl_owner().call(lambda _: self._read())

    def _read(self) -> dict[str, NDArray[np.float32]]:
        found = {"texels": _floats(self._map.read(), self._map.size)}
        if self._cubes:
            faces = [
                [_floats(cube.read(face), cube.size) for face in range(6)] for cube in self._cubes
            ]
            found["mirrors"] = np.array(faces)
        return found


def _floats(data: bytes, size: tuple[int, int]) -> NDArray[np.float32]:
    return np.frombuffer(data, np.float32).reshape(*size[::-1], 4)
