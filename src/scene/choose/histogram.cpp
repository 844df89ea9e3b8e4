// SPDX-License-Identifier: Apache-2.0
#include "scene/choose/histogram.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <string>

#include "base/all_ranks.h"
#include "base/parallel.h"
#include "data/dataset.h"
#include "data/field_ops.h"
#include "data/memory/memo.h"

namespace sg {

namespace {

// The field, and those of its name in the parts beside it.
std::vector<const Field*> with_parts(const Field& field, const Context& context) {
  std::vector<const Field*> all{&field};
  if (!context.parts) return all;
  for (const DatasetPtr& part : *context.parts) {
    const Field* f = part->fields().find(field.name, field.association);
    if (!f) f = part->fields().find(field.name);
    if (f && f->components() == field.components() && f->array.raw() != field.array.raw()) all.push_back(f);
  }
  return all;
}

size_t sample_step(size_t count) { return std::max<size_t>(1, count / 2000000); }

}  // namespace

std::vector<size_t> histogram(const Field& field, int component, double lo, double hi, size_t bins, const Context& context) {
  std::vector<size_t> h(bins);
  if (!(lo < hi)) return h;
  const double scale = double(bins) / (hi - lo);
  const std::vector<const Field*> fields = with_parts(field, context);
  size_t count = 0;
  for (const Field* f : fields) count += f->array.count();
  const size_t step = sample_step(count);
  const bool magnitude = component < 0 && field.components() > 1;
  using Counts = std::vector<size_t>;
  constexpr size_t grain = 1 << 17;  // samples
  for (const Field* f : fields)
    h = dispatch(f->array, [&](auto v) {
      return parallel_reduce((v.count + step - 1) / step, grain, std::move(h),
                             [&](size_t begin, size_t end) {
                               Counts part(bins);
                               for (size_t i = begin * step; i < v.count && i < end * step; i += step) {
                                 double x = double(v(i, std::max(component, 0)));
                                 if (magnitude) {
                                   x = 0;
                                   for (int c = 0; c < v.components; ++c) x += double(v(i, c)) * double(v(i, c));
                                   x = std::sqrt(x);
                                 }
                                 if (x >= lo && x <= hi) ++part[std::min(bins - 1, size_t((x - lo) * scale))];
                               }
                               return part;
                             },
                             [](Counts all, const Counts& part) {
                               for (size_t b = 0; b < part.size(); ++b) all[b] += part[b];
                               return all;
                             });
    });
  all_sum(std::span<size_t>(h), context.communicator);
  return h;
}

namespace {

// How often each 16-bit integer comes, from the smallest one on.
template <class T>
std::vector<size_t> value_counts(const Field& field) {
  std::vector<size_t> counts(size_t(1) << 16);
  const auto v = field.array.view<T>();
  const size_t step = sample_step(v.count);
  for (size_t i = 0; i < v.count; i += step) ++counts[size_t(int(v[i]) - std::numeric_limits<T>::min())];
  return counts;
}

std::vector<size_t> histogram_of_counts(const std::vector<size_t>& counts, double lowest, double lo, double hi, size_t bins) {
  std::vector<size_t> h(bins);
  if (!(lo < hi)) return h;
  const double scale = double(bins) / (hi - lo);
  for (size_t i = 0; i < counts.size(); ++i) {
    const double x = lowest + double(i);
    if (x >= lo && x <= hi) h[std::min(bins - 1, size_t((x - lo) * scale))] += counts[i];
  }
  return h;
}

template <class Make>
std::vector<size_t> kept(const Dataset& data, const std::string& key, Make&& make) {
  if (const auto known = data.memo().find<std::vector<size_t>>(key)) return *known;
  const std::vector<size_t> made = make();
  return *data.memo().keep(key, made, made.size() * sizeof(size_t));
}

}  // namespace

std::vector<size_t> histogram(const Dataset& data, const Field& field, int component, double lo, double hi, size_t bins,
                              const Context& context) {
  const bool alone = !context.parts || context.parts->size() <= 1;
  if (!alone || context.communicator || data.fields().find(field.name, field.association) != &field)
    return histogram(field, component, lo, hi, bins, context);
  const std::string name = fmt::format("{} {}", association_name(field.association), field.name);
  const bool with_sign = field.array.type() == ElementType::i16;
  if (field.components() == 1 && (with_sign || field.array.type() == ElementType::u16)) {
    const auto counts = [&] { return with_sign ? value_counts<int16_t>(field) : value_counts<uint16_t>(field); };
    return histogram_of_counts(kept(data, "counts of values " + name, counts), with_sign ? -32768 : 0, lo, hi, bins);
  }
  const Range all = data.range(field, component);
  if (lo != all.lo || hi != all.hi) return histogram(field, component, lo, hi, bins, context);
  return kept(data, fmt::format("histogram {} {} {}", component, bins, name),
              [&] { return histogram(field, component, lo, hi, bins, context); });
}

double histogram_quantile(const std::vector<size_t>& h, double lo, double hi, double q) {
  size_t all = 0;
  for (size_t n : h) all += n;
  double sum = 0;
  for (size_t b = 0; b < h.size(); ++b) {
    sum += double(h[b]);
    if (sum >= q * double(all)) return lo + (double(b) + 1) / double(h.size()) * (hi - lo);
  }
  return hi;
}

size_t fullest_bin(const std::vector<size_t>& h) {
  const size_t n = h.size(), width = std::max<size_t>(1, n / 20);
  size_t sum = 0, most = 0, begin = 0;
  for (size_t b = 0; b < n; ++b) {
    sum += h[b];
    if (b >= width) sum -= h[b - width];
    if (sum > most) most = sum, begin = b + 1 >= width ? b + 1 - width : 0;
  }
  return size_t(std::max_element(h.begin() + ptrdiff_t(begin), h.begin() + ptrdiff_t(std::min(n, begin + width))) - h.begin());
}

Range foreground(const Field& field, int component, double lo, double hi, const Context& context, double bright) {
  auto h = histogram(field, component, lo, hi, 1024, context);
  const double width = hi - lo;
  const size_t peak = fullest_bin(h);
  Range r{lo, hi};
  if (peak < h.size() / 2) {
    const size_t end = std::min(h.size() - 1, peak + 1 + h.size() / 50);
    r.lo = lo + double(end) / double(h.size()) * width;
    std::fill(h.begin(), h.begin() + ptrdiff_t(end), size_t(0));
  }
  r.hi = std::max(histogram_quantile(h, lo, hi, 1 - bright), r.lo + 0.01 * width);
  return r;
}

}  // namespace sg
