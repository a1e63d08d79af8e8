"""A process that lacks what Windows or macOS lack, and runs commands there.

    python tests/other_system.py SYSTEM PACKAGES COMMANDS

SYSTEM is win32 or darwin; PACKAGES, of ours, stand between commas; COMMANDS are lists in JSON.
Libraries of others are imported before anything is taken away: they know their systems.
"""

import importlib
import json
import os
import pkgutil
import signal
import socket
import sys
from contextlib import suppress
from pathlib import Path

# What Python 3.11 has on Linux and not on Windows, and on Linux and not on macOS, by the type
# stubs of Python's own library (typeshed, os/__init__.pyi and signal.pyi).
LACKING = {
    "win32": {
        "os": (
            "chown chroot confstr copy_file_range ctermid environb eventfd fchdir fchmod fchown "
            "fdatasync fork forkpty fpathconf fstatvfs fwalk get_blocking getegid getenvb geteuid "
            "getgid getgrouplist getgroups getloadavg getpgid getpgrp getpriority getrandom "
            "getresgid getresuid getsid getuid getxattr initgroups killpg lchown listxattr lockf "
            "makedev memfd_create mkfifo mknod nice openpty pathconf pidfd_open pipe2 "
            "posix_fadvise posix_fallocate posix_spawn posix_spawnp pread preadv pwrite pwritev "
            "readv register_at_fork removexattr sched_get_priority_max sched_getaffinity "
            "sched_getparam sched_getscheduler sched_setaffinity sched_setscheduler sched_yield "
            "sendfile set_blocking setegid seteuid setgid setgroups setpgid setpgrp setpriority "
            "setregid setreuid setsid setuid setxattr splice statvfs sync sysconf tcgetpgrp "
            "ttyname uname wait wait3 wait4 waitid writev O_CLOEXEC O_DIRECTORY O_NOCTTY "
            "O_NOFOLLOW O_NONBLOCK O_SYNC PRIO_PROCESS RTLD_GLOBAL RTLD_NOW SEEK_DATA "
            "WIFEXITED WIFSIGNALED WTERMSIG"
        ),
        "signal": (
            "SIGALRM SIGBUS SIGCHLD SIGCONT SIGHUP SIGIO SIGKILL SIGPIPE SIGPROF SIGQUIT SIGSTOP "
            "SIGSYS SIGTRAP SIGTSTP SIGTTIN SIGTTOU SIGURG SIGUSR1 SIGUSR2 SIGVTALRM SIGWINCH "
            "SIGXCPU SIGXFSZ SIG_BLOCK SIG_SETMASK SIG_UNBLOCK alarm getitimer pause pthread_kill "
            "pthread_sigmask setitimer siginterrupt sigpending sigtimedwait sigwait sigwaitinfo"
        ),
        "socket": "AF_UNIX recv_fds send_fds",
        "modules": "fcntl grp posix pty pwd readline resource spwd syslog termios tty crypt",
    },
    "darwin": {
        "os": (
            "copy_file_range eventfd fdatasync getrandom getresgid getresuid getxattr listxattr "
            "memfd_create pidfd_open pipe2 posix_fadvise posix_fallocate removexattr "
            "sched_getaffinity sched_getparam sched_getscheduler sched_setaffinity "
            "sched_setscheduler setresgid setresuid setxattr splice waitid O_DIRECT"
        ),
        "signal": "SIGCLD SIGPOLL SIGPWR SIGRTMAX SIGRTMIN SIGSTKFLT sigtimedwait sigwaitinfo",
        "socket": "",
        "modules": "spwd",
    },
}
# Libraries that are imported first.
LIBRARIES = (
    "asyncio", "concurrent.futures.process", "ctypes.util", "multiprocessing.synchronize",
    "multiprocessing.popen_spawn_posix", "multiprocessing.resource_tracker", "shutil", "tempfile",
    "uuid", "zipfile", "zoneinfo", "click", "platformdirs", "rich.console", "numpy", "scipy.sparse",
    "scipy.spatial", "numba", "PIL.Image", "pytest", "OpenGL.GL.shaders", "moderngl", "trimesh",
    "mitsuba", "PySide6.QtWidgets", "pyqtgraph", "zenoh",
)  # fmt: skip
YARD = """mtllib none.mtl
v 0 0 0
v 4 0 0
v 4 0 4
v 0 0 4
v 0 3 0
v 4 3 0
f 4 3 2 1
f 1 2 6 5
"""
DAY = ("--place", "50.0755,14.4378,200", "--at", "2026-06-21T12:00")
LIGHT = (
    ("sky", "-o", "hosek.npz", "--size", "16", "--sky", "dynamic_skylight", *DAY),
    ("record", "-o", "day.mcap", "--size", "8", "--from", "2026-06-21T04:00", "--to",
     "2026-06-21T06:00", *DAY),
    ("replay", "day.mcap", "--check"),
    ("modules",),
)  # fmt: skip
HEAVY = (
    ("sky", "-o", "bruneton.npz", "--size", "16", "--sky", "bruneton_sky", *DAY),
    ("daylight", "yard.obj", "-o", "numbers", "--sensors", "desks.csv", "--tolerance", "20%", *DAY),
)
TRACED = (
    ("render", "yard.obj", "-o", "traced.exr", "--engine", "path-tracer", "--spp", "4",
     "--size", "16x16", *DAY),
)  # fmt: skip


def take_away(system: str) -> None:
    """Remove from Python what a system lacks, and let vrut_lite believe that it runs there."""
    # Libraries of this machine go the way of this machine.
    os.environ.setdefault("PYOPENGL_PLATFORM", "egl")
    for name in LIBRARIES:
        # Some are optional, some need a library of the system.
        with suppress(ImportError, OSError, RuntimeError, NameError):
            importlib.import_module(name)
    lacking = LACKING[system]
    for module in (os, signal, socket):
        for name in lacking[module.__name__].split():
            if hasattr(module, name):
                delattr(module, name)
    for name in lacking["modules"].split():
        sys.modules[name] = None
    from vrut_lite import operating_system

    operating_system.NAME = system


def import_all(packages: tuple[str, ...]) -> list[str]:
    """Import all python modules of packages; names of those that lack a package of others."""
    lacking = []
    for package in packages:
        found = importlib.import_module(package)
        for info in pkgutil.walk_packages(found.__path__, f"{package}."):
            try:
                importlib.import_module(info.name)
            except ImportError as error:
                if error.name is None or error.name.partition(".")[0] in packages:
                    raise
                lacking.append(f"{info.name}: {error.name}")
    return lacking


def run(commands: tuple[tuple[str, ...], ...]) -> None:
    """Run commands in the present folder, one after another in this process; keep an array."""
    import numpy as np

    from vrut_lite import cli
    from vrut_lite.array_cache import ArrayCache

    cache = ArrayCache(Path("cache"))
    cache.put("a recipe", {"values": np.arange(3.0)})
    assert cache.get("a recipe") is not None
    Path("yard.obj").write_text(YARD, encoding="utf-8")
    Path("desks.csv").write_text("1,0.8,1\n2,0.8,2\n", encoding="utf-8")
    for command in commands:
        sys.argv = ["vrut-lite", *command]
        cli.main()


def main() -> None:
    """Take away, import, run; the last line is JSON of what could not be imported."""
    # In place of this file's folder, whose folders have the names of packages.
    del sys.path[0]
    system, packages, commands = sys.argv[1], sys.argv[2].split(","), json.loads(sys.argv[3])
    take_away(system)
    lacking = import_all(tuple(filter(None, packages)))
    run(commands)
    print(json.dumps(lacking))


if __name__ == "__main__":
    main()
