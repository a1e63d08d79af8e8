"""`python -m vrut_lite.module_packages.trial PACKAGE`: loads a package's modules, as a start does.

Prints "loaded", or a sentence for what cannot be loaded. Panels are left to the window.
"""

import sys
from importlib.metadata import distribution

from vrut_lite.discovery import checked
from vrut_lite.errors import UserError
from vrut_lite.foreign_errors import sentence_of
from vrut_lite.interrupts import pass_interrupt
from vrut_lite.kernel.bus import Kernel
from vrut_lite.package_facts import MODULES_GROUP, load_fitting

_LEFT_OUT = "vrut_lite.panels"


def main(package: str) -> int:
    """Load all; returns the exit code."""
    for point in distribution(package).entry_points:
        if not point.group.startswith("vrut_lite.") or point.group == _LEFT_OUT:
            continue
        try:
            loaded = load_fitting(point)
            if point.group == MODULES_GROUP:
                _try_module(loaded)
        except BaseException as error:
            pass_interrupt(error)
            print(f"{point.name} ({point.value}): {sentence_of(error)}")
            return 1
    print("loaded")
    return 0


def _try_module(loaded: object) -> None:
    module = checked(loaded)
    kernel = Kernel()
    services = {"inject": kernel.inject} if module.injects else {}
    kernel.add_module(module, **services)
    kernel.pump()
    fault = kernel.seats[module.manifest.name].last_fault
    kernel.close()
    if fault is not None:
        raise UserError(fault.error)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
