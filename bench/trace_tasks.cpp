// SPDX-License-Identifier: Apache-2.0
// The path tracer's trees and rays beside Embree: the mesh, the camera and the rays of the peers' embree_bench.cpp, which reads the same
// mesh_1M.raw.
#include <bit>
#include <cmath>
#include <cstring>
#include <memory>
#include <string>

#include "base/context.h"
#include "base/file/file.h"
#include "base/parallel.h"
#include "bench.h"
#include "data/mesh.h"
#include "inputs.h"
#include "render/trace/geometry/triangles.h"

namespace sg::bench {

namespace {

using namespace trace;

constexpr int width = 1920, height = 1080, tile = 16, rays_per_chunk = 4096;
constexpr int columns = (width + tile - 1) / tile, rows = (height + tile - 1) / tile;

struct Mesh1M {
  std::vector<float> xyz;
  std::vector<uint32_t> corners;
  TriangleInput input() const { return {xyz.data(), corners.data(), corners.size() / 3, {}, 1}; }
};

/// u64 points, u64 triangles, f32 positions, u32 corners; made where it is missing.
Mesh1M mesh_1m(const std::string& folder) {
  const std::string path = folder + "/mesh_1M.raw";
  if (!file_exists(path)) {
    const DatasetPtr d = surface_mesh(235);
    const auto& m = *d->as<SurfaceMesh>();
    const Array xyz = m.points.xyz.made_packed(), corners = m.polygons.connectivity.converted(ElementType::u32).made_packed();
    const uint64_t counts[2] = {m.points.count(), m.polygons.size()};
    std::string bytes(reinterpret_cast<const char*>(counts), sizeof counts);
    bytes.append(reinterpret_cast<const char*>(xyz.raw()), 12 * counts[0]);
    bytes.append(reinterpret_cast<const char*>(corners.raw()), 12 * counts[1]);
    write_file(path, bytes);
  }
  const MappedFile file(path);
  const auto* bytes = reinterpret_cast<const char*>(file.data());
  uint64_t counts[2];
  std::memcpy(counts, bytes, sizeof counts);
  Mesh1M m;
  m.xyz.resize(3 * counts[0]), m.corners.resize(3 * counts[1]);
  std::memcpy(m.xyz.data(), bytes + 16, 12 * counts[0]);
  std::memcpy(m.corners.data(), bytes + 16 + 12 * counts[0], 12 * counts[1]);
  return m;
}

struct View {
  Vec3f eye{2.2f, 2.6f, 3.6f}, forward = normalize(-eye), right = normalize(cross(forward, Vec3f(0, 1, 0))), up = cross(right, forward);
  float half_height, half_width;
  explicit View(float degrees) : half_height(std::tan(0.5f * degrees * 3.14159265f / 180)), half_width(half_height * width / height) {}
  Ray through(int x, int y) const {
    const float u = (2 * (float(x) + 0.5f) / width - 1) * half_width, v = (1 - 2 * (float(y) + 0.5f) / height) * half_height;
    return {eye, normalize(forward + right * u + up * v)};
  }
};

uint32_t mixed(uint32_t a) {
  a ^= a >> 16, a *= 0x7feb352du, a ^= a >> 15, a *= 0x846ca68bu;
  return a ^ a >> 16;
}

/// Calls f(x, y) for the pixels of a tile.
template <class F>
void pixels(size_t number, F&& f) {
  const int x0 = int(number % columns) * tile, y0 = int(number / columns) * tile;
  for (int y = y0; y < std::min(y0 + tile, height); ++y)
    for (int x = x0; x < std::min(x0 + tile, width); ++x) f(x, y);
}

struct Scene1M {
  Triangles triangles;
  View view;
  std::vector<Ray> diffuse;  ///< one from each pixel that is hit, tile by tile, cosine distributed

