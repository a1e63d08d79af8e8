"""Maps GPU recipes of this machine to those of the journal.

A recipe is a digest of all that decides a texture's texels. It includes uniforms, whose last digit
may differ on another processor. Jobs that are equal by value have equal textures: the recorded
texture answers this machine's job.
"""

from typing import Any

import msgspec

from vrut_lite.messages.gpu_job import GpuJob, recipe_of
from vrut_lite.recording.entry import Entry


class Recipes:
    """The recipes of the journal's jobs, and of the equal jobs here."""

    def __init__(self) -> None:
        self._here: dict[str, str] = {}

    def note(self, there: Entry, here: Entry) -> None:
        """Two entries are equal: if they are jobs, so are their textures."""
        if there.type_name == GpuJob.__name__ and there.digest != here.digest:
            recipes = recipe_of_plain(there.message), recipe_of_plain(here.message)
            if None not in recipes:
                self._here[str(recipes[0])] = str(recipes[1])

    def translated(self, entry: Entry) -> Entry:
        """An entry of the journal, with this machine's recipes."""
        if not self._here:
            return entry
        return msgspec.structs.replace(entry, message=self._translated(entry.message))

    def _translated(self, plain: Any) -> Any:
        if isinstance(plain, list):
            return [self._translated(item) for item in plain]
        if not isinstance(plain, dict):
            return plain
        fields = {name: self._translated(item) for name, item in plain.items()}
        recipe = fields.get("recipe")
        if isinstance(recipe, str):
            fields["recipe"] = self._here.get(recipe, recipe)
        return fields


def recipe_of_plain(job: dict[str, Any]) -> str | None:
    """The recipe of a plain `GpuJob`; None of one of other fields."""
    try:
        names = ("compute_shader", "uniforms", "output", "size", "format", "groups")
        then = [
            (*(step[name] for name in ("compute_shader", "uniforms", "groups")), _digests(step))
            for step in job.get("then", ())
        ]
        reads = job.get("reads")
        read = None if reads is None else reads["recipe"]
        return recipe_of(*(job[name] for name in names), _digests(job), then, read)
    except (KeyError, TypeError, ValueError):
        return None


def _digests(program: dict[str, Any]) -> list[tuple[int, str]]:
    return [(binding, handle["$array"]) for binding, handle in program["buffers"]]
