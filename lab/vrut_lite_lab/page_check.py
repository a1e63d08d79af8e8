"""A shared page beside the program: likeness, lux, first picture and the speed of a dragged hour.

    python -m vrut_lite_lab.page_check PAGE.html SCENE [--out FOLDER] [--only light|speed] [OPTIONS]

PAGE.html is what `vrut-lite share SCENE` wrote, at the same place and under the same sky. Further
options are those of `vrut-lite render`, such as `--genus Cu --wind-speed-m-s 0`: without wind
clouds are the same at all hours, as a page freezes them. Pictures have 640 x 400 pixels; the page's
are drawn by Chromium's software renderer. FOLDER keeps the program's pictures (the slow part), the
page's, its lux by the light map, and maps of FLIP. Needs Linux, chromium and the extra `ref`.

The program's pictures are those of a tolerance of 1 %. At 3 % their own noise puts 0.4 to 0.7 of
100 even pixels of a hall 5 % off, at the default of 10 % it puts 2.

Lux is compared at even pixels: surfaces whose lux in the program's own picture changes by less than
5 % within two pixels each way. Next to edges of shadows and things a pixel's mean and the value of
its middle differ, whatever the light. All even pixels count by the page's light map, which its
false colours show, and some of them, drawn at random, as a pointer that rests there reads them.
"""

import argparse
import base64
import importlib.util
import io
import os
import subprocess
import sys
import tempfile
from contextlib import suppress
from pathlib import Path
from time import perf_counter
from typing import Any

import flip_evaluator
import numpy as np
import OpenEXR
from numpy.typing import NDArray
from PIL import Image
from scipy.ndimage import maximum_filter, minimum_filter

from vrut_lite_lab.checkout import ROOT

HOURS = ("07:00", "12:30", "17:00", "20:30")
DAY = "2026-06-21"
SIZE_PX = (640, 400)
POINTS, LARGEST_ERROR = 40, 0.05
TOLERANCE = 0.01
# Largest ratio of the program's lux within a square of so many pixels around an even one.
_EVEN, _NEAR_PX = 1.05, 5
_DRAG_S, _DRAG_MINUTES = 8.0, 2.0
_VRUT_LITE = str(Path(sys.executable).with_name("vrut-lite"))
# The picture has the given size, whatever the window's; requestAnimationFrame is the script's own.
_FIX_SIZE = """(() => {{
    const page = window.daylight;
    page.layOut = () => {{}};
    page.canvas.style.width = '{0}px';
    page.canvas.style.height = '{1}px';
    page.view.resize({0}, {1}, 1);
    page.showView(Object.keys(page.header.views)[0]);
    page.view.camera.updateMatrixWorld(true);
    page.change();
}})()"""
_FINISHED = """(() => {{
    const page = window.daylight;
    page.setHour(page.day, {0});
    page.frame = () => {{}};
    page.moved = false;
    for (let k = 0; k < 60; ++k) {{ page.step(); if (!page.dirty) break; }}
    page.step();
    return page.canvas.toDataURL();
}})()"""
# Lux of all pixels, rows from the lower edge, as base64 of float32.
_LUX = """(() => {{
    const {{ view }} = window.daylight, {{ renderer, shared, points: {{ probe }} }} = view;
    const texels = new Float32Array(4 * {0} * {1});
    view.light.map.complete();
    probe.setSize({0}, {1});
    shared.values_shown.value = 1;
    shared.jitter.value.set(0, 0);
    renderer.setRenderTarget(probe);
    renderer.clear();
    renderer.render(view.scene, view.camera);
    renderer.readRenderTargetPixels(probe, 0, 0, {0}, {1}, texels);
    probe.setSize(1, 1);
    shared.values_shown.value = 0;
    const bytes = new Uint8Array(texels.filter((_, k) => k % 4 === 0).buffer);
    let text = '';
    for (let k = 0; k < bytes.length; k += 8192) {{
        text += String.fromCharCode(...bytes.subarray(k, k + 8192));
    }}
    return btoa(text);
}})()"""
# Lux that a resting pointer reads in the middles of pixels, a column and a row each.
_READ = "{0}.map(([x, y]) => window.daylight.view.points.gathered(x + 0.5, y + 0.5))"
# Pictures of a dragged hour; each waits for the last pixel, and has a code of its own.
_DRAG = """new Promise((done) => {{
    const page = window.daylight, {{ view }} = page, gl = view.renderer.getContext();
    const texel = new Uint8Array(4), codes = new Set(), seconds = [];
    const step = page.step.bind(page), begin = performance.now();
    let last = begin, way = 1;
    page.dragging = true;
    page.step = () => {{
        step();
        gl.bindFramebuffer(gl.FRAMEBUFFER, null);
        gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, texel);
        const now = performance.now();
        seconds.push((now - last) / 1000);
        last = now;
        codes.add(page.minute);
    }};
    const pull = () => {{
        if (performance.now() - begin > {0} * 1000) {{
            page.step = step;
            page.dragging = false;
            page.change();
            const wall = (last - begin) / 1000, {{ coarser }} = view;
            done({{ seconds, hours: codes.size, coarser, wall }});
            return;
        }}
        if (page.minute > 1110) way = -1;
        if (page.minute < 390) way = 1;
        page.setHour(page.day, page.minute + way * {1});
        requestAnimationFrame(pull);
    }};
    requestAnimationFrame(pull);
}})"""


