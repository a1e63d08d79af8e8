"""A scene backend that draws nothing and remembers what it was told."""

from collections.abc import Callable
from typing import Any

import numpy as np

from vrut_lite.scene.backend import Picture


class RecordingBackend:
    """A `SceneBackend` for tests and machines without GL.

    `told` holds (name of the call, its arguments) in order; `latest` the last arguments of
    each call. `draw` gives a black picture of the size asked for.
    """

    def __init__(self) -> None:
        self.told: list[tuple[str, tuple[Any, ...]]] = []
        self.latest: dict[str, tuple[Any, ...]] = {"set_size": (960, 540)}

    def __getattr__(self, name: str) -> Callable[..., None]:
        if name != "show_scene" and not name.startswith("set_"):
            raise AttributeError(name)

        def remember(*arguments: Any) -> None:
            self.told.append((name, arguments))
            self.latest[name] = arguments

        return remember

    def draw(self, still: bool = True) -> Picture:
        """A black picture."""
        width, height = self.latest["set_size"]
        return Picture(
            np.zeros((height, width, 3), np.float32), np.zeros((height, width, 3), np.uint8), 0.0
        )
