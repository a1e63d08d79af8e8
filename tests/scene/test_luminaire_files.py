"""Files of luminaires of every edition and hand: IES and EULUMDAT have one light."""

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from vrut_lite.scene.ies_file import read_ies
from vrut_lite.scene.luminaire_file import read_luminaire
from vrut_lite.scene.scene_file_error import SceneFileError

ANGLES = "0 45 90"


def ies(planes: dict[int, str], first: str = "IESNA:LM-63-2002", factors: str = "1 1") -> str:
    """An IES file with candela at 0, 45 and 90 degrees in planes."""
    return "\n".join(
        [
            *([first] if first else []), "[TEST] of ours", "TILT=NONE",
            f"1 1000 1 3 {len(planes)} 1 2 0 0 0", f"{factors} 10",
            ANGLES, " ".join(map(str, planes)), *planes.values(), "",
        ]
    )  # fmt: skip


def ldt(
    symmetry: int, planes: dict[int, str], head: Mapping[int, str] = MappingProxyType({})
) -> str:
    """An EULUMDAT file of 2000 lm with candela for 1000 lm in its stored planes; `head` has other
    lines by their number."""
    lines = [
        "Company", "1", str(symmetry), "4", "90", "3", "45", "report", "name",
        "", "file", "date", *["100"] * 9, "100", "80", "1", "0", "1",
        "1", "LED", "2000", "3000", "80", "20", *["0.5"] * 10,
        "0", "90", "180", "270", *ANGLES.split(),
        *" ".join(planes.values()).split(), "",
    ]  # fmt: skip
    for number, line in head.items():
        lines[number - 1] = line
    return "\n".join(lines)


def candela(text: str, encoding: str = "latin-1") -> np.ndarray:
    """Candela (181, 73) every degree from the axis and every five around it."""
    found = read_luminaire(text.encode(encoding)).photometry()
    return found.candela * found.table.astype(float)


def test_planes_without_360_close_the_circle() -> None:
    """Between the last plane and the first candela go over evenly: 250 between 400 and 100."""
    planes = {0: "100 100 0", 90: "200 200 0", 180: "300 300 0", 270: "400 400 0"}
    level = candela(ies(planes))[45]
    assert level[[0, 18, 54, 63, 72]] == pytest.approx([100, 200, 400, 250, 100], rel=1e-5)
    closed = candela(ies({**planes, 360: "100 100 0"}))
    assert candela(ies(planes)) == pytest.approx(closed, abs=1e-3)


@pytest.mark.parametrize(
    ("first", "times"),
    [
        ("", 0.9 * 0.5),
        ("IESNA91", 0.9 * 0.5),
        ("IESNA:LM-63-1995", 0.9),
        ("IESNA:LM-63-2002", 0.9),
        ("IES:LM-63-2019", 0.9),
        ("\ufeffIES:LM-63-2019", 0.9),
    ],
)
def test_the_ballast_lamp_factor_is_of_the_first_two_editions(first: str, times: float) -> None:
    """The number beside the ballast's is a factor in 1986 and 1991; since 1995 it is kept for
    future use, since 2019 it says who measured (1.00001 and such)."""
    found = candela(ies({0: "100 100 0"}, first, "0.9 0.5"), "utf-8")
    assert found[0] == pytest.approx(100.0 * times, rel=1e-5)


@pytest.mark.parametrize(
    "written",
    [
        lambda text: (text + "\x1a").encode(),
        lambda text: text.replace("\n", "\r\n").encode() + b"\r\n\x1a\x00\x00",
        lambda text: text.replace("\n", "\r").encode(),
        lambda text: text.encode("utf-16"),
        lambda text: text.encode("utf-16-le"),
        lambda text: text.encode("utf-8-sig"),
        lambda text: text.replace("TILT=NONE", "[MORE] TILT=0 in the test\nTilt = none").encode(),
        lambda text: (text + "\n[END] of file").encode(),
    ],
)
def test_what_editors_and_old_programs_add_is_no_damage(written) -> None:
    """Ctrl-Z, marks, line ends, UTF-16 and words after the last number."""
    plain = ies({0: "10 20 0", 90: "10 5 0"})
    assert np.array_equal(read_luminaire(written(plain)).candela, read_ies(plain.encode()).candela)


SIDES = ["10 1 0", "10 2 0", "10 3 0", "10 4 0"]


