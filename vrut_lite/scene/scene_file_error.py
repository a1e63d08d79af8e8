"""The error of a scene file."""


class SceneFileError(ValueError):
    """A fault of a scene file, with its remedy; `load_scene` adds the path."""


class UnreadFile(SceneFileError):
    """A file that a scene names is missing or not one that may be read.

    A scene is usable without its pictures: they are left out, with a warning by the reason in `why`
    (such as "missing").
    """

    def __init__(self, message: str, why: str) -> None:
        super().__init__(message)
        self.why = why
