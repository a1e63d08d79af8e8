"""What a program's sky is to the study."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple, Protocol

from bruneton_sky import Atmosphere

from vrut_lite.errors import UserError
from vrut_lite.numeric_types import FloatArray
from vrut_lite_lab.study.peers.views import SkyViewpoint


class NotHere(UserError):
    """A program is not installed, or does not run here; the sentence says which and why."""


@dataclass(frozen=True, eq=False, kw_only=True)
class PeerAir:
    """An atmosphere in which skies are compared.

    Attributes:
        to_rgb: (C, 3), radiance per nm to linear sRGB.
        note: how it was matched.
    """

    name: str
    title: str
    atmosphere: Atmosphere
    to_rgb: FloatArray
    note: str


class PeerShot(NamedTuple):
    """A sky: linear RGB (rows, 2 columns, 3) at the measured pixels in the program's own unit, and
    the CPU time of its 512 x 256 picture, NaN where only the measured pixels were computed."""

    rgb: FloatArray
    cpu_s: float


class Peer(Protocol):
    """A program's sky.

    Attributes:
        air: the one that it is compared in, by name of `airs.AIRS`.
        cannot: what it has not, for the table.
        grey: it knows luminance alone.
    """

    air: str
    cannot: str
    grey: bool

    @property
    def name(self) -> str:
        """An identifier."""

    @property
    def title(self) -> str:
        """For readers."""

    def shots(self, views: Sequence[SkyViewpoint]) -> dict[SkyViewpoint, PeerShot]:
        """Those of the views that it can show.

        Raises:
            NotHere: it is not installed.
        """

    def prepared_s(self) -> float:
        """CPU seconds of what a new atmosphere costs once; 0 where that is nothing."""
