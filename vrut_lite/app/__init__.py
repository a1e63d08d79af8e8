"""The desktop application: a window on a host that runs on a thread of its own.

Qt lives in this package alone. `engine` pumps and draws, `session` brings it to Qt's thread by a
mailbox, panels send inputs and listen to messages; they know nothing of each other.
"""
