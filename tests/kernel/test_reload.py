"""Reload: the newest files, the old settings, and nothing of the old instance."""

import sys
import weakref
from textwrap import dedent

import pytest
from probe_messages import Heard, Poke, act, collect, faults_of

from vrut_lite.discovery import discover
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import EnableModule, ReloadModule, SetSetting, SlotChanged
from vrut_lite.kernel.module import Manifest, Module, handles

SOURCE = """
    from typing import Annotated
    import msgspec
    from probe_messages import Heard, Poke, Sun
    from vrut_lite.kernel.module import Manifest, Module, handles
    from {name}.number import NUMBER

    class Settings(msgspec.Struct, frozen=True):
        {settings}

    class Counter(Module):
        manifest = Manifest(name="{name}", title="Counter", version="1", provides={provides})
        settings_type = Settings
        count = 0

        @handles(Poke)
        def on_poke(self, message: Poke) -> None:
            self.count += 1
            self.link.post(Heard(module="{name}", value=self.count, version=NUMBER))

        def snapshot(self):
            return {{"count": self.count}}

        def restore(self, state):
            self.count = state["count"]
"""
SETTINGS = "volume: Annotated[float, msgspec.Meta(ge=0, le=11)] = 3.0; tone: str = 'low'"


class Package:
    """A module's package on disk, which tests rewrite."""

    def __init__(self, folder, name):
        self.folder, self.name = folder, name
        (folder / name).mkdir()
        self.write(1)

    def write(self, number, settings=SETTINGS, extra="", provides=()):
        text = SOURCE.format(name=self.name, settings=settings, provides=provides)
        # A compiled file is known by size and whole seconds: each version gets its own size.
        padding = "#" * number + "\n"
        (self.folder / self.name / "__init__.py").write_text(dedent(text) + extra + padding)
        (self.folder / self.name / "number.py").write_text(f"NUMBER = {number}\n" + padding)


@pytest.fixture
def package(tmp_path, request):
    name = f"counter_{abs(hash(request.node.name))}"
    yield Package(tmp_path, name)
    sys.path[:] = [path for path in sys.path if path != str(tmp_path)]
    for module in [module for module in sys.modules if module.partition(".")[0] == name]:
        del sys.modules[module]


def kernel_with(package):
    modules, failures = discover([package.folder])
    assert failures == []
    kernel = Kernel()
    kernel.add_module(next(m for m in modules if m.manifest.name == package.name))
    kernel.pump()
    return kernel


def test_a_reload_runs_the_new_files_submodules_included(package):
    """An edited module is loaded at once, with the old version's state."""
    kernel = kernel_with(package)
    heard = collect(kernel, Heard)
    act(kernel, Poke())
    package.write(2)
    act(kernel, ReloadModule(module=package.name), Poke())
    assert [(message.value, message.version) for message in heard] == [(1, 1), (2, 2)]


def test_nothing_of_the_old_instance_stays(package):
    """3D Slicer's reload leaves the old instance connected; here the garbage is gone at once."""
    kernel = kernel_with(package)
    act(kernel, Poke())
    old = weakref.ref(kernel.seats[package.name].module)
    act(kernel, ReloadModule(module=package.name))
    assert old() is None
    heard = collect(kernel, Heard)
    act(kernel, Poke())
    assert len(heard) == 1


def test_settings_are_kept_as_far_as_the_new_version_takes_them(package):
    """Valid values stay; a value outside the new bounds or of a removed setting is reported and
    dropped."""
    kernel = kernel_with(package)
    faults = faults_of(kernel)
    act(kernel, SetSetting(module=package.name, name="volume", value=9))
    act(kernel, SetSetting(module=package.name, name="tone", value="high"))
    package.write(2)
    act(kernel, ReloadModule(module=package.name))
    assert (kernel.seats[package.name].settings.volume, faults) == (9.0, [])
    package.write(3, settings="volume: Annotated[float, msgspec.Meta(ge=0, le=5)] = 4.0")
    act(kernel, ReloadModule(module=package.name))
    assert kernel.seats[package.name].settings.volume == 4.0
    assert kernel.seats[package.name].module.settings.volume == 4.0
    assert "must be between 0 and 5, not 9" in faults[0].error
    assert "no setting 'tone'" in faults[1].error


@pytest.mark.parametrize(
    "broken",
    [
        "def (",
        "import no_such_thing",
        "del Counter",
        "Counter.manifest = Manifest(name='other', title='', version='')",
        "Counter.__init__ = lambda *_: 1 / 0",
    ],
)
def test_a_broken_version_leaves_the_old_one_running(package, broken):
    """A typing error must cost the author a message and not an afternoon."""
    kernel = kernel_with(package)
    faults, heard = faults_of(kernel), collect(kernel, Heard)
    old = sys.modules[package.name]
    package.write(2, extra=broken + "\n")
    act(kernel, ReloadModule(module=package.name), Poke())
    assert [(fault.module, fault.where) for fault in faults] == [(package.name, "reload")]
    assert [message.version for message in heard] == [1]
    # What the old version imports later must be its own package too.
    assert sys.modules[package.name] is old
    package.write(3)
    act(kernel, ReloadModule(module=package.name), Poke())
    assert [message.version for message in heard] == [1, 3]


def test_a_disabled_module_stays_disabled(package):
    """A reload changes the version, not what the user switched off."""
    kernel = kernel_with(package)
    heard = collect(kernel, Heard)
    act(kernel, EnableModule(module=package.name, enabled=False))
    package.write(2)
    act(kernel, ReloadModule(module=package.name), Poke())
    assert heard == []
    act(kernel, EnableModule(module=package.name), Poke())
    assert [message.version for message in heard] == [2]


def test_a_slot_follows_what_the_new_version_provides(package):
    """A version that learns to be the sun may hold its slot; one that forgets it lets go."""
    kernel = kernel_with(package)
    changes = collect(kernel, SlotChanged)
    package.write(2, provides=("sun",))
    act(kernel, ReloadModule(module=package.name))
    package.write(3)
    act(kernel, ReloadModule(module=package.name))
    assert [change.holder for change in changes] == [package.name, ""]


def test_a_part_of_the_host_is_not_reloaded():
    """The host's own package cannot be taken out under its feet."""

    class HostPart(Module):
        manifest = Manifest(name="part", title="Part", version="1")

        @handles(Poke)
        def on_poke(self, message: Poke) -> None:
            """Nothing."""

    HostPart.__module__ = "vrut_lite.part"
    kernel = Kernel()
    kernel.add_module(HostPart)
    kernel.pump()
    act(kernel, ReloadModule(module="part"))
    assert "is part of the host" in kernel.last_fault("part").error
    assert kernel.seats["part"].running


def test_an_invalid_snapshot_is_a_fault_and_the_reload_goes_on(package):
    """A snapshot is plain data: an object of the old version must not live on in the new one."""
    package.write(1, extra="Counter.snapshot = lambda self: object()\n")
    kernel = kernel_with(package)
    heard = collect(kernel, Heard)
    act(kernel, Poke())
    package.write(2)
    act(kernel, ReloadModule(module=package.name), Poke())
    assert kernel.last_fault(package.name).where == "snapshot"
    assert [(message.value, message.version) for message in heard] == [(1, 1), (1, 2)]
