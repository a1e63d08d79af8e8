"""Skies: the interface of their authors, and the complete light of the sky."""
