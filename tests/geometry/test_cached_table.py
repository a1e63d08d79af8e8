"""Tables of formulas kept on disk."""

import numpy as np

from vrut_lite.geometry.cached_table import kept_table


def test_a_table_is_made_anew_only_when_its_formula_is_another(monkeypatch, tmp_path):
    """Another session reads it; a source file with other bytes makes another."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    source, made = tmp_path / "formula.py", []

    def table():
        made.append(source.read_text())
        return np.full((2, 3), len(made), np.float32)

    for text in ("a", "a", "b"):
        source.write_text(text)
        found = kept_table("numbers", table, str(source))
        np.testing.assert_array_equal(found, len(made))
        assert not found.flags.writeable
    assert made == ["a", "b"]
