"""The contract: a class that is no module is refused in one sentence, and the others load."""

import sys
import textwrap

import pytest

from vrut_lite.discovery import discover
from vrut_lite.errors import UserError
from vrut_lite.kernel.bus import Kernel

HEAD = """
import asyncio
import msgspec
from typing import Annotated, Any, ClassVar, Literal
from vrut_lite.kernel.messages import SetClock, Tick
from vrut_lite.kernel.module import Manifest, Module, handles

class Panic(BaseException):
    def __str__(self):
        raise self

def manifest(**changes):
    return Manifest(**({"name": "hostile", "title": "Hostile", "version": "1"} | changes))
"""

# The body of a class, and a part of the sentence that refuses it.
CLASSES = {
    "no manifest": ("pass", "manifest must be a Manifest, not None"),
    "manifest of another type": ("manifest = {'name': 'x'}", "must be a Manifest"),
    "manifest class": ("manifest = Manifest", "must be a Manifest"),
    "name is a number": ("manifest = manifest(name=5)", "name of a manifest"),
    "name is empty": ("manifest = manifest(name='')", "name of a manifest"),
    "name of a line": ("manifest = manifest(name='a\\nb')", "name of a manifest"),
    "name of dots": ("manifest = manifest(name='a.b')", "name of a manifest"),
    "name of commas": ("manifest = manifest(name='a, b')", "name of a manifest"),
    "name of a megabyte": ("manifest = manifest(name='a' * 10**6)", "name of a manifest"),
    "name of an escape": ("manifest = manifest(name='\\x1b[31m')", "name of a manifest"),
    "name of the host": ("manifest = manifest(name='host')", "is the host's own name"),
    "name of the scene": ("manifest = manifest(name='scene')", "is the host's own name"),
    "name of the GPU": ("manifest = manifest(name='gl_jobs')", "is the host's own name"),
    "name of the sum": ("manifest = manifest(name='sky_sum')", "is the host's own name"),
    "title is none": ("manifest = manifest(title=None)", "title of a manifest"),
    "version is a number": ("manifest = manifest(version=1.0)", "version of a manifest"),
    "provides a text": ("manifest = manifest(provides='sky')", "provides of a manifest"),
    "provides numbers": ("manifest = manifest(provides=(1, 2))", "provides of a manifest"),
    "provides a list": ("manifest = manifest(provides=['sky'])", "provides of a manifest"),
    "requires none": ("manifest = manifest(requires=None)", "requires of a manifest"),
    "stands in by text": ("manifest = manifest(stand_in='no')", "stand_in of a manifest"),
    "settings are a dict": ("settings_type = dict", "settings_type must be a msgspec.Struct"),
    "settings are none": ("settings_type = None", "settings_type must be a msgspec.Struct"),
    "settings are a value": (
        "settings_type = type('S', (msgspec.Struct,), {})()",
        "settings_type must be a msgspec.Struct",
    ),
    "async handler": (
        "@handles(Tick)\n    async def go(self, m): pass", "neither async nor a generator",
    ),
    "generator handler": ("@handles(Tick)\n    def go(self, m): yield", "neither async nor a"),
    "async generator": ("@handles(Tick)\n    async def go(self, m): yield", "neither async nor"),
    "async settings_changed": ("async def settings_changed(self, name): pass", "neither async"),
    "snapshot is none": ("snapshot = None", "snapshot must be a method"),
    "handles a text": ("@handles('Tick')\n    def go(self, m): pass", "go handles 'Tick', which"),
    "handles a number": ("@handles(3)\n    def go(self, m): pass", "go handles 3, which is no"),
    "handles a list": ("@handles([Tick])\n    def go(self, m): pass", "which is no type of"),
    "handlers raise": (
        "@classmethod\n    def handlers(cls): raise Panic()", "cannot be used: Panic",
    ),
    "engine is a number": ("manifest = manifest(engine=5)", "engine of a manifest"),
    "engine without a maker": ("manifest = manifest(engine='x')", "needs a method open_engine"),
    "auxiliary by text": ("manifest = manifest(auxiliary='yes')", "auxiliary of a manifest"),
    "host is a number": ("manifest = manifest(host=1)", "host of a manifest"),
    "host is a word": ("manifest = manifest(host='any')", "'any' on vrut_lite is none"),
    "host of the future": ("manifest = manifest(host='>=99')", "it needs vrut_lite >=99"),
    "injects a text": ("injects = 'Tick'", "injects must be a tuple of types of inputs"),
    "injects a message": ("injects = (Manifest,)", "injects must be a tuple of types of inputs"),
}  # fmt: skip

