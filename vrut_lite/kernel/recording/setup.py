"""The kernel at the beginning of a recording: written down, and made again for a replay."""

from collections.abc import Iterable, Mapping
from typing import Any

from vrut_lite.errors import UserError
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import ChooseSlot, Demand, EnableModule, Message, SetSetting
from vrut_lite.kernel.module import Module
from vrut_lite.kernel.recording.codec import decode, to_plain
from vrut_lite.kernel.recording.entry import ModuleSetup, Setup
from vrut_lite.kernel.recording.registry import Registry
from vrut_lite.kernel.seat import Seat

Services = Mapping[str, Mapping[str, Any]]

# What these did is in the setup; what another input did may live on inside a module.
_IN_SETUP = (
    "SetSetting", "EnableModule", "RestartModule", "ReloadModule", "ChooseSlot", "Demand",
)  # fmt: skip


def capture_setup(kernel: Kernel) -> Setup:
    """The setup of a settled kernel.

    Raises:
        UserError: it has already had an input that a setup does not hold.
    """
    for kind in Registry(seat.module_type for seat in kernel.seats.values()).inputs():
        if kind.__name__ not in _IN_SETUP and kernel.last(kind) is not None:
            raise UserError(
                f"recording must begin before the first input of daylight, and a {kind.__name__} "
                "has been admitted: start a fresh session"
            )
    slots = {slot for seat in kernel.seats.values() for slot in seat.manifest.provides}
    return Setup(
        modules=[_module_setup(seat) for seat in kernel.seats.values()],
        slots={slot: kernel.slots.holder(slot) for slot in sorted(slots)},
        demands=[to_plain(demand) for demand in kernel.lifecycle.demands.every()],
    )


def restore_setup(
    kernel: Kernel, setup: Setup, modules: Iterable[type[Module]], services: Services
) -> None:
    """Give an empty kernel the modules, settings and slots of a setup, and let it settle.

    Raises:
        UserError: a module is missing, refuses a setting, or does not run as it did.
    """
    installed = {module.manifest.name: module for module in modules}
    for wanted in setup.modules:
        if wanted.name not in installed:
            raise UserError(
                f"the journal needs the module {wanted.name} {wanted.version}: install it, or "
                f"hand it to the replay; known are {', '.join(installed) or 'none'}"
            )
        kernel.add_module(installed[wanted.name], **services.get(wanted.name, {}))
    for message in _setting_up(kernel, setup):
        kernel.inject(message)
    kernel.pump()
    _check_restored(kernel, setup)


def _module_setup(seat: Seat) -> ModuleSetup:
    return ModuleSetup(
        name=seat.name,
        version=seat.manifest.version,
        state=seat.state,
        settings=to_plain(seat.settings),
    )


def _setting_up(kernel: Kernel, setup: Setup) -> list[Any]:
    inputs: list[Message] = []
    for module in setup.modules:
        here = to_plain(kernel.seats[module.name].settings)
        for name, value in module.settings.items():
            if here.get(name) != value:
                kernel.check_setting(module.name, name, value)
                inputs.append(SetSetting(module=module.name, name=name, value=value))
        if module.state == "disabled":
            inputs.append(EnableModule(module=module.name, enabled=False))
    for slot, holder in setup.slots.items():
        if holder:
            kernel.check_holder(slot, holder)
            inputs.append(ChooseSlot(slot=slot, module=holder))
    return [*inputs, *(decode(Demand, plain) for plain in setup.demands)]


def _check_restored(kernel: Kernel, setup: Setup) -> None:
    for module in setup.modules:
        state = kernel.seats[module.name].state
        if state != module.state:
            raise UserError(
                f"the module {module.name} is {state} here and was {module.state} when the "
                "journal began"
            )
    for slot, holder in setup.slots.items():
        if kernel.slots.holder(slot) != holder:
            raise UserError(
                f"the slot '{slot}' was held by '{holder}' when the journal began, and is held "
                f"by '{kernel.slots.holder(slot)}' here"
            )
