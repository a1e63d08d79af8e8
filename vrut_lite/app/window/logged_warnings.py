"""Warnings that the host and its modules log, shown in the window."""

import logging
from collections.abc import Callable
from functools import partial

from PySide6.QtCore import QObject, Signal

from vrut_lite.compiling.kernel_list import packages


class LoggedWarnings(QObject):
    """Emits `logged` with each warning of the host or of an installed module, from any thread.

    Warnings of other packages are for developers; all of them still go to stderr.
    """

    logged = Signal(str)

    def __init__(self, parent: QObject):
        super().__init__(parent)
        self._handlers: list[logging.Handler] = [
            _Emitter(self.logged.emit),
            logging.StreamHandler(),
        ]
        for handler in self._handlers:
            handler.setLevel(logging.WARNING)
            logging.getLogger().addHandler(handler)
        # A handler that outlived the window would fail in the module that warns.
        self.destroyed.connect(partial(_remove, self._handlers))

    def close(self) -> None:
        """Emit no more."""
        _remove(self._handlers)


def _remove(handlers: list[logging.Handler], *_: object) -> None:
    for handler in handlers:
        logging.getLogger().removeHandler(handler)


class _Emitter(logging.Handler):
    def __init__(self, emit: Callable[[str], None]):
        super().__init__()
        self._emit = emit
        self._packages = frozenset(packages())

    def emit(self, record: logging.LogRecord) -> None:
        if record.name.partition(".")[0] in self._packages:
            self._emit(record.getMessage())
