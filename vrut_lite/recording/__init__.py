"""Journals: recorded inputs and messages of a kernel, their replay and comparison."""
