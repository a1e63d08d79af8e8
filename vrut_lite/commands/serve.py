"""`vrut-lite serve`: runs commands that another program asks for, in one warm process."""

import contextlib
import io
import sys

import click
import msgspec

from vrut_lite.cli import EXPECTED, root, sentence_and_code

_WORDS = msgspec.json.Decoder(list[str])


@click.command(name="serve")
def serve() -> None:
    """Run commands given as lines of JSON, all in one process.

    A line of standard input is a list of a command's words. The answer is a line too: an object
    with the exit `code`, and `said` or `error`. Ends with standard input.

    Example: echo '["sky", "-o", "sky.exr", "--at", "2026-06-21T18:30"]' | vrut-lite serve
    """
    answers = sys.stdout
    for line in sys.stdin:
        answers.write(msgspec.json.encode(_answer(line)).decode() + "\n")
        answers.flush()


def _answer(line: str) -> dict[str, str | int]:
    said = io.StringIO()
    try:
        words = _WORDS.decode(line)
        if words[:1] == ["serve"]:
            raise click.UsageError("serve runs already: ask for another command")
        with contextlib.redirect_stdout(said):
            root.main(words, prog_name="vrut-lite", standalone_mode=False)
    except msgspec.MsgspecError:
        return {"code": 2, "error": 'a request is a list of words in JSON, as ["modules"]'}
    except EXPECTED as error:
        sentence, code = sentence_and_code(error)
        return {"code": code, "error": " ".join(sentence.split())}
    return {"code": 0, "said": said.getvalue().strip()}
