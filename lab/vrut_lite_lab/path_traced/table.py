"""The present frame against the truths on disk: a table and a sheet, in a minute or so.

    python -m vrut_lite_lab.path_traced.table SHEET.jpg [--sky NAME] [SCENE ...]

Prague, 21 June, turbidity 3 and ground of albedo 0.1, no air. FLIP is HDR-FLIP against the denoised
truth; the floor is that between two truths of different seeds, denoised alike; regions are
differences of mean luminance against the truths as they were traced. What is not on disk is
left out: trace_truths puts it there. Needs the extra `ref`.
"""

import argparse
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from vrut_lite.pictures.display import display_picture
from vrut_lite_lab.path_traced.cases import DRAWN, HOURS, Case
from vrut_lite_lab.path_traced.denoising import GUIDES_NAME, denoised
from vrut_lite_lab.path_traced.regions import REGIONS, REGIONS_NAME, Mask, difference, flip
from vrut_lite_lab.path_traced.truths import OTHER_TRUTH, TRUTH, Picture, known, known_truth
from vrut_lite_lab.pictures.drawing import SKIES, Captioned, sheet, shots

HEADER = ["| scene, hour, sky | FLIP | floor | sunlit | shadowed | sky |", "|---" * 6 + "|"]


class CaseTruths(NamedTuple):
    """The truths of a case: radiance (h, w, 3), of both seeds if there are two.

    `clean` is the first seed's without grain, `floor` the FLIP to the other's, NaN without one.
    """

    radiance: Picture
    clean: Picture
    floor: float
    regions: dict[str, Mask]


def truth_of(case: Case) -> CaseTruths | None:
    """The truths on disk of a case; None if more than the other seed is missing."""
    first = known_truth(case, TRUTH, case.samples)
    guide, regions = known(case, GUIDES_NAME), known(case, REGIONS_NAME)
    if first is None or guide is None or regions is None:
        return None
    clean = denoised(first, guide)
    other = known_truth(case, OTHER_TRUTH, case.samples)
    if other is None:
        return CaseTruths(first, clean, float("nan"), regions)
    return CaseTruths(0.5 * (first + other), clean, flip(denoised(other, guide), clean), regions)


def compared(scene: str, sky: str) -> Iterator[tuple[str, list[Captioned]]]:
    """A line of the table, and frame and truth at the frame's exposure, of each known hour."""
    cases = [Case(scene, sky, hour) for hour in HOURS]
    known_cases = [(case, found) for case in cases if (found := truth_of(case)) is not None]
    if not known_cases:
        return
    hours = [case.project.at for case, _ in known_cases]
    drawn = shots(known_cases[0][0].project, [hour for hour in hours if hour is not None])
    for (case, found), shot in zip(known_cases, drawn, strict=True):
        frame = shot.picture.radiance
        cells = [f"{flip(frame, found.clean):.3f}", _number(found.floor)]
        for region in REGIONS:
            cells.append(_percent(difference(frame, found.radiance, found.regions[region])))
        pair = (("frame", frame), ("path-traced", found.clean))
        yield (
            f"| {case.caption} | " + " | ".join(cells) + " |",
            [
                (f"{case.caption}, {told}", display_picture(radiance, shot.picture.ev100))
                for told, radiance in pair
            ],
        )


def _number(value: float) -> str:
    return "–" if np.isnan(value) else f"{value:.3f}"


def _percent(value: float) -> str:
    return "–" if np.isnan(value) else f"{100.0 * value:+.1f} %"


def draw(path: Path, scenes: Sequence[str], skies: Sequence[str]) -> None:
    """Print the table, write the sheet."""
    pictures: list[Captioned] = []
    print("\n".join(HEADER), flush=True)
    for scene in scenes:
        for sky in skies:
            for line, pair in compared(scene, sky):
                print(line, flush=True)
                pictures += pair
    if pictures:
        sheet(pictures, 2 * len(HOURS)).save(path, quality=80)


def main() -> None:
    """Draw it."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition(":")[0])
    parser.add_argument("sheet", type=Path)
    parser.add_argument("scenes", nargs="*", default=DRAWN)
    parser.add_argument("--sky", choices=list(SKIES), action="append")
    chosen = parser.parse_args()
    draw(chosen.sheet, chosen.scenes, chosen.sky or list(SKIES))


if __name__ == "__main__":
    main()
