"""Which input takes back what another is about to change."""

from vrut_lite.daylight.picture import SetExposure
from vrut_lite.daylight.place import SetPlace
from vrut_lite.daylight.tolerance import SetTolerance, tolerance_of
from vrut_lite.errors import UserError
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import (
    ChooseSlot,
    ClockMoved,
    EnableModule,
    Input,
    SetClock,
    SetSetting,
)


def inverse_of(message: Input, kernel: Kernel) -> Input | None:
    """What brings the present state back; asked before the kernel acts on the message.

    None for an input that changes nothing, that will be refused, or of a kind that is not taken
    back: views, scenes, and whatever is not the user's own.
    """
    try:
        message.check()
        back = _inverse(message, kernel)
        return None if back is None or back == _as_kept(message, kernel) else back
    except UserError:
        return None


def _inverse(message: Input, kernel: Kernel) -> Input | None:
    match message:
        case SetSetting():
            value = getattr(kernel.check_module(message.module).settings, message.name, None)
            return SetSetting(module=message.module, name=message.name, value=value)
        case ChooseSlot():
            kernel.check_holder(message.slot, message.module)
            holder = kernel.slots.holder(message.slot)
            able = holder and kernel.seats[message.module].running
            return ChooseSlot(slot=message.slot, module=holder) if able else None
        case EnableModule():
            running = kernel.check_module(message.module).running
            return EnableModule(module=message.module, enabled=running)
        case SetPlace():
            return kernel.last(SetPlace)
        case SetExposure():
            return kernel.last(SetExposure) or SetExposure()
        case SetTolerance():
            return SetTolerance(tolerance=tolerance_of(kernel))
        case SetClock():
            clock = kernel.last(ClockMoved)
            return None if clock is None else SetClock(instant=clock.instant)
    return None


def _as_kept(message: Input, kernel: Kernel) -> Input:
    """The message with its value as the module will keep it."""
    if isinstance(message, SetSetting):
        value = kernel.check_setting(message.module, message.name, message.value)
        return SetSetting(module=message.module, name=message.name, value=value)
    return message
