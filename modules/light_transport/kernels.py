"""How the kernels of this package are compiled.

They sum in order, run beside other threads and keep IEEE comparisons, so that a layout does not
depend on the machine's vector width.
"""

from vrut_lite.njit import njit

kernel = njit(cache=True, nogil=True, error_model="numpy")


@kernel
def dot(a, b):  # type: ignore[no-untyped-def]
    """The product of two vectors of three."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
