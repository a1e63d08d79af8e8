"""The host on its own thread, and a copy of its state on Qt's thread. No widgets."""
