// SPDX-License-Identifier: Apache-2.0
#include "filter/segment/distance_map.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "base/text/text.h"
#include "data/fields/known_looks.h"
#include "filter/segment/samples.h"

namespace sg {

namespace {

constexpr float nowhere = HUGE_VALF;
constexpr uint32_t nobody = UINT32_MAX;

// Along x the nearest set sample is the last one before or the first one after.
void along_row(const uint8_t* set, const std::vector<double>& x, size_t first, float* squared, uint32_t* nearest) {
  const size_t n = x.size();
  size_t before = SIZE_MAX;
  for (size_t i = 0; i < n; ++i) {
    if (set[i]) before = i;
    const double d = before == SIZE_MAX ? HUGE_VAL : x[i] - x[before];
    squared[i] = float(d * d);
    if (nearest) nearest[i] = before == SIZE_MAX ? nobody : uint32_t(first + before);
  }
  size_t after = SIZE_MAX;
  for (size_t i = n; i-- > 0;) {
    if (set[i]) after = i;
    if (after == SIZE_MAX) continue;
    const double d = x[after] - x[i];
    if (const float s = float(d * d); s < squared[i]) {
      squared[i] = s;
      if (nearest) nearest[i] = uint32_t(first + after);
    }
  }
}

// Lower envelope of the parabolas f[i] + (t - x[i])^2 over ascending x, read at each x.
class Envelope {
 public:
  explicit Envelope(const std::vector<double>& x) : x_(x), base_(x.size()), from_(x.size() + 1) {}
  void run(float* f, uint32_t* nearest, size_t stride) {
    const size_t n = x_.size();
    size_t count = 0;
    for (size_t i = 0; i < n; ++i) {
      const float value = f[i * stride];
      if (value == nowhere) continue;
      double start = -HUGE_VAL;
      while (count > 0) {
        const size_t b = base_[count - 1];
        const double h = double(value) + x_[i] * x_[i], g = double(height_[count - 1]) + x_[b] * x_[b];
        start = (h - g) / (2 * (x_[i] - x_[b]));
        if (start > from_[count - 1]) break;
        --count;
        start = -HUGE_VAL;
      }
      if (height_.size() <= count) height_.resize(n), owner_.resize(n);
      base_[count] = i, from_[count] = start, height_[count] = value, owner_[count] = nearest ? nearest[i * stride] : 0;
      ++count;
    }
    if (count == 0) return;
    from_[count] = HUGE_VAL;
    for (size_t i = 0, k = 0; i < n; ++i) {
      while (from_[k + 1] < x_[i]) ++k;
      const double d = x_[i] - x_[base_[k]];
      f[i * stride] = float(double(height_[k]) + d * d);
      if (nearest) nearest[i * stride] = owner_[k];
    }
  }

 private:
  const std::vector<double>& x_;
  std::vector<size_t> base_;
  std::vector<double> from_;
  std::vector<float> height_;
  std::vector<uint32_t> owner_;
};

}  // namespace

void distance_transform(const uint8_t* set, const std::array<std::vector<double>, 3>& places, float* squared, uint32_t* nearest,
                        const Context& context) {
  std::array<std::vector<double>, 3> at = places;
  for (auto& x : at)  // distances do not care which way an axis runs
    if (x.size() > 1 && x.front() > x.back())
      for (double& v : x) v = -v;
  const std::array<size_t, 3> d{at[0].size(), at[1].size(), at[2].size()};
  if (nearest && d[0] * d[1] * d[2] >= nobody) fail_usage("the grid has more than four billion samples", "distance_map", "crop it first");
  parallel_for(
      d[1] * d[2], 64,
      [&](size_t begin, size_t end) {
        for (size_t row = begin; row < end; ++row)
          along_row(set + row * d[0], at[0], row * d[0], squared + row * d[0], nearest ? nearest + row * d[0] : nullptr);
      },
      &context);
  // Columns along y, then z: 16 neighbouring ones are copied together so that memory is read in whole lines.
  constexpr size_t block = 16;
  for (size_t axis = 1; axis < 3; ++axis) {
    if (d[axis] == 1) continue;
    const size_t stride = axis == 1 ? d[0] : d[0] * d[1], other = axis == 1 ? d[2] : d[1], other_stride = axis == 1 ? d[0] * d[1] : d[0];
    const size_t blocks = (d[0] + block - 1) / block, n = d[axis];
    parallel_for(
        blocks * other, 4,
        [&](size_t begin, size_t end) {
          Envelope envelope(at[axis]);
          std::vector<float> f(n * block);
          std::vector<uint32_t> id(nearest ? n * block : 0);
          for (size_t b = begin; b < end; ++b) {
            const size_t first = (b % blocks) * block, width = std::min(block, d[0] - first), base = first + (b / blocks) * other_stride;
            for (size_t i = 0; i < n; ++i) {
              std::copy_n(squared + base + i * stride, width, f.data() + i * block);
              if (nearest) std::copy_n(nearest + base + i * stride, width, id.data() + i * block);
            }
            for (size_t c = 0; c < width; ++c) envelope.run(f.data() + c, nearest ? id.data() + c : nullptr, block);
            for (size_t i = 0; i < n; ++i) {
              std::copy_n(f.data() + i * block, width, squared + base + i * stride);
              if (nearest) std::copy_n(id.data() + i * block, width, nearest + base + i * stride);
            }
          }
        },
        &context);
  }
}

void describe(Schema& s, DistanceMapParams& p) {
  s("field", p.field, "Point or cell field that defines the set; default: the first label field, else the active scalar.")
      .takes(fields::scalars);
  s("min", p.min, "Smallest value in the set; default with max: no limit.").unit("@field");
  s("max", p.max, "Largest value in the set; default with min: no limit.").unit("@field");
  s("both_sides", p.both_sides, "Make distances inside the set negative.");
  s("name", p.name, "Name of the new field.");
}

DatasetPtr distance_map(const DatasetPtr& in, const DistanceMapParams& p, Context& context) {
  if (p.min && p.max && *p.min > *p.max)
    fail_usage(fmt::format("min {} is above max {}", short_number(*p.min), short_number(*p.max)), "distance_map", "swap them");
  const SampleImage image = sample_image(*in, p.field, "distance_map", true);
  const size_t n = image.count();
  const bool range = p.min || p.max;
  const double lo = p.min.value_or(-HUGE_VAL), hi = p.max.value_or(HUGE_VAL);
  Plane<uint8_t> inside(n), outside(n);
  dispatch(image.field.array, [&](auto v) {
    parallel_for(n, 1 << 16, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        const double x = double(v[i]);
        const bool known = x == x && !image.hidden(i), in_set = range ? x >= lo && x <= hi : x != 0;
        inside[i] = known && in_set, outside[i] = known && !in_set;
      }
    });
  });
  float* distance = nullptr;
  Field out{p.name, image.field.association, Array::make<float>(n, 1, &distance), "", Role::none};
  distance_transform(inside.data(), image.at, distance, nullptr, context);
  Plane<float> other(p.both_sides ? n : 0);
  if (p.both_sides) distance_transform(outside.data(), image.at, other.data(), nullptr, context);
  parallel_for(n, 1 << 16, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i)
      distance[i] = !inside[i] && !outside[i] ? NAN : p.both_sides && inside[i] ? -std::sqrt(other[i]) : std::sqrt(distance[i]);
  });
  if (std::none_of(inside.begin(), inside.end(), [](uint8_t b) { return b != 0; }))
    context.warn("distance_map: the set is empty, all distances are infinite");
  return with_result(in, std::move(out));
}

}  // namespace sg
