"""The light of hours on the graphics card, written into the textures that pictures sample.

The tables of a bake are uploaded once (`hour/card_tables.py`); an hour brings its inputs, and
nothing is read back. On the GL thread only.
"""

from pathlib import Path
from typing import Any

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


class HourOnCard:
    """Buffers and programs of the light of hours; the hour that was computed last is kept."""

    def __init__(self, gl: PartGl):
        self._gl, self._context = gl, gl.context
        self._passes: dict[tuple[str, tuple[str, ...]], ComputePass] = {}
        self._tables: CardTables | None = None
        self._inputs: CardInputs | None = None
        self._buffers: dict[str, Any] = {}

    def compute(self, hour: CardHour) -> None:
        """Compute an hour, unless it is the last one.

        Raises:
            UserError: the driver allows no buffer as large as the tables.
        """
        if hour.inputs is self._inputs:
            return
        self._inputs = None
        if hour.tables is not self._tables:
            self.release()
            self._upload(hour.tables)
        tables, inputs = hour.tables, hour.inputs
        self._put("key", inputs.key.values)
        self._put("seen_shares", inputs.seen.values)
        self._put("open_sky", inputs.open_sky.values)
        columns = self._bounced(tables, inputs)
        self._gathered(tables, inputs, columns)
        self._smoothed(tables)
        self._finished(tables, inputs, columns)
        self._inputs = inputs

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
        for buffer in self._buffers.values():
            buffer.release()
        self._buffers.clear()
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
            () if tables.lamps is None else ("LAMPS",),
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

    def _upload(self, tables: CardTables) -> None:
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
        limit = int(self._context.info[_LARGEST_BUFFER])
        largest = max(values.nbytes for values in sent.values() if values is not None)
        if largest > limit:
            raise UserError(
                f"the tables of the light map take {largest / 1e6:.0f} MB, and this driver allows "
                f"{limit / 1e6:.0f} MB"
            )
        for name, values in sent.items():
            if values is not None:
                self._put(name, values)
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
        for name, rows in kept.items():
            self._put(name, np.zeros(rows * _ROW_BYTES, np.uint8))
        self._tables = tables

    def _put(self, name: str, values: NDArray[Any]) -> None:
        """Write numbers into a buffer of whole words, made at its first use; none is empty."""
        data = np.ascontiguousarray(values).tobytes() or bytes(_ROW_BYTES)
        data += bytes(-len(data) % _WORD_BYTES)
        if name in self._buffers:
            self._buffers[name].write(data)
        else:
            self._buffers[name] = self._context.buffer(data)


def _of_links(name: str, links: Links) -> dict[str, NDArray[Any] | None]:
    return {f"{name}_start": links.start, f"{name}_entry": links.entry}


def _wide(tables: CardTables) -> tuple[str, ...]:
    return ("WIDE",) if tables.is_wide else ()


def _least_of_sky(inputs: CardInputs) -> float:
    return LEAST_OF_SKY * float(inputs.open_sky.values.max())


def _groups(size: ArrayLike, group: int) -> tuple[int, ...]:
    """Work groups that cover so many rows, or texels along each axis."""
    return tuple(-(-int(edge) // group) for edge in np.atleast_1d(size))
