"""The messages of daylight: values, each with `check()`; no computation."""
