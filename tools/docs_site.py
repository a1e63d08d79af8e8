"""The site of the documentation: mkdocs calls `on_files`, which adds what docs/ does not hold.

The README and its like become pages; the reference is written from the code: commands from click,
settings and slots from the modules' manifests, messages from their types. `make docs` builds it.
"""

import importlib
import inspect
import re
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import click
import msgspec

from tools.public_names import PYTHON
from vrut_lite.cli import root
from vrut_lite.daylight_kernel import daylight_kernel
from vrut_lite.kernel.messages import KERNEL_MESSAGES
from vrut_lite.kernel.settings import describe
from vrut_lite.messages.vocabulary import DERIVED, INPUTS

ROOT = Path(__file__).parents[1]
_MESSAGES = {kind.__name__ for kind in KERNEL_MESSAGES}
# Files of the repository's root, by their page.
ROOT_PAGES = {
    "index.md": "README.md",
    "architecture.md": "ARCHITECTURE.md",
    "contributing.md": "CONTRIBUTING.md",
    "changelog.md": "CHANGELOG.md",
}


def on_files(files: Any, config: Any) -> Any:
    """Add the pages that are made (mkdocs' event `files`)."""
    from mkdocs.structure.files import File

    for page, content in made_pages():
        files.append(File.generated(config, page, content=content))
    return files


def on_page_markdown(markdown: str, page: Any, config: Any, files: Any) -> str:
    """Let a page of docs/ link the pages of the repository's root (mkdocs' event)."""
    return _with_links_to_pages(markdown, "../")


def on_page_content(html: str, page: Any, config: Any, files: Any) -> str:
    """Let pictures open themselves at full size, and names in tables break (mkdocs' event)."""
    linked = re.sub(r'(<img [^>]*\bsrc="([^"]+)"[^>]*>)', r'<a href="\2">\1</a>', html)
    return re.sub(r"<td><code>\w+</code>", lambda cell: cell.group().replace("_", "_<wbr>"), linked)


def made_pages() -> Iterator[tuple[str, str]]:
    """Each made page's path in the site, and its Markdown."""
    for page, source in ROOT_PAGES.items():
        text = (ROOT / source).read_text()
        text = re.sub(r"\[docs/(\w+)\.md\]", r"[\1]", text).replace("](docs/", "](")
        yield page, _with_links_to_pages(text, "")
    yield "reference/commands.md", "\n".join(commands_reference())
    yield "reference/settings.md", "\n".join(settings_reference())
    yield "reference/messages.md", "\n".join(messages_reference())
    yield "reference/python.md", "\n".join(python_reference())


def _with_links_to_pages(text: str, up: str) -> str:
    for page, source in ROOT_PAGES.items():
        text = text.replace(f"]({up}{source}", f"]({page}")
    return text


def commands_reference() -> Iterator[str]:
    """Every command with its arguments and options, as `--help` has them."""
    yield "# Every command\n"
    yield from _command("vrut-lite", root, click.Context(root, info_name="vrut-lite"))


def _command(name: str, command: click.Command, context: click.Context) -> Iterator[str]:
    yield f"## {name}\n"
    yield f"    {' '.join([name, *command.collect_usage_pieces(context)])}\n"
    yield inspect.cleandoc((command.help or "").replace("\b", "")) + "\n"
    rows = [
        record
        for parameter in command.params
        if (record := parameter.get_help_record(context)) is not None
    ]
    yield from _table(("option", "meaning"), ((f"`{option}`", said) for option, said in rows))
    if isinstance(command, click.Group):
        for sub_name in command.list_commands(context):
            sub_command = command.get_command(context, sub_name)
            if sub_command is not None and not sub_command.hidden:
                full_name = f"{name} {sub_name}"
                sub_context = click.Context(sub_command, info_name=sub_name, parent=context)
                yield from _command(full_name, sub_command, sub_context)


def settings_reference() -> Iterator[str]:
    """Every installed module: slots, and settings with their ranges and defaults."""
    kernel, _ = daylight_kernel()
    yield "# Modules and settings\n"
    yield (
        "On the command line `--set MODULE.NAME=VALUE`; in a project file `[settings.MODULE]`; in "
        "Python the message `SetSetting`.\n"
    )
    for seat in kernel.seats.values():
        manifest = seat.manifest
        yield f"## {manifest.name}\n"
        slots = ", ".join(f"`{slot}`" for slot in manifest.provides)
        needs = ", ".join(f"`{slot}`" for slot in manifest.requires)
        yield f"{manifest.title}. Slots: {slots or 'none'}. Needs: {needs or 'nothing'}.\n"
        specs = describe(seat.module_type.settings_type).values()
        rows = (
            (f"`{spec.name}`", f"`{spec.default_text()}`", spec.range_text(), spec.help)
            for spec in specs
        )
        yield from _table(("setting", "default", "values", "meaning"), rows)
    kernel.close()


def messages_reference() -> Iterator[str]:
    """Every message of the host: what it says and its fields."""
    yield "# Messages\n"
    kinds = (("Inputs", INPUTS), ("What modules post", DERIVED), ("The kernel's", KERNEL_MESSAGES))
    for title, types in kinds:
        yield f"## {title}\n"
        for kind in types:
            yield f"### {kind.__name__}\n"
            yield f"`from {kind.__module__} import {kind.__name__}`\n"
            yield inspect.cleandoc(kind.__doc__ or "") + "\n"
            yield from _table(("field", "type", "default"), _fields(kind))


def _fields(kind: type) -> Iterator[tuple[str, str, str]]:
    for field in msgspec.structs.fields(kind):
        required = field.default is msgspec.NODEFAULT and field.default_factory is msgspec.NODEFAULT
        default = "" if required else f"`{field.default!r}`"
        if field.default_factory is not msgspec.NODEFAULT:
            default = f"`{field.default_factory()!r}`"
        yield f"`{field.name}`", f"`{_type_text(field.type)}`", default


def _type_text(kind: Any) -> str:
    text = inspect.formatannotation(kind)
    return re.sub(r"(?:\w+\.)+(\w+)", r"\1", text)


def python_reference() -> Iterator[str]:
    """Directives that mkdocstrings fills from the docstrings."""
    yield "# Python\n"
    yield "These names are public; [promises.md](../promises.md) says what that means.\n"
    for title, modules in PYTHON.items():
        yield f"## {title}\n"
        for module, names in modules.items():
            yield from (f"::: {name}\n" for name in _shown(module, names))


def _shown(module: str, names: tuple[str, ...] | None) -> list[str]:
    """A python module, or some of its names; messages have a page of their own."""
    if names is None:
        return [module]
    shown = [name for name in names if name not in _MESSAGES]
    imported = importlib.import_module(module)
    if hasattr(imported, "__getattr__"):
        # mkdocstrings reads files: a name that is imported late stands in its own.
        return [f"{getattr(imported, name).__module__}.{name}" for name in shown]
    return [f"{module}.{name}" for name in shown]


def _table(head: tuple[str, ...], rows: Iterable[tuple[str, ...]]) -> Iterator[str]:
    lines = [" | ".join(_in_one_cell(cell) for cell in row) for row in rows]
    if lines:
        yield "\n".join(
            [
                f"| {' | '.join(head)} |",
                "|" + "---|" * len(head),
                *(f"| {line} |" for line in lines),
            ]
        )
        yield ""


def _in_one_cell(text: str) -> str:
    return " ".join(text.split()).replace("|", "\\|")
