// SPDX-License-Identifier: Apache-2.0
// Cell projection (Shirley, Tuchman 1990): each tetrahedron is drawn into the pixels of its shadow, as a segment with the values of its
// two ends. Where their splats have approximations the segments are exact: every pixel has its own thickness and its own integral
// between the medium's knots. Theirs and later ones sort whole cells (Williams 1992: MPVO), which cycles and holes in the mesh defeat;
// here cells come roughly from near to far, and each pixel sorts the few that are out of order.
#include "render/volume/engines/tets/project.h"

#include "base/error.h"
#include "base/parallel.h"
#include "render/volume/methods/layer.h"
#include "render/volume/rays/integrate.h"
#include "render/volume/sources/cells/eye_space.h"

namespace sg::volume {

namespace {

constexpr int tile = TetRays::tile;

struct Segment {
  float enter, leave, front, back;
  uint32_t tet;
  uint8_t pixel;
};

/// The gradients at the vertices, along a ray.
class ProjectedLight : public RayField {
 public:
  ProjectedLight(const CellVolume& volume, const Plane<Vec3f>& gradients) : mesh_(*volume.mesh), gradients_(gradients) {}
  void start(Vec3 origin, Vec3 direction, double, double) override { origin_ = origin - mesh_.origin, direction_ = direction; }
  size_t next(std::span<Stretch>) override { return 0; }
  double entry() const override { return 0; }
  Vec3f gradient(const Stretch& stretch, double t) override {
    double w[4];
    tet_weights(mesh_, stretch.cell, origin_ + direction_ * t, w);
    Vec3f sum;
    for (size_t k = 0; k < 4; ++k) sum += gradients_[mesh_.corners[stretch.cell][k]] * float(std::clamp(w[k], 0.0, 1.0));
    return sum;
  }

 private:
  const TetMesh& mesh_;
  const Plane<Vec3f>& gradients_;
  Vec3 origin_, direction_;
};

class Projector {
 public:
  explicit Projector(const LayerInput& input)
      : input_(input),
        volume_(make_cell_volume(input.item, input.context)),
        medium_(make_medium(input.item, volume_)),
        table_(medium_, volume_.range, float(input.item.sampling.within())),
        eye_(volume_, input.projection, input.context),
        lamps_(lamps_of(input.lights, input.projection)) {}

  Layer draw() {
    const Projection& p = input_.projection;
    Layer layer;
    layer.rgba.assign(4 * size_t(p.width) * size_t(p.height), 0.0f);
    if (volume_.range.empty()) return layer;
    if (input_.item.shaded) gradients_ = volume_.gradients();
    across_ = (p.width + tile - 1) / tile, down_ = (p.height + tile - 1) / tile;
    sort();
    parallel_for(
        size_t(across_) * size_t(down_), 1,
        [&](size_t begin, size_t end) {
          Scratch s;
          for (size_t t = begin; t < end; ++t) draw_tile(t, s, layer);
        },
        &input_.context);
    return layer;
  }

 private:
  struct Scratch {
    std::vector<Segment> found, sorted;
    std::array<uint32_t, size_t(tile) * tile + 1> first{};
    LitRay lit;
    RayLines columns, rows;
  };

  /// Tetrahedra that can be seen, from near to far by their nearest vertex, in the tiles of their shadows.
  void sort() {
    const TetMesh& mesh = *volume_.mesh;
    struct Seen {
      float depth;
      uint32_t tet;
    };
    constexpr size_t grain = 16384;
    std::vector<std::vector<Seen>> parts((mesh.size() + grain - 1) / grain);
    parallel_for(
        mesh.size(), grain,
        [&](size_t begin, size_t end) {
          for (size_t t = begin; t < end; ++t) {
            float lo = HUGE_VALF, hi = -HUGE_VALF, near = HUGE_VALF, far = -HUGE_VALF;
            for (uint32_t v : mesh.corners[t]) {
              const float* e = eye_[v];
              lo = std::min(lo, e[3]), hi = std::max(hi, e[3]), near = std::min(near, e[2]), far = std::max(far, e[2]);
            }
            if (volume_.by_cell) lo = hi = volume_.values[mesh.cell(t)];
            if (far >= eye_.near_depth() && near <= eye_.far_depth() && !medium_.clear(lo, hi))
              parts[begin / grain].push_back({near, uint32_t(t)});
          }
          std::sort(parts[begin / grain].begin(), parts[begin / grain].end(),
                    [](const Seen& a, const Seen& b) { return a.depth < b.depth || (a.depth == b.depth && a.tet < b.tet); });
        },
        &input_.context);
    // Merge in pairs: the same order for any number of threads.
    const auto before = [](const Seen& a, const Seen& b) { return a.depth < b.depth || (a.depth == b.depth && a.tet < b.tet); };
    for (size_t width = 1; width < parts.size(); width *= 2)
      parallel_for((parts.size() + 2 * width - 1) / (2 * width), 1, [&](size_t begin, size_t) {
        const size_t a = 2 * width * begin, b = a + width;
        if (b >= parts.size()) return;
        std::vector<Seen> both(parts[a].size() + parts[b].size());
        std::merge(parts[a].begin(), parts[a].end(), parts[b].begin(), parts[b].end(), both.begin(), before);
        parts[a] = std::move(both), parts[b] = {};
      });
    const std::vector<Seen> seen = parts.empty() ? std::vector<Seen>() : std::move(parts[0]);
    std::vector<TileBox> boxes(seen.size());
    parallel_for(seen.size(), grain, [&](size_t begin, size_t end) {
      for (size_t k = begin; k < end; ++k) boxes[k] = eye_.tiles(mesh.corners[seen[k].tet], tile, across_, down_);
    });
    bin_boxes(boxes, across_, down_, first_, places_);
    order_.resize(seen.size());
    for (size_t k = 0; k < seen.size(); ++k) order_[k] = seen[k].tet;
  }

