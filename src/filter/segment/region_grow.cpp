// SPDX-License-Identifier: Apache-2.0
#include "filter/segment/region_grow.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "base/text/text.h"
#include "data/fields/known_looks.h"
#include "filter/segment/samples.h"

namespace sg {

void describe(Schema& s, RegionGrowParams& p) {
  s("field", p.field, "Field of values; default: the active scalar.").takes(fields::scalars);
  s("seeds", p.seeds, "Seed points of the regions: x,y,z of each.").unit("length");
  s("min", p.min, "Smallest value in the region.").unit("@field");
  s("max", p.max, "Largest value in the region.").unit("@field");
  s("confidence", p.confidence, "Without min and max: half width of the range, in standard deviations about the region's mean.").positive();
  s("rounds", p.rounds, "Without min and max: number of times the range is re-estimated.").range(0, 100);
  s("connectivity", p.connectivity, "Neighbours in space: 6 (faces), 18 (and edges) or 26 (and corners).").range(6, 26);
  s("name", p.name, "Name of the label field.");
}

namespace {

// The sample nearest to a place; false when it lies more than half a step outside.
bool nearest_sample(const Dataset& in, const SampleImage& image, Vec3 place, std::array<size_t, 3>& at) {
  if (const auto* g = in.as<UniformGrid>()) place = inverse(g->direction) * (place - g->origin);
  for (size_t a = 0; a < 3; ++a) {
    const auto& x = image.at[a];
    size_t best = 0;
    for (size_t i = 1; i < x.size(); ++i)
      if (std::abs(x[i] - place[int(a)]) < std::abs(x[best] - place[int(a)])) best = i;
    const double step = x.size() == 1 ? HUGE_VAL : best + 1 < x.size() ? std::abs(x[best + 1] - x[best]) : std::abs(x[best] - x[best - 1]);
    if (!(std::abs(x[best] - place[int(a)]) <= step / 2 * (1 + 1e-9)) && x.size() > 1) return false;
    at[a] = best;
  }
  return true;
}

struct Grower {
  const SampleImage& image;
  const Context& context;
  std::vector<std::array<int, 3>> steps;

