"""Variants of one scene: orientations and glazings by name, from a TOML file.

    [west]
    north_offset_deg = 90
    [triple.glazing."glass"]
    transmittance = 0.55
    panes = 3

A table is a variant; its name is that of its folder.
"""

import re
import tomllib
from pathlib import Path
from typing import Annotated

import msgspec

from vrut_lite.errors import UserError
from vrut_lite.headless import Project
from vrut_lite.messages.glazing import Glazing, GlazingFile
from vrut_lite.text_files import read_text

_MOST_BYTES, _MOST = 1 << 20, 200
# Names that are folders on every system.
_NAME = re.compile(r"[\w][\w .-]{0,60}")


class DaylightVariant(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Differences from a project; a missing field is the project's."""

    north_offset_deg: Annotated[float, msgspec.Meta(ge=-360, le=360)] | None = None
    glazing: dict[str, Glazing] = {}
    bsdf: dict[str, GlazingFile] = {}

    def applied(self, project: Project) -> Project:
        """The project with what differs; materials that are not named keep their glazing."""
        turned = (
            project.north_offset_deg if self.north_offset_deg is None else self.north_offset_deg
        )
        # A material has one kind of glazing.
        glazing = {name: one for name, one in project.glazing.items() if name not in self.bsdf}
        bsdf = {name: one for name, one in project.bsdf.items() if name not in self.glazing}
        return msgspec.structs.replace(
            project,
            north_offset_deg=turned,
            glazing=glazing | self.glazing,
            bsdf=bsdf | self.bsdf,
        )


def read_variants(path: str | Path) -> dict[str, DaylightVariant]:
    """Variants by name; files of measured glazing are relative to the file.

    Raises:
        UserError: it cannot be read, has no variant, or one has impossible values.
    """
    file = Path(path)
    text = read_text(file, "the variants", _MOST_BYTES)
    try:
        tables = tomllib.loads(text)
    except ValueError as error:
        raise UserError(f"the variants {file} are no TOML: {error}") from None
    if not 0 < len(tables) <= _MOST:
        raise UserError(f"{file} has {len(tables)} variants: give 1 to {_MOST} tables")
    found = {}
    for name, table in tables.items():
        if not _NAME.fullmatch(name) or name.endswith((".", " ")):
            raise UserError(f"{file}: the variant {name!r} has no name that a folder may have")
        try:
            variant = msgspec.convert(table, DaylightVariant)
        except msgspec.ValidationError as error:
            raise UserError(f"{file}: the variant {name}: {error}") from None
        beside = {
            material: one.with_paths(lambda told: str(file.parent / told))
            for material, one in variant.bsdf.items()
        }
        found[name] = msgspec.structs.replace(variant, bsdf=beside)
    return found
