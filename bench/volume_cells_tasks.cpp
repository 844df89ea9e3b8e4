// SPDX-License-Identifier: Apache-2.0
// Frames of a million tetrahedra: packets of rays, plain and lit, and cell projection.
#include "base/parallel.h"
#include "bench.h"
#include "inputs.h"
#include "render/volume/engines/tets/tet_rays.h"
#include "render/volume/methods/layer.h"

namespace sg::bench {

namespace {

constexpr int pixels = 1024;

/// The peers' camera, which moves a little each frame.
Projection moving(double turn) {
  Camera c;
  const double a = turn * 3.14159265358979323846 / 180;
  c.position = {2.2 * std::cos(a) + 3.6 * std::sin(a), 2.6, 3.6 * std::cos(a) - 2.2 * std::sin(a)};
  c.target = {0, 0, 0}, c.up = {0, 1, 0}, c.view_angle = 40;
  Box3 box;
  box.add({-1, -1, -1}), box.add({1, 1, 1});
  fit_planes(c, box);
  return make_projection(c, pixels, pixels);
}

VolumeItem tets(bool shaded) {
  VolumeItem item;
  item.data = tetrahedra(55), item.field = "f";
  item.color.map = find_colormap("sight");
  item.color.lo = -3, item.color.hi = 4;
  item.opacity.points = {{-3, 0}, {-.9, 0}, {-.6, .15}, {-.3, 0}, {.2, 0}, {.5, .3}, {.8, 0}, {1.6, 0}, {2, .8}, {4, .8}};
  item.unit_distance = 0.1;
  item.shaded = shaded;
  return item;
}

/// All that a frame takes: field, medium, vertices in eye space, rays.
double frame_by_rays(const VolumeItem& item, double turn) {
  Context context;
  const Projection projection = moving(turn);
  const volume::CellVolume cells = volume::make_cell_volume(item, context);
  volume::TetRays rays(cells, projection, volume::make_medium(item, cells), context);
  if (item.shaded) {
    rays.light(lamps_of(lights_of(Scene{}), projection), item.light, float(1 / (0.002 * (cells.range.hi - cells.range.lo))));
  }
  constexpr int tile = volume::TetRays::tile, across = pixels / tile;
  return parallel_reduce(
      size_t(across) * across, 4, 0.0,
      [&](size_t begin, size_t end) {
        volume::TetRays::Pixel out[tile * tile];
        double covered = 0;
        for (size_t t = begin; t < end; ++t) {
          rays.draw(int(t % across) * tile, int(t / across) * tile, tile, tile, nullptr, out);
          for (const auto& p : out) covered += p.transmittance < 1;
        }
        return covered;
      },
      [](double a, double b) { return a + b; });
}

double frame_by_projection(const VolumeItem& item, double turn) {
  Context context;
  const Projection projection = moving(turn);
  const Frame frame(pixels, pixels);
  const std::vector<Light> lights = lights_of(Scene{});
  const volume::Layer layer = volume::project_cells({item, projection, frame, lights, context});
  double covered = 0;
  for (size_t i = 3; i < layer.rgba.size(); i += 4) covered += layer.rgba[i] > 0;
  return covered;
}

Task frames(const char* peer, bool shaded, double (*draw)(const VolumeItem&, double)) {
  return {"volume_render_unstructured", "tet1M, 1024x1024", peer, "pixels covered", [=] {
            auto item = std::make_shared<VolumeItem>(tets(shaded));
            draw(*item, 0);  // the mesh's neighbours are known from the first frame on, as those of the peers
            auto turn = std::make_shared<double>(0);
            return [=] { return draw(*item, *turn += 2); };
          }};
}

}  // namespace

void add_volume_cells_tasks(std::vector<Task>& tasks) {
  tasks.push_back(frames("sightglass:tetrahedra", false, frame_by_rays));
  tasks.push_back(frames("sightglass:tetrahedra(shaded)", true, frame_by_rays));
  tasks.push_back(frames("sightglass:cell projection", false, frame_by_projection));
}

}  // namespace sg::bench
