"""Decorators of kernels that import numba at the first call of a kernel.

numba takes half a second to import, and a start whose results are all on disk calls no kernel.
`numba_compiler.py` imports it, on the thread that calls first.
"""

import threading
from collections.abc import Callable
from typing import Any

from vrut_lite.lazy import lazy

# For `fastmath`: there is no NaN, infinity or signed zero, and a product and its sum may be rounded
# once. Sums keep their order, so that the digits do not depend on the width of vectors. Nor do they
# depend on which process compiled a kernel: calls between kernels find other copies of a function
# there than in a process that loads them, and with `fastmath=True` each copy sums in its own order.
# Journals compare results of kernels by digest. It costs the solver 1 to 2 % of its time.
SUMS_IN_ORDER = {"nnan", "ninf", "nsz", "contract"}
_compiler = lazy("vrut_lite.numba_compiler")
_making = threading.RLock()


class JitFunction:
    """A function that numba compiles at its first call for each set of argument types.

    All that numba's own object of it has is an attribute.
    """

    def __init__(self, function: Callable[..., Any], make: str, options: dict[str, Any]):
        self.__module__, self.__name__ = function.__module__, function.__name__
        self.__qualname__, self.__doc__ = function.__qualname__, function.__doc__
        self.__wrapped__ = function
        self._make, self._options = make, options
        self._compiled: Any = None

    @property
    def compiled(self) -> Any:
        """numba's object of the function."""
        return self._made()

    def _made(self) -> Any:
        if self._compiled is None:
            make = getattr(_compiler, self._make)
            with _making:
                if self._compiled is None:
                    self._compiled = make(self.__wrapped__, self._options)
        return self._compiled

    @property
    def _numba_type_(self) -> Any:
        # numba asks for it where another kernel calls this one.
        return _compiler.type_of(self.compiled)

    def __call__(self, *arguments: Any, **named: Any) -> Any:
        """Call the function, compiled for these types of arguments."""
        return (self._compiled or self.compiled)(*arguments, **named)

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        # Not the property: an AttributeError of numba's would lead back here, without end.
        return getattr(self._made(), name)

    def __reduce__(self) -> str:
        return self.__qualname__


def njit(function: Callable[..., Any] | None = None, **options: Any) -> Any:
    """`numba.njit`, by which numba is imported at the first call."""
    if function is not None:
        return JitFunction(function, "compiled_function", options)
    return lambda function: JitFunction(function, "compiled_function", options)


def intrinsic(function: Callable[..., Any]) -> Any:
    """`numba.extending.intrinsic`: kernels alone call it; the function is called to compile it."""
    return JitFunction(function, "compiled_intrinsic", {})


def register_jitable(**options: Any) -> Any:
    """`numba.extending.register_jitable`: kernels call the function too, compiled with them."""
    return lambda function: JitFunction(function, "inlined_function", options)


# For files of intrinsics.
types = lazy("vrut_lite.numba_compiler:types")
cgutils = lazy("vrut_lite.numba_compiler:cgutils")
