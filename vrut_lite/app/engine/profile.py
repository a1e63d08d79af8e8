"""Time spent in modules, jobs and passes, and skipped work; taken on the engine's thread."""

from collections import Counter
from time import perf_counter_ns
from typing import NamedTuple

from vrut_lite.app.engine.stage import Stage
from vrut_lite.kernel.work_counters import WorkCounters
from vrut_lite.render.device import Device
from vrut_lite.sky.device_choice import DeviceChoice
from vrut_lite.sky.sky_sum import SkySum

FRAME = "frame"


class Profile(NamedTuple):
    """A time span of `span_s`; milliseconds by name.

    `modules` and `jobs` are sums over that time, `passes` those of a frame; `skipped`
    counts skipped work by the module or frame that skipped it and the kind of work. `device` is the
    renderer, None without OpenGL. `devices` says of products that a card may compute, by name,
    whether card or processor computes them and why.
    """

    span_s: float
    modules: dict[str, float]
    jobs: dict[str, float]
    passes: dict[str, float]
    skipped: dict[tuple[str, str], int]
    device: Device | None = None
    devices: dict[str, DeviceChoice] | None = None


class Counts(NamedTuple):
    """A counters, with its counts of skipped work at one moment."""

    counters: WorkCounters
    skipped: Counter[str]


class Profiler:
    """Takes profiles, each of the time since the one before."""

    def __init__(self, stage: Stage):
        self._stage = stage
        self._since_ns = perf_counter_ns()
        self._ledgers = self._snapshot()
        stage.measure_next()

    def take(self) -> Profile:
        """The time until now."""
        now_ns = perf_counter_ns()
        since_ns, self._since_ns = self._since_ns, now_ns
        before, self._ledgers = self._ledgers, self._snapshot()
        self._stage.measure_next()
        return Profile(
            span_s=(now_ns - since_ns) / 1e9,
            modules=self._modules_ms(since_ns),
            jobs=self._jobs_ms(since_ns),
            passes={name: 1e3 * s for name, s in self._stage.pass_seconds.items()},
            skipped=_grown(before, self._ledgers),
            device=self._stage.device,
            devices=self._devices(),
        )

    def _devices(self) -> dict[str, DeviceChoice]:
        """The choices in `devices` of the slots' holders and of the sum of skies."""
        kernel = self._stage.kernel
        found: dict[str, DeviceChoice] = {}
        for name, seat in kernel.seats.items():
            if kernel.slots.held_by(name) or name == SkySum.manifest.name:
                found |= getattr(seat.module, "devices", {})
        return found

    def _modules_ms(self, since_ns: int) -> dict[str, float]:
        spent: Counter[str] = Counter()
        for delivery in reversed(self._stage.kernel.trace.deliveries.copy()):
            receiver, start_ns, end_ns = delivery[4], delivery[5], delivery[6]
            if end_ns < since_ns:
                break
            if receiver:
                spent[receiver] += end_ns - start_ns
        return {name: ns / 1e6 for name, ns in spent.most_common()}

    def _jobs_ms(self, since_ns: int) -> dict[str, float]:
        """The whole time of the jobs that ended in this span."""
        spent: Counter[str] = Counter()
        for remark in self._stage.kernel.trace.remarks():
            if remark.kind == "job" and remark.end_ns >= since_ns:
                spent[f"{remark.module}: {remark.text}"] += remark.end_ns - remark.start_ns
        return {name: ns / 1e6 for name, ns in spent.most_common()}

    def _snapshot(self) -> dict[str, Counts]:
        counters_by_owner = {name: seat.counters for name, seat in self._stage.kernel.seats.items()}
        counters_by_owner[FRAME] = self._stage.frame_counters
        return {
            owner: Counts(counters, counters.skipped.copy())
            for owner, counters in counters_by_owner.items()
        }


def _grown(before: dict[str, Counts], after: dict[str, Counts]) -> dict[tuple[str, str], int]:
    """The growth of the counts; those of a restarted module count from zero."""
    grown = {}
    for owner, counts in after.items():
        old = before.get(owner)
        known = old.skipped if old and old.counters is counts.counters else Counter()
        for work, count in (counts.skipped - known).items():
            grown[owner, work] = count
    return grown
