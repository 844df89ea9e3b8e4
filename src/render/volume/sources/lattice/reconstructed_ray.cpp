// SPDX-License-Identifier: Apache-2.0
#include "render/volume/sources/lattice/reconstructed_ray.h"

#include <fmt/core.h>

#include <cmath>

#include "render/volume/sources/lattice/box_walk.h"
#include "render/volume/sources/lattice/reconstruct.h"

namespace sg::volume {

namespace {

/// Chebyshev-Lobatto points of degree 9 in [0, 1]; numbers 0, 3, 6 and 9 are those of degree 3: 0, 1/4, 3/4, 1.
struct Places {
  float at[places];
  float cubic[places][4];         // values at all places of the cubic through those four
  float half[2][places][places];  // values at the places of each half of the polynomial through all

  Places() {
    double x[places];
    for (int i = 0; i < places; ++i) x[i] = 0.5 * (1 - std::cos(M_PI * i / (places - 1)));
    x[0] = 0, x[3] = 0.25, x[6] = 0.75, x[9] = 1;
    const double four[4] = {0, 0.25, 0.75, 1};
    const auto lagrange = [](const double* nodes, int n, int i, double at) {
      double l = 1;
      for (int j = 0; j < n; ++j)
        if (j != i) l *= (at - nodes[j]) / (nodes[i] - nodes[j]);
      return l;
    };
    for (int i = 0; i < places; ++i) {
      at[i] = float(x[i]);
      for (int j = 0; j < 4; ++j) cubic[i][j] = float(lagrange(four, 4, j, x[i]));
      for (int j = 0; j < places; ++j) {
        half[0][i][j] = float(lagrange(x, places, j, 0.5 * x[i]));
        half[1][i][j] = float(lagrange(x, places, j, 0.5 + 0.5 * x[i]));
      }
    }
  }
};
const Places& the_places() {
  static const Places p;
  return p;
}
constexpr float lebesgue = 2.4f;
constexpr int most_halvings = 6;

struct Shared {
  std::shared_ptr<const Volume> volume;
  std::shared_ptr<const Reconstruction> field;
  TapPolynomials taps;
  GradientKind gradient;
  float error;
  std::vector<float> along[3];  // q of the samples on uneven axes, as the kernel wants them
};

class ReconstructedRay final : public RayField {
 public:
  ReconstructedRay(std::shared_ptr<const Shared> shared, const Invisible& invisible)
      : shared_(std::move(shared)),
        v_(*shared_->volume),
        r_(*shared_->field),
        invisible_(invisible),
        walk_(v_),
        radius_(traits(r_.kernel).radius),
        block_(size_t(8 * radius_ * radius_ * radius_)),
        wide_(size_t(8 * (radius_ + 1) * (radius_ + 1) * (radius_ + 1))) {}

  void start(Vec3 origin, Vec3 direction, double from, double to) override {
    walk_.start(origin, direction, from, to);
    brick_ = size_t(-1), pending_.clear(), given_ = 0;
  }

  size_t next(std::span<Stretch> out) override {
    size_t count = 0;
    for (;;) {
      while (given_ < pending_.size() && count < out.size()) out[count++] = pending_[given_++];
      if (count == out.size() || walk_.done()) return count;
      pending_.clear(), given_ = 0;
      if (walk_.to() > walk_.from() && !empty()) emit();
      walk_.advance();
    }
  }

  double entry() const override { return walk_.course_of_ray().enter; }

  Vec3f gradient(const Stretch&, double t) override {
    const int taps = 2 * (radius_ + 1);
    double slope[3][most_taps + 2], across[3][most_taps + 2], length[3];
    long cell[3];
    for (int a = 0; a < 3; ++a) {
      const double q = std::clamp(walk_.place(a, t), walk_.sample(a, 0), walk_.sample(a, long(v_.voxels.dims[size_t(a)]) - 1));
      cell[a] = walk_.clamped_cell(a, walk_.box_at(a, q));
      gradient_rows(r_.kernel, shared_->gradient, walk_.fraction(a, cell[a], q), slope[a], across[a]);
      length[a] = length_over(a, cell[a], slope[a]);
    }
    if (cell[0] != wide_cell_[0] || cell[1] != wide_cell_[1] || cell[2] != wide_cell_[2]) {
      std::copy(cell, cell + 3, wide_cell_);
      read_block(r_, v_.voxels.dims, cell, radius_ + 1, wide_.data());
    }
    Vec3 change{0, 0, 0};
    const float* p = wide_.data();
    for (int k = 0; k < taps; ++k) {
      Vec3 plane{0, 0, 0};
      for (int j = 0; j < taps; ++j) {
        double along = 0, mean = 0;
        for (int i = 0; i < taps; ++i, ++p) along += slope[0][i] * double(*p), mean += across[0][i] * double(*p);
        plane += Vec3{across[1][j] * along, slope[1][j] * mean, across[1][j] * mean};
      }
      change += Vec3{across[2][k] * plane.x, across[2][k] * plane.y, slope[2][k] * plane.z};
    }
    Vec3 world{0, 0, 0};
    for (int r = 0; r < 3; ++r)
      for (int a = 0; a < 3; ++a) world[r] += v_.to_q.m[a][r] * (length[a] > 0 ? change[a] / length[a] : 0);
    return Vec3f(world);
  }

