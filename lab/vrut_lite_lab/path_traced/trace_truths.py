"""Fill the folder of truths.

    python -m vrut_lite_lab.path_traced.trace_truths [--sky NAME] [SCENE ...]

First one truth of every scene and hour, then those of another seed, for the floor. What is there
already is left.
"""

import argparse
import time
from collections.abc import Sequence

from vrut_lite_lab.path_traced.cases import DRAWN, states
from vrut_lite_lab.path_traced.denoising import guides_of
from vrut_lite_lab.path_traced.regions import regions_of
from vrut_lite_lab.path_traced.truths import OTHER_TRUTH, TRUTH, Recipe, known_truth, truth
from vrut_lite_lab.pictures.drawing import SKIES


def fill(scenes: Sequence[str], sky: str, recipe: Recipe) -> None:
    """Trace these scenes at all hours."""
    for scene in scenes:
        for case, state in states(scene, sky):
            if known_truth(case, recipe, case.samples) is not None:
                continue
            began = time.process_time()
            truth(case, state, recipe, case.samples)
            guides_of(case, state)
            regions_of(case, state)
            print(f"{case.caption} {recipe.name}: {time.process_time() - began:.0f} s", flush=True)


def main() -> None:
    """Fill it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("scenes", nargs="*", default=DRAWN)
    parser.add_argument("--sky", choices=list(SKIES), action="append")
    parser.add_argument("--seeds", type=int, choices=(1, 2), default=2)
    chosen = parser.parse_args()
    for sky in chosen.sky or SKIES:
        for recipe in (TRUTH, OTHER_TRUTH)[: chosen.seeds]:
            fill(chosen.scenes, sky, recipe)


if __name__ == "__main__":
    main()