# The body of a settings class, and a part of the sentence that refuses it.
SETTINGS = {
    "no default": ("x: int", "its setting x needs a default"),
    "no such type": ("x: 'Nope' = 1", "name 'Nope' is not defined"),
    "a hint that panics": ("x: '(_ for _ in ()).throw(Panic())' = 1", "cannot be used"),
    "a list": ("x: list[int] = []", "its setting x must be of bool, int, float, str"),
    "anything": ("x: Any = 1", "its setting x must be of bool"),
    "a union": ("x: int | str = 1", "its setting x must be of bool"),
    "bytes": ("x: bytes = b''", "its setting x must be of bool"),
    "choices of numbers": ("x: Literal[1, 2] = 1", "a unit, source or choice that is no text"),
    "unit is a number": (
        "x: Annotated[int, msgspec.Meta(extra={'unit': 5})] = 1", "a unit, source or choice",
    ),
    "default below": (
        "x: Annotated[int, msgspec.Meta(ge=5)] = 1", "x of hostile must be at least 5, not 1",
    ),
    "default above": ("x: Annotated[float, msgspec.Meta(le=5)] = 7.5", "at most 5, not 7.5"),
    "default is a NaN": ("x: float = float('nan')", "must be a number, not nan"),
    "default of another type": ("x: int = 'many'", "must be a whole number, not many"),
    "default is a text": ("x: int = '5'", "not its default '5'"),
    "default is no choice": ("x: Literal['a', 'b'] = 'c'", "must be one of a, b, not c"),
    "default is none": ("x: int = None", "must be a whole number, not None"),
    "default is odd": ("x: float = Panic()", "must be a number, not"),
    "default raises": (
        "x: int = msgspec.field(default_factory=lambda: 1 // 0)", "ZeroDivisionError",
    ),
    "default panics": (
        "x: int = msgspec.field(default_factory=lambda: (_ for _ in ()).throw(Panic()))",
        "Panic: (its text cannot be made)",
    ),
    "made and panics": (
        "x: int = 1\n    def __post_init__(self): raise asyncio.CancelledError", "CancelledError",
    ),
}  # fmt: skip

# A whole file, and a part of the sentence.
FILES = {
    "panics": ("raise Panic()", "Panic: (its text cannot be made)"),
    "cancelled": ("raise asyncio.CancelledError('no')", "CancelledError: no"),
    "exits": ("import sys; sys.exit(3)", "SystemExit: 3"),
    "group": ("raise BaseExceptionGroup('two', [Panic()])", "BaseExceptionGroup: two"),
    "recursion": ("def f(): f()\nf()", "RecursionError"),
    "says a megabyte": ("raise ValueError('x' * 10**6)", "letters ...]"),
    "module is odd": (
        "class O:\n    __class__ = property(lambda s: 1 // 0)\nMODULE = O()",
        "cannot be used",
    ),
    "another in its place": ("import sys; sys.modules[__name__] = 5", ""),
}


@pytest.fixture
def folder(tmp_path):
    known = set(sys.modules)
    yield tmp_path
    sys.path[:] = [path for path in sys.path if not path.startswith(str(tmp_path))]
    for name in set(sys.modules) - known:
        if name.startswith("probe_hostile"):
            del sys.modules[name]


