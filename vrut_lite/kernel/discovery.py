"""Finding installed modules by entry point."""

from importlib.metadata import entry_points

from vrut_lite.errors import UserError
from vrut_lite.kernel.module import Module

GROUP = "vrut_lite.modules"


def discover() -> tuple[list[type[Module]], list[str]]:
    """Module classes sorted by entry-point name, and a sentence for each that failed to import."""
    found: list[type[Module]] = []
    failures: list[str] = []
    for point in sorted(entry_points(group=GROUP), key=lambda point: point.name):
        try:
            found.append(_checked(point.load()))
        except Exception as error:
            failures.append(f"module '{point.name}' ({point.value}) failed to load: {error}")
    return found, failures


def _checked(candidate: object) -> type[Module]:
    if not (isinstance(candidate, type) and issubclass(candidate, Module)):
        raise UserError(f"{candidate!r} is no subclass of vrut_lite.kernel.module.Module")
    return candidate
