"""`Array`: values cannot change afterwards, and are copied only if necessary."""

import gc

import numpy as np
import pytest

from vrut_lite.array import Array


def through_its_base():
    base = np.zeros(12)
    return Array(base[4:]), lambda: base.fill(1.0)


def through_another_view():
    base = np.zeros(12)
    other = base[2:8]
    return Array(base), lambda: other.fill(1.0)


def through_a_view_of_the_same_base():
    base = np.zeros((3, 4))
    other, said = base.reshape(-1), Array(base.T)
    return said, lambda: other.fill(1.0)


def through_a_field():
    table = np.zeros(5, dtype=[("light", "f4"), ("count", "i4")])
    return Array(table["light"]), lambda: table["light"].fill(1.0)


def through_a_real_part():
    field = np.zeros(5, complex)
    return Array(field.real), lambda: field.fill(1.0)


def through_a_buffer():
    buffer = bytearray(32)
    return Array(np.frombuffer(buffer)), lambda: buffer.__setitem__(slice(0, 32), b"1" * 32)


def through_a_read_only_view_of_a_buffer():
    buffer = bytearray(32)
    said = Array(np.frombuffer(memoryview(buffer).toreadonly()))
    return said, lambda: buffer.__setitem__(slice(0, 32), b"1" * 32)


def through_an_exported_buffer():
    values = np.zeros(4)
    exported = memoryview(values)
    return Array(values), lambda: exported.__setitem__(0, 1.0)


def through_a_list_beside_a_name():
    values = np.zeros(4)
    kept = [values]
    return Array(values), lambda: kept[0].fill(1.0)


@pytest.mark.parametrize(
    "make",
    [
        through_its_base,
        through_another_view,
        through_a_view_of_the_same_base,
        through_a_field,
        through_a_real_part,
        through_a_buffer,
        through_a_read_only_view_of_a_buffer,
        through_an_exported_buffer,
        through_a_list_beside_a_name,
    ],
)
def test_values_cannot_change_through_other_references(make):
    """The digest is the same before and after a write through the other reference."""
    array, write = make()
    before = Array(array.values.copy()).digest
    write()
    assert not array.values.any()
    assert array.digest == before
    with pytest.raises(ValueError, match="read-only"):
        array.values[...] = 2.0


def test_a_file_that_changes_does_not_change_what_was_said(tmp_path):
    """Neither for the mapped array itself nor for an array on it."""
    mapped = np.memmap(tmp_path / "sky.bin", dtype="f4", mode="w+", shape=(8,))
    arrays = [Array(mapped), Array(mapped[2:]), Array(np.asarray(mapped))]
    mapped[:] = 1.0
    assert not any(array.values.any() for array in arrays)


def names():
    values = np.ones((6, 4, 4, 3), np.float16)
    array = Array(values)
    return values, array


def a_view_of_what_nobody_holds():
    values = np.ones(24).reshape(6, 4)[1:]
    return values, Array(values)


def what_an_attribute_holds():
    held = type("Held", (), {})()
    held.values = np.ones(4)
    array = Array(held.values)
    return held.values, array


def bytes_that_cannot_change():
    values = np.frombuffer(bytes(32)).reshape(2, 2)
    return values, Array(values)


def what_is_in_another_message():
    array = Array(np.ones(4))
    return array.values, Array(array.values)


def what_was_locked_before():
    table = np.ones(9)
    table.flags.writeable = False
    return table, Array(table[3:])


@pytest.mark.parametrize(
    "make",
    [
        names,
        a_view_of_what_nobody_holds,
        what_an_attribute_holds,
        bytes_that_cannot_change,
        what_is_in_another_message,
        what_was_locked_before,
    ],
)
def test_arrays_that_nobody_else_can_write_are_not_copied(make):
    """A cube of 9 MB is passed by reference."""
    values, array = make()
    assert np.shares_memory(values, array.values)
    assert not values.flags.writeable


def test_broadcast_arrays_take_no_memory():
    """An array that is broadcast from one number stays without memory of its own."""
    array = Array(np.broadcast_to(np.zeros((), np.float32), (10**6, 10**6)))
    assert array.values.strides == (0, 0)
    gc.collect()
    assert not array.values.flags.writeable


def test_arrays_of_objects_are_refused():
    """Objects have addresses instead of content, and no reproducible digest."""
    with pytest.raises(TypeError, match="holds numbers, not object"):
        Array(np.array([None, {}]))
