"""What a journal's digests are bound to: machine features, versions, modules."""

import platform
from collections.abc import Iterable
from importlib.metadata import PackageNotFoundError
from importlib.metadata import version as version_of

import numpy as np

from vrut_lite import __version__

Signature = dict[str, str]


def signature_of(modules: Iterable[tuple[str, str]]) -> Signature:
    """Texts by name, for modules of these names and versions; equal ones promise equal digests."""
    return {
        "machine": platform.machine(),
        "cpu_features": _cpu_features(),
        "c_library": " ".join(platform.libc_ver()),
        "python": platform.python_version(),
        "numpy": np.__version__,
        "numba": _version("numba"),
        "vrut_lite": __version__,
        **{f"module {name}": version for name, version in modules},
    }


def differences(recorded: Signature, here: Signature) -> list[str]:
    """A phrase for each part of the signature that is not the same."""
    return [
        f"{name} {recorded.get(name, 'none')} there, {here.get(name, 'none')} here"
        for name in sorted(recorded.keys() | here.keys())
        if recorded.get(name) != here.get(name)
    ]


def _cpu_features() -> str:
    # What numpy uses, after NPY_DISABLE_CPU_FEATURES: exp and pow differ in their last bit by it.
    groups = np.show_config(mode="dicts")["SIMD Extensions"]
    return " ".join([*groups.get("baseline", ()), *groups.get("found", ())])


def _version(package: str) -> str:
    try:
        return version_of(package)
    except PackageNotFoundError:
        return "none"