 private:
  /// Length in q for which a row of a derivative stands: differences take the same of the places, so that fields that rise evenly have
  /// their slope on uneven axes too; the derivative of the kernel is per cell.
  double length_over(int a, long cell, const double* slope) const {
    if (v_.affine) return 1;
    if (shared_->gradient == GradientKind::analytic) return walk_.sample(a, cell + 1) - walk_.sample(a, cell);
    double sum = 0;
    bool any = false;
    for (int m = 0; m < 2 * (radius_ + 1); ++m) sum += slope[m] * reflected(a, cell - radius_ + m), any = any || slope[m] != 0;
    return any ? sum : 0;
  }
  double reflected(int a, long i) const {
    const long last = long(v_.voxels.dims[size_t(a)]) - 1;
    if (i < 0) return 2 * walk_.sample(a, 0) - reflected(a, -i);
    if (i > last) return 2 * walk_.sample(a, last) - reflected(a, 2 * last - i);
    return double(shared_->along[a][size_t(i)]);
  }

  /// Whether nothing is drawn in the brick of this box.
  bool empty() {
    size_t at[3];
    for (int a = 0; a < 3; ++a) at[a] = size_t(walk_.cell(a)) >> MinMaxBricks::shift;
    const size_t brick = r_.bricks.id(at[0], at[1], at[2]);
    if (brick != brick_) {
      brick_ = brick;
      const MinMaxBricks::Range range = r_.bricks.ranges[brick];
      empty_ = range.empty() || invisible_(range.lo - shared_->error, range.hi + shared_->error);
    }
    return empty_;
  }

  size_t sample_id(const long cell[3], int corner) const {
    return size_t(cell[0] + (corner & 1)) +
           v_.voxels.dims[0] * (size_t(cell[1] + (corner >> 1 & 1)) + v_.voxels.dims[1] * size_t(cell[2] + (corner >> 2)));
  }

  void emit() {
    long cell[3];
    for (int a = 0; a < 3; ++a) cell[a] = walk_.cell(a);
    if (!v_.hidden().empty() &&
        v_.hidden()[size_t(cell[0]) + (v_.voxels.dims[0] - 1) * (size_t(cell[1]) + (v_.voxels.dims[1] - 1) * size_t(cell[2]))])
      return;
    bool holes = false;
    if (!r_.missing.empty())
      for (int c = 0; c < 8; ++c) holes = holes || r_.missing[sample_id(cell, c)];
    const bool nearest = r_.kernel == Kernel::nearest;
    if (holes && !v_.dual && !nearest) return;
    if (holes || nearest) return emit_by_voxels(cell, nearest);
    fit(cell, walk_.from(), walk_.to());
  }

  /// The parts of the cell that lie in the voxels of its corners.
  void emit_by_voxels(const long cell[3], bool nearest) {
    double cut[5] = {walk_.from()};
    int n = 1;
    for (int a = 0; a < 3; ++a)
      if (const double t = walk_.middle(a, cell[a]); t > walk_.from() && t < walk_.to()) cut[n++] = t;
    std::sort(cut, cut + n);
    cut[n] = walk_.to();
    for (int p = 0; p < n; ++p) {
      if (!(cut[p + 1] > cut[p])) continue;
      int owner = 0;
      for (int a = 0; a < 3; ++a)
        if (walk_.fraction(a, cell[a], walk_.place(a, 0.5 * (cut[p] + cut[p + 1]))) >= 0.5) owner += 1 << a;
      if (!r_.missing.empty() && r_.missing[sample_id(cell, owner)]) continue;
      if (!nearest) {
        fit(cell, cut[p], cut[p + 1]);
        continue;
      }
      load(cell);
      const float value = block_[size_t(owner)];  // radius 1: the block is the cell
      pending_.push_back({cut[p], cut[p + 1], {value, value, value, value}});
    }
  }

  void load(const long cell[3]) {
    if (cell[0] == cell_[0] && cell[1] == cell_[1] && cell[2] == cell_[2]) return;
    std::copy(cell, cell + 3, cell_);
    read_block(r_, v_.voxels.dims, cell, radius_, block_.data());
  }

  void fit(const long cell[3], double from, double to) {
    load(cell);
    const int taps = 2 * radius_;
    alignas(32) float w[3][most_taps * lanes];
    for (int a = 0; a < 3; ++a) {
      // Clamped or not, the place goes evenly from one end to the other: the outer half cells are boxes of their own.
      const float f0 = float(walk_.fraction(a, cell[a], walk_.place(a, from))), f1 = float(walk_.fraction(a, cell[a], walk_.place(a, to)));
      float f[lanes];
      for (int p = 0; p < lanes; ++p) f[p] = p < places ? f0 + the_places().at[p] * (f1 - f0) : f0;
      shared_->taps.at(f, w[a]);
    }
    alignas(32) float value[lanes] = {};
    const float* s = block_.data();
    for (int k = 0; k < taps; ++k) {
      alignas(32) float plane[lanes] = {};
      for (int j = 0; j < taps; ++j) {
        alignas(32) float row[lanes] = {};
        for (int i = 0; i < taps; ++i, ++s)
          for (int p = 0; p < lanes; ++p) row[p] += *s * w[0][i * lanes + p];
        for (int p = 0; p < lanes; ++p) plane[p] += row[p] * w[1][j * lanes + p];
      }
      for (int p = 0; p < lanes; ++p) value[p] += plane[p] * w[2][k * lanes + p];
    }
    put(from, to, value, 0);
  }

