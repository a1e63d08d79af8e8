"""Daylight: its messages, places and times, the tolerance; what every sky and scene shares."""
