"""Measured glazing in LBNL's Window XML: matrices of visible light, by patches of angle bases.

The format of WINDOW 6 and 7 and of Radiance's genBSDF (LBNL 2013, "BSDF XML schema"). Its front is
the side outdoors; `IncidentDataStructure` says whether columns or rows are incident directions.
"""

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import NamedTuple
from xml.etree import ElementTree

import numpy as np

from daylight_numbers.glazing.angle_basis import KLEMS, KLEMS_FULL, AngleBasis
from daylight_numbers.glazing.tensor_tree import RANKS, klems_of_leaves, tree_leaves
from vrut_lite.errors import UserError
from vrut_lite.numeric_types import FloatArray, IntArray

_MOST_BYTES = 64 << 20
_MOST_PATCHES, _MOST_RINGS = 2500, 90
_SAME_DEG = 0.01
_TREE_BASIS = "LBNL/Shirley-Chiu"
# Transmittance above which the file is warned of, and the values' rounding in a sum of 1.
_ROUNDING = 1e-3
# A beam goes straight on where its patch has at least so many times the mean of the patches around
# it (as Radiance's aBSDF, m_bsdf.c), and at least this transmittance more than they.
_PEAK_OVER, _LEAST_PEAK = 1.5, 0.005


@dataclass(frozen=True, eq=False)
class MeasuredGlazing:
    """Visible transmission from outdoors to indoors, and diffuse reflectances.

    Attributes:
        name: of the layer's product, or of the file.
        incident, exiting: angle bases of I and O patches.
        transmission: (O, I), sr^-1, radiance into a patch by irradiance from another.
        reflectance_in, reflectance_out: share of even light that each side sends back, that indoors
            and that outdoors; 0 where the file has none.
    """

    name: str
    incident: AngleBasis
    exiting: AngleBasis
    transmission: FloatArray
    reflectance_in: float
    reflectance_out: float

    @cached_property
    def hemispherical(self) -> FloatArray:
        """Transmittance (I,) of light from each patch into all directions."""
        return np.asarray(self.exiting.projected_sr @ self.transmission)

    @cached_property
    def straight_patch(self) -> IntArray:
        """The exiting patch (I,) into which light from each incident one goes straight on."""
        return self.exiting.patch_of(self.incident.middles)

    @cached_property
    def straight(self) -> FloatArray:
        """Transmittance (I,) of the beam that passes unscattered: what the patch straight on has
        above the mean of those around it, where that is a peak."""
        through = self.transmission[self.straight_patch, np.arange(len(self.incident))]
        around = self._around
        peak = (through - around) * self.exiting.projected_sr[self.straight_patch]
        is_peak = (through > _PEAK_OVER * around) & (peak > _LEAST_PEAK)
        return np.where(is_peak, peak, 0.0)

    @cached_property
    def scattered(self) -> FloatArray:
        """`transmission` (O, I) without the straight beam."""
        found = self.transmission.copy()
        own = self.straight_patch, np.arange(len(self.incident))
        found[own] = np.where(self.straight > 0.0, self._around, found[own])
        return found

    @cached_property
    def _around(self) -> FloatArray:
        """Mean transmission (I,) into the patches around the one straight on."""
        beside = self.exiting.neighbours[self.straight_patch]
        return np.asarray((beside * self.transmission.T).sum(axis=1) / beside.sum(axis=1))

    def warnings(self) -> list[str]:
        """A sentence on columns that pass more light than falls on them; none where all are right.

        The text names the first of them by its number, from 1.
        """
        more = np.flatnonzero(self.hemispherical > 1.0 + _ROUNDING)
        if not len(more):
            return []
        worst = self.hemispherical.max()
        return [
            f"{self.name}: {len(more)} of {len(self.incident)} incident directions pass more light "
            f"than falls on them, the first is number {more[0] + 1}, at most {worst:.3f} times"
        ]


class _Block(NamedTuple):
    """A matrix (O, I) of one side, and its bases."""

    values: FloatArray
    incident: AngleBasis
    exiting: AngleBasis


