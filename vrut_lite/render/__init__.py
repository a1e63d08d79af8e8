"""The one owner of OpenGL, the frame that it draws, and picture files."""
