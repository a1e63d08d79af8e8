"""docs/promises.md, line by line: what is public stays, and what 1.0 wrote is read."""

import ast
import re
from pathlib import Path

import msgspec
import pytest
import write_kept

from tools import public_names
from vrut_lite import __version__, deprecation
from vrut_lite.app.panels.presets import PresetStore
from vrut_lite.app.window.kept import Kept
from vrut_lite.commands.headless_scene import modules_for
from vrut_lite.daylight_kernel import daylight_kernel
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import ClockMoved, Derived, Input, SetClock
from vrut_lite.kernel.module import Manifest, Module, handles
from vrut_lite.message_codec import decode
from vrut_lite.project import Project, load_project
from vrut_lite.recording.journal_reader import Journal
from vrut_lite.recording.recorder import Recorder
from vrut_lite.recording.registry import Registry
from vrut_lite.recording.replay import Replay

ROOT = Path(__file__).parents[2]
HOW = "write the lists anew with `python -m tools.public_names`"
# Versions whose files are kept, by their folder.
KEPT = ("1.0",)
# What a later version posts otherwise, by a change that CHANGELOG names: words of the first
# difference from a kept journal, by its folder.
CHANGED: dict[str, str] = {}


def listed(path):
    return path.read_text(encoding="utf-8").splitlines()


@pytest.fixture(scope="module")
def names():
    pytest.importorskip("PySide6.QtWidgets", reason="PySide6 is missing: panels' names need it")
    return public_names.public_names()


def test_public_names_stay(names):
    """Adding is free. A name goes only after two minor versions in which its use warned."""
    today, missing = set(names), []
    for line in listed(public_names.NAMES):
        plain, _, since = line.rstrip(")").partition(" (deprecated since ")
        may_go = bool(since) and deprecation.is_due(since, __version__)
        # A deprecated name is still there, and a parameter may get a default.
        there = {plain, line, f"{plain[:-1]}=)"} & {name.partition(" (dep")[0] for name in today}
        if not there and not may_go:
            missing.append(line)
    assert not missing, (
        f"public names are gone: keep them with vrut_lite.deprecation, two minor versions long; "
        f"where that has been, {HOW}"
    )


def test_functions_get_no_parameter_without_a_default(names):
    """Whoever calls them as before would fail."""
    kept = set(listed(public_names.NAMES))
    needed = re.compile(r"(python [\w.]+)\((\w+)\)")
    found = [line for line in names if line not in kept and needed.fullmatch(line)]
    assert not [line for line in found if needed.fullmatch(line)[1] in kept]


def test_names_are_listed_in_order():
    """So that a change of the lists is read as lines added and removed."""
    for path in (public_names.NAMES, public_names.FIELDS):
        assert listed(path) == sorted(set(listed(path)))


def test_messages_gain_fields_with_defaults_only():
    """No field goes, none gets another type or default, none comes that old senders must say."""
    today, kept = set(public_names.message_fields()), set(listed(public_names.FIELDS))
    assert not kept - today, f"fields have changed; where a new choice replaces none, {HOW}"
    types = {line.partition(".")[0] for line in kept}
    needed = [line for line in today - kept if " = " not in line and " may be " not in line]
    assert not [line for line in needed if line.partition(".")[0] in types]


