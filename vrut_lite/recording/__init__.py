"""Journals: what was said to the kernel, what it answered, and whether it still does."""
