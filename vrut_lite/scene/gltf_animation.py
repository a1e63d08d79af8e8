"""glTF's animations: how long they last, and the pose of the nodes at a time."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vrut_lite.scene.gltf_file import GltfFile, item_at, normalised
from vrut_lite.scene.gltf_nodes import REST, Pose
from vrut_lite.scene.gltf_schema import Animation, AnimationChannel, AnimationSampler
from vrut_lite.scene.scene_file_error import SceneFileError

_WIDTHS = {"translation": 3, "rotation": 4, "scale": 3}
# Numbers are kept in 64 bits, stored ones may have 8.
_KEY_BYTES = 8
# Cosine of two quaternions above which they are interpolated linearly.
_NEARLY_ONE = 1.0 - 1e-9


class _Track(NamedTuple):
    """One part of a node over time: keys at times_s (n,), values (n or 3 n, width)."""

    node: int
    path: str
    times_s: NDArray[np.float64]
    values: NDArray[np.float64]
    interpolation: str


class GltfAnimations:
    """All animations of a file, played together; of several that move the same, the first does.

    Raises:
        SceneFileError: for keys that are missing, unordered, of the wrong width, or too many.
    """

    def __init__(self, file: GltfFile) -> None:
        self._file = file
        self._keys: dict[int, tuple[NDArray[np.float64], NDArray[np.float64]]] = {}
        self._tracks = [self._track(channel, sampler) for channel, sampler in _channels(file)]

    @property
    def duration_s(self) -> float:
        """When the last of them has ended; 0 without any."""
        return max((float(track.times_s[-1]) for track in self._tracks), default=0.0)

    @property
    def nodes(self) -> set[int]:
        """The numbers of the nodes that they move."""
        return {track.node for track in self._tracks}

    def pose(self, time_s: float | None) -> Pose:
        """The pose at a time, seconds; None is the rest."""
        if time_s is None:
            return REST
        moved: dict[int, dict[str, tuple[float, ...]]] = {}
        for track in self._tracks:
            turns = track.path == "rotation"
            value = sampled(track.times_s, track.values, track.interpolation, time_s, turns=turns)
            moved.setdefault(track.node, {})[track.path] = tuple(value.tolist())
        return Pose(moved)

    def _track(self, channel: AnimationChannel, sampler: AnimationSampler) -> _Track:
        node, path = channel.target.node, channel.target.path
        assert node is not None
        if id(sampler) not in self._keys:
            self._keys[id(sampler)] = self._read(sampler)
        times, values = self._keys[id(sampler)]
        keys = len(times) * (3 if sampler.interpolation == "CUBICSPLINE" else 1)
        width = _WIDTHS.get(path) or values.size // keys
        if not width or values.size != keys * width:
            raise SceneFileError(
                f"an animation of node {node} has {values.size} values for {len(times)} keys; "
                "export it again"
            )
        return _Track(node, path, times, values.reshape(keys, width), sampler.interpolation)

    def _read(self, sampler: AnimationSampler) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Times (n,) and values, as they come."""
        file, budget = self._file, self._file.folder.budget
        for number in (sampler.input, sampler.output):
            budget.ask(file.accessor_bytes(number), "the keys of an animation")
            budget.take(_KEY_BYTES * file.accessor_bytes(number), "the keys of an animation")
        times = file.array(sampler.input)[:, 0].astype(np.float64)
        stored = file.array(sampler.output)
        values = normalised(stored) if file.accessor(sampler.output).normalized else stored
        values = values.astype(np.float64)
        if not (np.all(np.isfinite(times)) and np.all(np.diff(times) >= 0)):
            raise SceneFileError("the times of an animation are not in order; export it again")
        if not np.all(np.isfinite(values)):
            raise SceneFileError("an animation has values that are not finite; export it again")
        return times, values


def sampled(
    times_s: NDArray[np.float64],
    values: NDArray[np.float64],
    interpolation: str,
    time_s: float,
    *,
    turns: bool,
) -> NDArray[np.float64]:
    """The value (width,) of keys (n, width) at a time (glTF 2.0, appendix C).

    A spline has three rows a key: in-tangent, value, out-tangent. `turns`: quaternions.
    """
    after = int(np.searchsorted(times_s, time_s, side="right"))
    low, high = max(after - 1, 0), min(after, len(times_s) - 1)
    step_s = float(times_s[high] - times_s[low])
    share = (time_s - float(times_s[low])) / step_s if step_s > 0 and after > 0 else 0.0
    if interpolation == "CUBICSPLINE":
        value = _spline(values.reshape(len(times_s), 3, -1), low, high, share, step_s)
        return value / max(float(np.linalg.norm(value)), 1e-12) if turns else value
    if interpolation == "STEP":
        return values[low]
    if turns:
        return _slerp(values[low], values[high], share)
    return (1.0 - share) * values[low] + share * values[high]


def _spline(
    keys: NDArray[np.float64], low: int, high: int, share: float, step_s: float
) -> NDArray[np.float64]:
    t, t2, t3 = share, share**2, share**3
    return np.asarray(
        (2 * t3 - 3 * t2 + 1) * keys[low, 1]
        + step_s * (t3 - 2 * t2 + t) * keys[low, 2]
        + (3 * t2 - 2 * t3) * keys[high, 1]
        + step_s * (t3 - t2) * keys[high, 0]
    )


def _slerp(
    low: NDArray[np.float64], high: NDArray[np.float64], share: float
) -> NDArray[np.float64]:
    """Between two quaternions the shorter way (Shoemake 1985)."""
    cosine = float(low @ high)
    if cosine < 0:
        high, cosine = -high, -cosine
    if cosine > _NEARLY_ONE:
        return (1.0 - share) * low + share * high
    angle = np.arccos(cosine)
    return np.asarray(
        (np.sin((1.0 - share) * angle) * low + np.sin(share * angle) * high) / np.sin(angle)
    )


def _channels(file: GltfFile) -> Iterator[tuple[AnimationChannel, AnimationSampler]]:
    """The channels that move nodes: of each part of a node, those of the first animation."""
    taken: dict[tuple[int, str], Animation] = {}
    contended = 0
    for animation in file.document.animations:
        for channel in animation.channels:
            target = channel.target
            if target.node is None or target.path not in (*_WIDTHS, "weights"):
                file.notices.tell(f"animation of {target.path}", "at rest")
                continue
            owner = taken.setdefault((target.node, target.path), animation)
            if owner is not animation:
                contended += 1
                continue
            yield channel, item_at(animation.samplers, channel.sampler, "animation sampler")
    file.notices.tell("part moved by several animations", "the first moves it", contended)
