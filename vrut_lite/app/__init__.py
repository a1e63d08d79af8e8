"""The desktop application: a window on a host that runs on a thread of its own.

In the host Qt lives in this package alone. `engine/` pumps and draws, and its session brings what
it tells to Qt's thread; `view/` is the picture, `panels/` and `compare/` send inputs and listen to
messages without knowing of each other, `window/` puts them together.
"""
