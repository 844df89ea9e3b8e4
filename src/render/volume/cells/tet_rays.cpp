// SPDX-License-Identifier: Apache-2.0
#include "render/volume/cells/tet_rays.h"

#include "base/parallel.h"
#include "render/volume/cells/tet_walk.h"

namespace sg::volume {

namespace {

constexpr int slices = 2048;
constexpr int block = 4;  // pixels of a packet along each side
static_assert(block * block == TetPacket::lanes);

}  // namespace

TetMedium::TetMedium(const Medium& medium) {
  const auto lines = medium.straight();
  const auto add = [&](float lo, float hi, const Optics& at, const Optics& slope) {
    intervals.push_back({lo, hi, {at.tau, at.color.x, at.color.y, at.color.z}, {slope.tau, slope.color.x, slope.color.y, slope.color.z}, {}, {}});
  };
  // Below the first line, which has no lower end of its own, things stay as they are where it was made.
  const float lo = lines.front().lo, hi = lines.size() > 1 ? lines.back().lo : lo;
  add(-1e30f, lo, lines.front().at, {});
  for (const Medium::Straight& l : lines) add(l.lo, &l == &lines.back() ? 1e30f : l.hi, l.at, l.slope);

  double sum[4] = {};
  for (size_t i = 1; i < intervals.size(); ++i) {
    Interval& v = intervals[i];
    for (int k = 0; k < 4; ++k) v.before[k] = float(sum[k]);
    if (v.hi >= 1e30f) break;
    const double w = double(v.hi) - double(v.lo), tau = double(v.at[0]) + 0.5 * w * double(v.slope[0]);
    sum[0] += w * tau;
    for (int k = 1; k < 4; ++k)
      sum[k] += w * (tau * (double(v.at[k]) + 0.5 * w * double(v.slope[k])) + w * w / 12 * double(v.slope[k]) * double(v.slope[0]));
  }

  // Slice 0 lies below, the last one above, those between have equal width.
  slice_lo = lo, per_slice = hi > lo ? float(slices) / (hi - lo) : 0;
  if (!std::isfinite(per_slice)) per_slice = 0;
  const size_t count = slices + 2;
  first.assign(count, 0);
  std::vector<uint8_t> lit(count);
  const double width = (double(hi) - double(lo)) / slices;
  for (size_t s = 0, i = 0; s < count; ++s) {
    const double begin = s < 2 ? -1e30 : double(lo) + (double(s) - 2) * width;
    while (i + 1 < intervals.size() && double(intervals[i].hi) <= begin) ++i;
    first[s] = int32_t(i);
    const double end = s + 1 >= count ? 1e30 : double(lo) + (double(s) + 1) * width;
    for (size_t k = i; k < intervals.size() && double(intervals[k].lo) <= end; ++k) {
      const Interval& v = intervals[k];
      lit[s] = lit[s] || v.at[0] > 0 || v.slope[0] != 0;
    }
  }
  seen.assign(count + 1, 0);
  for (size_t s = 0; s < count; ++s) seen[s + 1] = seen[s] + lit[s];
}

struct TetRays::Scratch {
  std::vector<Hit> found, hits;  // hits: by pixel, then by depth
  std::array<uint32_t, tile * tile + 1> first{};
};

bool TetRays::fits(const CellVolume& volume) {
  if (volume.by_cell || volume.mesh->all_tets) return true;
  const Plane<uint32_t>& cells = volume.mesh->cells;
  for (size_t t = 1; t < cells.size(); ++t)
    if (cells[t] == cells[t - 1]) return false;
  return true;
}

TetRays::TetRays(const CellVolume& volume, const Projection& projection, const Medium& medium, Context& context, float stop_below)
    : volume_(volume), projection_(projection), medium_(medium), stop_below_(stop_below), eye_(volume, projection, context) {
  across_ = (projection_.width + tile - 1) / tile, down_ = (projection_.height + tile - 1) / tile;
  const auto& faces = volume.mesh->boundary;
  std::vector<TileBox> boxes(faces.size());
  parallel_for(faces.size(), 4096, [&](size_t begin, size_t end) {
    for (size_t f = begin; f < end; ++f) boxes[f] = eye_.tiles(faces[f].v, tile, across_, down_);
  });
  bin_boxes(boxes, across_, down_, first_face_, faces_);
}

/// Where each pixel's line crosses the boundary, by the same tests as the walk.
void TetRays::find_hits(int x0, int y0, int width, int height, Scratch& s) const {
  const TetMesh& mesh = *volume_.mesh;
  s.found.clear();
  s.first.fill(0);
  // Lines of the tile: x depends on the column alone, y on the row.
  RayLines columns, rows;
  for (int k = 0; k < tile; ++k) eye_.line(columns, k, x0 + k + 0.5, 0), eye_.line(rows, k, 0, y0 + k + 0.5);
  const size_t t = size_t(y0 / tile) * size_t(across_) + size_t(x0 / tile);
  for (size_t i = first_face_[t]; i < first_face_[t + 1]; ++i) {
    const auto& v = mesh.boundary[faces_[i]].v;
    const float *a = eye_[v[0]], *b = eye_[v[1]], *c = eye_[v[2]];
    float x[3][tile], y[3][tile];
    int begin = width, end = 0, top = height, bottom = 0;
    for (int k = 0; k < width; ++k) {
      x[0][k] = (a[0] - columns.x0[k]) - columns.dx[k] * a[2];
      x[1][k] = (b[0] - columns.x0[k]) - columns.dx[k] * b[2];
      x[2][k] = (c[0] - columns.x0[k]) - columns.dx[k] * c[2];
      if (std::min(x[0][k], std::min(x[1][k], x[2][k])) <= 0 && std::max(x[0][k], std::max(x[1][k], x[2][k])) >= 0)
        begin = std::min(begin, k), end = k + 1;
    }
    for (int k = 0; k < height; ++k) {
      y[0][k] = (a[1] - rows.y0[k]) - rows.dy[k] * a[2];
      y[1][k] = (b[1] - rows.y0[k]) - rows.dy[k] * b[2];
      y[2][k] = (c[1] - rows.y0[k]) - rows.dy[k] * c[2];
      if (std::min(y[0][k], std::min(y[1][k], y[2][k])) <= 0 && std::max(y[0][k], std::max(y[1][k], y[2][k])) >= 0)
        top = std::min(top, k), bottom = k + 1;
    }
    for (int r = top; r < bottom; ++r)
      for (int k = begin; k < end; ++k) {
        const float ab0 = x[0][k] * y[1][r], ab1 = y[0][r] * x[1][k], bc0 = x[1][k] * y[2][r], bc1 = y[1][r] * x[2][k];
        const float ca0 = x[2][k] * y[0][r], ca1 = y[2][r] * x[0][k];
        bool ab = ab0 > ab1, bc = bc0 > bc1, ca = ca0 > ca1;
        if (ab0 == ab1 || bc0 == bc1 || ca0 == ca1) {
          const auto left = [&](int p, int q) { return turns_left(double(x[p][k]), double(y[p][r]), double(x[q][k]), double(y[q][r])); };
          ab = left(0, 1), bc = left(1, 2), ca = left(2, 0);
        }
        if (ab != bc || bc != ca) continue;
        const float wa = std::abs(bc0 - bc1), wb = std::abs(ca0 - ca1), wc = std::abs(ab0 - ab1), all = wa + wb + wc;
        const float depth = all > 0 ? (wa * a[2] + wb * b[2] + wc * c[2]) / all : (a[2] + b[2] + c[2]) / 3;
        // `used` holds the turn until the hit is sorted in.
        s.found.push_back({depth, faces_[i], uint8_t(r * tile + k), uint8_t(ab)});
        ++s.first[size_t(r * tile + k) + 1];
      }
  }
  for (size_t p = 0; p < size_t(tile * tile); ++p) s.first[p + 1] += s.first[p];
  s.hits.resize(s.found.size());
  auto next = s.first;
  for (const Hit& h : s.found) {
    uint32_t k = next[h.pixel]++;
    for (; k > s.first[h.pixel] && h.depth < s.hits[k - 1].depth; --k) s.hits[k] = s.hits[k - 1];
    s.hits[k] = h;
  }
}

void TetRays::draw(int x0, int y0, int width, int height, const float* limit, Pixel* out) const {
  thread_local Scratch s;
  find_hits(x0, y0, width, height, s);
  const TetMesh& mesh = *volume_.mesh;
  const TetTables tables{
      mesh.links.data(), eye_[0],    volume_.by_cell ? volume_.values.data() : nullptr, mesh.cells.empty() ? nullptr : mesh.cells.data(),
      &medium_,          stop_below_};
  constexpr uint8_t gone = 2;  // in Hit::used: this end of a path is done with
  TetPacket p;
  for (int by = 0; by < height; by += block)
    for (int bx = 0; bx < width; bx += block) {
      bool any = false;
      const auto pixel_of = [&](int lane) { return size_t((by + lane / block) * tile + bx + lane % block); };
      const auto inside = [&](int lane) { return bx + lane % block < width && by + lane / block < height; };
      for (int lane = 0; lane < TetPacket::lanes; ++lane) {
        eye_.line(p, lane, x0 + bx + lane % block + 0.5, y0 + by + lane / block + 0.5);
        p.length[lane] = eye_.length(p, lane, p, lane);
        p.r[lane] = p.g[lane] = p.b[lane] = 0, p.pass[lane] = 1, p.half[lane] = NAN, p.last[lane] = -1;
        p.done[lane] = float(projection_.near_plane - eye_.middle_depth());
        p.limit[lane] = float(projection_.far_plane - eye_.middle_depth());
        if (!inside(lane)) {
          p.limit[lane] = p.done[lane];
          continue;
        }
        if (limit)
          p.limit[lane] =
              std::min(p.limit[lane], float(double(limit[(by + lane / block) * width + bx + lane % block]) - eye_.middle_depth()));
      }
      for (;;) {
        bool more = false;
        for (int lane = 0; lane < TetPacket::lanes; ++lane) {
          p.tet[lane] = -1;
          for (int k = 0; k < 3; ++k) p.id[k][lane] = 0;
          if (!(p.done[lane] < p.limit[lane]) || p.pass[lane] < stop_below_) continue;
          const size_t pixel = pixel_of(lane);
          for (uint32_t h = s.first[pixel]; h < s.first[pixel + 1]; ++h) {
            Hit& hit = s.hits[h];
            if (hit.used & gone) continue;
            const TetMesh::Face& face = mesh.boundary[hit.face];
            const int turn = hit.used;
            hit.used = gone;
            if (hit.depth >= p.limit[lane]) break;
            p.tet[lane] = int32_t(face.tet);
            for (int k = 0; k < 3; ++k) p.id[k][lane] = int32_t(face.v[size_t(turn || k == 0 ? k : 3 - k)]);
            more = any = true;
            break;
          }
        }
        if (!more) break;
        walk_tets(tables, p);
        for (int lane = 0; lane < TetPacket::lanes; ++lane) {
          if (p.last[lane] < 0 || !inside(lane)) continue;
          const size_t pixel = pixel_of(lane);
          for (uint32_t h = s.first[pixel]; h < s.first[pixel + 1]; ++h) {
            const TetMesh::Face& face = mesh.boundary[s.hits[h].face];
            if (face.tet == uint32_t(p.last[lane]) && face.apex == uint32_t(p.gone[lane])) s.hits[h].used = gone;
          }
        }
      }
      for (int lane = 0; lane < TetPacket::lanes; ++lane)
        if (inside(lane)) {
          Pixel& o = out[(by + lane / block) * width + bx + lane % block];
          o = Pixel{};
          if (any) o = {p.r[lane], p.g[lane], p.b[lane], p.pass[lane], float(double(p.half[lane]) + eye_.middle_depth())};
        }
    }
}

}  // namespace sg::volume
