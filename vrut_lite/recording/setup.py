"""The set-up of a kernel at the beginning of a recording, and its repetition for a replay."""

from collections.abc import Callable, Iterable, Mapping
from typing import Any

from vrut_lite.errors import UserError
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.dispatch import HOST
from vrut_lite.kernel.job_scheduler import JOBS
from vrut_lite.kernel.loaded_module import LoadedModule
from vrut_lite.kernel.messages import (
    ChooseSlot,
    Demand,
    EnableModule,
    Input,
    JobResult,
    Message,
    SetSetting,
)
from vrut_lite.kernel.module import Module
from vrut_lite.kernel.setup_log import MOST_STEPS, Step, sets_up
from vrut_lite.message_codec import decode, to_plain
from vrut_lite.recording.earlier_names import settings_in_todays_words
from vrut_lite.recording.entry import ModuleSetup, Setup, SetupStep
from vrut_lite.recording.registry import Registry

Services = Mapping[str, Mapping[str, Any]]
# Runs the job of this module and name and injects its result; false without such a job.
Release = Callable[[str, str], bool]


def capture_setup(kernel: Kernel) -> Setup:
    """Let a kernel settle, on its own thread, and write down how it was set up.

    Raises:
        UserError: it has already had an input that a setup does not hold.
    """
    kernel.pump()
    if kernel.beginning.ended_by:
        raise UserError(
            "recording must begin before the first input of daylight, and "
            f"{kernel.beginning.ended_by}: start a fresh session"
        )
    slots = {slot for seat in kernel.seats.values() for slot in seat.manifest.provides}
    return Setup(
        modules=[_module_setup(seat) for seat in kernel.seats.values()],
        slots={slot: kernel.slots.holder(slot) for slot in sorted(slots)},
        demands=[to_plain(demand) for demand in kernel.lifecycle.demands.every()],
        steps=[_step_setup(step) for step in kernel.beginning.steps],
    )


def restore_setup(
    kernel: Kernel,
    setup: Setup,
    modules: Iterable[type[Module]],
    services: Services,
    release: Release,
) -> None:
    """Repeat the recorded set-up on an empty kernel, and let it settle.

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

    def add(name: str) -> None:
        kernel.add_module(installed[name], **services.get(name, {}))

    if setup.steps:
        _check_modules(setup)
        registry = Registry(installed[module.name] for module in setup.modules)
        for step in setup.steps:
            if step.module:
                add(step.module)
                continue
            if step.sender == JOBS:
                release(str(step.message.get("module")), str(step.message.get("job")))
            elif step.type_name:
                kernel.inject(_input_of(step, registry))
            kernel.pump()
        kernel.pump()
        for module in setup.modules:
            for one in _unlike(kernel, module):
                kernel.inject(one)
        # A stand-in (of the GPU's owner, say) lacks the demands of the module itself.
        known = {demand.key(): demand for demand in kernel.lifecycle.demands.every()}
        for demand in (decode(Demand, plain) for plain in setup.demands):
            if known.get(demand.key()) != demand:
                kernel.inject(demand)
        # An earlier version may have given a slot without a choice to another module.
        for slot, holder in setup.slots.items():
            if holder and kernel.slots.holder(slot) != holder:
                kernel.inject(ChooseSlot(slot=slot, module=holder))
    else:
        for module in setup.modules:
            add(module.name)
        for message in _setting_up(kernel, setup):
            kernel.inject(message)
    kernel.pump()
    _check_restored(kernel, setup)


def _step_setup(step: Step) -> SetupStep:
    message = step.input
    if message is None:
        return SetupStep(module=step.module)
    plain, name = to_plain(message), type(message).__name__
    if isinstance(message, JobResult):
        whose = {"module": message.module, "job": message.job}
        return SetupStep(type_name=name, sender=JOBS, message=whose)
    decode(type(message), plain)
    return SetupStep(type_name=name, sender=HOST, message=plain)


def _check_modules(setup: Setup) -> None:
    """Raise UserError unless each module of the setup is added once, in so many steps at most."""
    if len(setup.steps) > MOST_STEPS:
        raise UserError(f"the journal's setup has {len(setup.steps)} steps, over {MOST_STEPS}")
    added = [step.module for step in setup.steps if step.module]
    if sorted(added) != sorted(module.name for module in setup.modules):
        raise UserError("the journal's setup adds other modules than it names: record it anew")


def _input_of(step: SetupStep, registry: Registry) -> Input:
    kind = registry.find_input(step.type_name)
    if not sets_up(kind):
        raise UserError(f"the journal's setup holds a {step.type_name}, which sets nothing up")
    return decode(kind, step.message)


def _module_setup(seat: LoadedModule) -> ModuleSetup:
    return ModuleSetup(
        name=seat.name,
        version=seat.manifest.version,
        state=seat.state,
        settings=to_plain(seat.settings),
    )


def _setting_up(kernel: Kernel, setup: Setup) -> list[Any]:
    """The inputs that bring about the values of a setup without steps."""
    inputs: list[Message] = []
    for module in setup.modules:
        inputs += _unlike(kernel, module)
        if module.state == "disabled":
            inputs.append(EnableModule(module=module.name, enabled=False))
    for slot, holder in setup.slots.items():
        if holder:
            kernel.check_holder(slot, holder)
            inputs.append(ChooseSlot(slot=slot, module=holder))
    return [*inputs, *(decode(Demand, plain) for plain in setup.demands)]


def _unlike(kernel: Kernel, module: ModuleSetup) -> list[SetSetting]:
    """Inputs for settings that differ from the recorded ones, as after a change of defaults."""
    here = to_plain(kernel.seats[module.name].settings)
    unlike: list[SetSetting] = []
    for name, value in settings_in_todays_words(module.settings).items():
        if here.get(name) != value:
            kernel.check_setting(module.name, name, value)
            unlike.append(SetSetting(module=module.name, name=name, value=value))
    return unlike


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