def browser_of(folder: Path, size: tuple[int, int]) -> Any:
    """A browser without a window, by the driver of the product's own tests."""
    path = ROOT / "tests" / "share" / "browser.py"
    spec = importlib.util.spec_from_file_location("browser", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.Browser(folder, size)


def rendered(scene: str, sky: list[str], hour: str, folder: Path) -> tuple[Path, Path]:
    """The program's picture and its illuminance; drawn where the folder lacks them."""
    paths = []
    for name, options in (("own", []), ("lux", ["--show", "illuminance"])):
        path = folder / f"{name}_{hour.replace(':', '')}.{'png' if name == 'own' else 'exr'}"
        paths.append(path)
        if not path.is_file():
            size = "x".join(map(str, SIZE_PX))
            given = ["--at", f"{DAY}T{hour}", "--size", size, *options]
            given += ["--tolerance", str(TOLERANCE), *sky]
            subprocess.run([_VRUT_LITE, "render", scene, "-o", str(path), *given], check=True)
    return paths[0], paths[1]


def even_pixels(lux: NDArray[np.float32]) -> NDArray[np.bool_]:
    """Pixels (h, w) of surfaces away from edges of light, by the program's lux (h, w) alone."""
    low, high = minimum_filter(lux, _NEAR_PX), maximum_filter(lux, _NEAR_PX)
    return np.asarray((low > 0.0) & (high < _EVEN * low))


def decoded(url: str) -> NDArray[np.uint8]:
    """Display values (h, w, 3) of a data URL."""
    content = base64.b64decode(url.partition(",")[2])
    return np.asarray(Image.open(io.BytesIO(content)).convert("RGB"))


def compare_light(browser: Any, scene: str, sky: list[str], folder: Path) -> None:
    """Print FLIP and lux of the page's finished pictures beside the program's."""
    for hour in HOURS:
        own_path, lux_path = rendered(scene, sky, hour, folder)
        hours, minutes = map(int, hour.split(":"))
        seen = decoded(browser.value(_FINISHED.format(60 * hours + minutes), 400.0))
        own = np.asarray(Image.open(own_path).convert("RGB"))
        error, mean, _ = flip_evaluator.evaluate(
            own.astype(np.float32) / 255.0, seen.astype(np.float32) / 255.0, "LDR", applyMagma=False
        )
        name = hour.replace(":", "")
        Image.fromarray(seen).save(folder / f"page_{name}.png")
        grey = np.uint8(255 * np.clip(np.asarray(error).squeeze() / 0.4, 0.0, 1.0))
        Image.fromarray(grey).save(folder / f"flip_{name}.png")
        with OpenEXR.File(str(lux_path)) as file:
            lux = file.channels()["RGB"].pixels[..., 0]
        text = browser.value(_LUX.format(*SIZE_PX), 400.0)
        found = np.frombuffer(base64.b64decode(text), np.float32).reshape(lux.shape)[::-1]
        np.save(folder / f"page_lux_{name}.npy", found)
        even = even_pixels(lux)
        off = np.abs(found[even] / lux[even] - 1.0)
        row, column = np.nonzero(even)
        chosen = np.random.default_rng(1).choice(len(row), POINTS, replace=False)
        row, column = row[chosen], column[chosen]
        points = np.column_stack([column, row]).tolist()
        read = np.array(browser.value(_READ.format(points), 400.0))
        off_read = np.abs(read / lux[row, column] - 1.0)
        print(
            f"{hour}: FLIP {mean:.3f}; lux by the map within 5 % at "
            f"{np.mean(off <= LARGEST_ERROR):.1%} of {even.mean():.0%} of all pixels, median "
            f"{np.median(off):.1%}, 99 of 100 within {np.quantile(off, 0.99):.1%}; as the pointer "
            f"reads it at {np.sum(off_read <= LARGEST_ERROR)} of {POINTS}, median "
            f"{np.median(off_read):.1%}, worst {off_read.max():.1%}",
            flush=True,
        )


def measure_speed(browser: Any, process: int) -> None:
    """Print pictures a second of a dragged hour, and the processor's time for each."""
    found = browser.value(_DRAG.format(1.5, _DRAG_MINUTES))
    before = _cpu_s(process)
    found = browser.value(_DRAG.format(_DRAG_S, _DRAG_MINUTES))
    spent = _cpu_s(process) - before
    count = len(found["seconds"])
    print(
        f"dragged: {count / found['wall']:.1f} pictures a second ({found['hours']} hours), "
        f"{spent / count:.3f} s of CPU each, median {np.median(found['seconds']) * 1e3:.0f} ms, "
        f"at 1/{found['coarser']}; load {os.getloadavg()[0]:.1f}",
        flush=True,
    )


def _cpu_s(process: int) -> float:
    """Seconds of the processor that a process and all its descendants have taken."""
    parents, ticks = {}, {}
    for path in Path("/proc").glob("[0-9]*/stat"):
        with suppress(OSError):
            # Names hold spaces; what follows the last bracket does not.
            fields = path.read_text().rpartition(")")[2].split()
            number = int(path.parent.name)
            parents[number], ticks[number] = int(fields[1]), int(fields[11]) + int(fields[12])
    found, wave = 0, {process}
    while wave:
        found += sum(ticks.get(number, 0) for number in wave)
        wave = {number for number, parent in parents.items() if parent in wave}
    return found / os.sysconf("SC_CLK_TCK")


def main() -> None:
    """Print the measurements of a page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("page", type=Path)
    parser.add_argument("scene")
    parser.add_argument("--out", type=Path)
    parser.add_argument("--only", choices=("light", "speed"))
    given, sky = parser.parse_known_args()
    folder = given.out or Path(tempfile.mkdtemp())
    folder.mkdir(parents=True, exist_ok=True)
    print(f"{given.page}: {given.page.stat().st_size / 1e6:.1f} MB")
    if given.only != "speed":
        print(
            f"lux at even pixels: the program's own, at a tolerance of {TOLERANCE:.0%}, changes by "
            f"less than {_EVEN - 1.0:.0%} within {_NEAR_PX // 2} pixels each way"
        )
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        browser = browser_of(Path(profile), SIZE_PX)
        try:
            begin = perf_counter()
            browser.open(f"{given.page.resolve().as_uri()}#{DAY}T12:30")
            print(f"first picture after {perf_counter() - begin:.2f} s", flush=True)
            browser.value(_FIX_SIZE.format(*SIZE_PX))
            if given.only != "light":
                measure_speed(browser, browser._process.pid)
            if given.only != "speed":
                compare_light(browser, given.scene, sky, folder)
        finally:
            browser.close()


if __name__ == "__main__":
    main()
