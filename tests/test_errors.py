"""Error texts are one printable line, whatever they quote."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from vrut_lite.errors import ModuleFailed, UserError


@pytest.mark.parametrize("kind", [UserError, ModuleFailed])
@given(text=st.text(max_size=50))
def test_any_text_becomes_one_line_that_a_terminal_shows(kind, text):
    """Control characters in quoted names, which could clear the screen, are escaped."""
    said = str(kind(f"cannot open {text}"))
    assert said.isprintable()
    assert said.startswith("cannot open ")


def test_long_sentences_are_shortened():
    """Start and end of a long text, which hold the cause and the remedy, are kept."""
    said = str(UserError(f"the name {'x' * 10**6} is too long: choose a shorter one"))
    assert len(said) < 2500
    assert said.startswith("the name xxx")
    assert said.endswith("choose a shorter one")
