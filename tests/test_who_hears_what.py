"""docs/who_hears_what.md says what the code does."""

from tools.who_hears_what import PAGE, handled, message_types


def test_the_page_names_every_message_and_who_handles_it():
    """After a change: python -m tools.who_hears_what."""
    rows = [line.split("|")[1:-1] for line in PAGE.read_text().splitlines() if "| `" in line]
    said = {row[0].strip(" `"): set(filter(None, row[-1].strip().split(", "))) for row in rows}
    hears = handled()
    assert said == {kind.__name__: hears[kind.__name__] for kind in message_types()}
