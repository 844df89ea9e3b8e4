// SPDX-License-Identifier: Apache-2.0
#include "render/volume/sources/bricks/brick_store.h"

#include <cmath>

#include "data/memory/memo.h"

namespace sg::volume {

namespace {

template <class T>
void read_corners(const std::byte* values, size_t at, const size_t step[3], float out[8]) {
  const T* p = reinterpret_cast<const T*>(values) + at;
  const size_t x = step[0], y = step[1], z = step[2];
  out[0] = float(p[0]), out[1] = float(p[x]), out[2] = float(p[y]), out[3] = float(p[y + x]);
  out[4] = float(p[z]), out[5] = float(p[z + x]), out[6] = float(p[z + y]), out[7] = float(p[z + y + x]);
}

// Along each axis, the four lines through the cell hold one sample more at both ends.
template <class T>
void read_differences(const std::byte* values, size_t at, const size_t step[3], const float place[3], float out[3]) {
  const T* p = reinterpret_cast<const T*>(values) + at;
  for (int a = 0; a < 3; ++a) {
    const int b = a == 0 ? 1 : 0, c = a == 2 ? 1 : 2;
    const size_t s = step[a];
    const float x = place[a], y = place[b], z = place[c];
    float line[4];
    for (int k = 0; k < 4; ++k) {
      const T* q = p + (k & 1 ? step[b] : 0) + (k & 2 ? step[c] : 0);
      const float v0 = float(*(q - s)), v1 = float(q[0]), v2 = float(q[s]), v3 = float(q[2 * s]);
      line[k] = (v2 - v0) + x * ((v3 - v2) - (v1 - v0));
    }
    const float low = line[0] + y * (line[1] - line[0]), high = line[2] + y * (line[3] - line[2]);
    out[a] = 0.5f * (low + z * (high - low));
  }
}

// By hand: the parallel conversion of arrays must not run inside of what others wait for.
Array narrowed(const Array& wide) {
  float* out = nullptr;
  Array r = Array::make<float>(wide.count(), 1, &out);
  dispatch(wide, [&](auto v) {
    for (size_t i = 0; i < v.count; ++i) out[i] = float(v[i]);
  });
  return r;
}

template <class T>
void find_ranges(const T* values, BrickData& b) {
  const auto nx = size_t(b.n[0]), ny = size_t(b.n[1]);
  size_t at = 0;
  for (int k = 0; k < b.cubes[2]; ++k)
    for (int j = 0; j < b.cubes[1]; ++j)
      for (int i = 0; i < b.cubes[0]; ++i) {
        const int lo[3] = {i * BrickData::small, j * BrickData::small, k * BrickData::small};
        int hi[3];
        for (int a = 0; a < 3; ++a) hi[a] = std::min(lo[a] + BrickData::small, b.n[size_t(a)] - 1);
        float least = HUGE_VALF, most = -HUGE_VALF;
        for (int z = lo[2]; z <= hi[2]; ++z)
          for (int y = lo[1]; y <= hi[1]; ++y) {
            const T* row = values + (size_t(z) * ny + size_t(y)) * nx;
            for (int x = lo[0]; x <= hi[0]; ++x) {
              const auto v = float(row[x]);
              least = v < least ? v : least;
              most = v > most ? v : most;
            }
          }
        b.cube[at++] = {least, most};
      }
}

template <class T>
void finish(BrickData& b) {
  b.corners = read_corners<T>, b.differences = read_differences<T>;
  find_ranges(b.values.view<T>().data, b);
}

}  // namespace

void level_places(const BrickedVolume& volume, size_t level, Vec3& scale, Vec3& shift) {
  const auto &fine = volume.levels[0], &l = volume.levels[level];
  const Vec3 moved = transpose(volume.direction) * (fine.origin - l.origin);
  for (int a = 0; a < 3; ++a) {
    // Places differ by whole halves as a rule; what is left of rounding would make cells of no width.
    scale[a] = 1.0 / double(l.coarseness[size_t(a)]);
    shift[a] = std::round(moved[a] / l.spacing[a] * 1048576) / 1048576;
  }
}

SampleBox samples_around(const BrickedVolume& volume, size_t level, Vec3 lo, Vec3 hi) {
  SampleBox box;
  Vec3 scale, shift;
  level_places(volume, level, scale, shift);
  for (size_t a = 0; a < 3; ++a) {
    const double last = double(volume.levels[level].dims[a]) - 1;
    const double first = std::clamp(std::floor(lo[int(a)] * scale[int(a)] + shift[int(a)]) - 1, 0.0, last);
    const double end = std::clamp(std::floor(hi[int(a)] * scale[int(a)] + shift[int(a)]) + 2, first, last);
    box.from[a] = size_t(first), box.count[a] = size_t(end - first) + 1;
  }
  return box;
}

Array read_samples(const BrickedVolume& volume, size_t level, const SampleBox& box) {
  std::byte* out = nullptr;
  Array values = Array::make_raw(volume.type, box.count[0] * box.count[1] * box.count[2], 1, &out);
  volume.read(level, box.from, box.count, out);
  switch (volume.type) {
    case ElementType::u8:
    case ElementType::i8:
    case ElementType::u16:
    case ElementType::i16:
    case ElementType::f32: return values;
    default: return narrowed(values);
  }
}

std::shared_ptr<const BrickData> load_brick(const BrickedVolume& volume, size_t level, Vec3 lo, Vec3 hi) {
  auto b = std::make_shared<BrickData>();
  const SampleBox box = samples_around(volume, level, lo, hi);
  for (size_t a = 0; a < 3; ++a) {
    b->n[a] = int(box.count[a]), b->first[a] = double(box.from[a]), b->most[a] = double(volume.levels[level].dims[a]) - 1;
    b->cubes[a] = std::max(1, (b->n[a] - 1 + BrickData::small - 1) / BrickData::small);
  }
  b->values = read_samples(volume, level, box);
  b->cube.resize(size_t(b->cubes[0]) * size_t(b->cubes[1]) * size_t(b->cubes[2]));
  switch (b->values.type()) {
    case ElementType::u8: finish<uint8_t>(*b); break;
    case ElementType::i8: finish<int8_t>(*b); break;
    case ElementType::u16: finish<uint16_t>(*b); break;
    case ElementType::i16: finish<int16_t>(*b); break;
    default: finish<float>(*b);
  }
  return b;
}

std::shared_ptr<BrickCaches> brick_caches(const Dataset& dataset) {
  constexpr char key[] = "bricks of a bricked volume";
  if (auto kept = dataset.memo().find<std::shared_ptr<BrickCaches>>(key)) return *kept;
  return *dataset.memo().keep(key, std::make_shared<BrickCaches>(), 0);
}

}  // namespace sg::volume
