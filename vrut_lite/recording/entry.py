"""The entries of a journal."""

from typing import Annotated, Any, Literal

import msgspec

from vrut_lite.kernel.setup_log import MOST_STEPS

Kind = Literal["input", "derived"]
_Name = Annotated[str, msgspec.Meta(max_length=200)]
# A restored kernel gets each of them; no session has more than some dozens.
_MOST = msgspec.Meta(max_length=1024)


class Entry(msgspec.Struct, frozen=True, kw_only=True):
    """One message: an admitted input, or one that a handler or the kernel posted.

    `message` is its plain form (see codec); `digest` that of the type's name and the form.
    """

    kind: Kind
    type_name: str
    sender: str
    digest: str
    message: dict[str, Any]


class SetupStep(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """One step before the recording: a module was added, or an input admitted.

    Of a result of the kernel's own job (see its sender) only module and job are kept.
    A step without either: queued messages were delivered.
    """

    module: str = ""
    type_name: str = ""
    sender: str = ""
    message: dict[str, Any] = {}


class ModuleSetup(msgspec.Struct, frozen=True, kw_only=True):
    """A module as it was when the recording began."""

    name: _Name
    version: _Name
    state: _Name
    settings: dict[str, Any]


class Setup(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """How the kernel was when the recording began.

    The modules in load order, who held which slot, and who wanted what (plain `Demand`s); and
    the steps that made it so. Journals of earlier versions have no steps.
    """

    modules: Annotated[list[ModuleSetup], _MOST]
    slots: Annotated[dict[str, str], _MOST]
    demands: Annotated[list[dict[str, Any]], _MOST] = []
    steps: Annotated[list[SetupStep], msgspec.Meta(max_length=MOST_STEPS)] = []
