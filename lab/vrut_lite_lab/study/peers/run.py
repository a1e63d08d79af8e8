"""All peers, each scored at all views that it can show."""

from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

from vrut_lite_lab.study.peers.airs import AIRS
from vrut_lite_lab.study.peers.blender import BLENDER
from vrut_lite_lab.study.peers.mitsuba_sky import Sunsky
from vrut_lite_lab.study.peers.ours import (
    OurHosekWilkie,
    OursPicture,
    OursRays,
    PreethamSky,
    PublishedTables,
)
from vrut_lite_lab.study.peers.peer import NotHere, Peer, PeerShot
from vrut_lite_lab.study.peers.prague import Prague
from vrut_lite_lab.study.peers.radiance_skies import Gensky, Genssky
from vrut_lite_lab.study.peers.scores import ViewScore, score
from vrut_lite_lab.study.peers.truth import Truth, truth
from vrut_lite_lab.study.peers.views import ALOFT, ON_GROUND, TIMED, SkyViewpoint

VIEWS = (*ON_GROUND, *ALOFT)
# Enough to see a plan through in a minute.
QUICK = (SkyViewpoint(30.0), SkyViewpoint(3.0), SkyViewpoint(-6.0))


def usual_peers() -> tuple[Peer, ...]:
    """Every program, and ours in the air of each."""
    others: tuple[Peer, ...] = (
        *BLENDER,
        Genssky(),
        Gensky(),
        Sunsky(),
        OurHosekWilkie(),
        PreethamSky(),
        Prague(),
        PublishedTables(),
    )
    ours: tuple[Peer, ...] = (
        OursPicture(),
        OursRays("continental", "fine"),
        *(OursRays(air, "usual") for air in AIRS if air != "continental"),
    )
    return others + ours


class Scored(NamedTuple):
    """A peer, its pictures and errors by view; `reason` says why it is left out."""

    peer: Peer
    shots: dict[SkyViewpoint, PeerShot]
    scores: dict[SkyViewpoint, ViewScore]
    reason: str = ""

    @property
    def cpu_s(self) -> float:
        """CPU time of the timed picture."""
        return self.shots[TIMED].cpu_s if TIMED in self.shots else float("nan")


class Truths:
    """The truth by air and view, computed when first asked for."""

    def __init__(self) -> None:
        self._known: dict[tuple[str, SkyViewpoint], Truth] = {}

    def of(self, air: str, view: SkyViewpoint) -> Truth:
        """Raises NotHere where the air's constants are missing."""
        if (air, view) not in self._known:
            self._known[air, view] = truth(air, view)
        return self._known[air, view]


def scored_peers(
    peers: Sequence[Peer],
    views: Sequence[SkyViewpoint],
    truths: Truths,
    tell: Callable[[str], None],
) -> Iterator[Scored]:
    """One peer after another; what is not here is told, not raised."""
    for peer in peers:
        tell(peer.title)
        try:
            shots = peer.shots(views)
            scores = {
                view: score(shot.rgb, truths.of(peer.air, view), view, peer.grey)
                for view, shot in shots.items()
            }
        except NotHere as error:
            yield Scored(peer, {}, {}, str(error))
            continue
        yield Scored(peer, shots, scores)
