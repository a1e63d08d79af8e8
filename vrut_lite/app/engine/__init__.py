"""The host on a thread of its own, and its state as known on Qt's thread. No widgets."""
