# SPDX-License-Identifier: Apache-2.0
"""Arrays pass both ways where they lie, and never change under data that hold them."""
import gc
import logging

import numpy as np
import pytest
import sightglass as sg


def address(a):
    return a.__array_interface__["data"][0]


@pytest.mark.parametrize("dtype", ["u1", "i1", "u2", "i2", "u4", "i4", "u8", "i8", "f4", "f8"])
def test_every_type_is_used_where_it_lies(dtype, caplog):
    v = np.arange(120).reshape(4, 5, 6).astype(dtype)
    with caplog.at_level(logging.INFO, "sightglass"):
        ds = sg.uniform(v, name="v")
    assert address(ds["v"]) == address(v) and ds["v"].dtype == v.dtype
    assert ds.dims == (6, 5, 4)
    assert not caplog.records


def test_fortran_order_with_x_first_is_used_where_it_lies(caplog):
    v = np.asfortranarray(np.arange(120.0).reshape(6, 5, 4))
    with caplog.at_level(logging.INFO, "sightglass"):
        ds = sg.uniform(v, order="xyz", name="v")
    assert address(ds["v"]) == address(v) and not caplog.records
    assert ds.dims == (6, 5, 4)
    assert ds["v"][1] == v[1, 0, 0] and ds["v"][6] == v[0, 1, 0]  # x is fastest


def test_other_orders_are_copied_and_say_so(caplog):
    v = np.arange(120.0).reshape(6, 5, 4)
    with caplog.at_level(logging.INFO, "sightglass"):
        ds = sg.uniform(v, order="xyz", name="v")
    assert "copied" in caplog.text and "order='zyx'" in caplog.text
    assert ds["v"][1] == v[1, 0, 0] and ds["v"][6] == v[0, 1, 0]


def test_columns_of_a_table_are_used_where_they_lie():
    table = np.zeros(7, dtype=[("x", "f8", 3), ("T", "f4"), ("id", "i4")])
    table["T"] = np.arange(7)
    table["x"] = np.arange(21).reshape(7, 3)
    ds = sg.points(np.array(table["x"])).with_field("T", table["T"])
    assert list(ds["T"]) == list(range(7))


def test_what_is_handed_in_is_read_only_until_nobody_holds_it(volume):
    part = volume[1:]
    a = sg.uniform(part, name="v")
    b = a.with_field("w", part.reshape(-1))
    for array in (volume, part):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1
    with pytest.raises(ValueError, match="read-only"):
        a["v"][0] = 1
    del a
    gc.collect()
    with pytest.raises(ValueError, match="read-only"):  # b shares it
        volume[1] = 1
    view = b["v"]
    del b
    gc.collect()
    with pytest.raises(ValueError, match="read-only"):  # so does the view
        volume[1] = 1
    del view
    gc.collect()
    volume[1] = 1
    part[0] = 2


def test_what_was_read_only_stays_so(volume):
    volume.flags.writeable = False
    ds = sg.uniform(volume)
    del ds
    gc.collect()
    assert not volume.flags.writeable


def test_views_keep_the_numbers():
    v = sg.gyroid(size=16)
    name = v.keys()[0]
    numbers = v[name]
    expected = numbers.copy()
    del v
    gc.collect()
    np.empty(numbers.nbytes // 8).fill(1)  # over memory that is free
    assert np.array_equal(numbers, expected)


def test_references_are_given_back(volume):
    import sys

    sg.uniform(volume)
    gc.collect()
    before = sys.getrefcount(volume)
    for _ in range(100):
        ds = sg.uniform(volume)
        ds.contour(values=[5])["values"]
        del ds
    gc.collect()
    assert sys.getrefcount(volume) == before


@pytest.mark.parametrize("bad, text", [
    (np.array([object()] * 8).reshape(2, 2, 2), "object"),
    (np.array(["a"] * 8).reshape(2, 2, 2), "<U1"),
    (np.ones((2, 2, 2), complex), "complex128"),
    (np.float32(3), "0 dimensions"),
    (np.ones((2, 2, 2, 2)), "4 dimensions"),
])
def test_arrays_that_are_none_of_values_are_refused(bad, text):
    with pytest.raises(sg.UsageError, match=text):
        sg.uniform(bad)


@pytest.mark.parametrize("odd", [
    np.arange(24.0).astype(">f8").reshape(2, 3, 4),
    np.arange(24).astype(np.float16).reshape(2, 3, 4),
    np.arange(24.0).reshape(2, 3, 4)[::-1],
    np.broadcast_to(np.arange(4.0), (2, 3, 4)),
    np.frombuffer(b"\0" + np.arange(24.0).tobytes(), "u1")[1:].view("f8").reshape(2, 3, 4),
    np.arange(24).reshape(2, 3, 4) % 2 == 0,
])
def test_odd_layouts_come_over_right(odd):
    assert np.array_equal(sg.uniform(odd, name="v")["v"].reshape(odd.shape), odd.astype(odd.dtype.newbyteorder("=")))


def test_lengths_have_to_fit(volume):
    ds = sg.uniform(volume)
    with pytest.raises(sg.UsageError, match="there are 120 points and 60 cells"):
        ds.with_field("x", np.zeros(7))
    assert sg.uniform(volume).with_field("c", np.zeros(60)).on("c") == "cells"


def test_several_fields_at_once():
    grid = sg.uniform(np.zeros((3, 4, 5), np.float32), name="zero")
    a, b = np.arange(60.0), np.arange(24, dtype=np.float32)
    ds = grid.with_fields({"a": (a, "K"), "b": b, "ab": np.stack([a, a], 1)})
    assert list(ds.keys()) == ["zero", "a", "b", "ab"]
    assert ds.unit("a") == "K" and ds.unit("b") == "" and ds.on("a") == "points" and ds.on("b") == "cells"
    assert np.shares_memory(ds["a"], a) and np.shares_memory(ds["zero"], grid["zero"])
    assert list(grid.keys()) == ["zero"]
    with pytest.raises(sg.UsageError, match="7 values"):
        grid.with_fields({"ok": a, "short": np.zeros(7)})
