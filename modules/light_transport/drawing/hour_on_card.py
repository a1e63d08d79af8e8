"""The light of hours on the graphics card, written into the textures that pictures sample.

The tables of a bake are uploaded once (`hour/card_tables.py`), in pieces so that a moving picture
need not wait for all of them; an hour brings its inputs, and nothing is read back. On the GL thread
only.
"""

from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from light_transport.hour.card_tables import (
    CardHour,
    CardInputs,
    CardTables,
    Links,
    largest_return,
    sweep_weights,
)
from light_transport.hour.relighting import LEAST_OF_SKY
from light_transport.hour.smoothing import STEPS
from light_transport.rays.sky_nodes import NODES
from vrut_lite.errors import UserError
from vrut_lite.frame_part import ComputePass, PartGl

_SHADERS = Path(__file__).parent / "shaders"
_GROUP, _GROUP_2D, _GROUP_3D = 64, 8, 4
_ROW_BYTES, _WORD_BYTES = 16, 4
_LARGEST_BUFFER = "GL_MAX_SHADER_STORAGE_BLOCK_SIZE"
# Bytes of tables that a moving picture uploads: 1 ms of its time at 4 GB/s.
PIECE_BYTES = 4_000_000
PIECE = "piece of the light on the card"
# A shader's file, and its defines.
_Program = tuple[str, tuple[str, ...]]


class _Coming(NamedTuple):
    """Tables that are being uploaded: the pieces that are left, and the buffers that they fill."""

    tables: CardTables
    pieces: Iterator[None]
    buffers: dict[str, Any]


