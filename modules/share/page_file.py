"""The page as one HTML file: template, script, scene and data."""

import base64
import gzip
import html
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from string import Template
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vrut_lite.errors import UserError

_HERE = Path(__file__).parent
SCRIPT, LICENCES = _HERE / "built" / "page.js", _HERE / "built" / "LICENSES.txt"
_TEMPLATE = _HERE / "page" / "index.html"
SUFFIX = ".html"
_MISSING = (
    "the page's script is not built: install Node.js with npm (Debian: apt-get install nodejs npm) "
    "and run `sh tools/bootstrap.sh page` in the checkout; an installed wheel has it"
)
_ALIGNED = 8
_KINDS = {"u1": "u1", "i1": "i1", "u2": "u2", "i2": "i2", "f4": "f4", "f2": "f2"}


def check_built() -> None:
    """Check that the page's script is there.

    Raises:
        UserError: it is not.
    """
    if not SCRIPT.is_file():
        raise UserError(_MISSING)


def check_name(path: Path) -> None:
    """Check the name of a page.

    Raises:
        UserError: it is not a page.
    """
    if path.suffix.lower() != SUFFIX:
        raise UserError(f"cannot write {path}: a page's name ends with .html")


def packed(header: Mapping[str, Any], arrays: Mapping[str, NDArray]) -> bytes:
    """Header and arrays as the page reads them (`page/src/data.js`), before gzip.

    Four bytes with the header's length, the header in JSON padded with spaces, then the arrays,
    little-endian, each at a multiple of eight bytes.
    """
    sections: dict[str, dict[str, Any]] = {}
    parts, offset = [], 0
    for name, array in arrays.items():
        plain = np.ascontiguousarray(array)
        kind = _KINDS[plain.dtype.str[1:]]
        sections[name] = {"type": kind, "shape": list(plain.shape), "offset": offset}
        content = plain.tobytes()
        content += bytes(-len(content) % _ALIGNED)
        parts.append(content)
        offset += len(content)
    # Offsets count from the file's start, and their digits lengthen the header.
    length = 0
    while True:
        start = -(-(4 + length) // _ALIGNED) * _ALIGNED
        moved = {
            name: section | {"offset": section["offset"] + start}
            for name, section in sections.items()
        }
        text = json.dumps({**header, "sections": moved}, separators=(",", ":")).encode()
        if len(text) <= start - 4 and length:
            break
        length = max(length + 1, len(text))
    text += b" " * (start - 4 - len(text))
    return b"".join([len(text).to_bytes(4, "little"), text, *parts])


def page_text(
    title: str,
    header: Mapping[str, Any],
    arrays: Mapping[str, NDArray],
    glb: bytes,
    stills: Sequence[tuple[str, bytes]],
) -> str:
    """The HTML file; `stills` are captions and WebP pictures for browsers without WebGL2.

    Raises:
        UserError: the page's script is not built.
    """
    check_built()
    # An end of the element within the script would end it.
    script = SCRIPT.read_text(encoding="utf-8").replace("</script", "<\\/script")
    licences = LICENCES.read_text(encoding="utf-8").replace("*/", "* /")
    return Template(_TEMPLATE.read_text(encoding="utf-8")).substitute(
        title=html.escape(title),
        stills="".join(_figure(caption, picture) for caption, picture in stills),
        data=_text(packed(header, arrays)),
        scene=_text(glb),
        script=f"/*\n{licences}*/\n{script}",
    )


def _text(content: bytes) -> str:
    return base64.b64encode(gzip.compress(content, 9, mtime=0)).decode()


def _figure(caption: str, picture: bytes) -> str:
    source = base64.b64encode(picture).decode()
    said = html.escape(caption)
    return (
        f'<figure><img src="data:image/webp;base64,{source}" alt="{said}">'
        f"<figcaption>{said}</figcaption></figure>"
    )
