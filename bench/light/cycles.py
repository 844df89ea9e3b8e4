# SPDX-License-Identifier: Apache-2.0
"""The same picture by Blender's Cycles on the processor: blender -b --factory-startup -P cycles.py -- MESH.raw SCENE PATHS WIDTH HEIGHT OUT.f32"""
import os
import sys
import tempfile
import time

import bpy
import numpy as np

mesh_file, name, paths, width, height, out = sys.argv[sys.argv.index("--") + 1:]
paths, width, height = int(paths), int(width), int(height)
bpy.ops.wm.read_factory_settings(use_empty=True)
scene = bpy.context.scene

with open(mesh_file, "rb") as f:
    points, triangles = np.fromfile(f, np.uint64, 2)
    xyz = np.fromfile(f, np.float32, 3 * int(points))
    corners = np.fromfile(f, np.uint32, 3 * int(triangles)).astype(np.int32)
mesh = bpy.data.meshes.new("mesh")
mesh.vertices.add(int(points))
mesh.vertices.foreach_set("co", xyz)
mesh.loops.add(len(corners))
mesh.loops.foreach_set("vertex_index", corners)
mesh.polygons.add(int(triangles))
mesh.polygons.foreach_set("loop_start", np.arange(0, len(corners), 3, dtype=np.int32))
mesh.update()
for p in ("use_smooth",):
    mesh.polygons.foreach_set(p, np.zeros(int(triangles), bool))
body = bpy.data.objects.new("mesh", mesh)
scene.collection.objects.link(body)
material = bpy.data.materials.new("m")
material.use_nodes = True
nodes, links = material.node_tree.nodes, material.node_tree.links
nodes.clear()
end = nodes.new("ShaderNodeOutputMaterial")
if name == "metal":
    shader = nodes.new("ShaderNodeBsdfPrincipled")
    shader.inputs["Base Color"].default_value = (.9, .6, .3, 1)
    shader.inputs["Metallic"].default_value, shader.inputs["Roughness"].default_value = 1, .3
else:
    shader = nodes.new("ShaderNodeBsdfDiffuse")
    shader.inputs["Color"].default_value = (.8, .8, .8, 1)
links.new(shader.outputs[0], end.inputs["Surface"])
mesh.materials.append(material)

world = bpy.data.worlds.new("w")
scene.world = world
world.use_nodes = True
world.node_tree.nodes["Background"].inputs["Color"].default_value = (1, 1, 1, 1)
world.node_tree.nodes["Background"].inputs["Strength"].default_value = 1 if name == "even" else .2
if name != "even":
    lamp = bpy.data.lights.new("lamp", "POINT")
    lamp.shadow_soft_size = .5
    lamp.energy = 4 * np.pi * np.pi * .25 * 20  # watts: of radiance 20
    there = bpy.data.objects.new("lamp", lamp)
    there.location = (3, 4, 2)
    scene.collection.objects.link(there)

camera = bpy.data.cameras.new("c")
camera.sensor_fit, camera.angle = "VERTICAL", np.radians(40)
eye = bpy.data.objects.new("c", camera)
from mathutils import Matrix, Vector
z = Vector((2.2, 2.6, 3.6)).normalized()
x = Vector((0, 1, 0)).cross(z).normalized()
y = z.cross(x)
eye.matrix_world = Matrix.Translation((2.2, 2.6, 3.6)) @ Matrix((x, y, z)).transposed().to_4x4()
scene.collection.objects.link(eye)
scene.camera = eye

r = scene.render
r.engine, r.resolution_x, r.resolution_y, r.resolution_percentage = "CYCLES", width, height, 100
r.film_transparent, r.threads_mode, r.threads = True, "FIXED", os.cpu_count()
r.use_persistent_data = True
c = scene.cycles
c.device, c.samples, c.use_adaptive_sampling, c.use_denoising = "CPU", paths, False, False
c.max_bounces = c.diffuse_bounces = c.glossy_bounces = 8
c.pixel_filter_type, c.sample_clamp_direct, c.sample_clamp_indirect = "BOX", 0, 0
c.caustics_reflective = c.caustics_refractive = True
c.blur_glossy, c.use_light_tree = 0, False
r.image_settings.file_format, r.image_settings.color_depth = "OPEN_EXR", "32"
r.image_settings.color_mode = "RGBA"
folder = tempfile.mkdtemp()


def draw(n, w, h):
    c.samples, r.resolution_x, r.resolution_y = n, w, h
    r.filepath = os.path.join(folder, "p.exr")
    begin, work = time.perf_counter(), time.process_time()
    bpy.ops.render.render(write_still=True)
    return time.perf_counter() - begin, time.process_time() - work


draw(1, 16, 9)  # the tree, off the clock
seconds, work = draw(paths, width, height)
picture = bpy.data.images.load(r.filepath)
rgba = np.empty(4 * width * height, np.float32)
picture.pixels.foreach_get(rgba)
rgba = rgba.reshape(height, width, 4)[::-1, :, :3]
rgba.astype(np.float32).tofile(out)
print("LIGHT %.4f %.4f" % (seconds, work))
