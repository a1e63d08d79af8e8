"""A scripted tour of the window, and what its memory is made of meanwhile."""
