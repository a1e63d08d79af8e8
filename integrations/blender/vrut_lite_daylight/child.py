"""The process of vrut_lite that computes skies: kept alive, asked by lines of JSON."""

import json
import os
import subprocess
import threading


class NoDaylight(Exception):
    """Why there is no sky, in one sentence."""


class Child:
    """`vrut-lite serve`, started when it is first asked, and again after it has ended."""

    def __init__(self):
        self._process = None
        self._program = ""
        self._lock = threading.Lock()
        # Modules of the program that was asked last.
        self.modules = frozenset()

    def ask(self, program, words):
        """Run a command of vrut_lite; returns what it says.

        Args:
            program: the path of `vrut-lite`.
            words: the command's words.

        Raises:
            NoDaylight: the program cannot be started, or it refuses.
        """
        with self._lock:
            answer = self._answer(program, json.dumps(words))
        if answer["code"]:
            raise NoDaylight(answer["error"])
        return answer["said"]

    def _answer(self, program, line):
        if program != self._program or self._process is None or self._process.poll() is not None:
            self.close()
            self._process, self._program = _start(program), program
            listed = self._said(program, '["modules"]')["said"].splitlines()
            self.modules = frozenset(row.split()[0] for row in listed if row[:1].isalpha())
        return self._said(program, line)

    def _said(self, program, line):
        try:
            self._process.stdin.write(line + "\n")
            self._process.stdin.flush()
            return json.loads(self._process.stdout.readline())
        except (OSError, ValueError) as error:
            self.close()
            raise NoDaylight(f"{program} ended without an answer: run it in a terminal") from error

    def close(self):
        """End the process, if there is one."""
        if self._process is not None:
            self._process.stdin.close()
            self._process.stdout.close()
            self._process.terminate()
            self._process.wait()
        self._process = None


def _start(program):
    # Blender's own Python is another one: what points to it must not reach the child.
    surroundings = {k: v for k, v in os.environ.items() if k not in ("PYTHONPATH", "PYTHONHOME")}
    try:
        return subprocess.Popen(
            [program, "serve"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            env=surroundings,
            text=True,
        )
    except OSError as error:
        raise NoDaylight(
            f"cannot start {program} ({error.strerror}): name the path of vrut-lite in the "
            "add-on's preferences"
        ) from error
