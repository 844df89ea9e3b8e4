# SPDX-License-Identifier: Apache-2.0
import base64
import re

import numpy as np
import sightglass as sg


def test_data_show_their_fields_and_a_small_picture(volume):
    text = sg.uniform(volume, name="a<b", unit="K")._repr_html_()
    assert "a&lt;b" in text and "0 .. 22" in text and "<table>" in text
    png = base64.b64decode(re.search(r"base64,([^\"]+)", text)[1])
    assert png.startswith(b"\x89PNG")
    assert "uniform 6x5x4" in repr(sg.uniform(volume))


def test_what_has_no_picture_shows_its_fields():
    empty = sg.points(np.zeros((0, 3)))._repr_html_()
    assert "0 points" in empty and "<img" not in empty


def test_tables_show_as_tables():
    text = sg.table({"t": np.arange(12.0), "site": ["<a>"] * 12}, units={"t": "s"})._repr_html_()
    assert "<th>t [s]</th>" in text and "<td>&lt;a&gt;</td>" in text and "2 more rows" in text and text.count("<tr>") == 11


def test_collections_show_their_parts(volume):
    text = sg.uniform(volume).clip(axis="x", keep="both")._repr_html_()
    assert "<td>inside</td>" in text and "<td>outside</td>" in text


def test_progress_is_told_where_somebody_sees_it(capfd):
    from sightglass import _progress

    assert _progress.text(0.5, "rendering", 10) == "50% rendering, 10 s left" and _progress.text(0.01, "reading", 1) == "1% reading"
    sg.set_progress(True)
    try:
        for size in (80, 160, 320):  # of work that is over in half a second nothing is told
            sg.abc(size=40).ftle(size=size)
            if told := capfd.readouterr().err:
                break
    finally:
        sg.set_progress(None)
    assert re.search(r"\r\x1b\[K\d+% ", told) and told.endswith("\r\x1b[K")
    sg.set_progress(False)
    sg.gyroid(size=64).plot(size=(64, 48), show="volume")
    assert capfd.readouterr().err == ""
