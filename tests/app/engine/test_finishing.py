"""When a finished picture is due: each event changes what its row in the table names, only that."""

import pytest

from vrut_lite.app.engine.finishing import DRAFT_PATIENCE_S, LOOK_AGAIN_S, Finishing

NOW_S = 100.0


def facts(finishing):
    return {name: getattr(finishing, name) for name in ("stands", "due_s", "insists")}


@pytest.mark.parametrize("stands", [False, True])
@pytest.mark.parametrize("insists", [False, True])
@pytest.mark.parametrize(
    ("event", "changes"),
    [
        (lambda it: it.moved(NOW_S + 0.2), {"due_s": NOW_S + 0.2, "insists": False}),
        (lambda it: it.lit(NOW_S), {"due_s": NOW_S, "insists": False}),
        (lambda it: it.waits_for_drafts(NOW_S), {"due_s": NOW_S + LOOK_AGAIN_S}),
        (lambda it: it.begun(), {"due_s": None}),
        (lambda it: it.given_up(NOW_S - 1.0), {"due_s": NOW_S - 1.0, "insists": True}),
        (lambda it: it.shown(True), {"stands": True}),
        (lambda it: it.shown(False), {"stands": False}),
        (lambda it: it.exposed(NOW_S), {"due_s": NOW_S}),
    ],
)
def test_an_event_changes_what_its_row_names(event, changes, stands, insists):
    """In every state alike: no event means another thing because of those before it."""
    finishing = Finishing()
    finishing.moved(NOW_S)
    if insists:
        finishing.given_up(NOW_S)
    finishing.shown(stands)
    before = facts(finishing)
    event(finishing)
    assert facts(finishing) == before | changes


def test_nothing_is_due_before_something_has_moved_and_after_it_is_finished():
    """A window at rest draws nothing."""
    finishing = Finishing()
    assert not finishing.is_due(NOW_S)
    finishing.moved(NOW_S)
    assert not finishing.is_due(NOW_S - 0.01)
    assert finishing.is_due(NOW_S)
    finishing.begun()
    finishing.shown(True)
    assert not finishing.is_due(NOW_S + 1e6)


def test_drafts_are_waited_for_as_long_as_their_patience_since_it_was_due():
    """Light that never comes must not keep the picture from being finished."""
    finishing = Finishing()
    finishing.moved(NOW_S)
    assert finishing.waits_for_drafts(NOW_S + DRAFT_PATIENCE_S - 0.01)
    assert not finishing.waits_for_drafts(NOW_S + DRAFT_PATIENCE_S)
    assert finishing.is_due(NOW_S + DRAFT_PATIENCE_S + LOOK_AGAIN_S)


def test_a_picture_that_was_given_up_is_finished_unless_something_visible_changes():
    """A clock that plays without effect must not end every finished picture."""
    finishing = Finishing()
    finishing.moved(NOW_S)
    finishing.begun()
    finishing.given_up(NOW_S)
    assert finishing.is_due(NOW_S)
    assert finishing.insists
    finishing.moved(NOW_S + 1.0)
    assert not finishing.insists
