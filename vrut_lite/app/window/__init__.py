"""The window: menus, docks, keys, and the files that it keeps."""
