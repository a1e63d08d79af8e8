"""A bridge over Zenoh: the same messages in two processes, on one machine or on several."""
