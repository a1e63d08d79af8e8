"""The signature of a journal's digests: machine features, versions, modules."""

import os
import platform
from collections.abc import Iterable
from importlib.metadata import PackageNotFoundError
from importlib.metadata import version as version_of

import numpy as np

from vrut_lite import __version__
from vrut_lite.lazy import lazy

Signature = dict[str, str]

_numba = lazy("vrut_lite.numba_compiler")

# Beginnings of the names of processor features that say how sums and products are rounded.
_ARITHMETIC = ("sse", "avx", "fma", "f16c", "fp", "neon", "sve", "vfp", "vsx", "altivec")
# Parts that are lists of words: only the different words are reported.
_LISTS = ("cpu_features", "numba_target")


def signature_of(modules: Iterable[tuple[str, str]]) -> Signature:
    """Texts by name, for modules of these names and versions; equal ones promise equal digests."""
    return {
        "machine": platform.machine(),
        "cpu_features": _cpu_features(),
        "c_library": " ".join(platform.libc_ver()),
        "python": platform.python_version(),
        "numpy": np.__version__,
        "numba": _version("numba"),
        "numba_target": _numba_target(),
        "vrut_lite": __version__,
        **{f"module {name}": version for name, version in modules},
    }


def differences(recorded: Signature, here: Signature) -> list[str]:
    """A phrase for each part of the signature that is not the same."""
    found = []
    for name in sorted(recorded.keys() | here.keys()):
        there, now = recorded.get(name, "none"), here.get(name, "none")
        if there != now:
            if name in _LISTS:
                there, now = _without(there, now), _without(now, there)
            found.append(f"{name} {there} there, {now} here")
    return found


def _without(words: str, others: str) -> str:
    """The words that are not among the others too; "no more" without any."""
    known = others.split()
    return " ".join(word for word in words.split() if word not in known) or "no more"


def _cpu_features() -> str:
    # Features that numpy uses, after NPY_DISABLE_CPU_FEATURES: the last bit of exp and pow depends
    # on them.
    groups = np.show_config(mode="dicts")["SIMD Extensions"]
    words = [*groups.get("baseline", ()), *groups.get("found", ())]
    # Matrix kernels that OpenBLAS is forced to use.
    if core := os.environ.get("OPENBLAS_CORETYPE"):
        words.append(f"OpenBLAS:{core}")
    return " ".join(words)


def _numba_target() -> str:
    """For which processor numba compiles: its name, and which arithmetic it has."""
    try:
        config, cpu_target = _numba.config, _numba.cpu_target
    except ImportError:
        return "none"
    if getattr(config, "DISABLE_JIT", False):
        return "interpreted"
    _, name, features = cpu_target.target_context.codegen().magic_tuple()
    words = sorted(word[1:] for word in features.split(",") if word.startswith("+"))
    vector_library = ["svml"] if getattr(config, "USING_SVML", False) else []
    return " ".join([name, *(w for w in words if w.startswith(_ARITHMETIC)), *vector_library])


def _version(package: str) -> str:
    try:
        return version_of(package)
    except PackageNotFoundError:
        return "none"
