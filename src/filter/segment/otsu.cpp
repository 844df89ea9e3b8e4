// SPDX-License-Identifier: Apache-2.0
#include "filter/segment/otsu.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/all_ranks.h"
#include "base/parallel.h"
#include "base/text/text.h"
#include "data/ranks/over_all.h"
#include "filter/segment/samples.h"

namespace sg {

void describe(Schema& s, OtsuParams& p) {
  s("field", p.field, "Point or cell field to split; default: the active scalar.").takes(fields::scalars);
  s("classes", p.classes, "Number of classes.").range(2, 64);
  s("bins", p.bins, "Bins of the histogram of floating-point values.").range(2, 1 << 16);
  s("name", p.name, "Name of the label field.");
}

ValueCounts value_counts(const Array& a, const std::vector<uint8_t>& states, int bins, const Context& context) {
  const size_t n = a.count();
  constexpr size_t chunk = 1 << 20;
  ValueCounts r;
  dispatch(a, [&](auto v) {
    using T = std::remove_cvref_t<decltype(v[0])>;
    const auto used = [&](size_t i) {
      if constexpr (std::is_floating_point_v<T>)
        if (!std::isfinite(v[i])) return false;
      return states.empty() || states[i] == sample_seen;
    };
    struct Span {
      T lo{}, hi{};
      bool any = false;
    };
    const Span span = parallel_reduce(
        n, chunk, Span{},
        [&](size_t begin, size_t end) {
          Span s;
          for (size_t i = begin; i < end; ++i) {
            if (!used(i)) continue;
            s.lo = s.any ? std::min<T>(s.lo, v[i]) : v[i];
            s.hi = s.any ? std::max<T>(s.hi, v[i]) : v[i];
            s.any = true;
          }
          return s;
        },
        [](Span x, Span y) {
          if (!x.any || !y.any) return x.any ? x : y;
          return Span{std::min(x.lo, y.lo), std::max(x.hi, y.hi), true};
        },
        &context);
    const Range all = over_all(span.any ? Range{double(span.lo), double(span.hi)} : Range{}, context);
    if (all.empty()) return;
    const double lo = all.lo, width = all.hi - lo;
    const bool exact = std::is_integral_v<T> && width < 65536;
    const size_t m = exact ? size_t(width) + 1 : size_t(bins);
    if (!std::isfinite(width)) fail_usage("the range of the values exceeds double precision", "histogram", "scale the field first");
    const double per_unit = width > 0 ? double(m) / width : 0;
    const auto place = [&](T x) -> size_t {
      if (exact) return size_t(double(x) - lo);
      return std::min(m - 1, size_t((double(x) - lo) * per_unit));
    };
    using Counts = std::vector<uint64_t>;
    Counts counts = parallel_reduce(
        n, chunk, Counts(m),
        [&](size_t begin, size_t end) {
          Counts c(m);
          for (size_t i = begin; i < end; ++i)
            if (used(i)) ++c[place(v[i])];
          return c;
        },
        [](Counts x, Counts y) {
          for (size_t i = 0; i < x.size(); ++i) x[i] += y[i];
          return x;
        },
        &context);
    all_sum(std::span(counts), context.communicator);
    for (size_t i = 0; i < m; ++i)
      if (counts[i]) {
        r.value.push_back(exact ? lo + double(i) : width > 0 ? lo + (double(i) + 0.5) / per_unit : lo);
        r.count.push_back(double(counts[i]));
      }
  });
  return r;
}

namespace {

// Sums of weight and of weighted values (about the mean) below each entry: the gain S^2/W of any interval in O(1).
struct Prefix {
  std::vector<double> w, s;
  explicit Prefix(const ValueCounts& h) : w(h.value.size() + 1), s(h.value.size() + 1) {
    double weight = 0, mean = 0;
    for (size_t i = 0; i < h.value.size(); ++i) weight += h.count[i], mean += h.count[i] * (h.value[i] - mean) / weight;
    for (size_t i = 0; i < h.value.size(); ++i) w[i + 1] = w[i] + h.count[i], s[i + 1] = s[i] + h.count[i] * (h.value[i] - mean);
  }
  double gain(size_t begin, size_t end) const {
    const double ww = w[end] - w[begin], ss = s[end] - s[begin];
    return ss * ss / ww;
  }
};

}  // namespace

// best[k][j]: most gain of the first j entries in k classes. The best start of the last class does not decrease with j (the gain is
// that of one-dimensional k-means), so each layer is filled by halving: O(n log n).
std::vector<size_t> best_split(const ValueCounts& h, int classes) {
  const size_t n = h.value.size(), k = size_t(classes);
  const Prefix prefix(h);
  std::vector<double> best(n + 1), next(n + 1);
  std::vector<std::vector<uint32_t>> start(k, std::vector<uint32_t>(n + 1, 0));
  for (size_t j = 1; j <= n; ++j) best[j] = prefix.gain(0, j);
  for (size_t c = 1; c < k; ++c) {
    auto fill = [&](auto&& self, size_t lo, size_t hi, size_t from, size_t to) -> void {
      if (lo > hi) return;
      const size_t j = (lo + hi) / 2;
      double most = -HUGE_VAL;
      size_t where = c;
      for (size_t i = std::max(from, c); i <= std::min(to, j - 1); ++i)
        if (const double g = best[i] + prefix.gain(i, j); g > most) most = g, where = i;
      next[j] = most, start[c][j] = uint32_t(where);
      if (j > lo) self(self, lo, j - 1, from, where);
      self(self, j + 1, hi, where, to);
    };
    fill(fill, c + 1, n, c, n - 1);
    std::swap(best, next);
  }
  std::vector<size_t> split(k - 1);
  for (size_t c = k - 1, j = n; c >= 1; --c) split[c - 1] = j = start[c][j];
  return split;
}

DatasetPtr otsu(const DatasetPtr& in, const OtsuParams& p, Context& context) {
  const Field* field = p.field.empty() ? in->fields().active(1) : with_context("otsu", [&] { return &in->fields().require(p.field.name); });
  if (!field) fail_usage("the mesh has no scalar field", "otsu", "name one: field=NAME");
  if (field->association == Association::whole)
    fail_usage(fmt::format("field '{}' belongs to the whole mesh, not to points or cells", field->name), "otsu");
  if (field->components() != 1)
    fail_usage(fmt::format("field '{}' has {} components, but one is needed", field->name, field->components()), "otsu",
               "take one of them with component, or use magnitude");
  const std::vector<uint8_t> states = sample_states(*in, field->association);
  const ValueCounts h = value_counts(field->array, states, p.bins, context);
  if (h.value.size() < size_t(p.classes))
    fail_usage(h.value.empty() ? fmt::format("field '{}' has no finite value", field->name)
               : h.value.size() == 1
                   ? fmt::format("field '{}' is {} everywhere, so there is nothing to split", field->name, short_number(h.value[0]))
                   : fmt::format("field '{}' has {} different values, too few for {} classes", field->name, h.value.size(), p.classes),
               "otsu", h.value.size() > 1 ? fmt::format("use at most {} classes", h.value.size()) : "choose another field");
  const std::vector<size_t> split = best_split(h, p.classes);
  std::vector<double> thresholds;
  for (const size_t i : split) thresholds.push_back((h.value[i - 1] + h.value[i]) / 2);

  const Prefix prefix(h);
  double between = 0, total = 0;
  const double mean = prefix.s.back() / prefix.w.back();
  for (size_t c = 0, begin = 0; c <= split.size(); ++c) {
    const size_t end = c < split.size() ? split[c] : h.value.size();
    between += prefix.gain(begin, end), begin = end;
  }
  for (size_t i = 0; i < h.value.size(); ++i) {
    const double x = (prefix.s[i + 1] - prefix.s[i]) / h.count[i] - mean;
    total += h.count[i] * x * x;
  }
  std::string text;
  for (const double t : thresholds) text += (text.empty() ? "" : ", ") + short_number(t);
  context.info(fmt::format("otsu: {} of '{}' separated at {}, {}% of the variance between them",
                           p.classes == 2 ? "2 classes" : fmt::format("{} classes", p.classes), field->name, text,
                           short_number(100 * between / total, 4)));

  uint8_t* label = nullptr;
  Field out{p.name, field->association, Array::make<uint8_t>(field->array.count(), 1, &label), "", Role::labels};
  dispatch(field->array, [&](auto v) {
    parallel_for(
        v.count, 1 << 15,
        [&](size_t begin, size_t end) {
          for (size_t i = begin; i < end; ++i) {
            const double x = double(v[i]);
            uint8_t c = 0;
            for (const double t : thresholds) c = uint8_t(c + (x > t));
            label[i] = !states.empty() && states[i] == sample_hidden ? uint8_t(0) : c;
          }
        },
        &context);
  });
  out.look.result = true;
  DatasetParts parts = in->parts();
  parts.fields.add(std::move(out));
  parts.fields.add({p.name + " thresholds", Association::whole, Array::from_vector(std::move(thresholds)), field->unit, Role::none});
  return make_dataset(std::move(parts));
}

}  // namespace sg