def told(folder, number, text):
    """The sentence in which a file is refused; the module beside it loads."""
    (folder / f"probe_hostile_{number}.py").write_text(HEAD + text)
    good = "class Good(Module):\n    manifest = manifest(name='good')\n"
    (folder / f"probe_hostile_{number}_good.py").write_text(HEAD + good)
    installed = len(discover([])[0])
    modules, failures = discover([folder])
    assert [module.manifest.name for module in modules[installed:]] == ["good"]
    sentences = [line for line in failures if f"probe_hostile_{number}" in line]
    assert len(sentences) == 1
    assert len(sentences[0]) < 3000
    return sentences[0]


@pytest.mark.parametrize("kind", CLASSES)
def test_a_class_that_is_no_module_is_a_sentence(folder, kind):
    """Manifests and handlers of the wrong kind are found before they can end a command."""
    body, says = CLASSES[kind]
    own = "" if "manifest" in body or kind == "no manifest" else "manifest = manifest()\n    "
    text = f"class Hostile(Module):\n    {own}{body}\n"
    assert says in told(folder, list(CLASSES).index(kind), text)


@pytest.mark.parametrize("kind", SETTINGS)
def test_invalid_settings_are_refused_in_a_sentence(folder, kind):
    """Options, panels and journals are made from settings: what they cannot bear is refused."""
    body, says = SETTINGS[kind]
    text = textwrap.dedent(
        """
        class S(msgspec.Struct, frozen=True):
            {body}

        class Hostile(Module):
            manifest = manifest()
            settings_type = S
        """
    ).replace("{body}", body)
    assert says in told(folder, 100 + list(SETTINGS).index(kind), text)


@pytest.mark.parametrize("kind", FILES)
def test_an_import_that_fails_is_a_sentence(folder, kind):
    """Every kind of exception during the import becomes one sentence."""
    text, says = FILES[kind]
    assert says in told(folder, 200 + list(FILES).index(kind), text)


def test_a_class_that_changes_is_refused_when_it_is_added():
    """A class that fails the second check gets no seat, and the kernel goes on."""
    import msgspec

    from vrut_lite.kernel.module import Manifest, Module

    counts = iter(range(100))

    class Fickle(msgspec.Struct, frozen=True):
        x: int = msgspec.field(default_factory=lambda: 1 // max(0, 3 - next(counts)))

    class Changing(Module):
        manifest = Manifest(name="changing", title="Changing", version="1")
        settings_type = Fickle

    kernel = Kernel()

    def add_five():
        for _ in range(5):
            kernel.add_module(Changing)
            kernel.seats.clear()

    with pytest.raises(UserError, match="cannot be used: ZeroDivisionError"):
        add_five()
    assert not kernel.seats


def test_settings_named_like_options_hide_no_option(folder, monkeypatch):
    """A command's own options go on to work; such a setting is reached by --set."""
    import click

    from vrut_lite.commands.options import daylight_options

    (folder / "probe_hostile_options.py").write_text(
        HEAD + "class S(msgspec.Struct, frozen=True):\n"
        "    at: float = 1.0\n    output: str = ''\n    help: int = 3\n    set: str = ''\n"
        "    width_of_it: int = 3\n"
        "class M(Module):\n    manifest = manifest()\n    settings_type = S\n"
    )
    monkeypatch.setenv("VRUT_LITE_MODULES", str(folder))

    @click.command()
    @daylight_options
    @click.option("-o", "--output")
    def command(**options):
        """Nothing."""

    flags = [flag for option in command.params for flag in option.opts]
    assert len(flags) == len(set(flags))
    assert "--width-of-it" in flags
    assert "--help" not in flags
    by_name = {option.name: option.opts for option in command.params}
    assert by_name["output"] == ["-o", "--output"]
    assert by_name["at"] == ["--at"]
    assert flags[0] == "-o", "its own are listed first"
