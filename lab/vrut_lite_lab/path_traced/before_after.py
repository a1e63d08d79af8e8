"""Twenty pictures without light transport, with it, and path traced, side by side on one sheet.

    python -m vrut_lite_lab.path_traced.before_after SHEET.jpg

Prague, 21 June, Hosek and Wilkie's sky of turbidity 3 over ground of albedo 0.1, no air. The frame
and the truth, without its grain, have the frame's exposure; the picture without light transport
has its own, as one would have seen it. The truths must be on disk: trace_truths puts them there.
"""

import argparse
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import msgspec
from light_transport.messages import NAME

from vrut_lite.errors import UserError
from vrut_lite.pictures.display import display_picture
from vrut_lite.project import Project
from vrut_lite.studio.scene_pictures import SceneShot
from vrut_lite_lab.path_traced.cases import HOURS, Case
from vrut_lite_lab.path_traced.table import truth_of
from vrut_lite_lab.pictures.drawing import Captioned, sheet, shots
from vrut_lite_lab.scenes import trials

SKY = "dynamic_skylight"
SCENES = ("street.toml", "large/hall.toml", "work/indoor.glb", "pavilion.gltf", "spheres.glb",
          "large/terrain.toml")  # fmt: skip
# Rooms that are no bundled scenes.
TRIALS = (("colour_bleeding", "20:00"), ("staircase", "12:30"))
_TRIPLES, _QUALITY = 2, 80


@dataclass(frozen=True)
class Triples:
    """A scene at some hours."""

    scene: str
    hours: tuple[str, ...]

    @cached_property
    def cases(self) -> list[Case]:
        """What is compared."""
        return [Case(self.scene, SKY, hour) for hour in self.hours]

    def pictures(self) -> Iterator[Captioned]:
        """Of each hour: without light transport, with it, path traced."""
        project = self.cases[0].project
        off = {**project.settings, NAME: {"on": False}}
        befores = self._shots(msgspec.structs.replace(project, settings=off))
        for case, before, after in zip(self.cases, befores, self._shots(project), strict=True):
            found = truth_of(case)
            if found is None:
                raise UserError(f"no truth of {case.caption} is on disk; trace_truths makes it")
            ev100 = after.picture.ev100
            where = f"{Path(case.scene).stem} {case.hour}"
            yield f"{where}, off, EV {before.picture.ev100:.1f}", before.picture.display
            yield f"on, EV {ev100:.1f}", after.picture.display
            yield "path traced", display_picture(found.clean, ev100)

    def _shots(self, project: Project) -> Iterator[SceneShot]:
        hours = [case.project.at for case in self.cases]
        return shots(project, [hour for hour in hours if hour is not None])


def drawn() -> list[Triples]:
    """All scenes in the order of the sheet; trial scenes are written to their folder."""
    files = trials.build()
    trials.FOLDER.mkdir(parents=True, exist_ok=True)
    triples = [Triples(scene, HOURS) for scene in SCENES]
    for name, hour in TRIALS:
        path = trials.FOLDER / f"{name}.glb"
        path.write_bytes(files[path.name])
        triples.append(Triples(str(path), (hour,)))
    return triples


def main() -> None:
    """Write the sheet."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("sheet", type=Path)
    chosen = parser.parse_args()
    pictures = [picture for triples in drawn() for picture in triples.pictures()]
    sheet(pictures, 3 * _TRIPLES).save(chosen.sheet, quality=_QUALITY, optimize=True)


if __name__ == "__main__":
    main()
