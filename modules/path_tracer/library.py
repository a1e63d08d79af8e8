"""mitsuba itself: imported when first needed, in a variant that is known to run here.

llvm_ad_rgb aborts the whole process with an unsupported LLVM, so it is tried in a separate process
first.
"""

import os
import signal
import subprocess
import sys
from functools import lru_cache
from glob import glob
from typing import Any, Literal

from vrut_lite.errors import UserError

Variant = Literal["auto", "scalar", "llvm"]
EXTRA = "ref"
# System package with a library that mitsuba's wheel loads and does not contain.
SYSTEM_PACKAGE = "libatomic1"
LIBRARY_VARIABLE = "DRJIT_LIBLLVM_PATH"
_PROBE_S = 60.0
# Newer ones first; mitsuba 3.6 and later are made for 16 to 20, and others abort.
_PLACES = ("/usr/lib/*/libLLVM*.so*", "/usr/lib/llvm-*/lib/libLLVM*.so*", "/usr/lib64/libLLVM*.so*")
_VERSIONS = ("20", "19", "18", "17", "16")


def load_mitsuba(variant: Variant = "scalar") -> Any:
    """The package, set to a variant; `auto` is llvm where it runs.

    Raises:
        UserError: it is not installed, or lacks a library, or this variant does not run here.
    """
    try:
        import mitsuba
    except ModuleNotFoundError:
        raise UserError(
            f"the path tracer needs mitsuba: install it with pip install 'vrut-lite[{EXTRA}]'"
        ) from None
    # Its package goes on after a library that is missing, and raises a NameError then.
    except Exception as error:
        raise UserError(
            f"mitsuba cannot be loaded ({error.__context__ or error}): install the system's "
            f"package {SYSTEM_PACKAGE}, or its like"
        ) from None
    library = _library_for(variant)
    if library:
        os.environ[LIBRARY_VARIABLE] = library
    mitsuba.set_variant("llvm_ad_rgb" if library else "scalar_rgb")
    mitsuba.set_log_level(mitsuba.LogLevel.Error)
    return mitsuba


def _library_for(variant: Variant) -> str:
    """The LLVM to use; empty for none."""
    if variant == "scalar":
        return ""
    try:
        return safe_library()
    except UserError:
        if variant == "llvm":
            raise
        return ""


@lru_cache(maxsize=1)
def safe_library() -> str:
    """An LLVM with which a separate process could trace a picture.

    Raises:
        UserError: no LLVM works; the sentence has the last one's fault.
    """
    reason = "no LLVM 16 or newer was found"
    for library in candidates():
        reason = probe(library)
        if not reason:
            return library
    raise UserError(
        f"the path tracer cannot use llvm here ({reason}): leave its variant at scalar, or name "
        f"another LLVM in {LIBRARY_VARIABLE}"
    )


def candidates() -> list[str]:
    """Files that may be an LLVM to use; one that the environment names is the only one."""
    named = os.environ.get(LIBRARY_VARIABLE)
    if named:
        return [named]
    found = sorted(path for place in _PLACES for path in glob(place))
    by_version = [path for version in _VERSIONS for path in found if _is_of(path, version)]
    # Links to one file are tried once.
    return list({os.path.realpath(path): path for path in by_version}.values())


def probe(library: str, command: tuple[str, ...] = ("-m", "path_tracer.probe")) -> str:
    """Why this LLVM will not do, found out in another process; empty if it will."""
    environment = {**os.environ, LIBRARY_VARIABLE: library}
    try:
        done = subprocess.run(
            [sys.executable, *command],
            env=environment,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            timeout=_PROBE_S,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return f"{library} does not answer within {_PROBE_S:g} s"
    if done.returncode < 0:
        return f"{library} ends a trial with {signal.Signals(-done.returncode).name}"
    return f"{library} fails in a trial" if done.returncode else ""


def _is_of(path: str, version: str) -> bool:
    name = os.path.basename(path)
    return f"-{version}" in name or name.endswith((f".so.{version}", f".so.{version}.1"))
