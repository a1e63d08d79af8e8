"""The benchmark paths, one file for each kind of computation."""