  /// One cubic, or both halves by themselves.
  void put(double from, double to, const float* value, int halvings) {
    const Places& at = the_places();
    float off = 0;
    for (int i = 0; i < places; ++i) {
      const float c = at.cubic[i][0] * value[0] + at.cubic[i][1] * value[3] + at.cubic[i][2] * value[6] + at.cubic[i][3] * value[9];
      off = std::max(off, std::abs(c - value[i]));
    }
    const double middle = 0.5 * (from + to);
    if (off * lebesgue <= shared_->error || halvings == most_halvings || !(middle > from && middle < to)) {
      Stretch s{from, to, {}};
      const float a = 64 * value[3] - 27 * value[0] - value[9], b = 64 * value[6] - value[0] - 27 * value[9];
      s.b[0] = value[0], s.b[1] = (3 * a - b) * (1.0f / 72), s.b[2] = (3 * b - a) * (1.0f / 72), s.b[3] = value[9];
      pending_.push_back(s);
      return;
    }
    for (int h = 0; h < 2; ++h) {
      float part[places];
      for (int i = 0; i < places; ++i) {
        part[i] = 0;
        for (int j = 0; j < places; ++j) part[i] += at.half[h][i][j] * value[j];
      }
      put(h == 0 ? from : middle, h == 0 ? middle : to, part, halvings + 1);
    }
  }

  std::shared_ptr<const Shared> shared_;
  const Volume& v_;
  const Reconstruction& r_;
  Invisible invisible_;
  BoxWalk walk_;
  int radius_;
  std::vector<float> block_, wide_;
  long cell_[3] = {-9, -9, -9}, wide_cell_[3] = {-9, -9, -9};
  size_t brick_ = size_t(-1);
  bool empty_ = false;
  std::vector<Stretch> pending_;
  size_t given_ = 0;
};

class ReconstructedSource final : public RaySource {
 public:
  explicit ReconstructedSource(std::shared_ptr<const Shared> shared) : shared_(std::move(shared)) {
    const Volume& v = *shared_->volume;
    base = v.base, bounds = v.bounds, edge = v.edge;
  }
  std::unique_ptr<RayField> walker() const override { return std::make_unique<ReconstructedRay>(shared_, invisible); }

 private:
  std::shared_ptr<const Shared> shared_;
};

}  // namespace

bool wants_reconstruction(const VolumeSampling& sampling) {
  return sampling.kernel != Kernel::linear || sampling.gradient != GradientKind::central;
}

std::unique_ptr<RaySource> reconstructed_source(std::shared_ptr<const Volume> volume, const VolumeSampling& sampling, Memo* memo,
                                                Range* reach) {
  const Kernel kernel = sampling.kernel;
  const GradientKind gradient = sampling.gradient;
  std::shared_ptr<const Reconstruction> field;
  // The samples are kept in the same memo, so that their address tells them.
  const std::string name =
      fmt::format("volume reconstruction: {} {}", word_of(sampling.kernel), static_cast<const void*>(volume->samples.get()));
  if (memo) field = memo->find<Reconstruction>(name);
  if (!field) {
    Reconstruction made = reconstruct(*volume, kernel);
    const size_t own = made.samples.raw() == volume->voxels.array.raw() ? made.bytes() - made.samples.bytes() : made.bytes();
    field = memo ? memo->keep(name, std::move(made), own) : std::make_shared<const Reconstruction>(std::move(made));
  }
  if (reach) *reach = {field->lo, field->hi};
  const double range = volume->samples->lo < volume->samples->hi ? volume->samples->hi - volume->samples->lo : 0;
  // Below some units in the last place there is nothing to gain.
  const double rounding = 1e-6 * std::max(std::abs(volume->samples->lo), std::abs(volume->samples->hi));
  const double error = std::max(sampling.within() / 128 * range, std::isfinite(rounding) ? rounding : 0);
  Shared shared{volume, std::move(field), TapPolynomials(kernel), gradient, float(error), {}};
  for (int a = 0; a < 3 && !volume->affine; ++a) {
    shared.along[a].assign(volume->coordinates[a].begin(), volume->coordinates[a].end());
    if (traits(kernel).prefilter) bspline_coefficients(shared.along[a].data(), {shared.along[a].size(), 1, 1});
  }
  return std::make_unique<ReconstructedSource>(std::make_shared<const Shared>(std::move(shared)));
}

}  // namespace sg::volume
