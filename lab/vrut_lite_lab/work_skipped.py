"""Work asked, done and skipped in five scenes over a scripted day, and the time that it saves.

    python -m vrut_lite_lab.work_skipped [--size 320x200]

The day has seven hours from before sunrise to night. At each the frame is drawn, drawn again with
nothing changed, and again a second later. Each scene is played twice: as it is, and with everything
done that a frame may leave out. What the second play did was asked; what the first did not do of it
was skipped. What the modules leave out cannot be switched off: of light, all three messages are
asked for each frame. The last column is the largest difference between the pictures of both plays,
in steps of 8 bits. Times are CPU time of all threads, the least of three plays for each frame: on
llvmpipe, what the passes cost a processor, not a graphics card.
"""

import argparse
import time
from collections.abc import Iterable, Iterator
from datetime import timedelta
from typing import NamedTuple

import msgspec
import numpy as np

from vrut_lite.host import Host
from vrut_lite.kernel.messages import SetClock
from vrut_lite.kernel.work_counters import WorkCounters
from vrut_lite.pictures.picture import Picture
from vrut_lite.project import Project, daylight_inputs, load_project, view_inputs
from vrut_lite.scene.scene_state import FrameSkips
from vrut_lite_lab.bench.paths.frame import NOTHING
from vrut_lite_lab.checkout import ROOT

SCENES = ROOT / "scenes"
DAY_SCENES = {
    "sundial": SCENES / "sundial.toml",
    "street": SCENES / "street.toml",
    "spheres": SCENES / "spheres.glb",
    "pavilion": SCENES / "pavilion.gltf",
    "terrain": SCENES / "large" / "terrain.toml",
}
_START = "2026-06-21T04:00"
_HOURS = (0.0, 1.5, 5.0, 9.0, 13.0, 17.25, 19.0)
_LATERS = tuple(
    timedelta(hours=hour, seconds=second) for hour in _HOURS for second in (0.0, 0.0, 1.0)
)
_PLAYS = 3
_LIGHT = ("BackgroundChanged", "KeyLightChanged", "AmbientChanged")


class Play(NamedTuple):
    """One play through a scene: its pictures, the counts of frame and sky, CPU time of each
    frame."""

    pictures: list[Picture]
    frame: WorkCounters
    sky: WorkCounters
    spent_s: list[float]


def play_frames(project: Project, skips: FrameSkips, laters: Iterable[timedelta]) -> Play:
    """A frame at each of some times after the project's own."""
    with Host(cube_size=64) as host:
        host.frame_skips = skips
        host.inject(*daylight_inputs(project), *view_inputs(project))
        host.settle()
        pictures, spent_s = [], []
        for later in laters:
            start_s = time.process_time()
            host.inject(SetClock(instant=project.instant() + later))
            pictures.append(host.draw())
            spent_s.append(time.process_time() - start_s)
        sky = host.kernel.seats["dynamic_skylight"].counters
        return Play(pictures, host.frame_counters, sky, spent_s)


def difference(one: Play, other: Play) -> int:
    """The largest of all pixels of all frames, in steps of 8 bits."""
    return max(
        int(np.abs(a.display.astype(int) - b.display.astype(int)).max())
        for a, b in zip(one.pictures, other.pictures, strict=True)
    )


def rows(one: Play, everything: Play) -> Iterator[tuple[str, int, int, str]]:
    """Work, how much of it was asked, how much was done, and how often what spared the rest."""
    for work, asked in sorted(everything.frame.done.items()):
        kind = work.removesuffix(" slice")
        reasons = {
            reason.partition(": ")[2]: count
            for reason, count in one.frame.skipped.items()
            if count and reason.startswith(kind + ":")
        }
        yield work, asked, one.frame.done[work], _in_words(reasons)
    done = sum(one.sky.done[kind] for kind in _LIGHT)
    spared = {
        why: sum(one.sky.skipped[f"{kind} {why}"] for kind in _LIGHT)
        for why in ("unwanted", "unchanged")
    }
    asked = len(one.pictures) * len(_LIGHT)
    # The same instant told again reaches no module.
    spared["no news"] = asked - done - sum(spared.values())
    yield "light: sky, sun, ambient", asked, done, _in_words(spared)


def _in_words(reasons: dict[str, int]) -> str:
    return ", ".join(f"{reason} ({count:,})" for reason, count in reasons.items() if count)


def report(size: tuple[int, int]) -> Iterator[str]:
    """The lines of both tables: of work, and of time."""
    times = []
    yield "| scene | work | asked | done | skipped | spared by | steps of 8 bits |"
    yield "|---|---|---:|---:|---:|---|---:|"
    for name, path in DAY_SCENES.items():
        own = load_project(path) if path.suffix == ".toml" else Project(scene=str(path))
        project = msgspec.structs.replace(own, at=_START, size=size)
        plays = [
            play_frames(project, skips, _LATERS)
            for _ in range(_PLAYS)
            for skips in (FrameSkips(), NOTHING)
        ]
        one, everything = plays[:2]
        steps = difference(one, everything)
        for work, asked, done, why in rows(one, everything):
            yield f"| {name} | {work} | {asked:,} | {done:,} | {asked - done:,} | {why} | {steps} |"
        least_s, most_s = (_least_s(plays[k::2]) for k in (0, 1))
        times.append(f"| {name} | {most_s:.2f} | {least_s:.2f} | {1.0 - least_s / most_s:.0%} |")
    yield from ("", "| scene | everything, s | as it is, s | saved |", "|---|---:|---:|---:|")
    yield from times


def _least_s(plays: list[Play]) -> float:
    """CPU time of a day: of each frame the least."""
    return sum(min(spent) for spent in zip(*(play.spent_s for play in plays), strict=True))


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description="Work of a day by scene, and the time saved.")
    parser.add_argument("--size", default="320x200", help="WIDTHxHEIGHT in pixels")
    width, _, height = parser.parse_args().size.partition("x")
    for line in report((int(width), int(height))):
        print(line, flush=True)


if __name__ == "__main__":
    main()
