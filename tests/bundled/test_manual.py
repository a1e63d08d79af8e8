"""The manual is whole without a network: every link and picture in it is there."""

from html.parser import HTMLParser
from pathlib import Path

import pytest
from click.testing import CliRunner

from vrut_lite.bundled import manual as manual_file
from vrut_lite.bundled.manual_pages import MOST_PICTURE_BYTES, entries, write_manual
from vrut_lite.commands.manual import manual
from vrut_lite.errors import UserError

ROOT = Path(__file__).parents[2]


class Page(HTMLParser):
    """A page's links, pictures, anchors and headings."""

    def __init__(self, file: Path):
        super().__init__()
        self.links: list[str] = []
        self.sources: list[str] = []
        self.anchors: set[str] = set()
        self.tags: list[str] = []
        self.feed(file.read_text(encoding="utf-8"))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        facts = dict(attrs)
        self.tags.append(tag)
        self.links += [str(facts["href"])] if tag == "a" else []
        self.sources += [str(facts["src"])] if "src" in facts else []
        self.anchors |= {str(facts["id"])} if "id" in facts else set()


@pytest.fixture(scope="module")
def pages(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Page]:
    """The pages by file name."""
    start = write_manual(ROOT, tmp_path_factory.mktemp("manual"))
    return {file.name: Page(file) for file in start.parent.glob("*.html")}


def test_links_lead_to_a_page_and_its_anchor(pages: dict[str, Page]) -> None:
    """A reader without a network cannot look elsewhere."""
    for name, page in pages.items():
        for link in page.links:
            if "://" not in link:
                target, _, anchor = link.partition("#")
                assert not anchor or anchor in pages[target or name].anchors, f"{name}: {link}"


def test_nothing_is_loaded_from_elsewhere(pages: dict[str, Page]) -> None:
    """Neither scripts, fonts nor pictures of a server."""
    for page in pages.values():
        assert not {"script", "link", "iframe"} & {*page.tags}
        assert not [source for source in page.sources if "://" in source]


def test_every_page_of_the_documentation_is_in_it(pages: dict[str, Page]) -> None:
    """The menu leads from each page to all others; what mkdocs writes from code is left out."""
    listed = {entry.page.replace(".md", ".html") for entry in entries(ROOT)}
    assert listed == {*pages}
    written = {path.name for path in (ROOT / "docs").glob("*.md")}
    assert written <= {entry.page for entry in entries(ROOT)}
    for page in pages.values():
        assert listed <= {link.partition("#")[0] for link in page.links}


def test_links_read_as_titles(tmp_path: Path) -> None:
    """A reader of the manual has no files of Markdown."""
    start = write_manual(ROOT, tmp_path)
    assert '<a href="bruneton.html">Bruneton</a>' in start.read_text(encoding="utf-8")
    assert not [file for file in tmp_path.glob("*.html") if ".md</a>" in file.read_text()]


def test_pictures_are_small_and_there(tmp_path: Path) -> None:
    """A wheel of many megabytes of pictures helps nobody; their place says that one is left out."""
    write_manual(ROOT, tmp_path)
    shown = {source for file in tmp_path.glob("*.html") for source in Page(file).sources}
    assert len(shown) > 40
    for source in shown:
        assert 0 < (tmp_path / source).stat().st_size <= MOST_PICTURE_BYTES
    page = (tmp_path / "app.html").read_text(encoding="utf-8")
    assert "[a picture, left out here: Every panel]" in page


def test_the_command_prints_a_page_that_is_there() -> None:
    """In a checkout it is written into the cache folder, from the pages as they are now."""
    start = Path(CliRunner().invoke(manual, []).output.strip())
    assert start.name == "index.html"
    assert "<h1" in start.read_text(encoding="utf-8")


def test_code_that_came_alone_says_where_the_manual_is(monkeypatch: pytest.MonkeyPatch) -> None:
    """A copy of the packages has neither pages nor the checkout's docs."""
    monkeypatch.setattr(manual_file, "is_checkout", lambda: False)
    with pytest.raises(UserError, match="install the wheel"):
        manual_file.manual_start()
