// SPDX-License-Identifier: Apache-2.0
#include "render/volume/engines/tets/tet_rays.h"

#include "base/parallel.h"
#include "render/volume/medium/color_between.h"
#include "render/volume/sources/cells/tet_walk.h"

namespace sg::volume {

namespace {

constexpr int slice_count = 2048;
constexpr int block = 4;  // pixels of a packet along each side
static_assert(block * block == TetPacket::lanes);

}  // namespace

namespace {

struct Sample {
  float value;
  Optics at;
};

/// On a line of the medium, its ends included.
Sample sample_on(const Medium& medium, int line, float v) { return {v, {medium.lines()[size_t(line)](v), color_between(medium, line, v)}}; }

/// Appends the ends of pieces after a, up to and with b, on which a line of the medium is straight.
void refine(const Medium& medium, int line, const Sample& a, const Sample& b, float accuracy, float faint, int depth,
            std::vector<Sample>& out) {
  // Values between are rounded, so that what changes within few floats is never told straighter.
  const float far = std::max(std::abs(a.value), std::abs(b.value)), width = b.value - a.value;
  const float rounded = width > 0 ? std::min(1.0f, (std::nextafter(far, HUGE_VALF) - far) / width) : 0;
  const auto straight = [&](float share) {
    const float v = a.value + share * (b.value - a.value);
    const Optics m = sample_on(medium, line, v).at;
    const auto off = [&](float x, float y, float z) { return std::abs(x + share * (y - x) - z); };
    if (off(a.at.tau, b.at.tau, m.tau) > accuracy * std::max(m.tau, faint) + rounded * std::abs(b.at.tau - a.at.tau)) return false;
    if (a.at.tau == 0 && b.at.tau == 0 && m.tau == 0) return true;
    for (int k = 0; k < 3; ++k)
      if (off(a.at.color[k], b.at.color[k], m.color[k]) > accuracy + rounded * std::abs(b.at.color[k] - a.at.color[k])) return false;
    return true;
  };
  const float middle = a.value + 0.5f * (b.value - a.value);
  if (depth > 0 && middle > a.value && middle < b.value && !(straight(0.5f) && straight(0.2f) && straight(0.8f))) {
    const Sample m = sample_on(medium, line, middle);
    refine(medium, line, a, m, accuracy, faint, depth - 1, out);
    return refine(medium, line, m, b, accuracy, faint, depth - 1, out);
  }
  out.push_back(b);
}

}  // namespace

TetMedium::TetMedium(const Medium& medium, const Range& range, float tolerance) {
  // D^2 / 12 of a change of colour is a 14th of the tolerance for D = sqrt(tolerance / change) / 1.06.
  const float accuracy = 0.25f * tolerance, faint = 0.2f * medium.faint();
  fine = std::sqrt(1.125f / tolerance);
  const auto add = [&](const Sample& a, const Sample& b) {
    Interval i{a.value, b.value, {a.at.tau, a.at.color.x, a.at.color.y, a.at.color.z}, {}, {}, 0, 0};
    const float to[4] = {b.at.tau, b.at.color.x, b.at.color.y, b.at.color.z}, width = b.value - a.value;
    for (int k = 0; k < 4 && width < 1e30f; ++k) i.slope[k] = (to[k] - i.at[k]) / width;
    intervals.push_back(i);
  };
  const float lo = range.empty() ? 0 : float(range.lo), hi = range.empty() ? 0 : float(range.hi);
  const Sample bottom{lo, medium.at(lo)}, top{hi, medium.at(hi)};
  add({-1e30f, bottom.at}, bottom);
  std::vector<Sample> samples;
  for (size_t number = 0; number < medium.lines().size(); ++number) {
    const Medium::Line& l = medium.lines()[number];
    const float from = std::max(l.lo, lo), to = std::min(l.hi, hi);
    if (!(from < to)) continue;
    // A knot may be a jump: each line has its own ends.
    const Sample a = sample_on(medium, int(number), from), b = sample_on(medium, int(number), to);
    samples.assign(1, a);
    refine(medium, int(number), a, b, accuracy, faint, 9, samples);
    for (size_t k = 0; k + 1 < samples.size(); ++k) add(samples[k], samples[k + 1]);
  }
  add(top, {1e30f, top.at});

  double sum[4] = {}, moment = 0;
  rests.assign(intervals.size(), Rest{});
  for (size_t i = 1; i < intervals.size(); ++i) {
    Interval& v = intervals[i];
    Rest& rest = rests[i];
    for (int k = 0; k < 4; ++k) v.before[k] = float(sum[k]), rest.before[k] = float(sum[k] - double(v.before[k]));
    v.moment = float(moment), rest.moment = float(moment - double(v.moment));
    if (v.hi >= 1e30f) break;
    const double w = double(v.hi) - double(v.lo), tau = double(v.at[0]) + 0.5 * w * double(v.slope[0]);
    sum[0] += w * tau;
    moment += w * (tau * (double(v.lo) + 0.5 * w - double(lo)) + w * w / 12 * double(v.slope[0]));
    for (int k = 1; k < 4; ++k)
      sum[k] += w * (tau * (double(v.at[k]) + 0.5 * w * double(v.slope[k])) + w * w / 12 * double(v.slope[k]) * double(v.slope[0]));
  }

  // What a segment over a whole line may have wrong of its mean tau, and of where that is.
  for (size_t i = 1; i + 1 < intervals.size(); ++i) {
    const Interval& v = intervals[i];
    const double w = double(v.hi) - double(v.lo), wrong = 0x1p-24 * sum[0] / w;
    long_sums = long_sums || wrong > std::max(1e-4 * double(v.at[0] + 0.5f * (v.hi - v.lo) * v.slope[0]), 0.01 * double(medium.faint()));
    long_moments = long_moments || w < (double(hi) - double(lo)) / 1024;
  }
  long_moments = long_moments || long_sums;

  // Slice 0 lies below, the last one above, those between have equal width.
  slice_lo = lo, per_slice = hi > lo ? float(slice_count) / (hi - lo) : 0;
  if (!std::isfinite(per_slice)) per_slice = 0;
  const size_t count = slice_count + 2;
  first.assign(count, 0);
  std::vector<uint8_t> lit(count);
  const double width = (double(hi) - double(lo)) / slice_count;
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
  if (volume.by_cell) return true;
  if (volume.mesh->all_tets && volume.part_of.empty()) return true;
  for (size_t t = 0; t < volume.mesh->size(); ++t)
    if (!volume.linear(t)) return false;
  return true;
}

TetRays::TetRays(const CellVolume& volume, const Projection& projection, const Medium& medium, Context& context, float stop_below,
                 float tolerance)
    : volume_(volume),
      projection_(projection),
      medium_(medium, volume.range, tolerance),
      stop_below_(stop_below),
      tolerance_(tolerance),
      eye_(volume, projection, context) {
  across_ = (projection_.width + tile - 1) / tile, down_ = (projection_.height + tile - 1) / tile;
  const auto& faces = volume.mesh->boundary;
  std::vector<TileBox> boxes(faces.size());
  parallel_for(faces.size(), 4096, [&](size_t begin, size_t end) {
    for (size_t f = begin; f < end; ++f) boxes[f] = eye_.tiles(faces[f].v, tile, across_, down_);
  });
  bin_boxes(boxes, across_, down_, first_face_, faces_);
}

void TetRays::light(std::vector<Lamp> lamps, const VolumeLight& light, float per_scale) {
  gradients_ = volume_.gradients();
  light_ = TetLight{std::move(lamps),
                    material_of(light),
                    float(volume_.mesh->edge) * per_scale,
                    tolerance_,
                    float(1 / std::max(volume_.mesh->bounds.diagonal(), 1e-30)),
                    reinterpret_cast<const float*>(gradients_->data())};
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
  const TetTables tables{mesh.links.data(),
                         eye_[0],
                         volume_.by_cell ? volume_.values.data() : nullptr,
                         mesh.cells.empty() ? nullptr : mesh.cells.data(),
                         &medium_,
                         light_ ? &*light_ : nullptr,
                         stop_below_};
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
        if (light_) {
          const Vec3f d(projection_.ray(x0 + bx + lane % block + 0.5, y0 + by + lane / block + 0.5).direction);
          for (int k = 0; k < 3; ++k) p.direction[k][lane] = d[k];
        } else {
          p.direction[0][lane] = p.direction[1][lane] = p.direction[2][lane] = 0;
        }
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
