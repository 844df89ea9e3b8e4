// SPDX-License-Identifier: Apache-2.0
#include "render/volume/sources/bricks/brick_lattice.h"

#include <cmath>
#include <cstring>

#include "index/brick_row.h"
#include "render/volume/sources/bricks/brick_store.h"

namespace sg::volume {

namespace {

// As fine_bricks(), in this thread alone.
FineBricks ranges_of(const Array& values, const std::array<size_t, 3>& dims) {
  FineBricks r;
  for (size_t a = 0; a < 3; ++a) r.dims[a] = (dims[a] - 2) / FineBricks::edge + 1;
  r.ranges.resize(r.dims[0] * r.dims[1] * r.dims[2]);
  dispatch(values, [&](auto view) {
    using T = std::remove_cvref_t<decltype(view.data[0])>;
    std::vector<T> lo, hi;
    for (size_t row = 0; row < r.dims[1] * r.dims[2]; ++row)
      brick_row(view.data, dims, row % r.dims[1] * FineBricks::edge, row / r.dims[1] * FineBricks::edge, lo, hi, FineBricks::edge,
                &r.ranges[row * r.dims[0]], r.dims[0]);
  });
  return r;
}

// The only layer of an axis twice.
Array doubled(const Array& in, const std::array<size_t, 3>& from, const std::array<size_t, 3>& to) {
  std::byte* out = nullptr;
  Array r = Array::make_raw(in.type(), to[0] * to[1] * to[2], 1, &out);
  const size_t size = element_size(in.type());
  for (size_t k = 0; k < to[2]; ++k)
    for (size_t j = 0; j < to[1]; ++j)
      for (size_t i = 0; i < to[0]; ++i) {
        const size_t at = std::min(i, from[0] - 1) + from[0] * (std::min(j, from[1] - 1) + from[1] * std::min(k, from[2] - 1));
        std::memcpy(out + (i + to[0] * (j + to[1] * k)) * size, in.raw() + at * size, size);
      }
  return r;
}

// Where the samples of one level along an axis lie between those of another.
struct Between {
  std::vector<size_t> cell;
  std::vector<float> fraction;
};
Between between(size_t from, size_t count, double scale, double shift, double to_scale, double to_shift, const SampleBox& to, size_t axis) {
  Between b;
  const double last = double(to.count[axis]) - 1;
  for (size_t i = 0; i < count; ++i) {
    const double u = (double(from + i) - shift) / scale;
    const double v = std::clamp(u * to_scale + to_shift - double(to.from[axis]), 0.0, last),
                 cell = std::min(std::floor(v), std::max(0.0, last - 1));
    b.cell.push_back(size_t(cell)), b.fraction.push_back(float(v - cell));
  }
  return b;
}

// fine + share * (coarse - fine) at the samples of the fine level.
Array blended(const BrickedVolume& volume, const BrickNode& leaf, Vec3 lo, Vec3 hi, const SampleBox& box, const Array& fine) {
  Vec3 scale, shift, to_scale, to_shift;
  level_places(volume, leaf.level, scale, shift), level_places(volume, leaf.level + 1u, to_scale, to_shift);
  Vec3 first, last;  // of the samples, in fine coordinates
  for (int a = 0; a < 3; ++a) {
    first[a] = (double(box.from[size_t(a)]) - shift[a]) / scale[a];
    last[a] = (double(box.from[size_t(a)] + box.count[size_t(a)] - 1) - shift[a]) / scale[a];
  }
  const SampleBox around = samples_around(volume, leaf.level + 1u, first, last);
  const Array coarse = read_samples(volume, leaf.level + 1u, around);
  Between at[3];
  for (size_t a = 0; a < 3; ++a)
    at[a] = between(box.from[a], box.count[a], scale[int(a)], shift[int(a)], to_scale[int(a)], to_shift[int(a)], around, a);
  float* out = nullptr;
  Array mixed = Array::make<float>(fine.count(), 1, &out);
  const size_t row = around.count[0], layer = row * around.count[1];
  const size_t next[3] = {around.count[0] > 1 ? size_t(1) : 0, around.count[1] > 1 ? row : 0, around.count[2] > 1 ? layer : 0};
  std::vector<float> line(row);
  dispatch(fine, [&](auto f) {
    using T = std::remove_cvref_t<decltype(f.data[0])>;
    const T* c = coarse.view<T>().data;
    for (size_t k = 0, n = 0; k < box.count[2]; ++k)
      for (size_t j = 0; j < box.count[1]; ++j) {
        const T* p = c + at[2].cell[k] * layer + at[1].cell[j] * row;
        const float y = at[1].fraction[j], z = at[2].fraction[k];
        for (size_t i = 0; i < row; ++i, ++p) {
          const float a = float(p[0]) + y * (float(p[next[1]]) - float(p[0]));
          const float b = float(p[next[2]]) + y * (float(p[next[1] + next[2]]) - float(p[next[2]]));
          line[i] = a + z * (b - a);
        }
        const double uy = (double(box.from[1] + j) - shift.y) / scale.y, uz = (double(box.from[2] + k) - shift.z) / scale.z;
        // Linear along the row.
        const double u0 = lo.x, u1 = hi.x;
        const auto w0 = float(coarser_share(leaf, lo, hi, {u0, uy, uz})), w1 = float(coarser_share(leaf, lo, hi, {u1, uy, uz}));
        for (size_t i = 0; i < box.count[0]; ++i, ++n) {
          const double u = (double(box.from[0] + i) - shift.x) / scale.x;
          const float w = w0 + float(std::clamp((u - u0) / std::max(u1 - u0, 1e-300), 0.0, 1.0)) * (w1 - w0);
          const float* l = &line[at[0].cell[i]];
          const float other = l[0] + at[0].fraction[i] * (l[next[0]] - l[0]);
          const auto own = float(f.data[n]);
          out[n] = w > 0 ? own + w * (other - own) : own;
        }
      }
  });
  return mixed;
}

}  // namespace

std::shared_ptr<const BrickLattice> load_lattice(const BrickedVolume& volume, const BrickTree& tree, const BrickNode& leaf) {
  auto b = std::make_shared<BrickLattice>();
  Vec3 lo, hi;
  tree.box(leaf, lo, hi);
  const SampleBox box = samples_around(volume, leaf.level, lo, hi);
  Array values = read_samples(volume, leaf.level, box);
  if (leaf.blend) values = blended(volume, leaf, lo, hi, box, values);
  std::array<size_t, 3> dims{};
  for (size_t a = 0; a < 3; ++a) dims[a] = std::max<size_t>(box.count[a], 2), b->first[int(a)] = double(box.from[a]);
  if (dims != box.count) values = doubled(values, box.count, dims);
  b->samples.voxels = {values, dims};
  b->samples.fine = ranges_of(values, dims);
  return b;
}

BrickSpace space_of(const FineBricks& fine, const Invisible& invisible) {
  BrickSpace s;
  constexpr uint8_t far = 15;
  s.distance.resize(fine.size() + 3);
  std::fill(s.distance.begin(), s.distance.end(), far);
  s.nothing = true;
  for (size_t i = 0; i < fine.size(); ++i) {
    const MinMaxBricks::Range& r = fine.ranges[i];
    const bool drawn = !r.empty() && !invisible(r.lo, r.hi);
    if (drawn) s.distance[i] = 0, s.nothing = false;
    else s.any_empty = true;
  }
  if (s.nothing || !s.any_empty) return s;
  // Two passes with half of the neighbours each: exact for the largest of the distances along the axes.
  const auto nx = ptrdiff_t(fine.dims[0]), ny = ptrdiff_t(fine.dims[1]), nz = ptrdiff_t(fine.dims[2]);
  const auto pass = [&](ptrdiff_t sign) {
    for (ptrdiff_t n = 0; n < nx * ny * nz; ++n) {
      const ptrdiff_t i = sign > 0 ? n : nx * ny * nz - 1 - n;
      if (s.distance[size_t(i)] == 0) continue;
      const ptrdiff_t x = i % nx, y = i / nx % ny, z = i / nx / ny;
      int least = s.distance[size_t(i)];
      for (ptrdiff_t d = 0; d < 13; ++d) {  // those before it
        const ptrdiff_t a = x + sign * (d % 3 - 1), b = y + sign * (d / 3 % 3 - 1), c = z + sign * (d / 9 - 1);
        if (a >= 0 && a < nx && b >= 0 && b < ny && c >= 0 && c < nz)
          least = std::min(least, s.distance[size_t(a + nx * (b + ny * c))] + 1);
      }
      s.distance[size_t(i)] = uint8_t(std::min<int>(least, far));
    }
  };
  pass(1), pass(-1);
  return s;
}

}  // namespace sg::volume