def imports_of(source):
    """Pairs (python module, name) that a source imports of ours."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.ImportFrom) and node.module:
            yield from ((node.module, alias.name) for alias in node.names)
        elif isinstance(node, ast.Import):
            yield from ((alias.name, "") for alias in node.names)


def sources_of_others():
    """What authors and scripts begin from: templates of packages, and examples of the pages."""
    for path in sorted((ROOT / "vrut_lite" / "module_templates").rglob("*.py")):
        yield str(path.relative_to(ROOT)), path.read_text(encoding="utf-8")
    for path in [ROOT / "README.md", *sorted(ROOT.glob("docs/*.md"))]:
        text = path.read_text(encoding="utf-8")
        for block in re.findall(r"```python\n(.*?)```", text, re.DOTALL):
            yield path.name, block


def test_templates_and_examples_use_public_names_only():
    """A package that was written from a template works in every later 1.x."""
    public = public_names.python_modules()
    packages = {module.partition(".")[0] for module in public}
    private = {
        (where, module, name)
        for where, source in sources_of_others()
        for module, name in imports_of(source)
        if module.partition(".")[0] in packages
        and name not in public.get(module, ())
        and f"{module}.{name}" not in public
    }
    assert not private


def test_the_page_for_authors_lists_every_python_module_for_them():
    """Who has a wheel has no reference pages."""
    page = (ROOT / "docs" / "write_a_module.md").read_text(encoding="utf-8")
    listed = page.partition("Public for modules are, after `vrut_lite.`:")[2]
    listed = listed.partition("**Others install it**")[0]
    titles = ("Scenes", "Skies", "Daylight in numbers")
    public = {module for title, some in public_names.PYTHON.items() for module in some
              if title not in titles}  # fmt: skip
    assert {f"vrut_lite.{name}" for name in re.findall(r"`([a-z_.]+)`", listed)} == public


def product():
    for folder in ("vrut_lite", "modules"):
        yield from sorted((ROOT / folder).rglob("*.py"))


def test_deprecated_names_go_when_they_are_due():
    """Two minor versions after the warning first came, the old name is removed."""
    due = []
    for path in product():
        source = path.read_text(encoding="utf-8")
        if "vrut_lite.deprecation" not in source:
            continue
        for node in ast.walk(ast.parse(source)):
            called = ast.unparse(node.func) if isinstance(node, ast.Call) else ""
            if called in ("deprecated", "MovedNames"):
                (since,) = (word.value.value for word in node.keywords if word.arg == "since")
                if deprecation.is_due(since, __version__):
                    due.append(f"{path.relative_to(ROOT)}:{node.lineno} (since {since})")
    assert not due, f"remove these old names, and {HOW}"


@pytest.mark.parametrize(
    ("since", "today", "due"),
    [
        ("1.2", "1.2.0", False),
        ("1.2", "1.3.4", False),
        ("1.2", "1.4.0", True),
        ("1.9", "2.0.0", True),
        ("1.0", "0.9.0", False),
    ],
)
def test_a_deprecation_lives_two_minor_versions(since, today, due):
    """In its own and the next one; a new major version may go without."""
    assert deprecation.is_due(since, today) is due


def test_an_old_function_warns_where_it_is_called_and_works():
    """The warning names the version and the new way; its place is the caller's line."""

    @deprecation.deprecated(since="1.2", instead="new_way")
    def old_way(number):
        """Twice a number."""
        return 2 * number

    with pytest.warns(DeprecationWarning, match=r"old_way .* 1\.2: use new_way") as warned:
        assert old_way(3) == 6
    assert warned[0].filename == __file__
    assert old_way.__doc__ == "Twice a number."


def test_the_list_says_what_is_deprecated(names):
    """By that a later version knows that a name may go."""
    assert "python light_transport.annual (deprecated since 1.0)" in names


@pytest.fixture(params=KEPT)
def kept(request, monkeypatch):
    """The folder of a version's files, which is the present one too."""
    folder = Path(__file__).parent / request.param
    monkeypatch.chdir(folder)
    return folder


def test_kept_projects_say_what_they_said(kept):
    """Every field of a project of 1.0 has its value."""
    project = load_project("project.toml")
    assert project == write_kept.PROJECT
    written = (kept / "project.toml").read_text(encoding="utf-8")
    default = Project()
    assert all(f"{name} = " in written or f"[{name}" in written
               for name in project.__struct_fields__
               if getattr(project, name) != getattr(default, name))  # fmt: skip


def test_kept_settings_are_taken_by_their_modules(kept):
    """Presets of 1.0 are offered, and each of their values is valid."""
    store = PresetStore(kept / "presets")
    assert store.names("clouds") == ["Evening"]
    values = store.values("clouds", "Evening")
    assert values == write_kept.PRESET
    kernel, _ = daylight_kernel()
    for name, value in values.items():
        assert kernel.check_setting("clouds", name, value) == value
    kernel.close()


