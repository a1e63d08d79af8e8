"""The sizes that modules choose by the tolerance: what `tolerance_fronts` measures, by module."""
