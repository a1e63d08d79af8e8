"""`vrut-lite modules`: lists, writes, installs, updates and removes modules."""

import tempfile
from pathlib import Path
from typing import Any

import click

from vrut_lite.daylight_kernel import daylight_kernel
from vrut_lite.installed_parts import parts_left_out
from vrut_lite.kernel.settings import describe
from vrut_lite.lazy import lazy
from vrut_lite.package_facts import PackageFacts, in_safe_mode, packages_of_others

# Only `new` needs the one, and only those that change what is installed need the other.
writing: Any = lazy("vrut_lite.module_packages.writing")
installing: Any = lazy("vrut_lite.module_packages.installing")

_yes = click.option("--yes", is_flag=True, help="Do not ask.")


@click.group(name="modules", invoke_without_command=True)
@click.pass_context
def modules(context: click.Context) -> None:
    """List installed modules; write, install, update and remove modules of others.

    Example: vrut-lite modules
    """
    if context.invoked_subcommand is None:
        _list()


@modules.command(name="list")
def list_() -> None:
    """List installed modules, the slots they can hold, and their settings.

    Example: vrut-lite modules list
    """
    _list()


@modules.command()
@click.argument("name")
@click.option("--kind", type=click.Choice(["sky", "layer", "tool"]), required=True)
@click.option("--into", "folder", metavar="FOLDER", help="A new or empty folder; default: NAME.")
def new(name: str, kind: str, folder: str | None) -> None:
    """Write the package of a new module, whose tests pass at once.

    Example: vrut-lite modules new rain_radar --kind layer
    """
    files = writing.write_package(name, kind, Path(folder or name))
    place = Path(folder or name)
    click.echo(
        f"{place}: {len(files)} files; next: cd {place}, pip install -e ., pytest; README.md says "
        "how it is published"
    )


@modules.command()
@click.argument("what")
@_yes
def install(what: str, yes: bool) -> None:
    """Install a package of modules: a wheel, a folder, or a name on pip's index.

    Example: vrut-lite modules install rain_radar-0.1.0-py3-none-any.whl
    """
    with tempfile.TemporaryDirectory() as folder:
        wheel = installing.prepare_install(what, Path(folder))
        _show(wheel.facts)
        _confirm("Install it?", yes)
        installing.install(wheel)
    click.echo(f"{wheel.facts.name} {wheel.facts.version} is installed and loads")


@modules.command()
@click.argument("name")
@click.argument("what", required=False)
@_yes
def update(name: str, what: str | None, yes: bool) -> None:
    """Update a package of modules of others, from the index or from WHAT, a wheel or a folder.

    Example: vrut-lite modules update rain_radar
    """
    with tempfile.TemporaryDirectory() as folder:
        before = installing.package_of_others(name)
        wheel = installing.prepare_update(name, what, Path(folder))
        _show(wheel.facts)
        _confirm(f"Install it in place of {before.version}?", yes)
        installing.install(wheel)
    facts = wheel.facts
    click.echo(f"{facts.name} is updated from {before.version} to {facts.version} and loads")


@modules.command()
@click.argument("name")
@_yes
def remove(name: str, yes: bool) -> None:
    """Remove a package of modules of others; what it requires stays.

    Example: vrut-lite modules remove rain_radar
    """
    facts = installing.package_of_others(name)
    _show(facts)
    _confirm("Remove it?", yes)
    with tempfile.TemporaryDirectory() as folder:
        installing.remove(facts, Path(folder))
    click.echo(f"{facts.name} {facts.version} is removed")


def _list() -> None:
    kernel, failures = daylight_kernel()
    packages = packages_of_others()
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
        for package in {facts.name: facts for facts in packages.values()}.values():
            click.echo(f"left out by safe mode: {package.title}")


def _show(facts: PackageFacts) -> None:
    click.echo(facts.title)
    if facts.sha256:
        click.echo(f"  sha256: {facts.sha256}")
    for group, names in facts.brings.items():
        what = group.removeprefix("vrut_lite.").replace("_", " ")
        click.echo(f"  {what}: {', '.join(names)}")
    if facts.sha256:
        click.echo(f"  {installing.RIGHTS}")


def _confirm(question: str, yes: bool) -> None:
    if not yes:
        click.confirm(question, abort=True)
