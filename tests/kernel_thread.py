"""The kernel's own thread, so that a slow handler never holds up a window."""

import threading
from collections.abc import Callable

from vrut_lite.kernel.bus import Kernel


class KernelThread:
    """Pumps a kernel whenever an input arrives, until stopped.

    What `pump` raises is the host's own error (a module's never leaves the kernel): it goes to
    `on_error`, on this thread, and the pumping goes on.
    """

    def __init__(self, kernel: Kernel, on_error: Callable[[BaseException], None]):
        self._kernel = kernel
        self._on_error = on_error
        self._awake = threading.Event()
        self._ending = False
        self._thread = threading.Thread(target=self._run, name="vrut-lite kernel", daemon=True)

    def start(self) -> None:
        """Begin to pump, also what was injected before."""
        self._kernel.on_inject(self._wake)
        self._awake.set()
        self._thread.start()

    def stop(self) -> None:
        """Act on all that was injected so far and end the thread."""
        self._ending = True
        self._awake.set()
        self._thread.join()
        self._kernel.on_inject(None)

    def _wake(self) -> None:
        # Asking is cheaper than setting. A wake-up that is still set is cleared before the
        # next pump, which therefore finds the input that this call is about.
        if not self._awake.is_set():
            self._awake.set()

    def _run(self) -> None:
        while not self._ending:
            self._awake.wait()
            self._awake.clear()
            self._pump()
        self._pump()

    def _pump(self) -> None:
        """Pump to the end: each error costs the one message at which it was raised."""
        while True:
            try:
                self._kernel.pump()
            except BaseException as error:
                self._on_error(error)
            else:
                return
