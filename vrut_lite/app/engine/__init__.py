"""The host on a thread of its own, and what is known of it on Qt's thread. No widgets."""
