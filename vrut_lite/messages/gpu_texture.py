"""A texture that stays on the GPU, for messages."""

from dataclasses import dataclass
from typing import Any, Self

import msgspec


@dataclass(frozen=True)
class GpuTexture:
    """Description of a texture on the GPU and of how it was made.

    The texels are kept, and not overwritten, while a reference to this object exists. Textures
    are equal if size, format and recipe are equal, so that messages compare and journals digest
    alike on every machine.

    Attributes:
        size: edge in texels; (width, height, depth) of a 3-D texture.
        format: "rgba16f" or "rgba32f".
        recipe: digest of the shader, its uniforms and the output (`GpuJob.recipe`).
    """

    size: int | tuple[int, int, int]
    format: str
    recipe: str

    # The GL owner's reference; not a field, because it is neither compared nor recorded.
    _texture = None

    @property
    def opaque(self) -> Any:
        """The GL owner's reference; None in a texture that was read from a journal."""
        return self._texture

    def holding(self, texture: Any) -> Self:
        """This description, with the texture itself."""
        object.__setattr__(self, "_texture", texture)
        return self

    @classmethod
    def of(cls, value: Any) -> Self:
        """The texture of a job's result, which a journal gives back as its plain fields.

        Raises:
            msgspec.ValidationError: the value is neither a texture nor its fields.
        """
        return value if isinstance(value, cls) else msgspec.convert(value, cls)