def test_kept_windows_come_back(kept):
    """The last session, the recent files and the window's shape."""
    state = Kept(kept / "state")
    session = state.session()
    assert session is not None
    assert Path(session.scene).resolve() == (kept / "yard.obj").resolve()
    assert msgspec.structs.replace(session, scene="yard.obj") == write_kept.SESSION
    assert state.recent == ["yard.obj"]
    assert state.shape() == write_kept.SHAPE


def test_kept_journals_are_read(kept):
    """Each message is of a known type, and this version accepts each input."""
    journal = Journal("session.mcap")
    registry = Registry(modules_for(journal.setup))
    entries = list(journal.entries())
    heard = {entry.type_name for entry in entries if entry.kind == "derived"}
    assert {"SceneOpened", "CloudsChanged", "NightLightChanged", "SkyLightChanged"} <= heard
    skies = {e.message["source"] for e in entries if e.type_name == "BackgroundChanged"}
    assert skies == {"dynamic_skylight", "bruneton_sky"}
    for entry in entries:
        kind = registry.find(entry.type_name)
        if entry.kind == "input" and entry.sender == "host":
            decode(kind, entry.message).check()


@pytest.mark.long
def test_kept_journals_replay(kept):
    """All inputs are played; messages are those of 1.0, by digest or by value."""
    journal = Journal("session.mcap")
    outcome = Replay(journal, modules_for(journal.setup)).run(to_the_end=True)
    assert outcome.inputs >= len(write_kept.SCRIPT)
    assert CHANGED.get(kept.name, "") in (outcome.difference or "")
    assert outcome.difference is None or kept.name in CHANGED


def said_type(**defaults):
    """A message type `Said` with a text and further fields; each has a default."""
    later = [(name, type(value), value) for name, value in defaults.items()]
    return msgspec.defstruct(
        "Said", [("text", str), *later], bases=(Derived,), frozen=True, kw_only=True
    )


def speaker(said, **values):
    """A module that posts one `Said` an hour."""

    class Speaker(Module):
        manifest = Manifest(name="speaker", title="Speaker", version="1")
        speaks = (said,)

        @handles(ClockMoved)
        def clock_set(self, message):
            self.link.post(said(text="it is now", **values))

    return Speaker


@pytest.mark.parametrize(
    ("loudness", "difference"), [(0.5, None), (0.7, "loudness is 0.7 here and 0.5 in the journal")]
)
def test_a_field_that_a_journal_lacks_has_its_default(tmp_path, loudness, difference):
    """A later version adds one: old journals stay equal as long as it says what was meant."""
    path = tmp_path / "old.mcap"
    kernel = Kernel()
    kernel.add_module(speaker(said_type()))
    with path.open("wb") as stream:
        recorder = Recorder(kernel, stream)
        message = decode(SetClock, {"instant": "2026-06-21T10:00:00Z"})
        assert isinstance(message, Input)
        kernel.inject(message)
        kernel.pump()
        recorder.close()
    later = speaker(said_type(loudness=0.5), loudness=loudness)
    outcome = Replay(Journal(path), [later]).run()
    assert outcome.messages > 0
    if difference is None:
        assert outcome.difference is None
    else:
        assert difference in outcome.difference


def test_the_page_names_what_holds_it():
    """Each test that docs/promises.md names is here."""
    page = (ROOT / "docs" / "promises.md").read_text(encoding="utf-8")
    here = {name for name in globals() if name.startswith("test_")}
    named = set(re.findall(r"`(test_\w+)`", page))
    assert named
    assert named <= here


def test_every_kept_folder_is_tried():
    """A version's files that no test opens would hold nothing."""
    folders = [path.name for path in Path(__file__).parent.iterdir() if path.name[0].isdigit()]
    assert sorted(folders) == sorted(KEPT)
