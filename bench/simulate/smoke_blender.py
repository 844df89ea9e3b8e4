#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A step of smoke by Sightglass and by Blender's Mantaflow, by turns: medians of milliseconds a step, with one thread and with two, and of
the processor's time, which other work beside it changes less.

    bench/simulate/smoke_blender.py --program build/sightglass [--blender 'COMMAND in front of blender'] [--size 128] [--steps 20] [--rounds 3]

Both carry density and heat in a cube of size^3 cells, that of Sightglass open above, Blender's on all sides, with a ball as source near the
bottom, in single precision, MacCormack advection and as many steps. Mantaflow solves the pressure by conjugate gradients with
its own accuracy, without vorticity and noise. Its steps are timed inside of Blender as bakes of frames with one step each (--steps frames,
the files of the cache written: without compression, in memory where --folder lies in /dev/shm); what one frame alone takes (making the
grids) is taken away. Ours are whole runs of the program less one that shows the first frame. Needs Blender 2.82 or newer.
"""
import argparse
import os
import re
import resource
import shlex
import shutil
import statistics
import subprocess
import sys
import time

INSIDE = r'''
import bpy, os, sys, time, shutil
size, steps, threads, folder = int(sys.argv[-4]), int(sys.argv[-3]), int(sys.argv[-2]), sys.argv[-1]
def scene(frames):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    s = bpy.context.scene
    s.render.threads_mode, s.render.threads = "FIXED", threads
    s.frame_start, s.frame_end = 1, frames
    bpy.ops.mesh.primitive_cube_add(size=1, location=(.5, .5, .5))
    box = bpy.context.object
    box.modifiers.new("f", "FLUID").fluid_type = "DOMAIN"
    d = box.modifiers["f"].domain_settings
    d.domain_type, d.resolution_max, d.use_noise, d.use_adaptive_domain = "GAS", size, False, False
    d.use_adaptive_timesteps, d.timesteps_min, d.timesteps_max = False, 1, 1
    d.vorticity, d.alpha, d.beta = 0, .1, 1
    d.cache_type, d.cache_directory = "ALL", folder
    d.cache_frame_start, d.cache_frame_end = 1, frames
    d.cache_data_format = "UNI" if "UNI" in [i.identifier for i in d.bl_rna.properties["cache_data_format"].enum_items] else "OPENVDB"
    if d.cache_data_format == "OPENVDB": d.openvdb_cache_compress_type = "NONE"
    bpy.ops.mesh.primitive_uv_sphere_add(radius=.1, location=(.5, .5, .15))
    ball = bpy.context.object
    ball.modifiers.new("f", "FLUID").fluid_type = "FLOW"
    f = ball.modifiers["f"].flow_settings
    f.flow_type, f.flow_behavior, f.temperature, f.density = "SMOKE", "INFLOW", 1, 1
    bpy.context.view_layer.objects.active = box
    box.select_set(True)
    return d.cache_data_format
def bake(frames):
    shutil.rmtree(folder, ignore_errors=True)
    os.makedirs(folder)
    kind = scene(frames)
    begin, work = time.perf_counter(), time.process_time()
    bpy.ops.fluid.bake_all()
    taken = time.perf_counter() - begin, time.process_time() - work
    made = sum(len(f) for _, _, f in os.walk(folder))
    return taken, made, kind
first, _, _ = bake(1)
all, made, kind = bake(steps + 1)
print("SECONDS", (all[0] - first[0]) / steps, (all[1] - first[1]) / steps, bpy.app.version_string.replace(" ", ""), made, kind, flush=True)
'''


def blender(prefix, folder, size, steps, threads):
    script = f"{folder}/inside.py"
    with open(script, "w") as f:
        f.write(INSIDE)
    ran = subprocess.run(prefix + ["blender", "-b", "--factory-startup", "-t", str(threads), "-P", script, "--", str(size), str(steps),
                                   str(threads), f"{folder}/cache"], capture_output=True, text=True)
    found = re.search(r"SECONDS (\S+) (\S+) (\S+) (\d+) (\S+)", ran.stdout)
    if not found or int(found[4]) < steps:
        sys.exit("Blender made no frames:\n" + ran.stdout[-2000:] + ran.stderr[-2000:])
    return float(found[1]), float(found[2]), f"Blender {found[3]} ({found[5]})"


def ours(program, folder, size, steps, threads):
    frame = 0.4 / size

    def seconds(frames):
        source = f"smoke size={size} bounds=0,1,0,1,0,1 source=0.5,0.5,0.15,0.1 frame={frame!r} time={frame * frames * (1 + 1e-9)!r}"
        begin, work = time.perf_counter(), resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run([program, "convert", "-q", "--threads", str(threads), "--source", source, "-o", f"{folder}/out.vti"], check=True,
                       stderr=subprocess.DEVNULL)
        done = resource.getrusage(resource.RUSAGE_CHILDREN)
        return time.perf_counter() - begin, done.ru_utime + done.ru_stime - work.ru_utime - work.ru_stime

    all_steps, first = seconds(steps + 1), seconds(1)
    return (all_steps[0] - first[0]) / steps, (all_steps[1] - first[1]) / steps, "Sightglass"


def main():
    a = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    a.add_argument("--program", default="build/sightglass")
    a.add_argument("--blender", default="", help="in front of blender, e.g. 'chroot ROOT'")
    a.add_argument("--folder", default="/dev/shm/smoke-bench", help="seen by both at the same path")
    a.add_argument("--size", type=int, default=128)
    a.add_argument("--steps", type=int, default=20)
    a.add_argument("--rounds", type=int, default=3)
    o = a.parse_args()
    prefix, folder = shlex.split(o.blender), os.path.abspath(o.folder)
    os.makedirs(folder, exist_ok=True)
    for threads in (1, 2):
        results = {}
        for _ in range(o.rounds):
            for run in (lambda: blender(prefix, folder, o.size, o.steps, threads),
                        lambda: ours(o.program, folder, o.size, o.steps, threads)):
                seconds, work, name = run()
                results.setdefault(name, []).append((seconds, work))
        medians = [[statistics.median(part) for part in zip(*r)] for r in results.values()]
        for name, (seconds, work) in zip(results, medians):
            print(f"{o.size}^3 {threads} thread{'s' if threads > 1 else ' '} {name:28} {seconds * 1000:9.1f} ms/step, "
                  f"of the processor {work * 1000:9.1f}", flush=True)
        (peer, peer_work), (own, own_work) = medians
        print(f"{o.size}^3 {threads} thread{'s' if threads > 1 else ' '} Sightglass takes {own / peer:.3f} of the peer's time, "
              f"{own_work / peer_work:.3f} of its processor time", flush=True)
    shutil.rmtree(folder, ignore_errors=True)


if __name__ == "__main__":
    main()
