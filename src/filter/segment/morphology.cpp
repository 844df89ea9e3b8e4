// SPDX-License-Identifier: Apache-2.0
#include "filter/segment/morphology.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "base/text/text.h"
#include "data/fields/known_looks.h"
#include "filter/segment/distance_map.h"
#include "filter/segment/label_components.h"
#include "filter/segment/samples.h"

namespace sg {

void describe(Schema& s, MorphologyParams& p) {
  s("field", p.field, "Field of labels; default: the first label field, else the active scalar.").takes(fields::scalars);
  s("operation", p.operation, "Operation to apply.");
  s("radius", p.radius, "Radius of the ball; default: the largest spacing of the grid.").unit("length").at_least(0);
  s("background", p.background, "Background label.");
  s("labels", p.labels, "Labels that form the set, the others staying unchanged; default: all except the background.");
  s("max_size", p.max_size, "fill: largest hole to fill, in samples; 0: any.").at_least(0);
  s("name", p.name, "Name of the result; default: it replaces the field.");
}

namespace {

constexpr size_t samples_per_chunk = 1 << 16;

using Mask = Plane<uint8_t>;

struct Work {
  const SampleImage& image;
  const Context& context;
  Mask unknown;  // no value: neither in the set nor outside it

  // Within r of `set`? A hair more, so that a radius of n spacings reaches the n-th sample.
  Mask grown(const Mask& set, double r) const {
    const size_t n = set.size();
    Plane<float> squared(n);
    distance_transform(set.data(), image.at, squared.data(), nullptr, context);
    const double limit = r * r * (1 + 1e-5);
    Mask out(n);
    parallel_for(n, samples_per_chunk, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) out[i] = set[i] || (!unknown[i] && double(squared[i]) <= limit);
    });
    return out;
  }
  Mask opposite(const Mask& set) const {
    Mask out(set.size());
    parallel_for(set.size(), samples_per_chunk, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) out[i] = !set[i] && !unknown[i];
    });
    return out;
  }
  Mask shrunk(const Mask& set, double r) const { return opposite(grown(opposite(set), r)); }

  Mask filled(const Mask& set, int64_t max_size) const {
    const auto d = image.dims;
    const size_t n = set.size();
    std::vector<int32_t> code(n);
    for (size_t i = 0; i < n; ++i) code[i] = !set[i];
    const CodeComponents c = code_components(code.data(), d, 6, true, context);
    std::vector<uint8_t> open(c.size.size() + 1, 0);
    for (size_t i = 0; i < n; ++i) {
      const size_t at[3] = {i % d[0], i / d[0] % d[1], i / (d[0] * d[1])};
      for (size_t a = 0; a < 3; ++a)
        if ((d[a] > 1 && (at[a] == 0 || at[a] + 1 == d[a])) || unknown[i]) open[size_t(c.component[i])] = 1;
    }
    if (max_size > 0)
      for (size_t k = 0; k < c.size.size(); ++k) open[k + 1] |= c.size[k] > max_size;
    Mask out(n);
    for (size_t i = 0; i < n; ++i) out[i] = set[i] || !open[size_t(c.component[i])];
    return out;
  }
};

}  // namespace

DatasetPtr morphology(const DatasetPtr& in, const MorphologyParams& p, Context& context) {
  const SampleImage image = sample_image(*in, p.field, "morphology", true);
  const size_t n = image.count();
  const LabelCodes codes = label_codes(image, p.background, p.labels, "morphology", context);
  double radius = 0;
  for (size_t a = 0; a < 3; ++a)
    if (image.dims[a] > 1) radius = std::max(radius, image.spacing(a));
  double least = HUGE_VAL;
  for (size_t a = 0; a < 3; ++a)
    if (image.dims[a] > 1) least = std::min(least, image.spacing(a));
  if (p.radius) radius = *p.radius;
  if (p.operation != Morphology::fill && radius < least && least < HUGE_VAL)
    context.warn(fmt::format("morphology: a ball of radius {} reaches no neighbours; the nearest are {} away", short_number(radius),
                             short_number(least)));

  Mask set(n);
  Work work{image, context, Mask(n)};
  dispatch(image.field.array, [&](auto v) {
    parallel_for(n, samples_per_chunk, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) set[i] = codes.code[i] != 0, work.unknown[i] = image.hidden(i) || v[i] != v[i];
    });
  });
  Mask result;
  if (p.operation == Morphology::erode) result = work.shrunk(set, radius);
  else if (p.operation == Morphology::dilate) result = work.grown(set, radius);
  else if (p.operation == Morphology::open) result = work.grown(work.shrunk(set, radius), radius);
  else if (p.operation == Morphology::close) result = work.shrunk(work.grown(set, radius), radius);
  else result = work.filled(set, p.max_size);

  Plane<float> squared(n);
  Plane<uint32_t> nearest(n);
  const bool adds = p.operation != Morphology::erode && p.operation != Morphology::open;
  if (adds) distance_transform(set.data(), image.at, squared.data(), nearest.data(), context);
  std::byte* bytes = nullptr;
  Field out{p.name.empty() ? image.field.name : p.name, image.field.association, Array::make_raw(image.field.array.type(), n, 1, &bytes),
            image.field.unit, Role::labels};
  struct Change {
    size_t added = 0, removed = 0;
  };
  const Change change = dispatch(image.field.array, [&](auto v) {
    using T = std::remove_cvref_t<decltype(v[0])>;
    T* to = reinterpret_cast<T*>(bytes);
    return parallel_reduce(
        n, samples_per_chunk, Change{},
        [&](size_t begin, size_t end) {
          Change c;
          for (size_t i = begin; i < end; ++i) {
            to[i] = v[i];
            if (set[i] && !result[i]) to[i] = T(p.background), ++c.removed;
            if (!set[i] && result[i] && adds && v[i] == T(p.background)) to[i] = v[nearest[i]], ++c.added;
          }
          return c;
        },
        [](Change a, Change b) {
          return Change{a.added + b.added, a.removed + b.removed};
        });
  });
  const std::string ball = p.operation == Morphology::fill ? "" : fmt::format(", ball of radius {}", short_number(radius));
  context.info(fmt::format("morphology: {}{}: {} samples added, {} removed", word_of(p.operation), ball, change.added, change.removed));
  return with_result(in, std::move(out));
}

}  // namespace sg
