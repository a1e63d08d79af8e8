"""In which order meshes are drawn, by what glTF's alphaMode says of their materials.

What is solid is drawn from near to far, which spares hidden fragments, with depth. What is blended
follows from far to near and leaves depth as it is, so that nothing behind it vanishes. Texels of a
blended material that let nothing through are drawn among the solid ones: a leaf hides the leaf
behind it, though both are one mesh.
"""

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vrut_lite.render.pyrender_scene import PlacedPrimitive

# 254 of 255 lets nothing through that eyes see.
SOLID_ALPHA = 0.996
_NO_END = 2.0


def in_order(
    seen: Iterable[PlacedPrimitive], eye_m: NDArray
) -> tuple[list[PlacedPrimitive], list[PlacedPrimitive]]:
    """What has solid texels, from near to far, and what has blended ones, from far to near."""
    by_distance = sorted(seen, key=lambda placed: float(np.linalg.norm(placed.centre_m - eye_m)))
    solid = [placed for placed in by_distance if has_solid_texels(placed.primitive)]
    blended = [placed for placed in by_distance if is_blended(placed.primitive.material)]
    return solid, blended[::-1]


def is_blended(material: Any) -> bool:
    """Whether what is behind a material shows through it."""
    return bool(material.alphaMode == "BLEND" or material.terms.transmits)


def has_solid_texels(primitive: Any) -> bool:
    """Whether something of a mesh may hide all that is behind it."""
    material = primitive.material
    if material.terms.transmits:
        return "transmission" in material.further
    if not is_blended(material):
        return True
    if float(material.baseColorFactor[3]) < SOLID_ALPHA:
        return False
    return material.baseColorTexture is not None or primitive.color_0 is not None


def alpha_range(primitive: Any, blended: bool) -> tuple[float, float]:
    """From which alpha on, and below which, fragments are drawn: among the blended or the solid."""
    material = primitive.material
    if material.is_cut_out:
        # Shaders cover samples by it.
        return 0.0, _NO_END
    if material.alphaMode == "MASK":
        return float(material.alphaCutoff), _NO_END
    if not is_blended(material) or material.terms.transmits:
        return 0.0, _NO_END
    if blended:
        return 0.0, SOLID_ALPHA if has_solid_texels(primitive) else _NO_END
    return SOLID_ALPHA, _NO_END