class HourOnCard:
    """Buffers and programs of the light of hours; the hour that was computed last is kept.

    The counters count each "piece of the light on the card": a part of a bake's tables, or a
    program.
    """

    def __init__(self, gl: PartGl):
        self._gl, self._context = gl, gl.context
        self._passes: dict[_Program, ComputePass] = {}
        self._tables: CardTables | None = None
        self._inputs: CardInputs | None = None
        self._buffers: dict[str, Any] = {}
        self._coming: _Coming | None = None

    def compute(self, hour: CardHour, most_pieces: int | None = None) -> bool:
        """Compute an hour, unless it is the last one; returns whether it is there.

        A bake's first hour brings its tables and programs, at most so many pieces a call; None
        means all. Until they are there the last hour stays.

        Raises:
            UserError: the driver allows no buffer as large as the tables.
            GivenUp: the picture that is drawn is no longer wanted; the next call goes on.
        """
        if self.holds(hour):
            return True
        if hour.tables is not self._tables and not self._brought(hour.tables, most_pieces):
            return False
        self._inputs = None
        tables, inputs = hour.tables, hour.inputs
        self._put("key", inputs.key.values)
        self._put("seen_shares", inputs.seen.values)
        self._put("open_sky", inputs.open_sky.values)
        columns = self._bounced(tables, inputs)
        self._gathered(tables, inputs, columns)
        self._smoothed(tables)
        self._finished(tables, inputs, columns)
        self._inputs = inputs
        return True

    def holds(self, hour: CardHour) -> bool:
        """Whether this is the hour that was computed last."""
        return hour.inputs is self._inputs

    def write_map(self, texture: Any) -> None:
        """Write the light map, rgba32f."""
        assert self._tables is not None
        work = self._pass("hour_map.comp", texels=self._tables.texels)
        texture.bind_to_image(0, read=False, write=True)
        self._bind("shown", "row_of")
        work.run(*_groups(texture.size, _GROUP_2D))

    def write_probes(self, texture: Any) -> None:
        """Write the probes (columns, rows, 6 slices), rgba32f."""
        assert self._tables is not None
        work = self._pass("hour_probes.comp", texels=self._tables.texels)
        texture.bind_to_image(0, read=False, write=True)
        self._bind("probes_start", "probes_entry", "shown")
        work.run(*_groups(texture.size, _GROUP_3D))

    def write_mirror(self, number: int, cube: Any) -> None:
        """Write the first level of the cube of a mirror, rgba32f."""
        assert self._tables is not None
        assert self._tables.target is not None
        work = self._pass("hour_mirror.comp", number=number, rays=self._tables.target.shape[-1])
        cube.bind_to_image(0, read=False, write=True)
        self._bind("target", "radiance")
        across = _groups(cube.size, _GROUP_2D)[0]
        work.run(across, across, 6)

    def release(self) -> None:
        """Free the buffers."""
        self._free_coming()
        _free(self._buffers)
        self._tables = self._inputs = None

    # --- the steps, as in hour/relighting.py ----------------------------------------------

    def _bounced(self, tables: CardTables, inputs: CardInputs) -> str:
        """Gather the sky, and bounce it between patches; returns the name of the columns."""
        albedo, irradiance = inputs.colours.values
        rows, patches = len(tables.rows) - 1, len(tables.patches)
        for columns in ("columns", "other_columns"):
            self._buffers[columns].write(inputs.nodes.values.tobytes())
        gather = self._pass("hour_gather.comp", _wide(tables), count=rows)
        self._bind("entry", "rows", "columns", "light")
        gather.run(*_groups(rows, _GROUP))
        direct = self._pass(
            "hour_direct.comp",
            count=patches,
            nodes=NODES,
            ground_albedo=albedo,
            key_irradiance=irradiance,
        )
        self._bind("members_start", "members_entry", "light", "patches", "key", "source",
                   "columns", "other_columns")  # fmt: skip
        direct.run(*_groups(patches, _GROUP))
        weights = sweep_weights(largest_return(tables, albedo))
        now, before = "columns", "other_columns"
        for sweep, weight in enumerate(weights, 1):
            is_last = int(sweep == len(weights))
            bounce = self._pass(
                "hour_bounce.comp",
                count=patches,
                nodes=NODES,
                ground_albedo=albedo,
                weight=weight,
                is_last=is_last,
            )
            self._bind("transfer_start", "transfer_entry", now, "patches", "source", before)
            bounce.run(*_groups(patches, _GROUP))
            now, before = before, now
        return now

    def _gathered(self, tables: CardTables, inputs: CardInputs, columns: str) -> None:
        gather = self._pass(
            "hour_gather.comp",
            ("PATCHES", *_wide(tables)),
            count=tables.lit,
            texels=tables.texels,
            least_of_sky=_least_of_sky(inputs),
        )
        self._bind("entry", "rows", columns, "light", "open_sky")
        gather.run(*_groups(tables.lit, _GROUP))

    def _smoothed(self, tables: CardTables) -> None:
        texels = tables.texels
        if texels:
            self._after_steps("light", "smooth", texels)
            difference = self._pass("hour_difference.comp", count=texels)
            self._bind("smooth", "light")
            difference.run(*_groups(texels, _GROUP))
            self._after_steps("light", "light", texels)
        restore = self._pass("hour_restore.comp", count=tables.lit, texels=texels)
        self._bind("smooth", "light", "back")
        restore.run(*_groups(tables.lit, _GROUP))

    def _after_steps(self, source: str, result: str, texels: int) -> None:
        """Smooth `source` in an even number of steps, into `result`."""
        for step in range(STEPS):
            target = "spare" if step % 2 == 0 else result
            smooth = self._pass("hour_smooth.comp", count=texels)
            self._bind("smoothing_start", "smoothing_entry", source, target)
            smooth.run(*_groups(texels, _GROUP))
            source = target

    def _finished(self, tables: CardTables, inputs: CardInputs, columns: str) -> None:
        finish = self._pass(
            "hour_finish.comp",
            _lamps(tables),
            count=tables.lit,
            texels=tables.texels,
            least_of_sky=_least_of_sky(inputs),
        )
        lamps = () if tables.lamps is None else ("lamps",)
        self._bind("smooth", "rows", "border_of", "borders", "open_sky", *lamps)
        self._buffers["shown"].bind_to_storage_buffer(6)
        finish.run(*_groups(tables.lit, _GROUP))
        if tables.seen is None:
            return
        albedo, irradiance = inputs.colours.values
        seen = self._pass(
            "hour_seen.comp",
            count=len(tables.seen),
            ground_albedo=albedo,
            key_irradiance=irradiance,
        )
        self._bind("seen", "seen_shares", "shown", columns, "radiance")
        seen.run(*_groups(len(tables.seen), _GROUP))

    # --- programs and buffers -------------------------------------------------------------

    def _pass(self, shader: str, defines: tuple[str, ...] = (), **uniforms: Any) -> ComputePass:
        key = shader, defines
        if key not in self._passes:
            self._passes[key] = self._gl.compute(_SHADERS / shader, defines)
        for name, value in uniforms.items():
            self._passes[key].set(name, value)
        return self._passes[key]

    def _bind(self, *names: str) -> None:
        """Bind buffers to the bindings 0, 1 and so on."""
        for binding, name in enumerate(names):
            self._buffers[name].bind_to_storage_buffer(binding)

    def _brought(self, tables: CardTables, most_pieces: int | None) -> bool:
        """Bring at most so many pieces of these tables, in place of the last once all are there."""
        if self._coming is None or self._coming.tables is not tables:
            self._free_coming()
            buffers: dict[str, Any] = {}
            self._coming = _Coming(tables, self._pieces(tables, buffers), buffers)
        done = 0
        while done != most_pieces:
            if not self._brought_piece(self._coming):
                _free(self._buffers)
                self._tables, self._buffers, self._coming = tables, self._coming.buffers, None
                return True
            self._gl.counters.did(PIECE)
            self._gl.check_wanted()
            done += 1
        return False

    def _brought_piece(self, coming: _Coming) -> bool:
        """Bring one more piece; False after the last."""
        try:
            return next(coming.pieces, _NO_MORE) is not _NO_MORE
        except Exception:
            # The next call begins again.
            self._free_coming()
            raise

    def _pieces(self, tables: CardTables, buffers: dict[str, Any]) -> Iterator[None]:
        """Fill buffers, `PIECE_BYTES` at a time, and compile programs, one at a time."""
        sent = _buffers_of(tables)
        limit = int(self._context.info[_LARGEST_BUFFER])
        largest = max(data.nbytes for data in sent.values())
        if largest > limit:
            raise UserError(
                f"the tables of the light map take {largest / 1e6:.0f} MB, and this driver allows "
                f"{limit / 1e6:.0f} MB"
            )
        room = PIECE_BYTES
        for name, data in sent.items():
            buffers[name] = self._context.buffer(reserve=_whole_words(data.nbytes))
            offset = 0
            while offset < data.nbytes:
                part = data[offset : offset + room]
                buffers[name].write(part, offset=offset)
                offset += part.nbytes
                room -= part.nbytes
                if room == 0:
                    yield
                    room = PIECE_BYTES
        for key in _programs_of(tables):
            if key not in self._passes:
                self._pass(*key)
                yield

    def _free_coming(self) -> None:
        if self._coming is not None:
            _free(self._coming.buffers)
            self._coming = None

    def _put(self, name: str, values: NDArray[Any]) -> None:
        """Write an hour's numbers into a buffer, made at its first use."""
        data = _bytes_of(values)
        if name not in self._buffers:
            self._buffers[name] = self._context.buffer(reserve=_whole_words(data.nbytes))
        self._buffers[name].write(data)


