// SPDX-License-Identifier: Apache-2.0
#include "render/volume/sources/cells/cell_source.h"

#include "render/volume/medium/cubic.h"
#include "render/volume/sources/cells/cell_value.h"
#include "render/volume/sources/cells/eye_space.h"
#include "render/volume/sources/cells/tet_walk.h"

namespace sg::volume {

namespace {

struct CellSource : RaySource {
  CellVolume volume;
  bool lit = false;  // gradients are asked for
  mutable std::once_flag once;
  mutable std::shared_ptr<const Plane<Vec3f>> gradients;

  const Plane<Vec3f>& vertex_gradients() const {
    std::call_once(once, [&] { gradients = volume.gradients(); });
    return *gradients;
  }
  std::unique_ptr<RayField> walker() const override;
};

class CellField : public RayField {
 public:
  explicit CellField(const CellSource& source) : source_(source), volume_(source.volume), walk_(source.volume), curve_(source.volume) {}

  void start(Vec3 origin, Vec3 direction, double from, double to) override {
    walk_.start(origin, direction, to);
    done_ = from, from_ = from, to_ = to;
    ready_.clear(), taken_ = 0, open_ = false;
    given_.clear();
  }

  size_t next(std::span<Stretch> out) override {
    size_t n = 0;
    while (n < out.size()) {
      if (taken_ < ready_.size()) {
        given_.emplace_back(ready_[taken_].from, ready_[taken_].cell);
        out[n++] = ready_[taken_++];
        continue;
      }
      ready_.clear(), taken_ = 0;
      TetWalk::Piece p;
      if (!walk_.next(p)) {
        if (!open_) break;
        close();
        continue;
      }
      add(p);
    }
    return n;
  }

  double entry() const override { return std::min(std::max(walk_.entry(), from_), to_); }

  Vec3f gradient(const Stretch& stretch, double t) override {
    const Plane<Vec3f>& g = source_.vertex_gradients();
    double w[4];
    const auto& v = volume_.mesh->corners[place(stretch, t, w)];
    Vec3f sum;
    for (size_t k = 0; k < 4; ++k) sum += g[v[k]] * float(w[k]);
    return sum;
  }

  float second(const Stretch& stretch, double t) override {
    if (volume_.seconds.empty()) return 0;
    double w[4], sum = 0;
    const size_t tet = place(stretch, t, w);
    if (volume_.second_by_cell) return volume_.seconds[volume_.mesh->cell(tet)];
    const auto& v = volume_.mesh->corners[tet];
    for (size_t k = 0; k < 4; ++k) sum += w[k] * double(volume_.seconds[v[k]]);
    return float(sum);
  }

 private:
  void add(const TetWalk::Piece& p) {
    const double from = std::max(p.from, done_), to = std::min(p.to, to_);
    if (!(to > from)) return;
    done_ = to;
    const TetMesh& mesh = *volume_.mesh;
    const uint32_t cell = volume_.by_cell ? mesh.cell(p.tet) : volume_.whole(p.tet);
    if (open_ && (cell != cell_ || from != cell_to_)) close();
    if (!volume_.by_cell && volume_.linear(p.tet)) {
      // Linear: straight from the ends of the tetrahedron, cut to what was asked for.
      const double per = p.to > p.from ? 1 / (p.to - p.from) : 0;
      const float f0 = from == p.from ? p.enter : float(p.enter + (p.leave - p.enter) * ((from - p.from) * per));
      const float f1 = to == p.to ? p.leave : float(p.enter + (p.leave - p.enter) * ((to - p.from) * per));
      if (source_.invisible(std::min(f0, f1), std::max(f0, f1))) return;
      ready_.push_back({from, to, {f0, f0 + (f1 - f0) / 3, f1 - (f1 - f0) / 3, f1}, p.tet});
      return;
    }
    if (!open_) open_ = true, cell_ = cell, cell_tet_ = p.tet, cell_from_ = from, bends_.clear();
    else if (source_.lit) bends_.push_back(from);
    cell_to_ = to;
  }

