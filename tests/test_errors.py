"""What is told to people: one line, whatever the file that it quotes has in it."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from vrut_lite.errors import ModuleFailed, UserError


@pytest.mark.parametrize("kind", [UserError, ModuleFailed])
@given(text=st.text(max_size=50))
def test_any_text_becomes_one_line_that_a_terminal_shows(kind, text):
    """A name in a stranger's file may hold what clears the screen or turns the line round."""
    said = str(kind(f"cannot open {text}"))
    assert said.isprintable()
    assert said.startswith("cannot open ")


def test_a_sentence_is_not_longer_than_people_read():
    """Its start says what is wrong, its end what to do; a megabyte between them says nothing."""
    said = str(UserError(f"the name {'x' * 10**6} is too long: choose a shorter one"))
    assert len(said) < 2500
    assert said.startswith("the name xxx")
    assert said.endswith("choose a shorter one")
