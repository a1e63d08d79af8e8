"""The tolerance as an input: admitted, refused, remembered; choices from fronts."""

import math
from typing import ClassVar

import pytest
from hypothesis import given
from hypothesis import strategies as st
from probe_messages import act, faults_of

from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.module import Manifest, Module, NoSettings, handles
from vrut_lite.messages.tolerance import (
    DEFAULT_TOLERANCE,
    MeasuredFronts,
    Point,
    SetTolerance,
    budget,
    cheapest,
    read_fronts,
    tolerance_of,
)

FRONT = [Point(8, 0.1, 64.0, 1.0), Point(16, 0.03, 256.0, 2.0), Point(32, 0.01, 1024.0, 3.0)]


class Listener(Module):
    """Records each tolerance that it receives, and what its link has at that moment."""

    manifest = Manifest(name="listener", title="Listener", version="1")
    settings_type = NoSettings
    heard: ClassVar[list[tuple[float, float]]] = []

    @handles(SetTolerance)
    def changed(self, message: SetTolerance) -> None:
        self.heard.append((message.tolerance, tolerance_of(self.link)))


@pytest.fixture
def kernel():
    Listener.heard.clear()
    kernel = Kernel()
    kernel.add_module(Listener)
    return kernel


def test_a_tolerance_reaches_modules_and_is_remembered(kernel):
    """A module that starts later gets the last tolerance from its link, at first the default."""
    assert tolerance_of(kernel.seats["listener"].link) == DEFAULT_TOLERANCE
    act(kernel, SetTolerance(tolerance=0.01), SetTolerance(tolerance=1.0))
    assert Listener.heard == [(0.01, 0.01), (1.0, 1.0)]
    assert tolerance_of(kernel.seats["listener"].link) == 1.0


@pytest.mark.parametrize("tolerance", [0.0, -0.01, 1.0001, math.nan, math.inf])
def test_invalid_tolerances_are_refused_in_one_sentence(kernel, tolerance):
    """An invalid share is refused before modules see it."""
    faults = faults_of(kernel)
    act(kernel, SetTolerance(tolerance=0.02), SetTolerance(tolerance=tolerance))
    (fault,) = faults
    assert fault.for_user
    assert fault.error == (f"the tolerance must be above 0 and 1 (100 %) at most, not {tolerance}")
    assert Listener.heard == [(0.02, 0.02)]
    assert kernel.last(SetTolerance) == SetTolerance(tolerance=0.02)


def test_the_cheapest_that_is_allowed_is_taken():
    """Least work within the error, whatever the order of the list; else the most exact."""
    assert [cheapest(FRONT[::-1], allowed) for allowed in (1.0, 0.05, 0.03, 0.02)] == [
        8,
        16,
        16,
        32,
    ]
    assert cheapest(FRONT, 1e-6) == 32


def test_more_work_for_no_less_error_is_never_taken():
    """Points that are dominated by others, as noise makes them, are ignored."""
    behind = Point(24, 0.03, 600.0, 2.5)
    assert cheapest([*FRONT, behind], 0.03) == 16


@given(st.floats(1e-6, 1.0), st.floats(1e-6, 1.0), st.floats(1e-4, 0.1), st.floats(0.01, 1.0))
def test_a_looser_tolerance_never_has_a_smaller_budget(one, other, usual, share):
    """A looser tolerance never asks for more work, and a tight one is not exceeded."""
    tight, loose = sorted((one, other))
    assert budget(tight, usual, share) <= budget(loose, usual, share) * (1.0 + 1e-12)
    if tight < DEFAULT_TOLERANCE:
        assert budget(tight, usual, share) <= share * tight
    assert budget(DEFAULT_TOLERANCE, usual, share) == usual


def test_fronts_are_read_as_they_were_written(tmp_path):
    """Sizes stay integers and names stay texts."""
    file = tmp_path / "fronts.json"
    file.write_text(
        '{"module": "m", "pictures": 3, "seed": 1, "fronts": {"size": [{"choice": 8, "error": 0.1,'
        ' "work": 64, "cpu_ms": 1}], "rung": [{"choice": "fine", "error": 0, "work": 1, "cpu_ms":'
        " 2}]}}"
    )
    sizes, rungs = [Point(8, 0.1, 64.0, 1.0)], [Point("fine", 0.0, 1.0, 2.0)]
    assert read_fronts(file) == MeasuredFronts("m", 3, 1, {"size": sizes, "rung": rungs})
