"""Skies of other programs beside ours, each against one truth in the same air."""
