"""A truth without its grain, by Intel's Open Image Denoise (Afra 2024), for FLIP alone.

Region means are of the traced picture: it is right in the mean, a denoised one need not be.
"""

from path_tracer.denoising import without_grain
from path_tracer.guides import Guides, guides
from path_tracer.settings import PathTracerSettings
from path_tracer.subject import Subject

from vrut_lite.scene.scene_state import SceneState
from vrut_lite_lab.path_traced.cases import Case
from vrut_lite_lab.path_traced.truths import Arrays, Picture, kept

GUIDES_NAME = "guides"
_GUIDE_SAMPLES = 32


def guides_of(case: Case, state: SceneState) -> Arrays:
    """Colours and normals that the eye meets, from disk if known."""
    settings = PathTracerSettings(surfaces="layered")
    return kept(
        case, GUIDES_NAME, lambda: guides(Subject(state), settings, _GUIDE_SAMPLES)._asdict()
    )


def denoised(radiance: Picture, guide: Arrays) -> Picture:
    """Radiance (h, w, 3) without grain."""
    return without_grain(radiance, Guides(**guide))
