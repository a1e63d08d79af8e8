"""`vrut-lite modules`: the installed modules, their slots and settings."""

from importlib.metadata import entry_points

import click

from vrut_lite.daylight_kernel import daylight_kernel
from vrut_lite.installed_parts import parts_left_out
from vrut_lite.kernel.settings import describe
from vrut_lite.package_facts import MODULES_GROUP, in_safe_mode, package_of


@click.command(name="modules")
def modules() -> None:
    """List installed modules, the slots they can hold, and their settings.

    Example: vrut-lite modules
    """
    kernel, failures = daylight_kernel()
    packages = {point.name: package_of(point) for point in entry_points(group=MODULES_GROUP)}
    for seat in kernel.seats.values():
        manifest = seat.manifest
        slots = [
            slot + (" (holds it)" if kernel.slots.holder(slot) == seat.name else "")
            for slot in manifest.provides
        ]
        click.echo(f"{manifest.name} {manifest.version}: {manifest.title}; {seat.state}")
        if (package := packages.get(manifest.name)) is not None:
            click.echo(f"  package: {package.title}")
        click.echo(f"  slots: {', '.join(slots) or 'none'}")
        for slot in manifest.requires:
            holder = kernel.slots.holder(slot) or "nobody holds it"
            click.echo(f"  needs: {slot} ({holder})")
        for name, spec in describe(seat.module_type.settings_type).items():
            words = f"{spec.help.rstrip('.')} ({spec.range_text()})"
            click.echo(f"  {name} = {spec.default_text()}: {words}")
        if (sentence := parts_left_out().get(manifest.name)) is not None:
            click.echo(f"  fault: its frame part is left out: {sentence}")
        if seat.last_fault is not None:
            click.echo(f"  fault: {seat.last_fault.error}")
    for failure in failures:
        click.echo(failure)
    if in_safe_mode():
        for package in {facts.name: facts for facts in packages.values() if facts}.values():
            click.echo(f"left out by safe mode: {package.title}")