  void draw_tile(size_t t, Scratch& s, Layer& layer) const {
    const int x0 = int(t % size_t(across_)) * tile, y0 = int(t / size_t(across_)) * tile;
    const int width = std::min(tile, input_.projection.width - x0), height = std::min(tile, input_.projection.height - y0);
    if (first_[t] == first_[t + 1]) return;
    for (int k = 0; k < tile; ++k) eye_.line(s.columns, k, x0 + k + 0.5, 0), eye_.line(s.rows, k, 0, y0 + k + 0.5);
    s.found.clear(), s.first.fill(0);
    for (size_t i = first_[t]; i < first_[t + 1]; ++i) cut(order_[places_[i]], width, height, s);
    for (size_t p = 0; p + 1 < s.first.size(); ++p) s.first[p + 1] += s.first[p];
    // By pixel; within one, nearly sorted already.
    s.sorted.resize(s.found.size());
    auto next = s.first;
    for (const Segment& g : s.found) {
      uint32_t k = next[g.pixel]++;
      for (; k > s.first[g.pixel] && before(g, s.sorted[k - 1]); --k) s.sorted[k] = s.sorted[k - 1];
      s.sorted[k] = g;
    }
    for (int row = 0; row < height; ++row) {
      if (gradients_)
        for (int x = 0; x < width; ++x) shade_pixel(x0 + x, y0 + row, row * tile + x, s, layer);
      else put_row(x0, y0 + row, row, width, s, layer);
    }
  }

  static bool before(const Segment& a, const Segment& b) {
    return a.enter < b.enter || (a.enter == b.enter && (a.leave < b.leave || (a.leave == b.leave && a.tet < b.tet)));
  }

  void cut(uint32_t tet, int width, int height, Scratch& s) const {
    const auto& v = volume_.mesh->corners[tet];
    ColumnTet c;
    float y[4][tile];
    int top = height, bottom = 0;
    for (size_t k = 0; k < 4; ++k) {
      const float* e = eye_[v[k]];
      c.z[k] = e[2], c.f[k] = volume_.by_cell ? volume_.values[volume_.mesh->cell(tet)] : e[3];
      for (int x = 0; x < tile; ++x) c.x[k][x] = (e[0] - s.columns.x0[x]) - s.columns.dx[x] * e[2];
      for (int r = 0; r < tile; ++r) y[k][r] = (e[1] - s.rows.y0[r]) - s.rows.dy[r] * e[2];
    }
    for (int r = 0; r < height; ++r)
      if (std::min(std::min(y[0][r], y[1][r]), std::min(y[2][r], y[3][r])) <= 0 &&
          std::max(std::max(y[0][r], y[1][r]), std::max(y[2][r], y[3][r])) >= 0)
        top = std::min(top, r), bottom = r + 1;
    const uint32_t columns = width >= 32 ? ~0u : (1u << width) - 1;
    RowCut out;
    for (int r = top; r < bottom; ++r) {
      const float yr[4] = {y[0][r], y[1][r], y[2][r], y[3][r]};
      for (uint32_t bits = cut_row(c, yr, out) & columns; bits; bits &= bits - 1) {
        const int x = std::countr_zero(bits), pixel = r * tile + x;
        if (!(out.leave[x] > out.enter[x])) continue;
        s.found.push_back({out.enter[x], out.leave[x], out.front[x], out.back[x], tet, uint8_t(pixel)});
        ++s.first[size_t(pixel) + 1];
      }
    }
  }

  /// Depths between which a pixel draws: the near plane, the opaque surface, the planes that clip.
  void limits(int x, int y, float& from, float& to) const {
    const Projection& p = input_.projection;
    const Projection::Ray ray = p.ray(x + 0.5, y + 0.5);
    const double first = dot(ray.origin - p.eye, p.forward), per_length = dot(ray.direction, p.forward);
    double a = p.near_plane, b = std::min(p.far_plane, double(input_.opaque.depth[size_t(y) * size_t(p.width) + size_t(x)]));
    for (const ClipPlane& plane : input_.item.clip) {
      const double d = dot(plane.normal, ray.direction), rest = plane.offset - dot(plane.normal, ray.origin);
      if (d > 0) b = std::min(b, first + rest / d * per_length);
      else if (d < 0) a = std::max(a, first + rest / d * per_length);
      else if (rest < 0) b = a;
    }
    from = float(a - eye_.middle_depth()), to = float(b - eye_.middle_depth());
  }

