"""Whoever reads the documentation gets wherever a link points, and every page can be found."""

import re
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest

from tools import docs_site
from vrut_lite.messages.vocabulary import DAYLIGHT_MESSAGES

ROOT = Path(__file__).parents[1]
PAGES = sorted([*ROOT.glob("*.md"), *ROOT.glob("docs/*.md")])


def anchors_of(page):
    """The names that a page's headings have as targets of links."""
    text = re.sub(r"```.*?```", "", page.read_text(), flags=re.DOTALL)
    headings = re.findall(r"^#+ (.*)$", text, re.MULTILINE)
    plain = [re.sub(r"[^\w\- ]", "", heading.lower()) for heading in headings]
    return {heading.strip().replace(" ", "-") for heading in plain}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_lead_somewhere(page):
    """Every link to a picture, a file or a heading leads to one that is in the repository."""
    for target in re.findall(r"\]\(([^)\s]+)\)", page.read_text()):
        if "://" in target:
            continue
        path, _, anchor = target.partition("#")
        led_to = page.parent / path if path else page
        assert led_to.exists(), target
        assert not anchor or anchor in anchors_of(led_to), target


def test_who_compares_us_with_other_programs_says_where_to_see_all_of_it():
    """A page that names one beside us leads to docs/peers.md, which says where one is better."""
    others = r"pyrender|`sunsky`|genssky|gendaylit|Cycles|beside Mitsuba|Mitsuba has|Radiance's "
    naming = [
        page
        for page in [ROOT / "README.md", *ROOT.glob("docs/*.md")]
        if page.name not in {"peers.md", "decisions.md"} and re.search(others, page.read_text())
    ]
    assert len(naming) > 5
    for page in naming:
        assert "peers.md)" in page.read_text(), page.name


def test_every_page_stands_in_the_navigation_once():
    """A page that nothing leads to is not read."""
    listed = re.findall(r": (\S+\.md)$", (ROOT / "mkdocs.yml").read_text(), re.MULTILINE)
    pages = [path.name for path in ROOT.glob("docs/*.md")]
    made = [path for path, _ in docs_site.made_pages()]
    assert sorted(listed) == sorted(pages + made)


def test_the_reference_is_whole():
    """Every message and its fields, every setting of a module, every command and option."""
    pages = dict(docs_site.made_pages())
    for kind in DAYLIGHT_MESSAGES:
        assert f"### {kind.__name__}\n" in pages["reference/messages.md"]
    assert "| `turbidity` | `none` | between 1 and 10, or none |" in pages["reference/settings.md"]
    for words in ("## vrut-lite render\n", "| `--place ", "## vrut-lite study"):
        assert words in pages["reference/commands.md"]


@pytest.mark.long
@pytest.mark.skipif(find_spec("mkdocs") is None, reason="the package mkdocs-material is missing")
def test_the_site_is_built_without_a_warning():
    """mkdocs' strict build finds no broken link and no unreadable docstring."""
    subprocess.run([sys.executable, "-m", "mkdocs", "build", "--quiet"], cwd=ROOT, check=True)
