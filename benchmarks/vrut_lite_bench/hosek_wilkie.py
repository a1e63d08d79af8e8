"""Run time and error of every path to a Hosek-Wilkie cube map, in the same run.

    python -m vrut_lite_bench.hosek_wilkie [PLOT.png]

One thread, CPU time, the least of all rounds in which the paths take turns: that is what
other work on the machine disturbs least. Set OPENBLAS_NUM_THREADS=1.
"""

import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from typing import Any, NamedTuple

from vrut_lite_bench import hosek_wilkie_gpu, hosek_wilkie_mitsuba
from vrut_lite_bench.hosek_wilkie_paths import PATHS, exact_cube
from vrut_lite_bench.hosek_wilkie_published import THESIS_MS

SIZES = (64, 128, 256, 512, 1024, 2048, 4096)
MITSUBA_SIZES = (64, 256, 1024)
# numba itself takes its time to start, once in a process, whatever it is asked first.
_FIRST_CALL = """
import time
start = time.process_time()
import numba
numba.njit(lambda x: x + 1)(1)
numba_s = time.process_time() - start
from dynamic_skylight import HosekWilkieSky
sky = HosekWilkieSky(3.0, 0.1, 0.7)
sky.rgb_distribution, sky.rgb_mean_radiance
start = time.process_time()
sky.cube_map(256)
print(numba_s, time.process_time() - start)
"""


class Row(NamedTuple):
    """Seconds by size, and the error at 256 texels; None where there is none to tell."""

    seconds: dict[int, float]
    error: float | None


def measure(budget_s: float = 1.5) -> dict[str, Row]:
    """Every path's row; each size of a path gets so much time, or three rounds."""
    rows = {}
    exact = exact_cube(256)
    for path in PATHS:
        rows[path.name] = Row({}, path.error(path.make(256)(), exact))
    for size in SIZES:
        runs = {path.name: path.make(size) for path in PATHS if size <= path.largest}
        for name, spent in _take_turns(runs, budget_s * len(runs)).items():
            rows[name].seconds[size] = spent
    gpu = hosek_wilkie_gpu.measure(SIZES)
    rows[f"GPU shader, float16 ({gpu.renderer}, {gpu.clock})"] = Row(gpu.seconds, gpu.error)
    mitsuba = hosek_wilkie_mitsuba.measure(MITSUBA_SIZES)
    for texels in ("sky", "all"):
        seconds = {int(size): spent for size, spent in mitsuba[texels].items()}
        rows[f"mitsuba {mitsuba['variant']}, {texels} texels"] = Row(seconds, None)
    for name, figures in THESIS_MS.items():
        rows[name] = Row({size: ms * 1e-3 for size, ms in figures.items()}, None)
    return rows


def _take_turns(runs: dict[str, Any], budget_s: float) -> dict[str, float]:
    least = dict.fromkeys(runs, float("inf"))
    end, rounds = time.perf_counter() + budget_s, 0
    while rounds < 3 or (time.perf_counter() < end and rounds < 100):
        rounds += 1
        for name, run in runs.items():
            # Some times in a row, as a running program does: another path has the caches filled.
            for _ in range(5 if least[name] < 0.02 else 1):
                start = time.process_time()
                run()
                least[name] = min(least[name], time.process_time() - start)
    return least


def first_calls() -> tuple[float, float, float]:
    """Seconds of CPU: starting numba, the first map with compilation, and from the cache."""
    with tempfile.TemporaryDirectory() as cache:
        environment = {**os.environ, "NUMBA_CACHE_DIR": cache}
        answers = [
            subprocess.run(
                [sys.executable, "-c", _FIRST_CALL],
                env=environment,
                capture_output=True,
                text=True,
                check=True,
            ).stdout.split()
            for _ in range(4)
        ]
    compiled = float(answers[0][1])
    cached = [[float(figure) for figure in answer] for answer in answers[1:]]
    return min(a for a, _ in cached), compiled, min(b for _, b in cached)


def report(rows: dict[str, Row]) -> Iterator[str]:
    """A Markdown table in milliseconds, and what follows from it."""
    yield "| path | " + " | ".join(f"{size}²" for size in SIZES) + " | largest error |"
    yield "|---|" + "---:|" * (len(SIZES) + 1)
    for name, row in rows.items():
        cells = [_cell(row.seconds.get(size)) for size in SIZES]
        error = "" if row.error is None else f"{row.error:.1e}"
        yield f"| {name} | " + " | ".join(cells) + f" | {error} |"
    fast, sky_only = rows["fast, float32"].seconds, rows["fast, float32, sky rows only"].seconds
    for name, row in rows.items():
        for size in (256, 1024):
            if size in row.seconds and not name.startswith("fast"):
                against = sky_only if "sky texels" in name else fast
                ratio = row.seconds[size] / against[size]
                yield f"{name}, {size}²: {ratio:.1f} times the fast path"
    start_s, compiled_s, cached_s = first_calls()
    yield f"numba starts in {start_s * 1e3:.0f} ms; then the first map takes"
    yield f"{cached_s * 1e3:.0f} ms from the compile cache, {compiled_s:.2f} s with compilation"


def _cell(seconds: float | None) -> str:
    return "" if seconds is None else f"{seconds * 1e3:.3g}"


def plot(rows: dict[str, Row], file: str) -> None:
    """Run time against error, both logarithmic: a line for each path, a dot for each size."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(figsize=(8.5, 5.2), dpi=130)
    for name, row in rows.items():
        if row.error is None or name.endswith("only"):
            continue
        sizes = [size for size in row.seconds if size <= 1024]
        times = [row.seconds[size] * 1e3 for size in sizes]
        (line,) = axes.plot(times, [row.error] * len(sizes), "-", linewidth=1, label=name)
        for size, spent in zip(sizes, times, strict=True):
            axes.plot(spent, row.error, "o", color=line.get_color(), markersize=size**0.5 / 3 + 1)
    axes.set(xscale="log", yscale="log", xlabel="CPU time for a map, ms (64² to 1024², the dots)")
    axes.set_ylabel("largest error, of max(value, 1 % of maximum)")
    axes.set_ylim(1e-17, 1.0)
    axes.legend(loc="center left", bbox_to_anchor=(0.02, 0.42), fontsize=8)
    axes.grid(visible=True, which="major", linewidth=0.3)
    axes.set_title("Hosek-Wilkie cube map: run time against error", fontsize=10)
    figure.tight_layout()
    figure.savefig(file)


if __name__ == "__main__":
    measured = measure()
    for text in report(measured):
        print(text, flush=True)
    for picture in sys.argv[1:]:
        plot(measured, picture)