def read_window_xml(path: str | Path) -> MeasuredGlazing:
    """Measured glazing of a file of LBNL's Window XML.

    Raises:
        UserError: it cannot be read, is no matrix of visible transmission, or has impossible
            values.
    """
    file = Path(path)
    root = _root_of(file)
    if _name(root) != "windowelement":
        raise UserError(f"{file} is no Window XML: its root is {root.tag!r}, not WindowElement")
    layer = _found(root, "layer")
    data = root if layer is None else layer
    structure = _text(data, "incidentdatastructure") or "Columns"
    kind = structure.lower()
    rank = next((rank for rank in RANKS if kind == f"tensortree{rank}"), None)
    if rank is None and kind not in ("columns", "rows"):
        raise UserError(
            f"{file} has the IncidentDataStructure {structure!r}: Columns, Rows, TensorTree3 and "
            "TensorTree4 are read"
        )
    bases = {} if rank else _bases(file, data)
    blocks: dict[str, _Block] = {}
    for block in _visible(file, data):
        side = _text(block, "wavelengthdatadirection").lower()
        if rank:
            blocks[side] = _tree_block(file, block, rank)
        else:
            blocks[side] = _block(file, block, bases, kind == "rows")
    if "transmission front" in blocks:
        front = blocks["transmission front"]
    elif "transmission back" in blocks:
        # Light takes the same way both ways (Helmholtz); on the way back x and y are reversed, as
        # in bsdf_m.c: half a turn.
        back = blocks["transmission back"]
        turned = back.values[np.ix_(back.exiting.half_turned, back.incident.half_turned)]
        front = _Block(turned.T, back.exiting, back.incident)
    else:
        raise UserError(f"{file} has no visible Transmission Front or Transmission Back")
    name = next((t for tag in ("name", "n") if (t := _text(data, tag))), "") or file.name
    return MeasuredGlazing(
        name,
        front.incident,
        front.exiting,
        front.values,
        _diffuse(blocks.get("reflection back")),
        _diffuse(blocks.get("reflection front")),
    )


def _root_of(file: Path) -> ElementTree.Element:
    try:
        if file.stat().st_size > _MOST_BYTES:
            raise UserError(f"the Window XML {file} is more than {_MOST_BYTES >> 20} MB")
        content = file.read_bytes()
    except OSError as error:
        raise UserError(f"cannot read the Window XML {file}: {error.strerror or error}") from None
    if b"<!ENTITY" in content:
        raise UserError(f"the Window XML {file} defines entities, which no such file needs")
    try:
        return ElementTree.fromstring(content)
    except (ElementTree.ParseError, ValueError, LookupError) as error:
        raise UserError(f"{file} is no XML: {error}") from None


def _name(element: ElementTree.Element) -> str:
    """The tag without its namespace, in small letters."""
    return element.tag.rpartition("}")[2].lower() if isinstance(element.tag, str) else ""


def _all(element: ElementTree.Element, name: str) -> list[ElementTree.Element]:
    return [one for one in element.iter() if _name(one) == name]


def _found(element: ElementTree.Element, name: str) -> ElementTree.Element | None:
    return next(iter(_all(element, name)), None)


def _text(element: ElementTree.Element, name: str) -> str:
    """The text of the first element of a name, or nothing."""
    one = _found(element, name)
    return "" if one is None else " ".join((one.text or "").split())


def _number(file: Path, element: ElementTree.Element, name: str) -> float:
    text = _text(element, name)
    try:
        value = float(text)
    except ValueError:
        value = np.nan
    if not np.isfinite(value):
        raise UserError(f"{file}: {name} of an angle basis is {text or 'missing'!r}, no number")
    return value


