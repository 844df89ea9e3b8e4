# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest
import sightglass as sg


def test_after_a_change_only_what_lies_below_runs_again(volume):
    asked = []

    def load(step):
        asked.append(step)
        return sg.uniform(volume, name="T")

    p = sg.pipeline(sg.series([0.0], load).gaussian_smooth(sigma=0.5).contour(values=[5]))
    assert list(p.steps) == ["read", "gaussian_smooth", "contour"] and p.steps["contour"]["stated"] == {"values": "5"}
    first = p.result()
    assert asked == [0, 0] and first.n_points > 0
    second = p.set("contour", values=[12]).result()
    assert asked == [0, 0] and "cached" in p.explain()
    assert np.allclose(second["contour value" if "contour value" in second else "T"], 12) and second.n_points != first.n_points
    assert p.set("contour", values=None).steps["contour"]["stated"] == {}
    smoothed = p.result("gaussian_smooth")
    assert smoothed.dims == (6, 5, 4) and asked == [0, 0]


def test_numbers_from_memory_run_as_they_are(volume):
    ds = sg.uniform(volume, name="T")
    surface = ds.contour(values=[5])
    p = sg.pipeline(surface)
    assert p.result().n_points == surface.n_points
    assert p.set("contour", values=[12]).result().n_points > 0
    with pytest.raises(sg.UsageError, match="memory"):
        p.set("memory", path="x")
    del ds
    assert p.set("contour", values=[8]).result().n_points > 0  # the pipeline holds them
    with pytest.raises(sg.UsageError, match="keep the Data"):
        sg.pipeline(sg.uniform(volume).contour(values=[5]))


def test_pictures_give_their_pipelines_back(tmp_path):
    sg.gyroid(size=16).save(tmp_path / "g.vti")
    picture = sg.read(tmp_path / "g.vti").contour(values=[0.2]).plot(size=(120, 90))
    picture.save(tmp_path / "a.png")
    p = sg.open(tmp_path / "a.png")
    assert np.array_equal(p.render().array, picture.array)
    assert p.render((60, 40)).size == (60, 40)
    p.save(tmp_path / "a.yaml")
    assert sg.pipeline(tmp_path / "a.yaml").result().n_points == p.result().n_points
    assert sg.pipeline(p.text).steps.keys() == p.steps.keys()
    sg.gyroid(size=12).save(tmp_path / "g.vti")
    with pytest.warns(sg.SightglassWarning, match="has changed"):
        sg.open(tmp_path / "a.png")


def test_a_strangers_picture_reads_nothing_elsewhere_and_writes_nothing(tmp_path):
    (tmp_path / "there").mkdir()
    secret = tmp_path / "secret.vti"
    sg.gyroid(size=8).save(secret)
    sg.read(secret).plot(size=(40, 30)).save(tmp_path / "there" / "a.png")
    with pytest.raises(sg.Error, match="secret.vti"):
        sg.open(tmp_path / "there" / "a.png")


def test_mistakes_name_what_is_near():
    p = sg.pipeline(sg.gyroid(size=8).contour())
    with pytest.raises(KeyError, match="did you mean 'contour'"):
        p.set("contuor", values=[1])
    with pytest.raises(KeyError, match="values"):
        p.set("contour", valeus=[1])
    with pytest.raises(sg.UsageError):
        sg.pipeline("steps:\n  a: {contuor: {}}\n").result()
    with pytest.raises(sg.Error, match="gone.png"):
        sg.open("gone.png")


def test_depth_and_what_is_seen(volume):
    ds = sg.uniform(volume)
    flat = sg.surface(np.array([[0, 0, 0], [4, 0, 0], [4, 3, 0], [0, 3, 0]], float), [[0, 1, 2, 3]])
    picture = sg.scene().add(flat, "surface").add(ds.contour(values=[8]), "surface").camera(view="front", projection="parallel").render((80, 60))
    assert picture.depth.shape == picture.ids.shape == (60, 80)
    assert set(np.unique(picture.ids)) <= {0, 1, 2} and 2 in picture.ids
    seen = np.isfinite(picture.depth)
    assert seen.any() and not seen.all() and (picture.depth[seen] > 0).all()
    # Seen from above, all of a plane is equally far.
    above = sg.scene().add(flat, "surface").camera(view="top", projection="parallel").picture(axes=False).render((80, 60))
    on = above.ids == 1
    assert on.sum() > 500 and np.ptp(above.depth[on]) < 1e-4 * above.depth[on].max()


def test_legends_say_what_is_drawn(volume):
    ds = sg.uniform(volume, name="T", unit="K")
    legend, = ds.plot(size=(80, 60)).legend
    assert (legend.title, legend.unit, legend.scale) == ("T", "K", "linear")
    assert legend.colors.shape == (256, 3) and legend.colors.dtype == np.uint8 and legend.entries == []
    assert legend.opacity.shape[1] == 2 and (np.diff(legend.opacity[:, 0]) >= 0).all()
    cut = ds.slice(axis="z")
    said, = sg.scene().add(cut, "surface", range=[1, 100], scale="log", map="gray").render((80, 60)).legend
    assert said.range == (1, 100) and said.scale == "log" and said.opacity.shape == (0, 2)
    assert tuple(said.colors[0]) < tuple(said.colors[-1])
    assert sg.scene().add(cut, "surface", legend=False).render((80, 60)).legend == []
    parts = np.repeat(np.array([0, 3, 7], np.uint8), 9 * 3).reshape(3, 9, 3)
    named, = sg.uniform(parts, name="part").slice(axis="y").plot(size=(80, 60)).legend
    assert [e.value for e in named.entries] == [0, 3, 7] and named.colors.shape == (0, 3)
    assert len({e.color for e in named.entries}) == 3


def test_pictures_by_paths_grow_and_tell_their_error(volume):
    scene = sg.scene().add(sg.uniform(volume).contour(values=[8]), "surface", color="tomato")
    scene.picture(integrator="path", noise=0.02, paths=32)
    seen = []
    picture = scene.render((80, 60), on_picture=seen.append)
    assert picture.error.shape == (60, 80)
    assert 0 < picture.error.max() < 0.5
    assert seen and seen[0].size == (80, 60)
    assert (seen[0].array != picture.array).any()
    assert np.sqrt((seen[0].error ** 2).mean()) > np.sqrt((picture.error ** 2).mean())
    assert (scene.render((80, 60)).array == picture.array).all()
    assert sg.scene().add(sg.uniform(volume)).render((80, 60)).error.size == 0

    def stop(_):
        raise LookupError("seen enough")

    with pytest.raises(LookupError, match="seen enough"):
        scene.render((80, 60), on_picture=stop)


def test_a_picture_that_time_ended_can_be_made_again(volume, tmp_path):
    scene = sg.scene().add(sg.uniform(volume).contour(values=[8]), "surface", color="tomato")
    scene.picture(integrator="path", noise=0.0001, paths=100000, seconds=0.2, denoise=True)
    picture = scene.render((80, 60))
    stated = picture.recipe.split("picture:")[1]
    assert "stop: " in stated and "seconds" not in stated and "denoise: true" in stated
