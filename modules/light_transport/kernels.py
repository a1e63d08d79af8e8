"""How the kernels of this package are compiled.

They sum in order, run beside other threads and keep IEEE comparisons, so that a layout does not
depend on the machine's vector width.
"""

from typing import Any

from vrut_lite.njit import SUMS_IN_ORDER, njit, register_jitable

# Least cosine between the shading normals on both sides of an edge that is smooth (10 degrees).
_SMOOTH = 0.985

kernel = njit(cache=True, nogil=True, error_model="numpy")
# Kernels that are called for each ray. They make no arrays and count no references to their
# arguments: counting took ten times as long as finding where a ray begins.
_WITHOUT_COUNTS: dict[str, Any] = {"_nrt": False}
hot: Any = njit(
    cache=True, nogil=True, error_model="numpy", fastmath=SUMS_IN_ORDER, **_WITHOUT_COUNTS
)
# For what kernels alone call. LLVM puts it into its callers: numba would do so before it has found
# types, and find them again in each caller, which took a quarter of all time spent on compiling.
inlined: Any = register_jitable(
    error_model="numpy", forceinline=True, no_cfunc_wrapper=True, **_WITHOUT_COUNTS
)


@inlined
def dot(a, b):  # type: ignore[no-untyped-def]
    """The product of two vectors of three."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@inlined
def cross(a, b, out):  # type: ignore[no-untyped-def]
    """Fill in the vector product of two vectors of three, which are other arrays."""
    out[0] = a[1] * b[2] - a[2] * b[1]
    out[1] = a[2] * b[0] - a[0] * b[2]
    out[2] = a[0] * b[1] - a[1] * b[0]


@inlined
def agree(normals, f, e, g, d):  # type: ignore[no-untyped-def]
    """Whether the normals (F, 3, 3) of two triangles' corners agree along an edge.

    Edge `e` of triangle `f` is edge `d` of `g`, in the other direction.
    """
    return (
        dot(normals[f, e], normals[g, (d + 1) % 3]) >= _SMOOTH
        and dot(normals[f, (e + 1) % 3], normals[g, d]) >= _SMOOTH
    )
