"""Entries of an array cache, and their lifetime; tests/faults kills, fills and forges it."""

import logging
import os
from hashlib import blake2b

import numpy as np
import pytest
from bruneton_sky.atmosphere import Atmosphere

from vrut_lite.array_cache import ArrayCache

RECIPE = (Atmosphere.earth(), 4)


def _arrays(value: float = 1.0) -> dict[str, np.ndarray]:
    return {"transmittance": np.full((4, 5, 3), value, np.float32), "irradiance": np.arange(3.0)}


def test_what_was_put_comes_back_to_the_bit(tmp_path):
    """A cache that changed a digit would make a second run differ from the first."""
    cache = ArrayCache(tmp_path)
    cache.put(RECIPE, _arrays())
    found = cache.get(RECIPE)
    assert found is not None
    for name, array in _arrays().items():
        assert found[name].dtype == array.dtype
        np.testing.assert_array_equal(found[name], array)


def test_another_atmosphere_is_another_entry(tmp_path):
    """The key is the content: a last digit of one coefficient makes other tables."""
    cache = ArrayCache(tmp_path)
    cache.put(RECIPE, _arrays())
    hazier = Atmosphere.earth().with_aerosol(0.0053 * (1 + 1e-15))
    assert cache.get((hazier, 4)) is None
    assert cache.get((Atmosphere.earth(), 3)) is None


@pytest.mark.parametrize(
    "damage", ["truncated", "a bit", "empty", "foreign", "older version", "no arrays"]
)
def test_a_damaged_entry_is_no_entry(tmp_path, caplog, damage):
    """Damaged arrays would make a wrong sky: they are refused, with one line, and made again."""
    cache = ArrayCache(tmp_path)
    cache.put(RECIPE, _arrays())
    (path,) = tmp_path.glob("*.arrays")
    content = bytearray(path.read_bytes())
    middle = len(content) // 2
    content[middle] ^= 1 if damage == "a bit" else 0
    replacement = {
        "truncated": content[:-1],
        "a bit": content,
        "empty": b"",
        "foreign": b"PK\x03\x04" + bytes(100),
        "older version": content.replace(b"arrays 3", b"arrays 2", 1),
        # With a digest that is right for it.
        "no arrays": content[: content.index(b"\n") + 1]
        + blake2b(b"PK", digest_size=32).digest()
        + b"PK",
    }
    path.write_bytes(replacement[damage])
    with caplog.at_level(logging.WARNING):
        assert cache.get(RECIPE) is None
    assert len(caplog.records) == 1
    assert "damaged" in caplog.text
    cache.put(RECIPE, _arrays())
    assert cache.get(RECIPE) is not None


def test_a_folder_that_cannot_be_written_costs_no_tables(tmp_path, caplog):
    """The tables are the user's purpose, the cache only saves time: one line, no exception."""
    blocked = tmp_path / "file"
    blocked.write_text("in the way")
    cache = ArrayCache(blocked / "cache")
    with caplog.at_level(logging.WARNING):
        cache.put(RECIPE, _arrays())
    assert len(caplog.records) == 1
    assert "not kept" in caplog.text
    assert cache.get(RECIPE) is None


def test_the_least_recently_used_goes_first(tmp_path):
    """The folder stays below its limit, and what was read last is kept."""
    size = 3000
    cache = ArrayCache(tmp_path, limit_bytes=3 * size)
    content = {"a": np.zeros(size // 4 // 2, np.float32)}
    for k in range(3):
        cache.put(k, content)
        os.utime(cache._path(k), ns=(k * 10**9, k * 10**9))
    assert cache.get(0) is not None
    for k in range(3, 6):
        cache.put(k, content)
    assert cache.get(0) is not None
    assert cache.get(1) is None
    assert sum(path.stat().st_size for path in tmp_path.iterdir()) <= cache.limit_bytes
