"""Randomly damaged scene files open, or are refused in one clear sentence."""

from pathlib import Path

from vrut_lite.errors import UserError
from vrut_lite.scene.loading import load_scene
from vrut_lite_lab.broken_files.mangled import GOOD, broken

FILES, LEAST_REFUSED = 130, 100
# Words of libraries' errors, which would not help the user.
FOREIGN = ("Traceback", "NoneType", "numpy", "dtype", "axis 0", "object has no", "invalid literal")


def test_each_broken_file_has_its_sentence(tmp_path, no_hang):
    """130 files with bytes, words, lines or values changed; at least 100 cannot be opened.

    A flipped bit of a vertex breaks nothing: such a file may open. All others end in a
    UserError: one line that names the file, without a library's words.
    """
    refusals = {}
    for number in range(FILES):
        name, files = broken(number)
        folder = tmp_path / str(number)
        folder.mkdir()
        for file, content in files.items():
            (folder / file).write_bytes(content)
        no_hang()
        try:
            assert load_scene(folder / name).triangles > 0
        except UserError as error:
            refusals[number] = str(error).replace(str(folder), "")
    assert len(refusals) >= LEAST_REFUSED
    for number, sentence in refusals.items():
        assert sentence.startswith("cannot open the scene "), (number, sentence)
        assert sentence.isprintable(), (number, sentence)
        assert len(sentence) < 400, (number, sentence)
        assert not any(word in sentence for word in FOREIGN), (number, sentence)


def test_the_files_break_each_time_alike(tmp_path):
    """The damage is reproducible by number; undamaged, all files open."""
    for number in (3, 40, 77):
        assert broken(number) == broken(number)
    for name, (folder, _) in GOOD.items():
        assert load_scene(Path(folder) / name).triangles > 0