_NO_MORE = object()


def _free(buffers: dict[str, Any]) -> None:
    for buffer in buffers.values():
        buffer.release()
    buffers.clear()


def _bytes_of(values: NDArray[Any]) -> NDArray[np.uint8]:
    return np.ascontiguousarray(values).reshape(-1).view(np.uint8)


def _whole_words(size: int) -> int:
    """Bytes of a buffer for so many: whole words, for shaders read these, and never none."""
    return max(-(-size // _WORD_BYTES) * _WORD_BYTES, _ROW_BYTES)


def _buffers_of(tables: CardTables) -> dict[str, NDArray[np.uint8]]:
    """The bytes of a bake's buffers: its tables, and zeros where an hour is computed."""
    sent: dict[str, NDArray[Any] | None] = {
        "entry": tables.entry,
        "rows": tables.rows,
        "patches": tables.patches,
        "back": tables.back,
        "border_of": tables.border_of,
        "borders": tables.borders,
        "lamps": tables.lamps,
        "row_of": tables.shown,
        "seen": tables.seen,
        "target": tables.target,
        **_of_links("members", tables.members),
        **_of_links("transfer", tables.transfer),
        **_of_links("smoothing", tables.smoothing),
    }
    if tables.probes is not None:
        sent |= _of_links("probes", tables.probes)
    patches = len(tables.patches)
    kept = {
        "columns": NODES + patches + 1,
        "other_columns": NODES + patches + 1,
        "source": patches,
        "light": len(tables.rows) - 1,
        "smooth": tables.lit,
        "spare": tables.texels,
        "shown": tables.lit,
        "radiance": 0 if tables.seen is None else len(tables.seen),
    }
    sent |= {name: np.zeros(rows * _ROW_BYTES, np.uint8) for name, rows in kept.items()}
    return {name: _bytes_of(values) for name, values in sent.items() if values is not None}


def _programs_of(tables: CardTables) -> list[_Program]:
    """The programs of an hour and of its textures."""
    wide = _wide(tables)
    found: list[_Program] = [
        ("hour_gather.comp", wide),
        ("hour_direct.comp", ()),
        ("hour_bounce.comp", ()),
        ("hour_gather.comp", ("PATCHES", *wide)),
        ("hour_smooth.comp", ()),
        ("hour_difference.comp", ()),
        ("hour_restore.comp", ()),
        ("hour_finish.comp", _lamps(tables)),
        ("hour_map.comp", ()),
    ]
    if tables.probes is not None:
        found.append(("hour_probes.comp", ()))
    if tables.seen is not None:
        found += [("hour_seen.comp", ()), ("hour_mirror.comp", ())]
    return found


def _of_links(name: str, links: Links) -> dict[str, NDArray[Any] | None]:
    return {f"{name}_start": links.start, f"{name}_entry": links.entry}


def _wide(tables: CardTables) -> tuple[str, ...]:
    return ("WIDE",) if tables.is_wide else ()


def _lamps(tables: CardTables) -> tuple[str, ...]:
    return () if tables.lamps is None else ("LAMPS",)


def _least_of_sky(inputs: CardInputs) -> float:
    return LEAST_OF_SKY * float(inputs.open_sky.values.max())


def _groups(size: ArrayLike, group: int) -> tuple[int, ...]:
    """Work groups that cover so many rows, or texels along each axis."""
    return tuple(-(-int(edge) // group) for edge in np.atleast_1d(size))