  /// The cell that was gathered from its tetrahedra.
  void close() {
    open_ = false;
    if (volume_.by_cell) {
      const float f = volume_.values[cell_];
      if (!source_.invisible(f, f)) ready_.push_back({cell_from_, cell_to_, {f, f, f, f}, cell_tet_});
    } else {
      float lowest, highest;
      curve_.open(cell_, lowest, highest);
      if (source_.invisible(lowest, highest)) return;
      curve_.add(walk_.origin(), walk_.direction(), cell_from_, cell_to_, cell_tet_, ready_);
      std::erase_if(ready_, [&](const Stretch& s) { return source_.invisible(s.lowest(), s.highest()); });
    }
    if (!bends_.empty()) cut_where_light_bends();
  }

  /// Gradients are straight within the tetrahedra and bend sharply between them.
  void cut_where_light_bends() {
    whole_.swap(ready_), ready_.clear();
    auto bend = bends_.begin();
    for (const Stretch& s : whole_) {
      double from = s.from;
      for (; bend != bends_.end() && *bend < s.to; ++bend)
        if (*bend > from) ready_.push_back(part_of(s, from, *bend)), from = *bend;
      ready_.push_back(from == s.from ? s : part_of(s, from, s.to));
    }
  }

  /// The tetrahedron of the stretch's cell that holds the place, and its weights there.
  size_t place(const Stretch& stretch, double t, double w[4]) const {
    size_t best = 0;
    if (!place_in_cell_of(stretch.cell, t, best, w)) {
      // Not a stretch of ours: the one that lay there.
      auto it = std::upper_bound(given_.begin(), given_.end(), t, [](double a, const auto& g) { return a < g.first; });
      if (it != given_.begin()) place_in_cell_of((it - 1)->second, t, best, w);
    }
    double sum = 0;
    for (int k = 0; k < 4; ++k) w[k] = std::max(w[k], 0.0), sum += w[k];
    for (int k = 0; k < 4; ++k) w[k] = sum > 0 ? w[k] / sum : 0.25;
    return best;
  }

  /// Walks from a tetrahedron towards the place; false when it lies outside of all that are met.
  bool place_in_cell_of(uint64_t tet, double t, size_t& best, double w[4]) const {
    const TetMesh& m = *volume_.mesh;
    const Vec3 x = walk_.origin() + walk_.direction() * t;
    best = tet;
    for (int step = 0; step < 256; ++step) {
      tet_weights(m, best, x, w);
      const int k = int(std::min_element(w, w + 4) - w);
      if (!(w[k] < -1e-9)) return w[k] == w[k];
      const int32_t next = m.links[best].next[k];
      if (next < 0) return w[k] > -1e-3;
      best = size_t(next);
    }
    return false;
  }

  const CellSource& source_;
  const CellVolume& volume_;
  TetWalk walk_;
  CellCurve curve_;
  double from_ = 0, done_ = 0, to_ = 0;
  std::vector<Stretch> ready_, whole_;
  std::vector<double> bends_;  // lit: where the ray goes from one of the cell's tetrahedra to another
  size_t taken_ = 0;
  std::vector<std::pair<double, uint64_t>> given_;  // where the stretches of this ray began, and their tetrahedra
  bool open_ = false;
  uint32_t cell_ = 0, cell_tet_ = 0;
  double cell_from_ = 0, cell_to_ = 0;
};

std::unique_ptr<RayField> CellSource::walker() const { return std::make_unique<CellField>(*this); }

}  // namespace

std::unique_ptr<RaySource> cell_source(const VolumeItem& item, Context& context) {
  auto source = std::make_unique<CellSource>();
  source->volume = make_cell_volume(item, context);
  source->lit = item.shaded || item.light.shadows > 0 || item.light.occlusion > 0 || item.light.style != LightStyle::none;
  source->base = source->volume.base;
  source->bounds = source->volume.mesh->bounds;
  source->edge = source->volume.mesh->edge > 0 ? source->volume.mesh->edge : 1;
  return source;
}

const CellVolume& cell_volume_of(const RaySource& source) { return static_cast<const CellSource&>(source).volume; }

}  // namespace sg::volume
