"""Facts on installed packages that bring modules, from their metadata: nothing is imported.

In safe mode, which the environment carries on to other processes, packages of others are left out.
"""

import os
from collections.abc import Iterable
from functools import cache, lru_cache
from importlib.metadata import (
    Distribution,
    EntryPoint,
    EntryPoints,
    PackageMetadata,
    entry_points,
)
from typing import Any, cast

import msgspec

from vrut_lite.errors import one_line
from vrut_lite.host_version import check_host
from vrut_lite.lazy import lazy

canonicalize_name = lazy("packaging.utils:canonicalize_name")
Requirement = lazy("packaging.requirements:Requirement")

# The host's distribution, and that of its laboratory, by their canonical names.
HOST = "vrut-lite"
OWN = (HOST, "vrut-lite-lab")
MODULES_GROUP = "vrut_lite.modules"
SAFE_MODE_VARIABLE = "VRUT_LITE_SAFE_MODE"
SAFE_MODE_OPTION = "--safe-mode"
_LONGEST_FACT = 120
_NAMELESS, _UNREADABLE = "a package without metadata", "(it cannot be read)"


class PackageFacts(msgspec.Struct, frozen=True):
    """A package as its metadata describe it; texts are empty where they say nothing.

    `host`: its requirement on vrut_lite. `brings`: names of entry points by group, those of
    vrut_lite alone. `sha256`: of its wheel, empty for an installed package.
    """

    name: str
    version: str
    author: str
    licence: str
    host: str
    brings: dict[str, tuple[str, ...]]
    sha256: str = ""

    @property
    def modules(self) -> tuple[str, ...]:
        """Names of its modules."""
        return self.brings.get(MODULES_GROUP, ())

    @property
    def title(self) -> str:
        """Name, version, author and licence in one phrase."""
        return (
            f"{self.name} {self.version}, by {self.author or 'an author it does not name'}, "
            f"{self.licence or 'without a licence'}"
        )


@lru_cache(maxsize=64)
def facts_of(distribution: Distribution) -> PackageFacts:
    """The facts of a distribution, installed or a wheel's.

    Metadata that cannot be read make a package without a name that fits no version.
    """
    try:
        return _read(distribution)
    except Exception:
        return PackageFacts(_NAMELESS, "", "", "", _UNREADABLE, {})


def _read(distribution: Distribution) -> PackageFacts:
    metadata = distribution.metadata
    if "Name" not in metadata:
        raise ValueError("it has no name")
    brings: dict[str, tuple[str, ...]] = {}
    for point in sorted(distribution.entry_points, key=lambda point: point.name):
        if point.group.startswith("vrut_lite."):
            brings[point.group] = (*brings.get(point.group, ()), point.name)
    licence = _first(metadata, "License-Expression", "License")
    if not licence:
        classified = (text.split(" :: ") for text in metadata.get_all("Classifier") or ())
        licence = next((words[-1] for words in classified if words[0] == "License"), "")
    return PackageFacts(
        name=_fact(_first(metadata, "Name")),
        version=_fact(_first(metadata, "Version")),
        author=_fact(_first(metadata, "Author", "Author-email")),
        licence=_fact(licence.partition("\n")[0]),
        host=_requirement_on_host(distribution.requires or ()),
        brings=brings,
    )


def package_of(point: EntryPoint) -> PackageFacts | None:
    """The package of somebody else that an entry point is of; None for our own."""
    if point.dist is None:
        return None
    facts = facts_of(point.dist)
    return None if is_own(facts.name) else facts


def packages_of_others() -> dict[str, PackageFacts]:
    """The packages of somebody else that bring modules, by the names of these."""
    points = sorted(entry_points(group=MODULES_GROUP), key=lambda point: point.name)
    found = {point.name: package_of(point) for point in points}
    return {name: facts for name, facts in found.items() if facts is not None}


def is_own(package: str) -> bool:
    """Whether a distribution is vrut_lite's own."""
    return canonicalize_name(package) in OWN


@cache
def installed_points() -> EntryPoints:
    """All entry points, read once: every reading opens the metadata of each installed package.

    A process keeps the modules that it has loaded, so that what is installed later counts from the
    next start.
    """
    # Before Python 3.12 it is of another class, which selects alike.
    points: Any = entry_points()
    return cast(EntryPoints, points)


def usable_points(group: str) -> list[EntryPoint]:
    """A group's entry points by name; in safe mode only those of our own packages."""
    in_order = sorted(installed_points().select(group=group), key=lambda point: point.name)
    if in_safe_mode():
        return [point for point in in_order if package_of(point) is None]
    return in_order


def load_fitting(point: EntryPoint) -> Any:
    """Import what an entry point names, if its package is for this version of vrut_lite.

    Raises:
        UserError: it is for another version.
        BaseException: whatever its import raises.
    """
    package = package_of(point)
    if package is not None:
        check_host(package.host)
    return point.load()


def in_safe_mode() -> bool:
    """Whether packages of others are left out."""
    return bool(os.environ.get(SAFE_MODE_VARIABLE))


def _requirement_on_host(requirements: Iterable[str]) -> str:
    found = []
    for text in requirements:
        # The name comes first; packaging is imported only for the one that may be meant.
        if text.replace("_", "-").replace(".", "-").lower().startswith(HOST):
            try:
                requirement = Requirement(text)
            except ValueError:
                return _UNREADABLE
            holds = requirement.marker is None or requirement.marker.evaluate({"extra": ""})
            if canonicalize_name(requirement.name) == HOST and holds:
                found.append(str(requirement.specifier))
    return ",".join(filter(None, found))


def _first(metadata: PackageMetadata, *rows: str) -> str:
    """The first of some rows that says something, or an empty text."""
    texts = (str(metadata[row]).strip() for row in rows if row in metadata)
    return next(filter(None, texts), "")


def _fact(text: str) -> str:
    return one_line(text.strip(), _LONGEST_FACT)
