"""Scenes: loading them, framing them, and the manager that hands them to a backend."""
