"""The benchmark's rows of the card, by timer queries; where there is no card, by CPU time.

Published figures for comparison: the thesis's tables 5.1 and 5.2 (a cube map of Hosek and
Wilkie's sky, an environment map of Bruneton's), and Bruneton's precomputation.
"""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

from vrut_lite.errors import ModuleFailed, UserError
from vrut_lite_lab.bench.bench_path import BenchPath, Group
from vrut_lite_lab.bench.gl import close_gl
from vrut_lite_lab.bench.paths import (
    air,
    hosek_wilkie,
    light_map,
    single_scattering,
    sky_view,
    tables,
)
from vrut_lite_lab.bench.runner import QUICK, measure_group
from vrut_lite_lab.card_check import night_and_clouds
from vrut_lite_lab.card_check.parts import Keep

_KINDS = (hosek_wilkie, sky_view, night_and_clouds, air, light_map, single_scattering, tables)


def measure(_folder: Path, keep: Keep) -> None:
    """Time each path of a card; errors are the parity's and the tests'."""
    found: list[dict[str, Any]] = []
    refused: list[str] = []
    for group in _groups():
        try:
            rows = measure_group(group, QUICK, print, lambda *why: refused.append(" ".join(why)))
        except (ModuleFailed, UserError) as error:
            refused.append(f"{group.name}: {error}")
            rows = []
        found += [
            {
                "group": row.group,
                "name": row.name,
                "seconds": row.seconds,
                "wall_s": row.wall_s,
                "clock": row.clock,
                "unit": group.unit,
            }
            for row in rows
        ]
        keep({"rows": found, "refused": refused})
    close_gl()


def _groups() -> Iterator[Group]:
    for kind in _KINDS:
        for group in kind.groups(quick=False):
            paths = tuple(_without_error(path) for path in group.paths if path.device == "GPU")
            if paths:
                yield replace(group, paths=paths)


def _without_error(path: BenchPath) -> BenchPath:
    return replace(path, error=None)
