"""The documentation as HTML pages that a browser reads without a network.

The build of a wheel runs this file by itself (`setup.py`), so that it imports no package of ours.
Pages and their order are those of `mkdocs.yml`, without the reference, which mkdocs writes from the
running code. Pictures above 300 kB are left out, and their place says so.
"""

import html
import re
import shutil
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

from markdown_it import MarkdownIt
from markdown_it.token import Token

START = "index.html"
MOST_PICTURE_BYTES = 300_000
# Files of the repository's root, by their page.
ROOT_PAGES = {
    "index.md": "README.md",
    "architecture.md": "ARCHITECTURE.md",
    "contributing.md": "CONTRIBUTING.md",
    "changelog.md": "CHANGELOG.md",
}
_PAGE_OF = {source: page for page, source in ROOT_PAGES.items()}
_SECTION = re.compile(r"^  - (.+):$")
_ENTRY = re.compile(r"^      - (.+): (\S+\.md)$")
_PAGE_NAME = re.compile(r"(docs/)?\w+\.md")
_STYLE = """
body { margin: 0; font: 16px/1.55 system-ui, sans-serif; color: #222; background: #fff; }
nav { position: fixed; top: 0; bottom: 0; width: 14em; padding: 1em 1.2em; overflow-y: auto;
  background: #f2f2f0; box-sizing: border-box; font-size: 14px; }
nav b { display: block; margin-top: 1em; color: #666; }
nav a { display: block; color: #222; }
nav a.here { font-weight: 600; }
main { margin-left: 15em; padding: 1em 2em 4em; max-width: 58em; }
a { color: #0b5a8a; text-decoration: none; }
a:hover { text-decoration: underline; }
img { max-width: 100%; height: auto; }
table { border-collapse: collapse; display: block; overflow-x: auto; }
th, td { border-bottom: 1px solid #ddd; padding: 4px 10px; text-align: left; vertical-align: top; }
pre, code { font: 14px/1.45 ui-monospace, monospace; background: #f2f2f0; }
pre { padding: 0.8em 1em; overflow-x: auto; }
.left-out { color: #666; font-style: italic; }
@media (max-width: 60em) { nav { position: static; width: auto; } main { margin-left: 0; } }
@media (prefers-color-scheme: dark) {
  body { color: #ddd; background: #1b1b1d; } nav, pre, code { background: #2a2a2d; }
  nav a { color: #ddd; } a { color: #e2b36a; } th, td { border-color: #444; }
}
""".strip()
_PAGE = """<!doctype html>
<html lang="en"><head><meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{title} - vrut_lite</title><style>{style}</style></head>
<body><nav>{menu}</nav><main>
{content}</main></body></html>
"""


class ManualEntry(NamedTuple):
    """A page in the menu: its section, title and Markdown file below `docs`."""

    section: str
    title: str
    page: str


def entries(root: Path) -> list[ManualEntry]:
    """The pages of a checkout in the order of `mkdocs.yml`."""
    found, section = [], ""
    for line in (root / "mkdocs.yml").read_text(encoding="utf-8").splitlines():
        if head := _SECTION.match(line):
            section = head[1]
        elif entry := _ENTRY.match(line):
            found.append(ManualEntry(section, entry[1], entry[2]))
    return [entry for entry in found if _source(root, entry.page).is_file()]


def write_manual(root: Path, folder: Path) -> Path:
    """Write all pages of a checkout and their pictures into a folder; the start page's path."""
    folder.mkdir(parents=True, exist_ok=True)
    listed = entries(root)
    titles = {entry.page: entry.title for entry in listed}
    for entry in listed:
        source = _source(root, entry.page)
        writer = _PageWriter(root, source, titles)
        content = writer.content()
        for picture in writer.pictures:
            target = folder / picture.relative_to(root / "docs")
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(picture, target)
        page = _PAGE.format(
            title=html.escape(entry.title),
            style=_STYLE,
            menu="\n".join(_menu(listed, entry)),
            content=content,
        )
        (folder / _html_name(entry.page)).write_text(page, encoding="utf-8")
    return folder / START


