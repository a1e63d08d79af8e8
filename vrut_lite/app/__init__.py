"""The desktop application: a window on a host that runs on a separate thread.

No other package of the host imports Qt. `engine/` pumps the kernel and draws; its session delivers
messages and pictures on Qt's thread. `view/` shows the picture. `panels/` and `compare/` send
inputs and listen to messages; no panel imports another. `window/` puts them together.
"""
