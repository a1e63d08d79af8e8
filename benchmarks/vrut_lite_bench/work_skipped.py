"""Work asked, done and skipped in scenes that need little, as a Markdown table.

    python -m vrut_lite_bench.work_skipped [--size 480x300]

Each scene is played through twice, frame by frame: as it is, and with everything done that a
frame may leave out. What the second play did was asked; what the first did not do of it was
skipped. What the modules leave out cannot be switched off: of light, all three messages are
asked for each frame. The last column is the largest difference between the pictures of both
plays, in steps of 8 bits.
"""

import argparse
import time
from collections.abc import Iterable, Iterator
from dataclasses import fields
from datetime import timedelta
from pathlib import Path
from typing import NamedTuple

import numpy as np

from vrut_lite.daylight.scene_state import FrameSkips
from vrut_lite.host import Host
from vrut_lite.kernel.ledger import Ledger
from vrut_lite.kernel.messages import SetClock
from vrut_lite.pictures.picture import Picture
from vrut_lite.project import Project, daylight_inputs, view_inputs

SCENES = Path(__file__).resolve().parents[2] / "scenes"
# A closed room, a camera to the ground, a small indoor scene, a planet, and a street.
PLAYED = {
    "closed room": SCENES / "work" / "room.glb",
    "camera to the ground": SCENES / "work" / "ground.glb",
    "small indoor scene": SCENES / "work" / "indoor.glb",
    "planet-sized": SCENES / "work" / "planet.glb",
    "street": SCENES / "street.obj",
}
NOTHING = FrameSkips(**{field.name: False for field in fields(FrameSkips)})
_LATER = (timedelta(0), timedelta(0), timedelta(seconds=1), timedelta(minutes=20))
_LIGHT = ("BackgroundChanged", "KeyLightChanged", "AmbientChanged")


class Play(NamedTuple):
    """What one play through a scene drew, what frame and sky counted, CPU time of each frame."""

    pictures: list[Picture]
    frame: Ledger
    sky: Ledger
    spent_s: list[float]


def play(path: Path, size: tuple[int, int], skips: FrameSkips) -> Play:
    """Four frames: the first; the same again; a second later; twenty minutes later."""
    return play_frames(Project(scene=str(path), at="2026-06-21T16:00", size=size), skips, _LATER)


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
        sky = host.kernel.seats["dynamic_skylight"].ledger
        return Play(pictures, host.frame_ledger, sky, spent_s)


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
    # What was told again as it was, the same instant say, reaches no module.
    spared["no news"] = asked - done - sum(spared.values())
    yield "light: sky, sun, ambient", asked, done, _in_words(spared)


def _in_words(reasons: dict[str, int]) -> str:
    return ", ".join(f"{reason} ({count:,})" for reason, count in reasons.items() if count)


def report(size: tuple[int, int]) -> Iterator[str]:
    """The table's lines."""
    yield "| scene | work | asked | done | skipped | spared by | steps of 8 bits |"
    yield "|---|---|---:|---:|---:|---|---:|"
    for name, path in PLAYED.items():
        one, everything = (play(path, size, skips) for skips in (FrameSkips(), NOTHING))
        steps = difference(one, everything)
        for work, asked, done, why in rows(one, everything):
            yield f"| {name} | {work} | {asked:,} | {done:,} | {asked - done:,} | {why} | {steps} |"


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description="Work asked, done and skipped, by scene.")
    parser.add_argument("--size", default="480x300", help="WIDTHxHEIGHT in pixels")
    width, _, height = parser.parse_args().size.partition("x")
    for line in report((int(width), int(height))):
        print(line)


if __name__ == "__main__":
    main()
