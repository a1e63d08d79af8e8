"""Whether this version of vrut_lite is one that a module was written for."""

from vrut_lite import __version__
from vrut_lite.errors import UserError
from vrut_lite.lazy import lazy

# packaging takes 10 ms to import; most starts meet no requirement.
SpecifierSet = lazy("packaging.specifiers:SpecifierSet")


def check_host(requirement: str) -> None:
    """Pass if this version fits a requirement such as ">=1.0,<2"; an empty one fits all.

    Raises:
        UserError: it does not, or the requirement is malformed.
    """
    if not requirement:
        return
    try:
        fits = SpecifierSet(requirement).contains(__version__, prereleases=True)
    except ValueError:
        raise UserError(
            f"its requirement {requirement!r} on vrut_lite is none: write one such as '>=1.0,<2'"
        ) from None
    if not fits:
        raise UserError(
            f"it needs vrut_lite {requirement}, and this is {__version__}: update the one or the "
            "other"
        )


def host_range() -> str:
    """The versions for which a module is written that is begun today: up to the next major one."""
    major, minor = __version__.split(".")[:2]
    return f">={major}.{minor},<{int(major) + 1}"
