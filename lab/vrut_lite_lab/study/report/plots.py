"""The two plots of the rules: error by the sun's zenith angle, and run time against error."""

from collections.abc import Sequence
from io import BytesIO
from typing import Any

from vrut_lite_lab.study.rules.against_truth import RULES, SAMPLES, RuleError
from vrut_lite_lab.study.rules.run_times import RunTime

OURS = "gauss-legendre"
_STYLES = {
    "midpoint": ("tab:blue", "o", "Midpoint"),
    "trapezoid": ("tab:orange", "s", "Trapezoid"),
    "simpson-trapezoid": ("tab:red", "v", "Simpson, odd nodes by trapezoid"),
    "simpson": ("tab:green", "^", "Simpson"),
    OURS: ("black", "D", "Gauss-Legendre"),
}
_SHOWN_NODES = (8, 12, 16)


def errors_by_sun(errors: Sequence[RuleError]) -> bytes:
    """PNG: a row of panels for each atmosphere, a panel for each number of samples."""
    airs = list(dict.fromkeys(each.air for each in errors))
    figure, axes = _subplots(len(airs), len(SAMPLES))
    for row, air in zip(axes, airs, strict=True):
        for axis, pair in zip(row, SAMPLES, strict=True):
            some = [each for each in errors if each.air == air]
            for rule in RULES:
                _line(axis, [e for e in some if (e.rule, e.samples) == (rule, pair)], rule)
            for count in _SHOWN_NODES:
                ours = [e for e in some if (e.rule, e.samples) == (OURS, count)]
                axis.plot([e.sun_zenith_deg for e in ours], [e.rms for e in ours], "k:", lw=0.8)
                axis.annotate(str(count), (ours[0].sun_zenith_deg, ours[0].rms), fontsize=7)
            axis.set(title=f"atmosphere {air}, {pair[0]} × {pair[1]}", yscale="log")
            axis.set(xlabel="sun's zenith angle in degrees", ylabel="relative RMSE")
            axis.grid(alpha=0.3)
    _legend(figure, axes[0][0])
    figure.suptitle("Against the integral itself; dotted: Gauss-Legendre, nodes per segment")
    return _png(figure)


def _line(axis: Any, errors: Sequence[RuleError], rule: str) -> None:
    colour, marker, label = _STYLES[rule]
    x, y = [e.sun_zenith_deg for e in errors], [e.rms for e in errors]
    axis.plot(x, y, marker + "-", color=colour, label=label, ms=4, lw=1)


def run_time_against_error(times: Sequence[RunTime]) -> bytes:
    """PNG: a panel for each device and sun."""
    devices = list(dict.fromkeys(each.device for each in times))
    suns = list(dict.fromkeys(each.sun_zenith_deg for each in times))
    figure, axes = _subplots(len(devices), len(suns))
    for row, device in zip(axes, devices, strict=True):
        for axis, sun in zip(row, suns, strict=True):
            some = [t for t in times if (t.device, t.sun_zenith_deg) == (device, sun)]
            for rule, (colour, marker, label) in _STYLES.items():
                points = [t for t in some if t.rule == rule]
                x, y = [t.ns_per_ray for t in points], [t.rms for t in points]
                axis.loglog(x, y, marker + "-", color=colour, label=label, ms=4, lw=1)
            axis.set(title=f"{device}, sun {sun:g}° from the zenith", ylabel="relative RMSE")
            axis.set(xlabel="nanoseconds of CPU time per ray, three wavelengths")
            axis.grid(alpha=0.3)
    _legend(figure, axes[0][0])
    return _png(figure)


def _subplots(rows: int, columns: int) -> tuple[Any, Any]:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(4.4 * columns, 3.3 * rows), layout="constrained")
    return figure, figure.subplots(rows, columns, squeeze=False)


def _legend(figure: Any, axis: Any) -> None:
    figure.legend(*axis.get_legend_handles_labels(), loc="outside lower center", ncols=5)


def _png(figure: Any) -> bytes:
    into = BytesIO()
    figure.savefig(into, format="png", dpi=110)
    return into.getvalue()
