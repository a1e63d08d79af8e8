"""Draw order of meshes, by the glTF alphaMode of their materials.

Opaque meshes are drawn from near to far, which spares hidden fragments, with depth writes. Blended
meshes follow from far to near without depth writes, so that nothing behind them is lost. Opaque
texels of a blended material are drawn with the opaque meshes: a leaf hides the leaf behind it,
though both belong to one mesh.
"""

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vrut_lite.render.pyrender_scene import PlacedPrimitive

# Least alpha of an opaque texel: 254 of 255 transmits nothing visible.
SOLID_ALPHA = 0.996
_NO_END = 2.0


def in_order(
    seen: Iterable[PlacedPrimitive], eye_m: NDArray
) -> tuple[list[PlacedPrimitive], list[PlacedPrimitive]]:
    """Meshes with opaque texels from near to far, and with blended ones from far to near."""
    by_distance = sorted(seen, key=lambda placed: float(np.linalg.norm(placed.centre_m - eye_m)))
    solid = [placed for placed in by_distance if has_solid_texels(placed.primitive)]
    blended = [placed for placed in by_distance if is_blended(placed.primitive.material)]
    return solid, blended[::-1]


def is_blended(material: Any) -> bool:
    """Whether a material lets the background show through."""
    return bool(material.alphaMode == "BLEND" or material.terms.transmits)


def has_solid_texels(primitive: Any) -> bool:
    """Whether a mesh may have opaque texels."""
    material = primitive.material
    if material.terms.transmits:
        return "transmission" in material.further
    if not is_blended(material):
        return True
    if float(material.baseColorFactor[3]) < SOLID_ALPHA:
        return False
    return material.baseColorTexture is not None or primitive.color_0 is not None


def alpha_range(primitive: Any, blended: bool) -> tuple[float, float]:
    """Range of alpha, its end excluded, of the fragments in the blended or the opaque pass."""
    material = primitive.material
    if material.is_cut_out:
        # The shader turns alpha into sample coverage.
        return 0.0, _NO_END
    if material.alphaMode == "MASK":
        return float(material.alphaCutoff), _NO_END
    if not is_blended(material) or material.terms.transmits:
        return 0.0, _NO_END
    if blended:
        return 0.0, SOLID_ALPHA if has_solid_texels(primitive) else _NO_END
    return SOLID_ALPHA, _NO_END
