"""The ways that are measured, one file for each kind of computation."""
