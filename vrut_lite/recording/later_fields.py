"""Fields that a message got after a journal was written: they have their defaults there.

Messages gain fields with defaults only, so that journals of earlier versions stay equal to what is
posted today. Where an earlier version meant another value, `earlier_names.py` has it.
"""

from functools import cache
from typing import Any, get_args, get_type_hints

import msgspec

from vrut_lite.message_codec import to_plain

Plain = dict[str, Any]


def with_later_fields(kind: type[msgspec.Struct], there: Plain, here: Plain) -> Plain:
    """A recorded message with the defaults of fields that it lacks, also in its structures.

    Args:
        kind: today's type.
        there: the recorded message, plain.
        here: today's message, plain, whose fields count.
    """
    defaults, structures = _defaults(kind), _structures(kind)
    added = {name: defaults[name] for name in here.keys() - there.keys() if name in defaults}
    filled = {
        name: _filled(structures[name], there[name], here[name])
        for name in structures.keys() & there.keys() & here.keys()
    }
    return {**there, **filled, **added}


def _filled(kind: type[msgspec.Struct], there: Any, here: Any) -> Any:
    if isinstance(there, list) and isinstance(here, list) and len(there) == len(here):
        return [_filled(kind, *pair) for pair in zip(there, here, strict=True)]
    if isinstance(there, dict) and isinstance(here, dict):
        return with_later_fields(kind, there, here)
    return there


@cache
def _defaults(kind: type[msgspec.Struct]) -> Plain:
    """Plain defaults of the fields that have one."""
    found = {}
    for field in msgspec.structs.fields(kind):
        if field.default is not msgspec.NODEFAULT:
            found[field.name] = to_plain(field.default)
        elif field.default_factory is not msgspec.NODEFAULT:
            found[field.name] = to_plain(field.default_factory())
    return found


@cache
def _structures(kind: type[msgspec.Struct]) -> dict[str, type[msgspec.Struct]]:
    """The structure that a field holds, alone or in a list, by the field's name."""
    hints = get_type_hints(kind)
    found = {name: _structures_in(hints[name]) for name in kind.__struct_fields__}
    return {name: kinds[0] for name, kinds in found.items() if len(kinds) == 1}


def _structures_in(hint: Any) -> list[type[msgspec.Struct]]:
    if isinstance(hint, type) and issubclass(hint, msgspec.Struct):
        return [hint]
    return [kind for part in get_args(hint) for kind in _structures_in(part)]
