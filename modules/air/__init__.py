"""The air between the eye and what it sees."""
