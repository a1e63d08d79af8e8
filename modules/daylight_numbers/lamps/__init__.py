"""Lamps: their light at sensors, their controls, their year."""
