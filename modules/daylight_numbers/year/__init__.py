"""A year of hours: its skies, its light, its metrics."""
