# SPDX-License-Identifier: Apache-2.0
"""The same picture by Blender's Cycles on the processor:
blender -b --factory-startup -P cycles.py -- MESH.raw SCENE PATHS WIDTH HEIGHT OUT.f32"""
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


def cloud():
    """In a cube of side 2 an extinction of 8 (1 - |p|^2) (0.55 + 0.45 sin 9x sin 9y sin 9z), nine tenths of it scattered to all sides."""
    bpy.ops.mesh.primitive_cube_add(size=2)
    material = bpy.data.materials.new("s")
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.clear()

    def math(operation, *inputs):
        node = nodes.new("ShaderNodeMath")
        node.operation = operation
        for i, v in enumerate(inputs):
            if isinstance(v, (int, float)):
                node.inputs[i].default_value = v
            else:
                links.new(v, node.inputs[i])
        return node.outputs[0]

    place, apart = nodes.new("ShaderNodeTexCoord").outputs["Object"], nodes.new("ShaderNodeSeparateXYZ")
    links.new(place, apart.inputs[0])
    x, y, z = apart.outputs
    waves = math("MULTIPLY", math("MULTIPLY", *(math("SINE", math("MULTIPLY", v, 9.)) for v in (x, y))), math("SINE", math("MULTIPLY", z, 9.)))
    square = math("ADD", math("ADD", math("MULTIPLY", x, x), math("MULTIPLY", y, y)), math("MULTIPLY", z, z))
    density = math("MULTIPLY", math("MAXIMUM", math("SUBTRACT", 1., square), 0.), math("ADD", math("MULTIPLY", waves, .45), .55))
    both = nodes.new("ShaderNodeAddShader")
    for i, (kind, share) in enumerate((("ShaderNodeVolumeScatter", .9), ("ShaderNodeVolumeAbsorption", .1))):
        part = nodes.new(kind)
        # Scattered is colour times density, absorbed one minus colour.
        part.inputs["Color"].default_value = (1, 1, 1, 1) if i == 0 else (0, 0, 0, 1)
        links.new(math("MULTIPLY", density, 8 * share), part.inputs["Density"])
        links.new(part.outputs[0], both.inputs[i])
    links.new(both.outputs[0], nodes.new("ShaderNodeOutputMaterial").inputs["Volume"])
    bpy.context.object.data.materials.append(material)


def surface():
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


cloud() if name == "cloud" else surface()

world = bpy.data.worlds.new("w")
scene.world = world
world.use_nodes = True
world.node_tree.nodes["Background"].inputs["Color"].default_value = (1, 1, 1, 1)
world.node_tree.nodes["Background"].inputs["Strength"].default_value = 1 if name in ("even", "cloud") else .2
if name in ("lamp", "metal"):
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
if name == "cloud":
    c.max_bounces = c.volume_bounces = 1024
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
