"""Messages and helpers that several tests of the kernel share."""

from typing import ClassVar

from vrut_lite.kernel.messages import Derived, Fault, Input
from vrut_lite.messages.sun import SunMoved


class Poke(Input, frozen=True, kw_only=True):
    """Every single one counts; `fails` names modules that shall raise."""

    value: int = 0
    fails: tuple[str, ...] = ()

    def key(self) -> None:
        return None


class Slide(Input, frozen=True, kw_only=True):
    """A slider's value: of those that wait the latest wins."""

    value: int


class Heard(Derived, frozen=True, kw_only=True):
    """A module tells what it heard, and which start and version of it did."""

    module: str
    value: int
    version: int = 0

    def key(self) -> None:
        return None


class Sun(Derived, frozen=True, kw_only=True):
    """What only the holder of the slot `sun` may say."""

    slot: ClassVar[str | None] = "sun"

    source: str
    value: int = 0


class Halo(Derived, frozen=True, kw_only=True):
    """Another message of the same slot."""

    slot: ClassVar[str | None] = "sun"

    source: str


def collect(kernel, kind):
    """A list that grows by every delivered message of a kind."""
    collected = []
    kernel.tap(lambda message, _: collected.append(message) if type(message) is kind else None)
    return collected


def faults_of(kernel):
    """A list that grows by every Fault."""
    return collect(kernel, Fault)


def act(kernel, *inputs):
    """Each input in turn, in a transaction of its own."""
    for message in inputs:
        kernel.inject(message)
        kernel.pump()


def sun_at(elevation_rad):
    """A sun of this elevation, its disc whole."""
    return SunMoved(
        direction=(0.0, 1.0, 0.0),
        azimuth_rad=0.0,
        elevation_rad=elevation_rad,
        apparent_elevation_rad=elevation_rad,
        visible_disc_fraction=1.0,
    )
