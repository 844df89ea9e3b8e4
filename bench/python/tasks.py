# SPDX-License-Identifier: Apache-2.0
"""tasks.py sightglass|pyvista TASK: one task in a process of its own; prints seconds (or bytes), one number.

The same work in both: `import` is the time above numpy's; `hand_over` gives a 512^3 f32 array over (`hand_over_memory`: what the peak of
memory grows by, in bytes); `small_*` are calls on a mesh of 100 cells; `many` what 10,000 pictures of 320 x 240 add to
the memory in use after the first 100, in bytes; `picture` is the contour of a 256^3 array as the bytes of a PNG,
1280 x 720, `process` the same as a whole process.
"""
import resource
import subprocess
import sys
import time

import numpy as np

PEER, TASK = sys.argv[1], sys.argv[2]


def median_of(f, runs):
    times = []
    for _ in range(runs):
        begin = time.perf_counter()
        f()
        times.append(time.perf_counter() - begin)
    return sorted(times)[len(times) // 2]


def peak():
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024


def now():
    """Bytes of memory in use."""
    return int(open("/proc/self/statm").read().split()[1]) * resource.getpagesize()


def volume(n):
    z, y, x = np.ogrid[-1:1:n * 1j, -1:1:n * 1j, -1:1:n * 1j]
    return (np.sqrt(x * x + y * y + z * z) + 0.1 * np.sin(9 * x) * np.sin(9 * y) * np.sin(9 * z)).astype(np.float32)


def small():
    """5 x 5 x 4 hexahedra."""
    z, y, x = np.mgrid[0:5, 0:6, 0:6].astype(float)
    points = np.stack([x.ravel(), y.ravel(), z.ravel()], axis=1)
    first = np.array([i + 6 * (j + 6 * k) for k in range(4) for j in range(5) for i in range(5)])
    return points, first[:, None] + np.array([0, 1, 7, 6, 36, 37, 43, 42]), points @ (1.0, 2.0, 3.0)


def import_time():
    code = f"import numpy, time; b = time.perf_counter(); import {PEER}; print(time.perf_counter() - b)"
    return sorted(float(subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout) for _ in range(7))[3]


def sightglass(task):
    import sightglass as sg

    if task.startswith("hand_over"):
        a = np.zeros((512, 512, 512), np.float32)
        a += 1
        before = peak()
        seconds = median_of(lambda: sg.uniform(a, name="v"), 9)
        return seconds if task == "hand_over" else peak() - before
    if task.startswith("small_"):
        points, cells, values = small()
        mesh = sg.unstructured(points, {"hexahedron": cells}).with_field("v", values)
        calls = {"contour": lambda: mesh.contour(values=[12.0]), "threshold": lambda: mesh.threshold(min=10.0),
                 "clip": lambda: mesh.clip(normal=(1, 0, 0)), "slice": lambda: mesh.slice(axis="x"), "gradient": lambda: mesh.gradient()}
        return median_of(calls[task[6:]], 2000)
    if task == "many":
        a = volume(48)
        for n in range(10000):
            sg.uniform(a, name="v").contour(values=[0.7 + 1e-6 * n]).plot(size=(320, 240)).array.sum()
            if n == 99:
                before = now()
        return now() - before
    a = volume(256)
    return median_of(lambda: sg.uniform(a, name="v").contour(values=[0.7]).plot(size=(1280, 720))._repr_png_(), 7)


def pyvista(task):
    import pyvista as pv

    if task == "many":
        raise SystemExit("not measured")

    def grid(a):
        g = pv.ImageData(dimensions=a.shape[::-1])
        g.point_data.set_array(a.reshape(-1), "v")
        g.set_active_scalars("v")
        return g

    if task.startswith("hand_over"):
        a = np.zeros((512, 512, 512), np.float32)
        a += 1
        before = peak()
        seconds = median_of(lambda: grid(a), 9)
        return seconds if task == "hand_over" else peak() - before
    if task.startswith("small_"):
        points, cells, values = small()
        mesh = pv.UnstructuredGrid({pv.CellType.HEXAHEDRON: cells}, points)
        mesh["v"] = values
        calls = {"contour": lambda: mesh.contour([12.0]), "threshold": lambda: mesh.threshold(10.0), "clip": lambda: mesh.clip("x"),
                 "slice": lambda: mesh.slice("x"), "gradient": lambda: mesh.compute_derivative("v")}
        return median_of(calls[task[6:]], 200)
    a = volume(256)

    def draw():
        import io

        from PIL import Image

        p = pv.Plotter(off_screen=True, window_size=(1280, 720))
        p.add_mesh(grid(a).contour([0.7]), scalars="v")
        p.show_grid()
        pixels = p.screenshot(return_img=True)
        p.close()
        out = io.BytesIO()
        Image.fromarray(pixels).save(out, "PNG")
        return out.getvalue()

    return median_of(draw, 5)


if TASK == "import":
    print(import_time())
elif TASK == "process":
    begin = time.perf_counter()
    subprocess.run([sys.executable, __file__, PEER, "one"], check=True, capture_output=True)
    print(time.perf_counter() - begin)
elif TASK == "one":
    median_of = lambda f, runs: f()  # noqa: E731  once
    globals()[PEER]("picture")
else:
    print(globals()[PEER](TASK))
