"""Presets: settings of a module by name, a JSON file for each module."""

from pathlib import Path
from typing import Any

from platformdirs import user_config_path

from vrut_lite.app.json_files import read_object, write_object

Values = dict[str, Any]


class PresetStore:
    """Presets of all modules in one folder, created with the first preset."""

    def __init__(self, folder: Path | None = None):
        self._folder = folder or user_config_path("vrut_lite") / "presets"

    def names(self, module: str) -> list[str]:
        """The presets of a module, sorted."""
        return sorted(self._read(module))

    def values(self, module: str, name: str) -> Values:
        """The settings of a preset; none if it is gone."""
        return self._read(module).get(name, {})

    def keep(self, module: str, name: str, values: Values) -> None:
        """Save settings under a name; replaces older ones.

        Raises:
            UserError: the folder cannot be written to.
        """
        file = self._file(module)
        write_object(file, {**read_object(file), name: values})

    def forget(self, module: str, name: str) -> None:
        """Delete a preset."""
        file = self._file(module)
        write_object(file, {k: v for k, v in read_object(file).items() if k != name})

    def _file(self, module: str) -> Path:
        return self._folder / f"{module}.json"

    def _read(self, module: str) -> dict[str, Values]:
        presets = read_object(self._file(module))
        return {name: kept for name, kept in presets.items() if isinstance(kept, dict)}
