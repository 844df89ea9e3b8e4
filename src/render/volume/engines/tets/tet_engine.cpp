// SPDX-License-Identifier: Apache-2.0
// Meshes of cells within the tolerance: 16 rays at once, tetrahedron by tetrahedron.
#include <algorithm>
#include <cmath>

#include "data/bricked.h"
#include "render/volume/engines/engine.h"
#include "render/volume/engines/tets/tet_rays.h"
#include "render/volume/sources/cells/cell_source.h"

namespace sg::volume {

namespace {

static_assert(tile == TetRays::tile);

class TetEngine : public TileEngine {
 public:
  explicit TetEngine(const EngineInput& in)
      : projection_(in.projection),
        id_(in.volume.id),
        rays_(cell_volume_of(*in.volume.source), in.projection, *in.volume.medium, in.context, in.volume.budget.stop_below,
              float(in.volume.budget.tolerance)) {
    if (in.item().shaded) rays_.light(in.lamps, in.item().light, in.volume.per_scale);
  }

  void draw(int x0, int y0, int x1, int y1, Frame& frame) const override {
    float limit[TetRays::tile * TetRays::tile];
    TetRays::Pixel found[TetRays::tile * TetRays::tile];
    const int width = x1 - x0;
    const auto place = [&](int x, int y) { return size_t(y) * size_t(frame.width) + size_t(x); };
    for (int y = y0; y < y1; ++y)
      for (int x = x0; x < x1; ++x) limit[(y - y0) * width + x - x0] = std::min(float(projection_.far_plane), frame.depth[place(x, y)]);
    rays_.draw(x0, y0, width, y1 - y0, limit, found);
    for (int y = y0; y < y1; ++y)
      for (int x = x0; x < x1; ++x) {
        const TetRays::Pixel& from = found[(y - y0) * width + x - x0];
        const size_t p = place(x, y);
        float* out = &frame.rgba[4 * p];
        Gathered sum{from.r, from.g, from.b, from.transmittance};
        sum.behind(out);
        out[0] = sum.r, out[1] = sum.g, out[2] = sum.b, out[3] = 1 - sum.transmittance;
        if (from.half == from.half && !(frame.depth[p] < HUGE_VALF)) frame.depth[p] = from.half, frame.ids[p] = id_;
      }
  }

 private:
  const Projection& projection_;
  uint32_t id_;
  TetRays rays_;
};

}  // namespace

std::unique_ptr<TileEngine> tetrahedra_engine(const EngineInput& in) {
  if (in.lattice || in.volume.detail || !in.by_tolerance() || !in.item().clip.empty() || in.item().data->bricks()) return nullptr;
  if (!TetRays::fits(cell_volume_of(*in.volume.source))) return nullptr;
  return std::make_unique<TetEngine>(in);
}

}  // namespace sg::volume
