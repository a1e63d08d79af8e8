"""Packages announce the kernels that they compile, so that these are compiled side by side."""

from typing import NamedTuple

import pytest
from hypothesis import given
from hypothesis import strategies as st
from numba.core import types

from tools.list_kernels import kernels_of
from vrut_lite.compiling.kernel_list import announced_kernels, decoded, encoded, packages


class Pair(NamedTuple):
    """A named tuple that kernels could take."""

    first: int
    second: int


NUMBERS = st.sampled_from(
    [types.int32, types.int64, types.uint8, types.uint16, types.float32, types.float64]
)
ARRAYS = st.builds(
    types.Array,
    NUMBERS | st.just(types.boolean),
    st.integers(1, 5),
    st.sampled_from("CFA"),
    readonly=st.booleans(),
    aligned=st.booleans(),
)
TYPES = st.recursive(
    NUMBERS | ARRAYS | st.sampled_from([types.boolean, types.none]),
    lambda inner: (
        st.lists(inner, max_size=4).map(lambda parts: types.BaseTuple.from_types(tuple(parts)))
        | st.tuples(inner, inner).map(lambda parts: types.BaseTuple.from_types(parts, Pair))
    ),
    max_leaves=6,
)


@given(TYPES)
def test_types_of_arguments_come_back_from_their_text(kind: types.Type) -> None:
    """A kernel compiled for other types would be compiled again where it is called."""
    assert decoded(encoded(kind)) == kind


@pytest.mark.gl
def test_what_is_called_is_what_is_announced() -> None:
    """A kernel off the list is compiled late and alone, one that nobody calls for nothing.

    After a change of a kernel's name or arguments `python -m tools.list_kernels` mends the lists.
    """
    called = {kernel.key for kernel in kernels_of("window")}
    announced = announced_kernels()
    groups = [group for package in packages() for group in announced.of(package)]
    listed = {kernel.key for group in groups if group.on_default_way for kernel in group.kernels}
    # A renderer on a card has no use for the kernels of moving pictures.
    alone = {kernel.key for group in groups if group.window_alone for kernel in group.kernels}
    if not alone & called:
        listed -= alone
    assert {key[:2] for key in called ^ listed} == set()


def test_lists_are_of_their_own_package() -> None:
    """A package that is not installed takes its list with it."""
    announced = announced_kernels()
    named = {
        (package, kernel.module.partition(".")[0])
        for package in packages()
        for group in announced.of(package)
        for kernel in group.kernels
    }
    assert named
    assert all(package == owner for package, owner in named)