@pytest.mark.parametrize(
    ("symmetry", "stored", "around"),
    [
        (0, {0: SIDES[0], 90: SIDES[1], 180: SIDES[2], 270: SIDES[3]}, SIDES),
        (1, {0: SIDES[0]}, [SIDES[0]] * 4),
        (2, {0: SIDES[0], 90: SIDES[1], 180: SIDES[2]}, [*SIDES[:3], SIDES[1]]),
        (3, {270: SIDES[3], 0: SIDES[0], 90: SIDES[1]}, [SIDES[0], SIDES[1], SIDES[0], SIDES[3]]),
        (4, {0: SIDES[0], 90: SIDES[1]}, SIDES[:2] * 2),
    ],
)
def test_eulumdats_symmetries_are_those_of_an_ies_file(
    symmetry: int, stored: dict[int, str], around: list[str]
) -> None:
    """The same luminaire, written with all its planes: candela are for 1000 lm of 2000.

    C90 is along the luminaire, as an IES file's angle 0; C0 is across it.
    """
    planes = dict(zip((0, 90, 180, 270), [*around[1:], around[0]], strict=True))
    assert candela(ldt(symmetry, stored)) == pytest.approx(2.0 * candela(ies(planes)), abs=1e-4)


def test_eulumdats_factor_flux_and_decimal_comma() -> None:
    """Line 24 multiplies, the first set of lamps shines, and Germany writes 0,5; names are in any
    encoding and lines may be empty."""
    one = candela(ldt(1, {0: "100 50 0"}, head={24: "0,5", 29: "3000,0", 9: "Flügel", 10: ""}))
    assert one[0] == pytest.approx(150.0)
    lines = ldt(1, {0: "100 50 0"}, head={26: "2"}).split("\n")
    second = ["2", "HID", "9000", "4000", "80", "250"]
    two = candela("\r\n".join([*lines[:32], *second, *lines[32:]]))
    assert two[0] == pytest.approx(200.0)


def test_eulumdats_flux_is_that_of_its_lamps() -> None:
    """A Lambertian luminaire with a light output ratio of 0.8 has 800 / pi candela for 1000 lm."""
    angles = np.arange(0.0, 91.0, 1.0)
    head = ldt(1, {}, head={6: "91"}).split("\n")[: 32 + 10 + 4]
    values = 800.0 / np.pi * np.cos(np.radians(angles))
    text = "\n".join([*head, *map(str, angles), *map(str, values)])
    theta = np.radians(np.arange(181.0))
    mean = candela(text)[:, :-1].mean(axis=1)
    assert 2.0 * np.pi * np.trapezoid(mean * np.sin(theta), theta) == pytest.approx(
        1600.0, rel=1e-3
    )


BROKEN = {
    "short": (lambda t: t.rsplit("\n", 2)[0], "cut short"),
    "symmetry 7": (lambda t: t.replace("1\n0\n4\n", "1\n7\n4\n", 1), "symmetry 7"),
    "no lamps": (lambda t: t.replace("\n2000\n", "\n0\n", 1), "no luminous flux"),
    "letters": (lambda t: t.replace("\n2000\n", "\n2k\n", 1), "damaged"),
    "negative": (lambda t: t.replace("\n10\n4\n0", "\n10\n-4\n0", 1), "impossible candela"),
    "falling": (lambda t: t.replace("0\n45\n90\n10", "0\n90\n45\n10", 1), "do not rise"),
    "another file": (lambda t: "a letter\nto a maker", "neither an IES file"),
    "a picture": (lambda t: "\x89PNG\r\n\x1a\n", "neither an IES file"),
}


@pytest.mark.parametrize("case", BROKEN)
def test_a_damaged_eulumdat_file_is_refused_in_a_sentence(case: str) -> None:
    """Never a traceback."""
    change, said = BROKEN[case]
    text = ldt(0, dict(enumerate(side.replace(" ", "\n") for side in SIDES)))
    with pytest.raises(SceneFileError, match=said):
        candela(change(text))


WORDS = st.text(max_size=6) | st.floats().map(str) | st.integers(-5, 10**12).map(str)


@given(st.integers(0, 70), WORDS, st.sampled_from(["", "\x1a", "\r\n", "\n\n7"]))
def test_any_line_is_read_or_refused_in_a_sentence(line: int, word: str, end: str) -> None:
    """Any line of either format is read, or refused in one sentence."""
    for text in (ldt(2, {0: "9 8 7", 90: "9 5 3", 180: "9 1 0"}), ies({0: "9 8 7", 90: "9 1 0"})):
        lines = text.split("\n")
        lines[line % len(lines)] = word
        try:
            found = read_luminaire(("\n".join(lines) + end).encode(errors="replace")).photometry()
        except SceneFileError:
            continue
        assert np.all(found.table >= 0.0)
        assert found.table.max() <= 1.0
