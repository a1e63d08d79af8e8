"""Settings of a module kept by name, one JSON file a module."""

import json
from pathlib import Path
from typing import Any

from platformdirs import user_config_path

from vrut_lite.errors import UserError
from vrut_lite.render.write_atomic import atomic_output

Values = dict[str, Any]


class PresetStore:
    """Presets of all modules in one folder, made when the first is kept."""

    def __init__(self, folder: Path | None = None):
        self._folder = folder or user_config_path("vrut_lite") / "presets"

    def names(self, module: str) -> list[str]:
        """The presets of a module, sorted."""
        return sorted(self._read(module))

    def values(self, module: str, name: str) -> Values:
        """The settings of a preset; none if it is gone."""
        return self._read(module).get(name, {})

    def keep(self, module: str, name: str, values: Values) -> None:
        """Keep settings by a name, in place of older ones.

        Raises:
            UserError: the folder cannot be written to.
        """
        self._write(module, {**self._read(module), name: values})

    def forget(self, module: str, name: str) -> None:
        """Drop a preset."""
        self._write(module, {k: v for k, v in self._read(module).items() if k != name})

    def _file(self, module: str) -> Path:
        return self._folder / f"{module}.json"

    def _read(self, module: str) -> dict[str, Values]:
        try:
            presets = json.loads(self._file(module).read_text(encoding="utf-8"))
        except (OSError, ValueError):
            # What is not there or is no JSON holds no presets.
            return {}
        if not isinstance(presets, dict):
            return {}
        return {name: kept for name, kept in presets.items() if isinstance(kept, dict)}

    def _write(self, module: str, presets: dict[str, Values]) -> None:
        try:
            self._folder.mkdir(parents=True, exist_ok=True)
            with atomic_output(self._file(module)) as beside:
                beside.write_text(json.dumps(presets, indent=1), encoding="utf-8")
        except OSError as error:
            raise UserError(f"cannot keep a preset in {self._folder}: {error}") from None
