# SPDX-License-Identifier: Apache-2.0
import hashlib
import subprocess

import numpy as np
import pytest
import sightglass as sg


def digest(path):
    return hashlib.sha256(path.read_bytes()).hexdigest()


def test_the_same_pixels_as_the_command_line(tmp_path, program):
    sg.gyroid(size=24).save(tmp_path / "g.vti")
    picture = sg.read(tmp_path / "g.vti").plot(size=(200, 150))
    subprocess.run([program, "render", tmp_path / "g.vti", "--size", "200x150", "-o", tmp_path / "there.png"], check=True, capture_output=True)
    picture.save(tmp_path / "here.png")
    there = sg.read(tmp_path / "there.png")
    here = sg.read(tmp_path / "here.png")
    name = here.keys()[0]
    assert np.array_equal(here[name], there[name])
    assert picture.array.shape == (150, 200, 3) and picture.size == (200, 150)


def test_any_number_of_threads_gives_the_same_bytes():
    try:
        pictures = []
        for n in (1, 2, 5):
            sg.set_threads(n)
            pictures.append(sg.gyroid(size=24).plot(size=(160, 120), show="volume")._repr_png_())
        assert pictures[0] == pictures[1] == pictures[2]
    finally:
        sg.set_threads(0)


def test_scenes_hold_several_things(volume):
    ds = sg.uniform(volume, name="T")
    scene = sg.scene().add(ds, "outline").add(ds.contour(values=[8]), "surface", color="red", opacity=0.5).camera(view="front")
    picture = scene.picture(title="Two", background="black").render((120, 90))
    assert picture.array.std() > 1
    assert "contour" in picture.recipe
    assert picture._repr_png_().startswith(b"\x89PNG")
    with pytest.raises(sg.UsageError, match="opacity"):
        scene.add(ds, "surface", opacity=7)
    with pytest.raises(sg.UsageError, match="sufrace"):
        scene.add(ds, "sufrace")


def test_pictures_say_what_was_chosen(volume):
    assert any("volume" in note for note in sg.uniform(volume).plot(size=(64, 48)).notes)


def test_films(tmp_path):
    scene = sg.scene().add(sg.gyroid(size=12).contour(), "surface").camera(azimuth="{t}")
    assert scene.movie(tmp_path / "turn.webm", size=(64, 48), times="0:288:5") == [0, 72, 144, 216, 288]
    assert (tmp_path / "turn.webm").stat().st_size > 100


def test_a_camera_goes_around(tmp_path):
    scene = sg.scene().add(sg.gyroid(size=12).contour(), "surface")
    assert scene.movie(tmp_path / "a.gif", size=(64, 48), orbit=360, frames=4) == [0, 90, 180, 270]
    assert scene.movie(tmp_path / "b_{n}.png", size=(64, 48), orbit=90, frames=3) == [0, 45, 90]
    with pytest.raises(sg.UsageError, match="times"):
        scene.movie(tmp_path / "c.gif", orbit=360, times="0:1:2")


def test_two_threads_draw_at_once():
    import threading

    pictures = {}

    def draw(n):
        pictures[n] = sg.gyroid(size=20).plot(size=(120, 90))._repr_png_()

    threads = [threading.Thread(target=draw, args=(n,)) for n in range(4)]
    for t in threads:
        t.start()
    for t in threads:
        t.join()
    assert len(set(pictures.values())) == 1


def test_other_processes_draw_too():
    """Forked ones as well, after this one has drawn, on all its threads."""
    import multiprocessing

    wanted = picture_of_gyroid()
    for way in ("fork", "spawn", "forkserver"):
        with multiprocessing.get_context(way).Pool(2) as pool:
            assert [r.get(timeout=60) for r in [pool.apply_async(picture_of_gyroid) for _ in range(3)]] == [wanted] * 3
    assert picture_of_gyroid() == wanted


def picture_of_gyroid():
    return sg.gyroid(size=20).contour(values=[0.1]).plot(size=(120, 90), picture={"title": "gyroid"})._repr_png_()


def test_a_picture_turns_as_a_page(tmp_path):
    picture = sg.sphere(size=12).plot(size=(120, 90))
    page = picture.interactive()
    assert page.html.startswith("<!doctype html>") and "http" not in page.html.split("<script>")[0].replace("http-equiv", "")
    frame = page._repr_html_()
    assert frame.startswith("<iframe srcdoc=") and "<script" not in frame and "aspect-ratio: 120 / 90" in frame
    page.save(tmp_path / "s.html")
    assert [p.name for p in tmp_path.iterdir()] == ["s.html"]
    assert (tmp_path / "s.html").read_text(encoding="utf-8") == page.html
    small = sg.scene().add(sg.gyroid(size=48), "volume", opacity="0:0,1:0.3").interactive(size=(120, 90), max="220K")
    assert len(small.html.encode()) <= 220 * 1024
    with pytest.raises(sg.UsageError, match="no room"):
        picture.interactive(max="1K")
    with pytest.raises(sg.UsageError, match="maxi"):
        picture.interactive(maxi="1M")


def test_a_picture_of_a_pipeline_turns_as_a_page(tmp_path):
    p = sg.pipeline(sg.sphere(size=12).contour(values=[0]))
    picture = p.render(size=(120, 90))
    page = picture.interactive()
    scene = sg.sphere(size=12).contour(values=[0]).plot(size=(120, 90)).interactive()
    assert "aspect-ratio: 120 / 90" in page._repr_html_()

    def arrays(page):
        return [line for line in page.html.splitlines() if line.startswith('<script type="text/plain"')]

    assert arrays(page) == arrays(scene) != []
    p.set("contour", values=[0.2])
    assert picture.interactive().html == page.html  # as it was drawn
    assert arrays(p.render(size=(120, 90)).interactive()) != arrays(page)
    with pytest.raises(sg.UsageError, match="maxi"):
        picture.interactive(maxi="1M")
    # Numbers from memory, and pictures that were saved.
    x = np.linspace(-1, 1, 9)
    ball = (x[:, None, None] ** 2 + x[None, :, None] ** 2 + x[None, None, :] ** 2).astype(np.float32)
    assert arrays(sg.pipeline(sg.uniform(ball, name="v").contour(values=[0.5])).render(size=(120, 90)).interactive())
    picture.save(tmp_path / "a.png")
    assert arrays(sg.open(tmp_path / "a.png").render().interactive()) == arrays(page)
    moves = sg.pipeline(sg.double_gyre(dims=[21, 11, 1])).render(size=(120, 90))
    assert moves.interactive(times=[0, 0.5, 1]).html.count('"time":') == 3
    assert moves.interactive().html.count('"time":') <= 1


def test_a_page_has_the_steps_of_what_moves():
    page = sg.scene().add(sg.double_gyre(dims=[21, 11, 1]), "surface", field="velocity").interactive(size=(120, 90), times=[0, 0.5, 1])
    assert page.html.count('"time":') == 3


def test_a_page_of_a_series_in_a_pipeline_is_of_the_picture_s_time(tmp_path):
    for n in range(3):
        sg.sphere(size=8 + n).save(tmp_path / f"a_{n}.vti")
    p = sg.pipeline(f"sightglass: 1\nsteps:\n  a: {{read: '{tmp_path}/a_{{n}}.vti'}}\n")
    picture = p.render(size=(120, 90))
    assert picture.interactive().html.count('"time":') <= 1
    assert picture.interactive(times=[0, 1, 2]).html.count('"time":') == 3
