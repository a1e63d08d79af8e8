"""The steps of installing for a program that must not wait: each a process that answers in JSON.

    python -m vrut_lite.module_packages.remote install WHAT FOLDER
    python -m vrut_lite.module_packages.remote update NAME WHAT FOLDER   (WHAT may be empty)
    python -m vrut_lite.module_packages.remote apply WHEEL SHA256
    python -m vrut_lite.module_packages.remote remove NAME FOLDER

`install` and `update` prepare a wheel in a folder, which `apply` installs when the user has agreed.
"""

import sys
from pathlib import Path

import msgspec

from vrut_lite.errors import UserError
from vrut_lite.foreign_errors import sentence_of
from vrut_lite.interrupts import pass_interrupt
from vrut_lite.module_packages import installing
from vrut_lite.module_packages.wheels import ModuleWheel, read_wheel


class Answer(msgspec.Struct, frozen=True):
    """The end of a step: a sentence if it failed, and the wheel that it made, if it makes one."""

    error: str = ""
    wheel: ModuleWheel | None = None


def answer_of(output: bytes) -> Answer:
    """The answer in the output of a step, whose last line it is."""
    lines = output.strip().splitlines()
    try:
        return msgspec.json.decode(lines[-1] if lines else b"", type=Answer)
    except msgspec.DecodeError:
        said = lines[-1].decode(errors="replace") if lines else "it says nothing"
        return Answer(error=f"the step ended without an answer: {said}")


def main(step: str, *arguments: str) -> int:
    """Do a step and print its answer."""
    try:
        answer = Answer(wheel=_do(step, *arguments))
    except BaseException as error:
        pass_interrupt(error)
        answer = Answer(error=sentence_of(error))
    sys.stdout.buffer.write(msgspec.json.encode(answer) + b"\n")
    return 0


def _do(step: str, *arguments: str) -> ModuleWheel | None:
    if step == "install":
        what, folder = arguments
        return installing.prepare_install(what, Path(folder))
    if step == "update":
        name, what, folder = arguments
        return installing.prepare_update(name, what or None, Path(folder))
    if step == "remove":
        name, folder = arguments
        installing.remove(installing.package_of_others(name), Path(folder))
        return None
    path, sha256 = arguments
    wheel = read_wheel(Path(path))
    if wheel.facts.sha256 != sha256:
        raise UserError(f"{wheel.facts.name} has changed since it was shown: install it again")
    installing.install(wheel)
    return None


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
