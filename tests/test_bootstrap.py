"""Set-up installs no more than the project needs, on any machine, and says what it does.

The real scripts run with a PATH of stand-ins that record how they were called.
"""

import os
import shutil
import subprocess
from pathlib import Path

import pytest
from system_libraries import LIBRARIES

ROOT = Path(__file__).parents[1]
PLAIN_TOOLS = ["cat", "dirname", "env", "find", "head", "ln", "mkdir", "mv", "rm", "sed"]
APT_GET = """
case $* in
*--simulate*)
    echo 'Inst libegl1 (1.6.0-1 Debian:12/stable [amd64])'
    echo 'Inst libc6 [2.36-8] (2.36-9 Debian:12/stable [amd64])'
    echo 'Conf libegl1 (1.6.0-1 Debian:12/stable [amd64])' ;;
*download*) echo deb >libegl1_1.6.0-1_amd64.deb ;;
esac"""
DPKG = """
mkdir -p "$3/usr/lib/x86_64-linux-gnu"
for name in libEGL.so.1 libGL.so.1; do echo elf >"$3/usr/lib/x86_64-linux-gnu/$name"; done
"""
SUDO = """
while [ "$1" = -n ]; do shift; done
[ "$1" = true ] || exec "$@"
"""
OFFLINE = "exit 100"


class Machine:
    """A checkout with the scripts, and a PATH with only the stand-ins."""

    def __init__(self, folder: Path):
        self.root = folder / "the checkout"
        self.bin = folder / "bin"
        self.log = folder / "log"
        self.bin.mkdir()
        shutil.copytree(ROOT / "tools", self.root / "tools")
        shutil.copy(ROOT / "pyproject.toml", self.root)
        (self.root / "lab").mkdir()
        shutil.copy(ROOT / "lab" / "pyproject.toml", self.root / "lab")
        for tool in PLAIN_TOOLS:
            found = shutil.which(tool)
            assert found, tool
            (self.bin / tool).symlink_to(found)

    def has(self, command: str, body: str = "", folder: Path | None = None) -> None:
        script = (folder or self.bin) / command
        script.parent.mkdir(parents=True, exist_ok=True)
        script.write_text(f'#!/bin/sh\necho "{command} $*" >>"{self.log}"\n{body}\n')
        script.chmod(0o755)

    def user(self, number: int) -> None:
        (self.bin / "id").write_text(f"#!/bin/sh\necho {number}\n")
        (self.bin / "id").chmod(0o755)

    def shell(self, *arguments: str, **variables: str) -> subprocess.CompletedProcess[str]:
        self.log.write_text("")
        return subprocess.run(
            ["/bin/sh", *arguments],
            cwd=self.root,
            env={"PATH": os.fspath(self.bin), **variables},
            capture_output=True,
            text=True,
            check=False,
        )

    def has_libraries(self, *groups: str) -> None:
        names = [name for group in groups for name in LIBRARIES[group]]
        lines = "".join(f"\t{name} (libc6,x86-64) => /x/{name}\n" for name in names)
        self.has("ldconfig", f"printf '%s' '{lines}'")

    def provide(self, purpose: str = "test", **variables: str) -> str:
        """Run the system set-up as `bootstrap.sh` does; returns its output. It must not fail."""
        script = (
            'set -eu; say() { echo "$*" >&2; }; . tools/bootstrap_system.sh; '
            f'provide_system "$PWD" {purpose}; echo on'
        )
        done = self.shell("-c", script, **variables)
        assert (done.returncode, done.stdout) == (0, "on\n"), done.stderr
        return done.stderr

    def calls(self, *commands: str) -> list[str]:
        lines = self.log.read_text().splitlines()
        return [line for line in lines if not commands or line.split()[0] in commands]


@pytest.fixture
def machine(tmp_path):
    made = Machine(tmp_path)
    made.has("ldconfig")
    made.user(1000)
    return made


OTHERS = ("qt", "x11", "mitsuba")


