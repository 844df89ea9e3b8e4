#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Surfaces in light at equal error: Sightglass, OSPRay and Cycles draw the same mesh, materials, lights and camera with some numbers of
paths a pixel. The error of a picture is the root mean square of its difference to the same program's picture of --reference paths, by the
mean of that. Times are those of the picture alone, without the tree.

    bench/light/compare.py --mesh mesh_1M.raw --program build/bench/sg_light --ospray 'COMMAND' --blender 'COMMAND' [--scene even,lamp,metal]

The scene `cloud` is matter in even light, by Sightglass and Cycles. The scene `occlusion` is ambient occlusion, PATHS then rays to the open (Sightglass: 16 for each from the camera), in OSPRay by its renderer
`scivis`; Cycles has none.

mesh_1M.raw is made by `sg_bench --only embree`; COMMANDs are what stands in front of the arguments: the program that ospray.cpp becomes,
and blender (with what runs it in another root). The table: seconds (wall, and of the processor) to an error of one per cent by the law of
1/sqrt(paths) from the run nearest to it, the paths that takes, and the mean of the reference, which shows that all draw the same.
"""
import argparse
import os
import shlex
import subprocess
import sys
import tempfile

import numpy as np


def main():
    a = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    a.add_argument("--mesh", required=True)
    a.add_argument("--program")
    a.add_argument("--ospray")
    a.add_argument("--blender")
    a.add_argument("--scene", default="even,lamp,metal")
    a.add_argument("--size", default="640x360")
    a.add_argument("--paths", default="4,16,64")
    a.add_argument("--reference", type=int, default=1024)
    a.add_argument("--folder", default=None, help="for pictures; default: a new one")
    a = a.parse_args()
    width, height = a.size.split("x")
    folder = a.folder or tempfile.mkdtemp()
    here = os.path.dirname(os.path.abspath(__file__))
    peers = []
    if a.program:
        peers.append(("sightglass", lambda scene, n, out: [a.program, a.mesh, scene, n, width, height, out]))
    if a.ospray:
        peers.append(("ospray", lambda scene, n, out: shlex.split(a.ospray) + [a.mesh, scene, n, width, height, out]))
    if a.blender:
        peers.append(("cycles", lambda scene, n, out: shlex.split(a.blender) + [
            "-b", "--factory-startup", "-P", os.path.join(here, "cycles.py"), "--", a.mesh, scene, n, width, height, out]))

    def draw(command, out):
        done = subprocess.run(command, capture_output=True, text=True)
        times = [l.split()[-2:] for l in done.stdout.splitlines() if l.startswith("LIGHT ") or (l and l[0].isdigit())]
        if done.returncode or not times or not os.path.exists(out):
            sys.exit("%s failed:\n%s%s" % (" ".join(command), done.stdout[-2000:], done.stderr[-2000:]))
        return [float(t) for t in times[-1]], np.fromfile(out, np.float32).astype(float)

    print("| scene | peer | seconds to 1 % | of the processor | paths | mean |\n|---|---|---|---|---|---|")
    for scene in a.scene.split(","):
        for name, command in peers:
            if (scene, name) in (("occlusion", "cycles"), ("cloud", "ospray")):
                continue
            out = os.path.join(folder, "%s_%s_%%d.f32" % (scene, name))
            _, truth = draw(command(scene, str(a.reference), out % a.reference), out % a.reference)
            rows = []
            for n in map(int, a.paths.split(",")):
                (wall, work), picture = draw(command(scene, str(n), out % n), out % n)
                # The reference has errors of its own.
                rows.append((n, wall, work, np.sqrt(np.mean((picture - truth) ** 2) / (1 + n / a.reference)) / truth.mean()))
            n, wall, work, error = min(rows, key=lambda r: abs(np.log(r[3] / 0.01)))
            factor = (error / 0.01) ** 2
            print("| %s | %s | %.2f | %.2f | %.0f | %.4f |" % (scene, name, wall * factor, work * factor, n * factor, truth.mean()), flush=True)
            print("  " + "; ".join("%d paths %.2f s (%.2f s) %.4f" % r for r in rows), file=sys.stderr, flush=True)


if __name__ == "__main__":
    main()
