// SPDX-License-Identifier: Apache-2.0
// The same picture by OSPRay (3.x): c++ -O2 ospray.cpp -lospray. Renderer 'scivis' gives ambient occlusion with so many samples.
#include <ospray/ospray.h>
#include <ospray/ospray_util.h>

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <string>
#include <vector>

int main(int argc, char** argv) {
  if (argc != 7) return std::fprintf(stderr, "usage: %s MESH.raw even|lamp|metal|occlusion PATHS WIDTH HEIGHT OUT.f32\n", argv[0]), 2;
  const std::string name = argv[2];
  const int paths = std::atoi(argv[3]), width = std::atoi(argv[4]), height = std::atoi(argv[5]);
  const bool occlusion = name == "occlusion";
  int none = 0;
  if (ospInit(&none, nullptr) != OSP_NO_ERROR) return 1;
  std::FILE* f = std::fopen(argv[1], "rb");
  uint64_t counts[2];
  if (!f || std::fread(counts, 8, 2, f) != 2) return 1;
  std::vector<float> xyz(3 * counts[0]);
  std::vector<uint32_t> corners(3 * counts[1]);
  if (std::fread(xyz.data(), 4, xyz.size(), f) != xyz.size() || std::fread(corners.data(), 4, corners.size(), f) != corners.size())
    return 1;
  std::fclose(f);

  OSPGeometry mesh = ospNewGeometry("mesh");
  OSPData positions = ospNewSharedData(xyz.data(), OSP_VEC3F, counts[0]), indices = ospNewSharedData(corners.data(), OSP_VEC3UI, counts[1]);
  ospCommit(positions), ospCommit(indices);
  ospSetObject(mesh, "vertex.position", positions), ospSetObject(mesh, "index", indices), ospCommit(mesh);
  OSPMaterial material = ospNewMaterial(name == "metal" ? "principled" : "obj");
  if (name == "metal") {
    ospSetVec3f(material, "baseColor", .9f, .6f, .3f), ospSetFloat(material, "metallic", 1), ospSetFloat(material, "roughness", .3f);
  } else {
    ospSetVec3f(material, "kd", .8f, .8f, .8f);
  }
  ospCommit(material);
  OSPGeometricModel model = ospNewGeometricModel(mesh);
  ospSetObject(model, "material", material), ospCommit(model);
  OSPGroup group = ospNewGroup();
  ospSetObjectAsData(group, "geometry", OSP_GEOMETRIC_MODEL, model), ospCommit(group);
  OSPInstance instance = ospNewInstance(group);
  ospCommit(instance);
  OSPWorld world = ospNewWorld();
  ospSetObjectAsData(world, "instance", OSP_INSTANCE, instance);
  std::vector<OSPObject> lights;
  OSPLight around = ospNewLight("ambient");
  ospSetFloat(around, "intensity", name == "even" || occlusion ? 1 : .2f),
      ospSetInt(around, "intensityQuantity", OSP_INTENSITY_QUANTITY_RADIANCE);
  ospSetBool(around, "visible", false);
  ospCommit(around), lights.push_back(around);
  if (name == "lamp" || name == "metal") {
    OSPLight lamp = ospNewLight("sphere");
    ospSetVec3f(lamp, "position", 3, 4, 2), ospSetFloat(lamp, "radius", .5f), ospSetFloat(lamp, "intensity", 20);
    ospSetInt(lamp, "intensityQuantity", OSP_INTENSITY_QUANTITY_RADIANCE), ospSetBool(lamp, "visible", true);
    ospCommit(lamp), lights.push_back(lamp);
  }
  OSPData list = ospNewSharedData(lights.data(), OSP_LIGHT, lights.size());
  ospCommit(list), ospSetObject(world, "light", list), ospCommit(world);

  OSPCamera camera = ospNewCamera("perspective");
  ospSetFloat(camera, "aspect", float(width) / float(height)), ospSetFloat(camera, "fovy", 40);
  ospSetVec3f(camera, "position", 2.2f, 2.6f, 3.6f), ospSetVec3f(camera, "direction", -2.2f, -2.6f, -3.6f),
      ospSetVec3f(camera, "up", 0, 1, 0);
  ospCommit(camera);
  OSPRenderer renderer = ospNewRenderer(occlusion ? "scivis" : "pathtracer");
  ospSetInt(renderer, "pixelSamples", occlusion ? 1 : paths), ospSetInt(renderer, "pixelFilter", OSP_PIXELFILTER_BOX);
  ospSetVec4f(renderer, "backgroundColor", 0, 0, 0, 0);
  if (occlusion) ospSetInt(renderer, "aoSamples", paths), ospSetFloat(renderer, "aoDistance", 1), ospSetBool(renderer, "shadows", false);
  else ospSetInt(renderer, "maxPathLength", 9), ospSetInt(renderer, "roulettePathLength", 4);
  OSPData materials = ospNewSharedData(&material, OSP_MATERIAL, 1);
  ospCommit(materials), ospSetObject(renderer, "material", materials), ospCommit(renderer);
  auto draw = [&](int w, int h, const char* out) {
    OSPFrameBuffer buffer = ospNewFrameBuffer(w, h, OSP_FB_RGBA32F, OSP_FB_COLOR | OSP_FB_ACCUM);
    ospCommit(buffer);
    const auto begin = std::chrono::steady_clock::now();
    const std::clock_t work = std::clock();
    OSPFuture done = ospRenderFrame(buffer, renderer, camera, world);
    ospWait(done, OSP_TASK_FINISHED);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    if (out) {
      const float* rgba = static_cast<const float*>(ospMapFrameBuffer(buffer, OSP_FB_COLOR));
      std::FILE* to = std::fopen(out, "wb");
      for (int y = h - 1; y >= 0; --y)  // from the top
        for (int x = 0; x < w; ++x) std::fwrite(rgba + 4 * (size_t(y) * size_t(w) + size_t(x)), 4, 3, to);
      std::fclose(to);
      ospUnmapFrameBuffer(rgba, buffer);
      std::printf("%.4f %.4f\n", seconds, double(std::clock() - work) / CLOCKS_PER_SEC);
    }
    ospRelease(done), ospRelease(buffer);
  };
  draw(16, 9, nullptr);  // the tree, off the clock
  draw(width, height, argv[6]);
}
