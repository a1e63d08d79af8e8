"""The examples that come with the program: scenes, a sky as a module, a notebook.

`examples.toml` lists them. In a wheel all lie in one folder, in a checkout in `examples/` and
`scenes/`; copied, they have the wheel's places, which are those that the documentation names.
"""

import shutil
from collections.abc import Iterable
from functools import lru_cache
from pathlib import Path
from typing import Literal

import msgspec

from vrut_lite.bundled.places import EXAMPLES, EXAMPLES_HERE, is_checkout
from vrut_lite.errors import UserError

_LIST = "examples.toml"


class Example(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """An example; the first of its files, below the folder of examples, is the one to open."""

    name: str
    title: str
    files: tuple[str, ...]
    kind: Literal["scene", "module", "notebook"] = "scene"

    @property
    def opens(self) -> Path:
        """The file to open, where it is installed."""
        return installed(self.files[0])


class _List(msgspec.Struct, frozen=True):
    example: tuple[Example, ...]


@lru_cache(maxsize=1)
def all_examples() -> dict[str, Example]:
    """The examples by name, in their order.

    Raises:
        UserError: the program came without them.
    """
    listed = msgspec.toml.decode(installed(_LIST).read_bytes(), type=_List)
    return {example.name: example for example in listed.example}


def example_named(name: str) -> Example:
    """An example.

    Raises:
        UserError: no example has this name.
    """
    known = all_examples()
    if name not in known:
        raise UserError(f"there is no example {name!r}: `vrut-lite examples` lists {_all(known)}")
    return known[name]


def installed(file: str) -> Path:
    """Where a file of the examples is on this machine.

    Raises:
        UserError: it is not there.
    """
    folders = EXAMPLES_HERE if is_checkout() else (EXAMPLES,)
    for folder in folders:
        if (folder / file).is_file():
            return folder / file
    raise UserError(
        f"this installation has no {file}: install the wheel of vrut_lite, which holds the examples"
    )


def copy_examples(examples: Iterable[Example], folder: Path) -> list[Path]:
    """Copy examples into a folder, which is made; the copies, each file once.

    Raises:
        UserError: a file is there already, so that nothing is copied, or the folder takes no
            files.
    """
    names = list(dict.fromkeys(file for example in examples for file in example.files))
    sources = {folder / name: installed(name) for name in names}
    there = next((target for target in sources if target.exists()), None)
    if there is not None:
        raise UserError(f"{there} is there already: name another folder, or move it away")
    try:
        for target, source in sources.items():
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(source, target)
    except OSError as error:
        raise UserError(f"cannot copy examples into {folder}: {error.strerror}") from error
    return list(sources)


def _all(known: Iterable[str]) -> str:
    *first, last = known
    return f"{', '.join(first)} and {last}"
