"""Files that come with the program beside its code: examples, the manual, a font, icons.

In a wheel they lie in the package's `data`, where the build put them (`setup.py`); in a checkout
they are the repository's own. Data files outside the packages would be lost to `pip --target`, and
to whoever copies the packages.
"""
