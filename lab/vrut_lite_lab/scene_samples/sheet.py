"""Every kind of sample in frame and path tracer, and what differs, on one sheet.

    python -m vrut_lite_lab.scene_samples.sheet SHEET.webp [KIND...] [--spp N] [--folder FOLDER]

Columns are the frame, the path tracer's picture at the frame's exposure, and their FLIP. Printed is
a Markdown table of FLIP's mean, the ratio of both pictures' mean luminance, and what was told.
"""

import argparse
import tempfile
from pathlib import Path

import flip_evaluator
import msgspec
import numpy as np
from numpy.typing import NDArray
from path_tracer.settings import PathTracerSettings
from path_tracer.subject import Subject
from path_tracer.tracer import Tracer

from vrut_lite.geometry.colour import luminance
from vrut_lite.host import Host
from vrut_lite.pictures.display import display_picture
from vrut_lite.project import daylight_inputs, view_inputs
from vrut_lite.studio.open_kernel import open_host
from vrut_lite_lab.pictures.drawing import Captioned, sheet
from vrut_lite_lab.scene_samples.files import Sample, samples

SIZE = (176, 110)
_COLUMNS = 3 * 4


def compared(host: Host, sample: Sample, spp: int) -> tuple[str, list[Captioned]]:
    """A line of the table, and the three pictures."""
    project = msgspec.structs.replace(sample.project, size=SIZE)
    host.inject(*daylight_inputs(project), *view_inputs(project))
    picture = host.draw()
    tracer = Tracer(Subject(host.state), PathTracerSettings(spp=spp))
    traced = tracer.trace(0, spp)
    assert traced is not None
    assert host.state.scene is not None
    frame = picture.radiance
    pictures: list[NDArray[np.uint8]] = [
        np.asarray(display_picture(one, picture.ev100), np.uint8) for one in (frame, traced)
    ]
    one, other = (np.asarray(picture, np.float32) / 255.0 for picture in pictures)
    error, mean, _ = flip_evaluator.evaluate(other, one, "LDR", applyMagma=True)
    ratio = float(luminance(frame).mean() / luminance(traced).mean())
    told = "; ".join(host.state.scene.notices)
    flipped = np.round(255 * np.asarray(error)).astype(np.uint8)
    shown: list[Captioned] = [
        (sample.kind, pictures[0]),
        ("path traced", pictures[1]),
        (f"FLIP {mean:.3f}", flipped),
    ]
    return f"| {sample.kind} | {mean:.3f} | {ratio:.3f} | {told} |", shown


def main() -> None:
    """Draw it."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("sheet", type=Path)
    parser.add_argument("kinds", nargs="*")
    parser.add_argument("--spp", type=int, default=64)
    parser.add_argument("--folder", type=Path)
    chosen = parser.parse_args()
    shown: list[Captioned] = []
    print("| kind | FLIP | frame / traced | told |\n|---|---|---|---|")
    with tempfile.TemporaryDirectory() as temporary:
        folder = chosen.folder or Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        host = open_host()
        for sample in samples(folder):
            if chosen.kinds and sample.kind not in chosen.kinds:
                continue
            line, pictures = compared(host, sample, chosen.spp)
            print(line, flush=True)
            shown += pictures
            sheet(shown, _COLUMNS).save(chosen.sheet, quality=85)
        host.close()


if __name__ == "__main__":
    main()
