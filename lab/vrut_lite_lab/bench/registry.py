"""All kinds of computation by name."""

from collections.abc import Callable

from vrut_lite.errors import UserError
from vrut_lite_lab.bench.bench_path import Group
from vrut_lite_lab.bench.paths import (
    air,
    dispatch,
    first_light,
    frame,
    frame_peers,
    hosek_wilkie,
    light_map,
    night,
    single_scattering,
    sky_view,
    solver,
    sun,
    tables,
    window,
)

# Frames and the window come last: frames take the one context of OpenGL for themselves.
KINDS: dict[str, Callable[[bool], list[Group]]] = {
    "sun": sun.groups,
    "hosek-wilkie": hosek_wilkie.groups,
    "single-scattering": single_scattering.groups,
    "solver": solver.groups,
    "sky-view": sky_view.groups,
    "tables": tables.groups,
    "air": air.groups,
    "light-map": light_map.groups,
    "first-light": first_light.groups,
    "dispatch": dispatch.groups,
    "night": night.groups,
    "frame": frame.groups,
    "frame-peers": frame_peers.groups,
    "window": window.groups,
}


def chosen_kinds(names: str | None) -> list[str]:
    """The kinds of computation that are named, comma-separated; all of them without names.

    Raises:
        UserError: a name is none of them.
    """
    if names is None:
        return list(KINDS)
    asked = [name.strip() for name in names.split(",")]
    for name in asked:
        if name not in KINDS:
            raise UserError(f"there is no computation {name!r} to measure: {', '.join(KINDS)}")
    return [kind for kind in KINDS if kind in asked]
