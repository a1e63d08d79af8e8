"""What a terminal is told of work in the background."""

from vrut_lite.kernel.trace import Remark
from vrut_lite.studio.progress import progress_text


def told(seconds, text, kind="progress", module="light"):
    return Remark(kind, module, text, 0, int(seconds * 1e9))


def test_the_time_to_go_is_that_of_an_even_pace():
    """Half of what was left took 6 s, so that 6 s are left; another job's progress does not
    count, and what has ended says nothing."""
    remarks = [
        told(1, "solve: 50% 5 of 10", module="sky"),
        told(2, "rays: 20% 20 of 100 rays"),
        told(3, "layout", "job"),
        told(8, "rays: 60% 60 of 100 rays"),
    ]
    assert progress_text(remarks) == ": 60 of 100 rays, 6 s to go"
    assert progress_text(remarks[:2]) == ": 20 of 100 rays"
    assert progress_text([told(1, "solve: 30%")]) == ": 30 %"
    assert progress_text([*remarks, told(9, "rays: 100% 100 of 100 rays")]) == ""
    assert progress_text([]) == ""