def test_libraries_that_are_there_are_left_alone(machine):
    """Nothing is installed or printed, even if the user could install."""
    machine.has_libraries("gl", *OTHERS)
    machine.has("apt-get", APT_GET)
    machine.user(0)
    assert machine.provide() == ""
    assert set(machine.calls()) == {"ldconfig -p"}


def test_libgl_without_libegl_is_not_enough(machine):
    """libGL without libEGL, as on minimal desktops, does not count as OpenGL."""
    machine.has("ldconfig", "echo '\tlibGL.so.1 (libc6,x86-64) => /x/libGL.so.1'")
    assert "going on without GL: missing" in machine.provide()


def test_root_installs_without_recommendations(machine):
    """Lists are updated first; the two packages contain Mesa's llvmpipe."""
    machine.has_libraries(*OTHERS)
    machine.has("apt-get", APT_GET)
    machine.user(0)
    assert machine.provide() == "installing libegl1 libgl1\n"
    update, install = machine.calls("apt-get")
    assert update.endswith(" update")
    assert install.endswith("install --yes --no-install-recommends libegl1 libgl1")
    assert not (machine.root / ".system").exists()


@pytest.mark.parametrize(
    ("purpose", "display", "groups"),
    [
        ("run", "", ["libegl1", "libglib2.0-0"]),
        ("run", ":0", ["libegl1", "libglib2.0-0", "libxcb-cursor0"]),
        ("test", "", ["libegl1", "libglib2.0-0", "libxcb-cursor0", "libatomic1"]),
        ("long", "", ["libegl1", "libglib2.0-0", "libxcb-cursor0", "libatomic1", "libllvm19"]),
    ],
)
def test_each_purpose_installs_what_it_loads(machine, purpose, display, groups):
    """PySide6's wheels lack what Qt loads, mitsuba's lacks libatomic and a compiler; X11 serves
    screens alone."""
    machine.has("apt-get", APT_GET)
    machine.user(0)
    machine.provide(purpose, DISPLAY=display)
    installed = [call.split("--no-install-recommends ")[1] for call in machine.calls("apt-get")[1:]]
    assert [packages.split()[0] for packages in installed] == groups


def test_a_group_that_cannot_be_installed_costs_no_other(machine):
    """If one package does not exist, the others are installed, and the line names it."""
    machine.has("apt-get", "case $* in *--simulate*|*libatomic1*) exit 100;; esac")
    machine.user(0)
    said = machine.provide().splitlines()
    assert [line for line in said if "missing" in line] == [
        "going on without the path tracer: missing are the system's packages libatomic1, "
        "or their like"
    ]


def test_sudo_is_used_when_it_asks_no_password(machine):
    """sudo -n is tried first, so that set-up never stops at a prompt."""
    machine.has_libraries(*OTHERS)
    machine.has("apt-get", APT_GET)
    machine.has("sudo", SUDO)
    machine.provide()
    assert machine.calls("sudo")[0] == "sudo -n true"
    assert all(call.startswith("sudo -n ") for call in machine.calls("sudo"))
    assert machine.calls("apt-get")[-1].endswith(
        "install --yes --no-install-recommends libegl1 libgl1"
    )


def test_a_failed_update_does_not_stop_the_installation(machine):
    """One unreachable source fails the update; the installation is tried all the same."""
    machine.has_libraries(*OTHERS)
    machine.has("apt-get", "case $* in *update) exit 100;; esac")
    machine.user(0)
    assert machine.provide() == "installing libegl1 libgl1\n"


@pytest.mark.parametrize("sudo", ["none", "asks"])
def test_without_root_the_packages_go_into_a_private_folder(machine, sudo):
    """Missing packages, but never the C library, are downloaded and unpacked, not installed."""
    machine.has_libraries(*OTHERS)
    machine.has("apt-get", APT_GET)
    machine.has("dpkg", DPKG)
    if sudo == "asks":
        machine.has("sudo", "exit 1")
    assert "fetching libegl1 libgl1 into .system" in machine.provide()
    update, simulate, download = machine.calls("apt-get")
    assert update.endswith(" update")
    assert "--simulate" in simulate
    assert download.endswith(" download libegl1")
    assert f"Dir::State::Lists={machine.root}/.system/apt/lists" in download
    libraries = machine.root / ".system/root/usr/lib/x86_64-linux-gnu"
    assert (libraries / "EGL").resolve() == libraries / "libEGL.so.1"
    assert sorted(entry.name for entry in (machine.root / ".system").iterdir()) == [
        ".gitignore",
        "env",
        "root",
    ]