  // The region as a mask; breadth first from the seeds.
  template <class T>
  std::vector<size_t> grow(const View<T>& v, const std::vector<size_t>& seeds, double lo, double hi, std::vector<uint8_t>& mask) const {
    const auto d = image.dims;
    std::fill(mask.begin(), mask.end(), uint8_t(0));
    std::vector<size_t> region;
    const auto visit = [&](size_t i) {
      if (mask[i] || image.hidden(i)) return;
      const double x = double(v[i]);
      if (x >= lo && x <= hi) mask[i] = 1, region.push_back(i);
    };
    for (const size_t s : seeds) visit(s);
    for (size_t at = 0; at < region.size(); ++at) {
      if (at % (1 << 20) == 0) context.check();
      const size_t i = region[at], x = i % d[0], y = i / d[0] % d[1], z = i / (d[0] * d[1]);
      for (const auto& s : steps) {
        const size_t nx = x + size_t(s[0]), ny = y + size_t(s[1]), nz = z + size_t(s[2]);  // wraps below 0
        if (nx < d[0] && ny < d[1] && nz < d[2]) visit(nx + d[0] * (ny + d[1] * nz));
      }
    }
    return region;
  }
};

// mean -+ width deviations, summed in the order of the list.
template <class T>
Range confidence_range(const View<T>& v, const std::vector<size_t>& ids, double width) {
  double mean = 0, var = 0;
  for (const size_t i : ids) mean += double(v[i]);
  mean /= double(ids.size());
  for (const size_t i : ids) var += (double(v[i]) - mean) * (double(v[i]) - mean);
  const double d = width * std::sqrt(var / double(ids.size()));
  return {mean - d, mean + d};
}

std::vector<size_t> around(const SampleImage& image, const std::vector<size_t>& seeds) {
  const auto d = image.dims;
  std::vector<size_t> ids;
  for (const size_t s : seeds) {
    const size_t x = s % d[0], y = s / d[0] % d[1], z = s / (d[0] * d[1]);
    for (size_t k = z - (z > 0); k <= std::min(z + 1, d[2] - 1); ++k)
      for (size_t j = y - (y > 0); j <= std::min(y + 1, d[1] - 1); ++j)
        for (size_t i = x - (x > 0); i <= std::min(x + 1, d[0] - 1); ++i)
          if (const size_t id = i + d[0] * (j + d[1] * k); !image.hidden(id) && std::isfinite(image.field.array.get(id))) ids.push_back(id);
  }
  return ids;
}

}  // namespace

DatasetPtr region_grow(const DatasetPtr& in, const RegionGrowParams& p, Context& context) {
  if (p.seeds.empty() || p.seeds.size() % 3 != 0)
    fail_usage(p.seeds.empty() ? std::string("no seed is given") : fmt::format("{} numbers do not make a list of points", p.seeds.size()),
               "region_grow seeds", "give x,y,z of each seed");
  if (p.connectivity != 6 && p.connectivity != 18 && p.connectivity != 26)
    fail_usage(fmt::format("{} is not a valid connectivity", p.connectivity), "region_grow connectivity", "give 6, 18 or 26");
  if (p.min && p.max && *p.min > *p.max)
    fail_usage(fmt::format("min {} is above max {}", short_number(*p.min), short_number(*p.max)), "region_grow", "swap them");
  const SampleImage image = sample_image(*in, p.field, "region_grow");
  const size_t n = image.count();
  std::vector<size_t> seeds;
  for (size_t s = 0; s < p.seeds.size(); s += 3) {
    const Vec3 place{p.seeds[s], p.seeds[s + 1], p.seeds[s + 2]};
    const std::string where = fmt::format("seed {},{},{}", short_number(place.x), short_number(place.y), short_number(place.z));
    std::array<size_t, 3> at{};
    if (!nearest_sample(*in, image, place, at))
      fail_usage(where + " lies outside the grid", "region_grow", "info shows the bounds of the grid");
    const size_t id = at[0] + image.dims[0] * (at[1] + image.dims[1] * at[2]);
    const double x = image.field.array.get(id);
    if (image.hidden(id) || std::isnan(x)) fail_usage(where + " lies where there is no value", "region_grow");
    if ((p.min && x < *p.min) || (p.max && x > *p.max))
      fail_usage(fmt::format("{} has the value {}, outside the range", where, short_number(x)), "region_grow",
                 "widen min and max, or move the seed");
    seeds.push_back(id);
  }
  Grower grower{image, context, neighbors_before(p.connectivity)};
  for (size_t s = grower.steps.size(); s-- > 0;) grower.steps.push_back({-grower.steps[s][0], -grower.steps[s][1], -grower.steps[s][2]});

  std::vector<uint8_t> mask(n);
  Range range{p.min.value_or(-HUGE_VAL), p.max.value_or(HUGE_VAL)};
  size_t size = 0;
  dispatch(image.field.array, [&](auto v) {
    const bool given = p.min || p.max;
    if (!given) range = confidence_range(v, around(image, seeds), p.confidence);
    std::vector<size_t> region = grower.grow(v, seeds, range.lo, range.hi, mask);
    for (int r = 0; r < p.rounds && !given && !region.empty(); ++r) {
      const Range next = confidence_range(v, region, p.confidence);
      if (next == range) break;
      range = next;
      region = grower.grow(v, seeds, range.lo, range.hi, mask);
    }
    size = region.size();
  });
  context.info(fmt::format("region_grow: {} samples with values from {} to {}", size, short_number(range.lo), short_number(range.hi)));
  if (size == 0) context.warn("region_grow: the seeds themselves lie outside the range; give min and max");
  return with_result(in, {p.name, image.field.association, Array::from_vector(std::move(mask)), "", Role::labels});
}

}  // namespace sg