def _bases(file: Path, data: ElementTree.Element) -> dict[str, AngleBasis]:
    """Bases by their names in small letters: Klems's, and those that the file defines."""
    found = dict(KLEMS)
    for element in _all(data, "anglebasis"):
        name = _text(element, "anglebasisname")
        upper: list[float] = []
        count: list[int] = []
        before = 0.0
        for ring in _all(element, "anglebasisblock"):
            low, high = (_number(file, ring, f"{end}theta") for end in ("lower", "upper"))
            number = _number(file, ring, "nphis")
            if abs(low - before) > _SAME_DEG or high <= low or number < 1 or number % 1:
                raise UserError(
                    f"{file}: ring {len(upper) + 1} of the angle basis {name} has {number:g} "
                    f"patches from {low:g} to {high:g} degrees, after one that ends at {before:g}"
                )
            before = high
            upper.append(high)
            count.append(int(number))
        if not upper:
            continue
        if abs(before - 90.0) > _SAME_DEG or len(upper) > _MOST_RINGS or sum(count) > _MOST_PATCHES:
            raise UserError(
                f"{file}: the angle basis {name} has {sum(count)} patches up to {before:g} degrees:"
                f" at most {_MOST_PATCHES} up to 90 are read"
            )
        known = KLEMS.get(name.lower())
        same = known is not None and tuple(count) == known.count
        if known and not (same and np.allclose(upper, known.upper_deg, atol=_SAME_DEG)):
            raise UserError(
                f"{file} defines the angle basis {name} with {sum(count)} patches otherwise than "
                f"LBNL does: {len(known)} patches in rings up to {known.upper_deg} degrees"
            )
        found[name.lower()] = known or AngleBasis(name, tuple(upper), tuple(count))
    return found


def _visible(file: Path, data: ElementTree.Element) -> list[ElementTree.Element]:
    """Blocks of visible light."""
    wavelengths = _all(data, "wavelengthdata")
    names = {_text(one, "wavelength") for one in wavelengths}
    found = [
        block
        for one in wavelengths
        if _text(one, "wavelength").lower() == "visible"
        for block in _all(one, "wavelengthdatablock")
    ]
    if not found:
        has = ", ".join(sorted(name for name in names if name)) or "none"
        raise UserError(f"{file} has no data for the wavelength Visible; it has {has}")
    return found


def _block(
    file: Path, block: ElementTree.Element, bases: dict[str, AngleBasis], by_rows: bool
) -> _Block:
    side = _text(block, "wavelengthdatadirection")
    column, row = (_basis(file, block, bases, f"{kind}anglebasis") for kind in ("column", "row"))
    element = _found(block, "scatteringdata")
    text = "" if element is None else element.text or ""
    try:
        values = np.array(text.replace(",", " ").split(), float)
    except ValueError as error:
        raise UserError(f"{file}: {side} has no numbers: {error}") from None
    if len(values) != len(column) * len(row):
        raise UserError(
            f"{file}: {side} has {len(values):,} values: {len(row)} rows of {len(column)} columns "
            f"({column.name}) are {len(row) * len(column):,}"
        )
    matrix = values.reshape(len(row), len(column))
    bad = np.argwhere(~(np.isfinite(matrix) & (matrix >= 0.0)))
    if len(bad):
        raise UserError(
            f"{file}: {side} has {matrix[tuple(bad[0])]:g} in row {bad[0][0] + 1}, column "
            f"{bad[0][1] + 1}: values are finite and not negative"
        )
    return _Block(matrix.T, row, column) if by_rows else _Block(matrix, column, row)


def _tree_block(file: Path, block: ElementTree.Element, rank: int) -> _Block:
    """A tree as a matrix of Klems's full basis."""
    side = _text(block, "wavelengthdatadirection")
    basis = _text(block, "anglebasis")
    if basis.lower() != _TREE_BASIS.lower():
        raise UserError(f"{file}: a tree has the angle basis {_TREE_BASIS}, not {basis!r}")
    element = _found(block, "scatteringdata")
    try:
        leaves = tree_leaves("" if element is None else element.text or "", rank)
    except ValueError as error:
        raise UserError(f"{file}: {side} is no tensor tree of rank {rank}: {error}") from None
    return _Block(klems_of_leaves(leaves, rank), KLEMS_FULL, KLEMS_FULL)


def _basis(
    file: Path, block: ElementTree.Element, bases: dict[str, AngleBasis], kind: str
) -> AngleBasis:
    name = _text(block, kind)
    if name.lower() not in bases:
        known = ", ".join(sorted(basis.name for basis in bases.values()))
        raise UserError(f"{file}: the angle basis {name!r} is not known; these are: {known}")
    return bases[name.lower()]


def _diffuse(block: _Block | None) -> float:
    """Share of even light that is sent back."""
    if block is None:
        return 0.0
    sent = block.exiting.projected_sr @ block.values @ block.incident.projected_sr / np.pi
    return min(float(sent), 1.0)