def test_all_that_is_lacking_goes_into_one_private_folder(machine):
    """The window and the path tracer also run for a user without root."""
    machine.has_libraries("gl")
    machine.has("apt-get", APT_GET)
    machine.has("dpkg", DPKG)
    machine.provide()
    (simulate,) = [call for call in machine.calls("apt-get") if "--simulate" in call]
    for package in ("libglib2.0-0", "libxcb-cursor0", "libatomic1"):
        assert package in simulate.split()


def test_the_private_folder_is_found_through_the_environment(machine):
    """The variables of loader, Mesa, GLVND and glcontext point there, with blanks in the path."""
    machine.has_libraries(*OTHERS)
    machine.has("apt-get", APT_GET)
    machine.has("dpkg", DPKG)
    machine.provide()
    done = machine.shell("-c", '. ".system/env"; env', LD_LIBRARY_PATH="/own")
    variables = dict(line.split("=", 1) for line in done.stdout.splitlines())
    private = f"{machine.root}/.system/root"
    libraries = f"{private}/usr/lib/x86_64-linux-gnu"
    assert variables["LD_LIBRARY_PATH"] == f"{libraries}:{private}/lib/x86_64-linux-gnu:/own"
    assert variables["LIBGL_DRIVERS_PATH"] == f"{libraries}/dri"
    assert variables["__EGL_VENDOR_LIBRARY_DIRS"] == f"{private}/usr/share/glvnd/egl_vendor.d"
    assert variables["GLCONTEXT_LINUX_LIBGL"] == f"{libraries}/libGL.so.1"
    assert variables["GLCONTEXT_LINUX_LIBEGL"] == f"{libraries}/libEGL.so.1"


def test_a_private_folder_is_fetched_once(machine):
    """The second run calls no apt-get and prints nothing."""
    machine.has_libraries(*OTHERS)
    machine.has("apt-get", APT_GET)
    machine.has("dpkg", DPKG)
    machine.provide()
    assert machine.provide() == ""
    assert set(machine.calls()) == {"ldconfig -p"}


def test_a_private_folder_that_lacks_a_library_is_fetched_anew(machine):
    """`make test` after `make run` fetches the libraries that are still missing."""
    machine.has_libraries(*OTHERS)
    machine.has("apt-get", APT_GET)
    machine.has("dpkg", DPKG)
    machine.provide()
    machine.has_libraries("qt", "x11")
    assert "fetching libegl1 libgl1 libatomic1" in machine.provide()


def test_the_systems_gl_wins_over_the_private_one(machine):
    """A driver that is installed later is not hidden by llvmpipe."""
    machine.has_libraries(*OTHERS)
    machine.has("apt-get", APT_GET)
    machine.has("dpkg", DPKG)
    machine.provide()
    machine.has_libraries("gl", *OTHERS)
    machine.provide()
    assert not (machine.root / ".system/env").exists()


def test_private_can_be_asked_for(machine):
    """VRUT_LITE_SYSTEM=private leaves the system unchanged, even for root."""
    machine.has_libraries(*OTHERS)
    machine.has("apt-get", APT_GET)
    machine.has("dpkg", DPKG)
    machine.user(0)
    machine.provide(VRUT_LITE_SYSTEM="private")
    assert (machine.root / ".system/env").exists()
    assert not any(" install --yes" in call for call in machine.calls("apt-get"))


def test_none_can_be_asked_for(machine):
    """VRUT_LITE_SYSTEM=none skips the search."""
    machine.user(0)
    assert machine.provide(VRUT_LITE_SYSTEM="none") == ""
    assert machine.calls() == []


