"""A picture's metadata as a JSON file, for programs that cannot read its header."""

import json
import os
from collections.abc import Mapping

from vrut_lite.write_atomic import atomic_output


def write_json(path: str | os.PathLike[str], values: Mapping[str, object]) -> None:
    """Write names and values, one a line.

    Raises:
        UserError: the file cannot be written.
    """
    text = json.dumps(values, indent=2, ensure_ascii=False, allow_nan=False)
    with atomic_output(path) as beside:
        beside.write_text(text + "\n", encoding="utf-8")
