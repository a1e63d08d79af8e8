"""Standards and rules of daylight, clause by clause."""
