"""`vrut-lite cache`: lists and removes cached files."""

import click

from vrut_lite.errors import UserError
from vrut_lite.user_files import (
    CachedKind,
    cache_folder,
    cached_kinds,
    clear_cache,
    session_folder,
    settings_folder,
    size_of,
    size_text,
)


@click.group(name="cache", invoke_without_command=True)
@click.pass_context
def cache(context: click.Context) -> None:
    """List cached files by kind, and the folders of settings and session; clear the cache.

    Example: vrut-lite cache clear kernels
    """
    if context.invoked_subcommand is None:
        _list()


@cache.command()
@click.argument("kind", required=False)
@click.option("--yes", is_flag=True, help="Do not ask.")
def clear(kind: str | None, yes: bool) -> None:
    """Remove cached files of KIND, or all; settings and the last session stay.

    Example: vrut-lite cache clear light --yes
    """
    chosen = _chosen(kind)
    if not chosen:
        click.echo(f"{cache_folder()} is empty")
        return
    size = size_text(sum(each.size_bytes for each in chosen))
    what = ", ".join(each.name for each in chosen)
    if not yes:
        click.confirm(f"Remove {what} ({size}) from {cache_folder()}?", abort=True)
    clear_cache(chosen)
    click.echo(f"{size} are free: {what}")


def _chosen(kind: str | None) -> list[CachedKind]:
    found = cached_kinds()
    if kind is None:
        return found
    chosen = [each for each in found if each.name == kind]
    if not chosen:
        names = ", ".join(each.name for each in found) or "nothing"
        raise UserError(f"the cache holds no {kind!r}: it holds {names}")
    return chosen


def _list() -> None:
    found = cached_kinds()
    total = size_text(sum(each.size_bytes for each in found))
    click.echo(f"cache, computed again when it is missing: {cache_folder()}, {total}")
    for kind in found:
        words = f": {kind.meaning}" if kind.meaning else ""
        click.echo(f"  {kind.name} {size_text(kind.size_bytes)}, {kind.files} files{words}")
    for title, folder in (("settings", settings_folder()), ("last session", session_folder())):
        files, size_bytes = size_of(folder)
        click.echo(f"{title}: {folder}, {files} files, {size_text(size_bytes)}")