def _source(root: Path, page: str) -> Path:
    return root / ROOT_PAGES[page] if page in ROOT_PAGES else root / "docs" / page


def _html_name(page: str) -> str:
    return page.removesuffix(".md") + ".html"


def _menu(listed: list[ManualEntry], here: ManualEntry) -> Iterator[str]:
    section = ""
    for entry in listed:
        if entry.section != section:
            section = entry.section
            yield f"<b>{html.escape(section)}</b>"
        kind = ' class="here"' if entry == here else ""
        yield f'<a{kind} href="{_html_name(entry.page)}">{html.escape(entry.title)}</a>'


class _PageWriter:
    """One page's HTML; `pictures` are the files that it shows, once `content` was called."""

    def __init__(self, root: Path, source: Path, titles: dict[str, str]):
        self._root, self._source, self._titles = root, source, titles
        self.pictures: list[Path] = []

    def content(self) -> str:
        """The HTML of the page's text, its headings with anchors as on mkdocs' site."""
        parser = MarkdownIt("commonmark").enable("table")
        tokens = parser.parse(self._source.read_text(encoding="utf-8"))
        for token, inner in pairwise(tokens):
            if token.type == "heading_open":
                token.attrSet("id", anchor_of(_plain(inner)))
        for token in tokens:
            token.children = list(self._followed(token.children or []))
        made: str = parser.renderer.render(tokens, parser.options, {})
        return made

    def _followed(self, children: list[Token]) -> Iterator[Token]:
        """Links and pictures of a line of text, as they are in the manual."""
        open_links: list[bool] = []
        for token in children:
            if token.type == "link_open":
                target = self._link(str(token.attrs["href"]))
                open_links.append(target is not None)
                if target is None:
                    continue
                token.attrs["href"] = target
            elif token.type == "link_close" and not open_links.pop():
                continue
            elif token.type == "text" and open_links and _PAGE_NAME.fullmatch(token.content):
                token.content = self._title(token.content)
            elif token.type == "image" and not self._shows(token):
                yield _left_out(token.content)
                continue
            yield token

    def _link(self, target: str) -> str | None:
        """A link's target in the manual; None for a file that is not part of it."""
        if "://" in target or target.startswith(("#", "mailto:")):
            return target
        path, _, anchor = target.partition("#")
        file = (self._source.parent / path).resolve()
        page = _PAGE_OF.get(file.name) if file.parent == self._root.resolve() else file.name
        if page not in self._titles:
            return None
        return _html_name(page) + (f"#{anchor}" if anchor else "")

    def _title(self, name: str) -> str:
        """The title of a page that a link names by its file."""
        page = Path(name).name
        return self._titles.get(_PAGE_OF.get(page, page), name)

    def _shows(self, image: Token) -> bool:
        """Whether a picture is small enough; its source is then the manual's."""
        file = (self._source.parent / str(image.attrs["src"])).resolve()
        docs = (self._root / "docs").resolve()
        if not file.is_relative_to(docs) or file.stat().st_size > MOST_PICTURE_BYTES:
            return False
        self.pictures.append(self._root / "docs" / file.relative_to(docs))
        image.attrs["src"] = file.relative_to(docs).as_posix()
        return True


def anchor_of(heading: str) -> str:
    """The anchor of a heading: its words in lower case with hyphens."""
    return re.sub(r"[^\w\- ]", "", heading.lower()).strip().replace(" ", "-")


def _plain(inline: Token) -> str:
    kept = ("text", "code_inline")
    return "".join(child.content for child in inline.children or () if child.type in kept)


def _left_out(words: str) -> Token:
    token: Any = Token("html_inline", "", 0)
    said = html.escape(words or "a picture")
    token.content = f'<span class="left-out">[a picture, left out here: {said}]</span>'
    return token
