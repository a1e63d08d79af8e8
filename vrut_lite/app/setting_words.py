"""Settings in people's words: labels, choices, ranges, tooltips. Scripts keep their names."""

import re
from typing import Any

from vrut_lite.kernel.settings import SettingSpec
from vrut_lite.quantities import figure, suffix_of

LEFT_OPEN = "automatic"
# Endings of names that are left out, since the unit stands beside the number.
_UNIT_ENDINGS = (
    "_per_m", "_m_s", "_w_m2", "_cd_m2", "_deg_c", "_lux", "_deg", "_rad", "_nm", "_du", "_km",
    "_kib", "_mib", "_sfu", "_m", "_s", "_k",
)  # fmt: skip
_ABBREVIATIONS = ("cpu", "gpu", "llvm")


def label_of(spec: SettingSpec) -> str:
    """The setting's label: its author's, or its name without the unit beside the number."""
    if spec.label:
        return spec.label
    name = spec.name
    if spec.unit:
        ending = next((ending for ending in _UNIT_ENDINGS if name.endswith(ending)), "")
        name = name.removesuffix(ending)
    words = name.replace("_", " ")
    return words[:1].upper() + words[1:]


def left_open_label(spec: SettingSpec) -> str:
    """The entry that leaves a choice unset."""
    return spec.choice_labels.get("none", LEFT_OPEN)


def choice_label(spec: SettingSpec, choice: Any) -> str:
    """A choice as people read it."""
    text = str(choice)
    if text in spec.choice_labels:
        return spec.choice_labels[text]
    return text.upper() if text in _ABBREVIATIONS else re.sub("[-_]", " ", text)


def value_text(spec: SettingSpec, value: Any) -> str:
    """A value as people read it, with its unit."""
    if value is None:
        return left_open_label(spec)
    if isinstance(value, bool):
        return "on" if value else "off"
    if isinstance(value, (int, float)):
        return figure(value) + suffix_of(spec.unit)
    return choice_label(spec, value) if spec.choices else str(value) or "none"


def tooltip_of(spec: SettingSpec) -> str:
    """The setting's help, range, default and source."""
    values = _values_text(spec)
    lines = [f"{values}; default {value_text(spec, spec.default)}" if values else ""]
    if spec.help:
        lines.insert(0, spec.help.rstrip(".") + ".")
    if spec.source:
        lines.append(f"Source: {spec.source}")
    return "\n".join(line for line in lines if line)


def _values_text(spec: SettingSpec) -> str:
    """The accepted values."""
    said = _range_text(spec)
    return f"{said}, or {left_open_label(spec)}" if said and spec.may_be_none else said


def _range_text(spec: SettingSpec) -> str:
    if spec.choices:
        return "One of " + ", ".join(choice_label(spec, choice) for choice in spec.choices)
    low, high = spec.at_least, spec.at_most
    if low is not None and high is not None:
        return f"Between {figure(low)} and {figure(high)}{suffix_of(spec.unit)}"
    if low is not None:
        return f"At least {figure(low)}{suffix_of(spec.unit)}"
    if high is not None:
        return f"At most {figure(high)}{suffix_of(spec.unit)}"
    return {bool: "On or off", int: "A whole number", float: "A number"}.get(spec.type, "")
