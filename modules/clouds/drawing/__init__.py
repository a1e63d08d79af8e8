"""The clouds of a frame."""
