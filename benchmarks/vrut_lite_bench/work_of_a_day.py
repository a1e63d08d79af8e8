"""Work asked, done and skipped in five scenes over a scripted day, and the time that it saves.

    python -m vrut_lite_bench.work_of_a_day [--size 320x200]

The day has seven hours from before sunrise to night. At each the frame is drawn, drawn again
with nothing changed, and again a second later. Each scene is played as it is and with nothing
left out: what the second play did was asked. Times are CPU time of all threads, the least of three
plays for each frame; they tell what the passes of llvmpipe cost, not those of a graphics card.
"""

import argparse
from collections.abc import Iterator
from datetime import timedelta

import msgspec

from vrut_lite.daylight.scene_state import FrameSkips
from vrut_lite.project import Project, load_project
from vrut_lite_bench.work_skipped import NOTHING, SCENES, Play, difference, play_frames, rows

DAY_SCENES = {
    "sundial": SCENES / "sundial.toml",
    "street": SCENES / "street.toml",
    "spheres": SCENES / "spheres.glb",
    "pavilion": SCENES / "pavilion.gltf",
    "terrain": SCENES / "large" / "terrain.toml",
}
_START = "2026-06-21T04:00"
_HOURS = (0.0, 1.5, 5.0, 9.0, 13.0, 17.25, 19.0)
LATERS = tuple(
    timedelta(hours=hour, seconds=second) for hour in _HOURS for second in (0.0, 0.0, 1.0)
)
_PLAYS = 3


def play_day(name: str, size: tuple[int, int], skips: FrameSkips) -> Play:
    """The scripted day in one of the scenes."""
    path = DAY_SCENES[name]
    is_project = path.suffix == ".toml"
    project = load_project(path) if is_project else Project(scene=str(path))
    return play_frames(msgspec.structs.replace(project, at=_START, size=size), skips, LATERS)


def report(size: tuple[int, int]) -> Iterator[str]:
    """The lines of both tables: of work, and of time."""
    times = []
    yield "| scene | work | asked | done | skipped | spared by | steps of 8 bits |"
    yield "|---|---|---:|---:|---:|---|---:|"
    for name in DAY_SCENES:
        plays = [play_day(name, size, s) for _ in range(_PLAYS) for s in (FrameSkips(), NOTHING)]
        one, everything = plays[:2]
        steps = difference(one, everything)
        for work, asked, done, why in rows(one, everything):
            yield f"| {name} | {work} | {asked:,} | {done:,} | {asked - done:,} | {why} | {steps} |"
        least_s, most_s = (_least_s(plays[k::2]) for k in (0, 1))
        share = 1.0 - least_s / most_s
        times.append(f"| {name} | {most_s:.2f} | {least_s:.2f} | {share:.0%} |")
    yield ""
    yield "| scene | everything, s | as it is, s | saved |"
    yield "|---|---:|---:|---:|"
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
