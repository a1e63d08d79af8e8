"""GLSL of the frame parts' hooks, of which several parts may have some.

The functions of each part get its name as a prefix; functions without one join them.
"""

import re
from pathlib import Path
from typing import NamedTuple

from vrut_lite.installed_parts import HOOKS_OF_ONE, HOOKS_OF_SEVERAL, frame_parts, part_with


class _Joined(NamedTuple):
    """A GLSL function that joins those of all parts.

    `start` and `step` are statements; `{part}` stands for a part's prefix.
    """

    signature: str
    start: str
    step: str


_JOINED = {
    "sun_factor": (
        _Joined(
            "float sun_factor(vec3 from_eye)",
            "float joined = 1.0;",
            "joined *= {part}sun_factor(from_eye);",
        ),
        _Joined(
            "vec3 ground_factor(vec3 from_eye)",
            "vec3 joined = vec3(1.0);",
            "joined *= {part}ground_factor(from_eye);",
        ),
        _Joined(
            "float sun_factor_end_m(vec3 d, float metres)",
            "float joined = 0.0;",
            "joined = max(joined, {part}sun_factor_end_m(d, metres));",
        ),
    ),
    "extra_lights": (
        _Joined(
            "int extra_light_count()", "int joined = 0;", "joined += {part}extra_light_count();"
        ),
        _Joined(
            "vec3 extra_light(int number, vec3 point, vec3 face, out vec3 towards)",
            "vec3 joined = vec3(0.0);\n    towards = face;",
            "if (number >= 0 && number < {part}extra_light_count())\n"
            "        joined = {part}extra_light(number, point, face, towards);\n"
            "    number -= {part}extra_light_count();",
        ),
    ),
}


def hook_of(file_name: str) -> str | None:
    """The hook for which `//!include` names a file, or None."""
    hook = file_name.removesuffix(".glsl")
    return hook if hook in (*HOOKS_OF_ONE, *HOOKS_OF_SEVERAL) else None


def hook_files(hook: str) -> dict[str, Path]:
    """The files of the installed parts that have a hook, by the parts' names."""
    if hook in HOOKS_OF_ONE:
        name = part_with(hook, frame_parts())
        return {name: getattr(frame_parts()[name], hook)} if name else {}
    files = {name: getattr(part, hook) for name, part in frame_parts().items()}
    return {name: file for name, file in files.items() if file is not None}


def hook_define(hook: str, part_name: str) -> str:
    """The define with which shaders call a part's functions of a hook of several."""
    return f"{hook}_{_identifier(part_name)}".upper()


def joined_glsl(hook: str, sources: dict[str, str]) -> str:
    """The functions of a hook of several parts, by the GLSL of each."""
    functions = _JOINED[hook]
    names = [re.search(r"(\w+)\(", each.signature)[1] for each in functions]  # type: ignore[index]
    text = ""
    for part_name, source in sources.items():
        prefix = _identifier(part_name) + "_"
        renamed = "".join(f"#define {name} {prefix}{name}\n" for name in names)
        restored = "".join(f"#undef {name}\n" for name in names)
        text += f"#ifdef {hook_define(hook, part_name)}\n{renamed}{source}\n{restored}#endif\n"
    for each in functions:
        steps = "".join(
            f"#ifdef {hook_define(hook, part_name)}\n"
            f"    {each.step.format(part=_identifier(part_name) + '_')}\n#endif\n"
            for part_name in sources
        )
        text += f"{each.signature} {{\n    {each.start}\n{steps}    return joined;\n}}\n"
    return text


def _identifier(part_name: str) -> str:
    return re.sub(r"\W", "_", part_name)
