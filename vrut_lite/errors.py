"""The exceptions that the command line tells in one sentence."""


class UserError(Exception):
    """Bad input: what is wrong, where, and what to do, in one sentence; exit code 2."""


class ModuleFailed(Exception):
    """A module raised what it should not; the text names it. Exit code 1."""
