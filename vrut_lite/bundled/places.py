"""Where the files that come with the program are, in a wheel and in a checkout."""

from pathlib import Path

PACKAGE = Path(__file__).parents[1]
DATA = PACKAGE / "data"
CHECKOUT = PACKAGE.parent
# Folder of the wheel's examples, and the folders of a checkout that hold the same.
EXAMPLES = DATA / "examples"
EXAMPLES_HERE = (CHECKOUT / "examples", CHECKOUT)
# Folder of the wheel's manual.
MANUAL = DATA / "manual"


def is_checkout() -> bool:
    """Whether the packages lie in a checkout; a build copies `pyproject.toml` nowhere."""
    return (CHECKOUT / "pyproject.toml").is_file() and (CHECKOUT / "docs").is_dir()


def is_bundled(file: Path) -> bool:
    """Whether a file came with an installed wheel: an upgrade replaces it."""
    return file.resolve().is_relative_to(DATA.resolve())
