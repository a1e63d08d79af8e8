"""CPU seconds to 10 % rms relative error of the path tracer, guided to openings and not.

    python -m vrut_lite_lab.path_traced.convergence [SCENE [HOUR]]

Needs mitsuba's llvm variant. The error of n samples a pixel is sqrt(V / n), V the mean over pixels
of a sample's variance over the squared luminance. V is of three batches of independent samples; it
is divided by the luminance of all batches without grain, for a noisy one would count its own bright
pixels as right. CPU seconds are the least of the batches'; building and learning apart.
"""

import sys
import time

import numpy as np
from numpy.typing import NDArray
from path_tracer import tracer
from path_tracer.denoising import without_grain
from path_tracer.settings import PathTracerSettings
from path_tracer.subject import Subject
from path_tracer.tracer import Tracer

from vrut_lite.geometry.colour import luminance
from vrut_lite.scene.scene_state import SceneState
from vrut_lite_lab.path_traced.cases import states

_SIZE, _SPP, _BATCHES = (480, 270), 16, 3
_AIM = 0.1


def batches(state: SceneState) -> tuple[NDArray[np.float32], float, float, int]:
    """Pictures (n, h, w, 3), CPU seconds a sample and before the first, and what is guided."""
    traced = Tracer(Subject(state), PathTracerSettings(variant="llvm"))
    begun = time.process_time()
    traced.trace(0, 1)
    before_s = time.process_time() - begun
    pictures, seconds = [], []
    for number in range(_BATCHES):
        begun = time.process_time()
        picture = traced.trace(_SPP * (number + 1), _SPP)
        assert picture is not None
        seconds.append((time.process_time() - begun) / _SPP)
        pictures.append(picture)
    return np.array(pictures), min(seconds), before_s, traced.guided


def main() -> None:
    """Print a line for guided and unguided paths."""
    scene = sys.argv[1] if len(sys.argv) > 1 else "work/indoor.glb"
    hour = sys.argv[2] if len(sys.argv) > 2 else "12:30"
    _, state = next(states(scene, "bruneton_sky", (hour,), _SIZE))
    guided = batches(state)
    tracer._guided = lambda *_: None
    plain = batches(state)
    mean = np.concatenate([guided[0], plain[0]]).mean(axis=0)
    truth = luminance(without_grain(mean))
    for name, (pictures, sample_s, before_s, scenes) in (("guided", guided), ("plain", plain)):
        variance = luminance(pictures).var(axis=0, ddof=1) * _SPP
        samples = float(np.mean(variance / truth**2)) / _AIM**2
        print(
            f"{name}: {samples:.0f} samples a pixel, {samples * sample_s:.0f} CPU s, before them "
            f"{before_s:.1f}; mean {pictures.mean():.4f}, scenes guided {scenes}"
        )


if __name__ == "__main__":
    main()
