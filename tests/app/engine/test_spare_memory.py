"""Memory that the C library keeps after it was freed is returned while the window rests."""

import ctypes
from pathlib import Path

import pytest

from vrut_lite.app.engine.spare_memory import SpareMemory, malloc_trim

pytestmark = pytest.mark.skipif(malloc_trim() is None, reason="the C library is not glibc")
_BLOCKS, _BLOCK_BYTES = 20_000, 8192
_PATIENCE_MS = 240_000


def resident_bytes():
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * 4096


@pytest.fixture
def holes():
    """160 MB of blocks that were used and freed, below one that is still in use."""
    libc = ctypes.CDLL(None)
    libc.malloc.restype, libc.malloc.argtypes = ctypes.c_void_p, [ctypes.c_size_t]
    libc.free.argtypes = [ctypes.c_void_p]
    blocks = [libc.malloc(_BLOCK_BYTES) for _ in range(_BLOCKS)]
    for block in blocks:
        ctypes.memset(block, 1, _BLOCK_BYTES)
    for block in blocks[:-1]:
        libc.free(block)
    yield
    libc.free(blocks[-1])


def test_after_a_picture_spare_memory_goes_back_once_the_window_rests(qtbot, qapp, holes):
    """A scene that was closed must not stay in the process's memory."""
    before = resident_bytes()
    spare = SpareMemory(qapp)
    spare.picture_shown()
    qtbot.waitUntil(lambda: before - resident_bytes() > 100e6, timeout=_PATIENCE_MS)
    spare.stop()


def test_each_picture_of_a_window_starts_the_wait(drawn_window):
    """By the window itself: its session asks for it with each picture, and ends it at its end."""
    spare = drawn_window.session._spare
    drawn_window.until(lambda: not spare._rest.isActive())
    drawn_window.session.meter_exposure()
    drawn_window.until(spare._rest.isActive)