  Scene1M(const std::string& folder, float degrees) : view(degrees) {
    const Mesh1M mesh = mesh_1m(folder);
    Context context;
    triangles = Triangles(mesh.input(), context);
    for (size_t t = 0; t < size_t(columns) * rows; ++t)
      pixels(t, [&](int x, int y) {
        const Ray r = view.through(x, y);
        Hit h;
        if (triangles.nearest(r, h)) diffuse.push_back(reflected(r, h, uint32_t(y) * width + uint32_t(x)));
      });
  }
  Ray reflected(const Ray& r, const Hit& h, uint32_t pixel) const {
    const auto c = triangles.corners(h.primitive);
    Vec3f n = normalize(cross(c[1] - c[0], c[2] - c[0]));
    if (dot(n, r.direction) > 0) n = -n;
    const uint32_t random = mixed(pixel);
    const float u = float(random >> 8) * 0x1p-24f, phi = 6.2831853f * float(mixed(random) >> 8) * 0x1p-24f, s = std::sqrt(u);
    const Vec3f t = normalize(cross(n, std::abs(n.x) > 0.5f ? Vec3f(0, 1, 0) : Vec3f(1, 0, 0))), b = cross(n, t);
    return {r.origin + r.direction * h.t + n * 1e-4f,
            normalize(t * (s * std::cos(phi)) + b * (s * std::sin(phi)) + n * std::sqrt(std::max(0.0f, 1 - u)))};
  }
};

/// Counts the hits of chunks by all threads.
template <class F>
double counted(size_t n, size_t grain, F&& f) {
  return double(parallel_reduce<size_t>(n, grain, 0, f, [](size_t a, size_t b) { return a + b; }));
}

size_t primary(const Scene1M& s, size_t number) {
  size_t hits = 0;
  pixels(number, [&](int x, int y) {
    Hit h;
    hits += s.triangles.nearest(s.view.through(x, y), h);
  });
  return hits;
}

size_t primary_packets(const Scene1M& s, size_t number) {
  const int x0 = int(number % columns) * tile, y0 = int(number / columns) * tile;
  size_t hits = 0;
  for (int y = y0; y < std::min(y0 + tile, height); y += 4)
    for (int x = x0; x < std::min(x0 + tile, width); x += 4) {
      Ray rays[packet_rays];
      Hit out[packet_rays];
      int n = 0;
      for (int k = 0; k < packet_rays; ++k)
        if (x + k % 4 < width && y + k / 4 < height) rays[n++] = s.view.through(x + k % 4, y + k / 4);
      hits += size_t(std::popcount(s.triangles.nearest(rays, n, out)));
    }
  return hits;
}

}  // namespace

void add_trace_tasks(std::vector<Task>& tasks, const std::string& folder) {
  tasks.push_back({"embree_build", "mesh 1M", "sightglass:trace", "triangles", [=] {
                     auto mesh = std::make_shared<Mesh1M>(mesh_1m(folder));
                     return [=] {
                       Context context;
                       return double(Triangles(mesh->input(), context).count());
                     };
                   }});
  for (const float degrees : {40.0f, 20.0f}) {
    const std::string size = degrees == 40 ? "mesh 1M, 1920x1080" : "mesh 1M filling the picture, 1920x1080";
    const auto add = [&](const char* task, const char* peer, auto&& work) {
      tasks.push_back({task, size, std::string("sightglass:") + peer, "hits", [=] {
                         auto scene = std::make_shared<Scene1M>(folder, degrees);
                         return [=] { return work(*scene); };
                       }});
    };
    const auto by_tiles = [](auto&& of_tile) {
      return [=](const Scene1M& s) { return counted(size_t(columns) * rows, 1, [&](size_t begin, size_t) { return of_tile(s, begin); }); };
    };
    add("embree_primary", "one by one", by_tiles(primary));
    add("embree_primary", "sixteen at once", by_tiles(primary_packets));
    add("embree_diffuse", "one by one", [](const Scene1M& s) {
      return counted(s.diffuse.size(), rays_per_chunk, [&](size_t begin, size_t end) {
        size_t hits = 0;
        for (size_t i = begin; i < end; ++i) {
          Hit h;
          hits += s.triangles.nearest(s.diffuse[i], h);
        }
        return hits;
      });
    });
    add("embree_diffuse", "sixty-four at once", [](const Scene1M& s) {
      return counted(s.diffuse.size(), rays_per_chunk, [&](size_t begin, size_t end) {
        size_t hits = 0;
        for (size_t i = begin; i < end; i += stream_rays) {
          Hit h[stream_rays];
          hits += size_t(std::popcount(s.triangles.nearest(&s.diffuse[i], int(std::min(size_t(stream_rays), end - i)), h)));
        }
        return hits;
      });
    });
    add("embree_ao", "one by one", [](const Scene1M& s) {
      return counted(s.diffuse.size(), rays_per_chunk, [&](size_t begin, size_t end) {
        size_t hits = 0;
        for (size_t i = begin; i < end; ++i) hits += s.triangles.blocked({s.diffuse[i].origin, s.diffuse[i].direction, 0.3f});
        return hits;
      });
    });
    add("embree_ao", "sixty-four at once", [](const Scene1M& s) {
      return counted(s.diffuse.size(), rays_per_chunk, [&](size_t begin, size_t end) {
        size_t hits = 0;
        for (size_t i = begin; i < end; i += stream_rays) {
          Ray rays[stream_rays];
          const size_t n = std::min(size_t(stream_rays), end - i);
          for (size_t k = 0; k < n; ++k) rays[k] = {s.diffuse[i + k].origin, s.diffuse[i + k].direction, 0.3f};
          hits += size_t(std::popcount(s.triangles.blocked(rays, int(n))));
        }
        return hits;
      });
    });
  }
}

}  // namespace sg::bench