@pytest.mark.parametrize("broken", ["no apt", "offline", "no download", "broken package"])
@pytest.mark.parametrize("user", [0, 1000])
def test_without_network_or_apt_set_up_goes_on(machine, broken, user):
    """A line for each group names its packages; no incomplete environment file remains."""
    machine.user(user)
    if broken != "no apt":
        failing = {"offline": OFFLINE, "no download": "case $* in *download*|*--yes*) exit 1; esac"}
        machine.has("apt-get", failing.get(broken, "case $* in *--yes*) exit 1; esac") + APT_GET)
        machine.has("dpkg", DPKG + ("exit 2" if broken == "broken package" else ""))
    *_, gl, qt, x11, mitsuba = machine.provide().splitlines()
    assert gl.startswith("going on without GL: missing are the system's packages libegl1 libgl1")
    assert qt.startswith("going on without windows: missing are the system's packages libglib2.0-0")
    assert x11.startswith("going on without windows on a screen: missing")
    assert mitsuba.endswith("the system's packages libatomic1, or their like")
    assert not (machine.root / ".system/env").exists()


def with_venv(machine: Machine, pip: str = "", uv: str = "exit 1") -> None:
    """A complete .venv with a new Python and stand-ins for pip and uv."""
    body = f"""
case $1$2 in
-mpip) {pip} ;;
-muv) {uv} ;;
-cimport*version_info*) ;;
-c*) echo 3.11.7 ;;
esac"""
    machine.has("python", body, machine.root / ".venv/bin")
    machine.has("pip", "", machine.root / ".venv/bin")
    machine.has_libraries("gl", *OTHERS)


def installations(machine: Machine) -> list[str]:
    """The product's extras in each call of pip, which installs the laboratory beside it."""
    calls = [call for call in machine.calls("python") if " -m pip install " in call]
    both = [call.split(f" --editable {machine.root}")[1:] for call in calls]
    assert all(lab.startswith("/lab") for _, lab in filter(None, both))
    return [product for product, _ in filter(None, both)]


def test_packages_are_installed_once_and_again_when_pyproject_changes(machine):
    """The stamp holds everything that an installation depends on."""
    with_venv(machine)
    assert machine.shell("tools/bootstrap.sh", "test").returncode == 0
    assert installations(machine) == ["[app,test,ref,ifc]"]
    done = machine.shell("tools/bootstrap.sh", "test")
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    assert installations(machine) == []
    for changed in ("pyproject.toml", "lab/pyproject.toml"):
        with (machine.root / changed).open("a") as file:
            file.write("# changed\n")
        machine.shell("tools/bootstrap.sh", "test")
        assert installations(machine) == ["[app,test,ref,ifc]"]


def test_what_suffices_to_test_suffices_to_run_but_not_the_reverse(machine):
    """`make run` after `make test` installs nothing; `make test` after `make run` does."""
    with_venv(machine)
    machine.shell("tools/bootstrap.sh", "run")
    assert installations(machine) == ["[app]"]
    machine.shell("tools/bootstrap.sh", "test")
    assert installations(machine) == ["[app,test,ref,ifc]"]
    shutil.rmtree(machine.root / ".venv")
    with_venv(machine)
    machine.shell("tools/bootstrap.sh", "test")
    machine.shell("tools/bootstrap.sh", "run")
    assert installations(machine) == []
    machine.shell("tools/bootstrap.sh", "lint")
    assert installations(machine) == ["[app,test,ref,ifc,lint]"]
    machine.shell("tools/bootstrap.sh", "test")
    assert installations(machine) == []


def test_without_mitsuba_the_tests_still_run_and_it_is_tried_again(machine):
    """mitsuba has no wheels for some machines: its tests are skipped with the reason."""
    with_venv(machine, pip="case $* in *ref*) exit 1 ;; esac")
    for _ in range(2):
        done = machine.shell("tools/bootstrap.sh", "test")
        assert done.returncode == 0
        assert "without mitsuba" in done.stderr
        assert installations(machine) == ["[app,test,ref,ifc]", "[app,test]"]