  /// The part of a segment that is between the limits and not drawn yet.
  static bool trim(Segment& g, float from, float to) {
    const float enter = std::max(g.enter, from), leave = std::min(g.leave, to);
    if (!(leave > enter)) return false;
    const float per = (g.back - g.front) / (g.leave - g.enter), front = g.front;
    if (enter > g.enter) g.front = front + (enter - g.enter) * per;
    if (leave < g.leave) g.back = front + (leave - g.enter) * per;
    g.enter = enter, g.leave = leave;
    return true;
  }

  void put_row(int x0, int y, int row, int width, Scratch& s, Layer& layer) const {
    SegmentPacket p;
    float from[tile], to[tile], length[tile];
    uint32_t next[tile], end[tile];
    size_t most = 0;
    for (int x = 0; x < tile; ++x) {
      p.r[x] = p.g[x] = p.b[x] = 0, p.pass[x] = 1;
      next[x] = end[x] = 0, from[x] = to[x] = 0;
      length[x] = eye_.length(s.columns, x, s.rows, row);
      if (x >= width) continue;
      limits(x0 + x, y, from[x], to[x]);
      next[x] = s.first[size_t(row * tile + x)], end[x] = s.first[size_t(row * tile + x) + 1];
      most = std::max<size_t>(most, end[x] - next[x]);
    }
    for (size_t k = 0; k < most; ++k) {
      for (int x = 0; x < tile; ++x) {
        p.length[x] = p.front[x] = p.back[x] = 0;
        if (next[x] == end[x]) continue;
        Segment g = s.sorted[next[x]++];
        if (!trim(g, from[x], to[x])) continue;
        p.front[x] = g.front, p.back[x] = g.back, p.length[x] = (g.leave - g.enter) * length[x], from[x] = g.leave;
      }
      put_segments(table_, p);
    }
    for (int x = 0; x < width; ++x) {
      float* out = &layer.rgba[4 * (size_t(y) * size_t(input_.projection.width) + size_t(x0 + x))];
      out[0] = p.r[x], out[1] = p.g[x], out[2] = p.b[x], out[3] = 1 - p.pass[x];
    }
  }

  void shade_pixel(int x, int y, int pixel, Scratch& s, Layer& layer) const {
    const Projection& p = input_.projection;
    const Projection::Ray ray = p.ray(x + 0.5, y + 0.5);
    const double first = dot(ray.origin - p.eye, p.forward), per_depth = 1 / dot(ray.direction, p.forward);
    s.lit.direction = Vec3f(ray.direction);
    seen_along(lamps_, ray.direction, s.lit.lights);
    s.lit.material = material_of(input_.item.light);
    const float edge = float(volume_.mesh->edge), per_scale = float(1 / std::max(0.002 * (volume_.range.hi - volume_.range.lo), 1e-30));
    const double tolerance = input_.item.sampling.within();
    const Look look{medium_, {tolerance, std::max(volume_.mesh->bounds.diagonal(), 1e-30), 0}, 0, &s.lit, per_scale, edge};
    ProjectedLight field(volume_, *gradients_);
    field.start(ray.origin, ray.direction, 0, 0);
    RayState state;
    float from, to;
    limits(x, y, from, to);
    for (uint32_t k = s.first[size_t(pixel)]; k < s.first[size_t(pixel) + 1]; ++k) {
      Segment g = s.sorted[k];
      if (!trim(g, from, to)) continue;
      from = g.leave;
      const auto t_of = [&](float z) { return (double(z) + eye_.middle_depth() - first) * per_depth; };
      const double t0 = t_of(g.enter), t1 = t_of(g.leave);
      const float third = (g.back - g.front) / 3;
      if (t1 > t0) composite(look, {t0, t1, {g.front, g.front + third, g.back - third, g.back}, g.tet}, field, state);
    }
    float* out = &layer.rgba[4 * (size_t(y) * size_t(p.width) + size_t(x))];
    out[0] = state.sum.r, out[1] = state.sum.g, out[2] = state.sum.b, out[3] = 1 - state.sum.transmittance;
  }

  const LayerInput& input_;
  CellVolume volume_;
  Medium medium_;
  TetMedium table_;
  EyeSpace eye_;
  std::vector<Lamp> lamps_;
  std::shared_ptr<const Plane<Vec3f>> gradients_;  // shaded only
  int across_ = 0, down_ = 0;
  std::vector<uint32_t> first_, places_, order_;
};

}  // namespace

Layer project_cells(const LayerInput& input) {
  if (input.item.mode != RayFunction::composite)
    fail_usage("cell projection draws emission and absorption only", "volume", "use method=ray for other ray functions");
  if (!input.item.detail.plain())
    fail_usage("cell projection supports opacity by one value only", "volume", "use method=ray for transfer functions of two values");
  return Projector(input).draw();
}

}  // namespace sg::volume
