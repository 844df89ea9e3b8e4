// SPDX-License-Identifier: Apache-2.0
#include "render/volume/sources/cells/eye_space.h"

#include "base/error.h"
#include "base/parallel.h"

namespace sg::volume {

EyeSpace::EyeSpace(const CellVolume& volume, const Projection& projection, Context& context) : projection_(projection) {
  const TetMesh& mesh = *volume.mesh;
  const Vec3 eye = mesh.origin - projection.eye;
  const double x = dot(eye, projection.right), y = dot(eye, projection.up);
  middle_depth_ = dot(eye, projection.forward);
  vertices_.resize(4 * mesh.at.size());
  parallel_for(
      mesh.at.size(), 16384,
      [&](size_t begin, size_t end) {
        for (size_t v = begin; v < end; ++v) {
          const Vec3 p = mesh.at[v];
          float* e = &vertices_[4 * v];
          e[0] = float(dot(p, projection.right) + x), e[1] = float(dot(p, projection.up) + y), e[2] = float(dot(p, projection.forward));
          e[3] = volume.by_cell ? 0 : volume.values[v];
        }
      },
      &context);
}

void EyeSpace::line(RayLines& lines, int lane, double px, double py) const {
  const double sx = (px - projection_.middle_x()) / projection_.scale;
  const double sy = (projection_.middle_y() - py) / projection_.scale;
  const bool flat = projection_.parallel;
  lines.dx[lane] = flat ? 0 : float(sx), lines.dy[lane] = flat ? 0 : float(sy);
  lines.x0[lane] = float(flat ? sx : sx * middle_depth_), lines.y0[lane] = float(flat ? sy : sy * middle_depth_);
}

template <size_t N>
TileBox EyeSpace::tiles(const std::array<uint32_t, N>& vertices, int size, int across, int down) const {
  double lo[2] = {HUGE_VAL, HUGE_VAL}, hi[2] = {-HUGE_VAL, -HUGE_VAL};
  size_t before = 0, behind = 0;
  for (uint32_t v : vertices) {
    const float* e = (*this)[v];
    const double z = double(e[2]) + middle_depth_, wide = std::abs(double(e[0])) + std::abs(double(e[1])) + 1e-30;
    const double s = projection_.parallel ? projection_.scale : projection_.scale / z;
    // Near the eye's plane a shadow has no end.
    before += z > 1e-4 * wide, behind += z < -1e-4 * wide;
    const double p[2] = {projection_.middle_x() + s * double(e[0]), projection_.middle_y() - s * double(e[1])};
    for (int a = 0; a < 2; ++a) lo[a] = std::min(lo[a], p[a]), hi[a] = std::max(hi[a], p[a]);
  }
  if (!projection_.parallel && before < N && behind < N) return {0, 0, across - 1, down - 1};
  // Half a pixel is far more than floats leave uncertain.
  const auto tile_of = [&](double p, int count) { return int(std::floor(std::clamp(p / size, -1.0, double(count)))); };
  return {std::max(tile_of(lo[0] - 0.6, across), 0), std::max(tile_of(lo[1] - 0.6, down), 0),
          std::min(tile_of(hi[0] + 0.6, across), across - 1), std::min(tile_of(hi[1] + 0.6, down), down - 1)};
}

template TileBox EyeSpace::tiles(const std::array<uint32_t, 3>&, int, int, int) const;
template TileBox EyeSpace::tiles(const std::array<uint32_t, 4>&, int, int, int) const;

void bin_boxes(const std::vector<TileBox>& boxes, int across, int down, std::vector<uint32_t>& first, std::vector<uint32_t>& places) {
  std::vector<size_t> count(size_t(across) * size_t(down) + 1);
  const auto each = [&](auto&& act) {
    for (size_t k = 0; k < boxes.size(); ++k)
      for (int y = boxes[k].y0; y <= boxes[k].y1; ++y)
        for (int x = boxes[k].x0; x <= boxes[k].x1; ++x) act(size_t(y) * size_t(across) + size_t(x), k);
  };
  each([&](size_t t, size_t) { ++count[t]; });
  const size_t total = exclusive_scan(count);
  if (total >= (size_t(1) << 32)) fail_usage("too many cells overlap too many tiles of the picture", "volume", "make the picture smaller");
  places.resize(total);
  first.assign(count.begin(), count.end());
  each([&](size_t t, size_t k) { places[count[t]++] = uint32_t(k); });
}

}  // namespace sg::volume
