"""Builds sdist and wheel of the last commit into dist/, twice, and compares them byte by byte.

    python -m tools.make_dist

All times in them are the commit's (SOURCE_DATE_EPOCH), names are sorted, owners and permissions are
plain, so that anybody who builds the commit with the same setuptools gets the same files. The wheel
is built from the sdist.
"""

import gzip
import hashlib
import io
import os
import shutil
import subprocess
import sys
import tarfile
import tempfile
from pathlib import Path

ROOT = Path(__file__).parents[1]
DIST = ROOT / "dist"


def main() -> None:
    """Build, compare, and print names, sizes and digests."""
    os.umask(0o022)
    commit_time = int(_output("git", "log", "-1", "--format=%ct"))
    with tempfile.TemporaryDirectory() as first, tempfile.TemporaryDirectory() as second:
        built = build(Path(first), commit_time)
        for file, again in zip(built, build(Path(second), commit_time), strict=True):
            if file.name != again.name or file.read_bytes() != again.read_bytes():
                sys.exit(f"{file.name} differs when it is built again: {again.name}")
        DIST.mkdir(exist_ok=True)
        for file in built:
            shutil.copyfile(file, DIST / file.name)
            content = file.read_bytes()
            digest = hashlib.sha256(content).hexdigest()
            print(f"dist/{file.name}: {len(content) / 1e6:.1f} MB, sha256 {digest}")
    print("built twice, byte for byte the same")


def build(folder: Path, commit_time: int) -> list[Path]:
    """The sdist and the wheel of the last commit, below an empty folder.

    Args:
        folder: an empty folder.
        commit_time: seconds since 1970, the time of everything in them.
    """
    source, made = folder / "source", folder / "made"
    source.mkdir()
    committed = subprocess.run(
        ["git", "-c", "tar.umask=0022", "archive", "HEAD"],
        cwd=ROOT,
        check=True,
        stdout=subprocess.PIPE,
    ).stdout
    with tarfile.open(fileobj=io.BytesIO(committed)) as archive:
        archive.extractall(source, filter="data")
    sdist = _built("--sdist", source, made, commit_time)
    _make_plain(sdist, commit_time)
    with tarfile.open(sdist) as archive:
        archive.extractall(folder / "unpacked", filter="data")
    (unpacked,) = (folder / "unpacked").iterdir()
    return [sdist, _built("--wheel", unpacked, made, commit_time)]


def _built(kind: str, source: Path, made: Path, commit_time: int) -> Path:
    there = set(made.glob("*"))
    done = subprocess.run(
        [sys.executable, "-m", "build", kind, "--no-isolation", "--outdir", str(made)],
        cwd=source,
        env=os.environ | {"SOURCE_DATE_EPOCH": str(commit_time), "PYTHONHASHSEED": "0"},
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode:
        sys.exit(done.stdout + done.stderr)
    (new,) = set(made.glob("*")) - there
    return new


def _make_plain(sdist: Path, commit_time: int) -> None:
    """Rewrite an sdist with sorted names, one time and no owner."""
    plain = io.BytesIO()
    with (
        tarfile.open(sdist) as before,
        tarfile.open(fileobj=plain, mode="w", format=tarfile.PAX_FORMAT) as after,
    ):
        for member in sorted(before.getmembers(), key=lambda member: member.name):
            member.mtime = commit_time
            member.uid = member.gid = 0
            member.uname = member.gname = ""
            member.mode = 0o755 if member.isdir() or member.mode & 0o100 else 0o644
            member.pax_headers = {}
            after.addfile(member, before.extractfile(member) if member.isfile() else None)
    with (
        open(sdist, "wb") as file,
        gzip.GzipFile(filename="", mode="wb", fileobj=file, mtime=commit_time) as packed,
    ):
        packed.write(plain.getvalue())


def _output(*command: str) -> str:
    return subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout


if __name__ == "__main__":
    main()