def test_uv_installs_from_the_index_that_pip_is_told(machine):
    """uv, which is three times as fast, reads neither pip's settings nor its certificates."""
    index = 'case "$3 $4" in "config get") echo https://mirror.example/simple ;; esac'
    with_venv(machine, pip=index, uv="")
    assert machine.shell("tools/bootstrap.sh", "run").returncode == 0
    (call,) = (call for call in machine.calls("python") if " -m uv " in call)
    assert " --default-index https://mirror.example/simple --editable" in call
    assert call.endswith(f"{machine.root}[app] --editable {machine.root}/lab")


@pytest.mark.parametrize("purpose", ["run", "test"])
def test_a_failing_pip_stops_set_up_and_leaves_no_stamp(machine, purpose):
    """Set-up stops, because an ImportError later would hide the cause."""
    with_venv(machine, pip="exit 1")
    assert machine.shell("tools/bootstrap.sh", purpose).returncode != 0
    assert not list((machine.root / ".venv").glob("installed*"))


def test_an_old_python_is_refused_in_one_line(machine):
    """No .venv is made with a Python that is too old."""
    machine.has("python3", "exit 1")
    done = machine.shell("tools/bootstrap.sh", "run")
    assert done.returncode != 0
    assert done.stderr.count("\n") == 1
    assert "no Python 3.11 or newer" in done.stderr
    assert not (machine.root / ".venv").exists()


# A Python of Debian's, without ensurepip, of which `-m venv` makes a whole .venv.
SPLIT_PYTHON = """
case "$1 $2" in
"-c import ensurepip"*) exit 1 ;;
"-c "*print*) echo python3.11-venv ;;
"-m venv") mkdir -p "$3/bin"; cp "$0" "$3/bin/python"; cp "$0" "$3/bin/pip" ;;
esac"""


def test_debians_missing_venv_half_is_installed_or_named(machine):
    """Root installs it by apt-get; for others one line names the package of this version."""
    machine.has("python3", SPLIT_PYTHON)
    (machine.bin / "cp").symlink_to(shutil.which("cp"))
    done = machine.shell("tools/bootstrap.sh", "run")
    assert done.returncode != 0
    assert done.stderr == (
        "vrut_lite: python3 cannot make virtual environments: install python3.11-venv\n"
    )
    machine.has("apt-get")
    machine.user(0)
    assert machine.shell("tools/bootstrap.sh", "run").returncode == 0
    assert "apt-get -qq -o DPkg::Lock::Timeout=60 install --yes --no-install-recommends " in (
        machine.log.read_text()
    )
    assert (machine.root / ".venv/installed-for-run").exists()


def test_bootstrap_asks_for_a_purpose(machine):
    """A wrong argument prints the usage, exits with 2 and makes nothing."""
    done = machine.shell("tools/bootstrap.sh")
    assert done.returncode == 2
    assert done.stderr == "vrut_lite: usage: tools/bootstrap.sh run|test|lint|long|docs|page\n"
    assert not (machine.root / ".venv").exists()


def test_the_pages_script_is_bundled_again_when_its_sources_change(machine):
    """Once for the same sources; npm and node run in .page, not in the package's folder."""
    sources = machine.root / "modules" / "share" / "page"
    shutil.copytree(ROOT / "modules" / "share" / "page", sources)
    (machine.bin / "cp").symlink_to(str(shutil.which("cp")))
    machine.has("npm")
    built = machine.root / "modules" / "share" / "built"
    machine.has("node", f'mkdir -p "{built}"; echo script >"{built}/page.js"')
    assert machine.shell("tools/bootstrap.sh", "page").returncode == 0
    assert [call.split()[0] for call in machine.calls("npm", "node")] == ["npm", "node"]
    assert machine.shell("tools/bootstrap.sh", "page").returncode == 0
    assert machine.calls("npm", "node") == []
    with (sources / "src" / "main.js").open("a") as file:
        file.write("// changed\n")
    assert machine.shell("tools/bootstrap.sh", "page").returncode == 0
    assert len(machine.calls("npm", "node")) == 2
    assert not (sources / "node_modules").exists()


def test_without_npm_the_page_is_said_to_be_missing(machine):
    done = machine.shell("tools/bootstrap.sh", "page")
    assert done.returncode == 1
    assert "apt-get install nodejs npm" in done.stderr
