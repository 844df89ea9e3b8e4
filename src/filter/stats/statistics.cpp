// SPDX-License-Identifier: Apache-2.0
#include "filter/stats/statistics.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "base/error.h"
#include "base/parallel.h"
#include "data/field_ops.h"
#include "data/ranks/over_all.h"
#include "filter/stats/finite_numbers.h"
#include "filter/stats/order_statistics.h"
#include "filter/stats/stats_parts.h"

namespace sg {

namespace {

constexpr size_t values_per_chunk = 1 << 16;

// Ghosts of the field's places; empty when there are none.
const Array& ghosts_of(const DatasetPtr& in, const Field& f) {
  static const Array none;
  return f.association == Association::point ? in->point_ghost() : f.association == Association::cell ? in->cell_ghost() : none;
}

// A field, in each of the parts that have it.
struct FieldOfParts {
  std::vector<std::pair<DatasetPtr, Field>> parts;
  const Field& first() const { return parts[0].second; }
};

FiniteNumbers numbers_of(const FieldOfParts& f, int component) {
  std::vector<FiniteNumbers::Source> sources;
  for (const auto& [part, field] : f.parts) sources.push_back({&field.array, &ghosts_of(part, field)});
  return {sources, component};
}

// The sums of f(v) and g(v) in fixed chunks, of all pieces.
template <class F, class G>
std::array<double, 2> exact_sums(std::span<const double> v, F&& f, G&& g, const Context& ctx) {
  using Two = std::array<ExactSum, 2>;
  const Two two = parallel_reduce(
      v.size(), values_per_chunk, Two{},
      [&](size_t begin, size_t end) {
        Two p;
        for (size_t i = begin; i < end; ++i) p[0].add(f(v[i])), p[1].add(g(v[i]));
        return p;
      },
      [](Two a, const Two& b) {
        a[0].add(b[0]), a[1].add(b[1]);
        return a;
      });
  std::vector<ExactSum> sums(two.begin(), two.end());
  over_all(sums, ctx);
  return {sums[0].value(), sums[1].value()};
}

// The value at a share of the way between two neighbours in order.
double between(double lo, double hi, double t) {
  const double apart = hi - lo;
  return std::isfinite(apart) ? lo + t * apart : lo * (1 - t) + hi * t;
}

// The numbers at these places of the order of all pieces' numbers, by halving the range of doubles; -0 counts as 0.
std::vector<double> all_at(std::span<double> v, const std::vector<int64_t>& places, const Context& ctx) {
  for (double& x : v) x += 0.0;
  std::sort(v.begin(), v.end());
  std::vector<uint64_t> lo(places.size(), 0), hi(places.size(), UINT64_MAX);
  std::vector<int64_t> below(places.size());
  for (int round = 0; round < 64; ++round) {
    for (size_t i = 0; i < places.size(); ++i) {
      const uint64_t middle = lo[i] + (hi[i] - lo[i]) / 2;
      below[i] = std::partition_point(v.begin(), v.end(), [&](double x) { return key_of(x) <= middle; }) - v.begin();
    }
    all_sum(std::span(below), ctx.communicator);
    for (size_t i = 0; i < places.size(); ++i) {
      const uint64_t middle = lo[i] + (hi[i] - lo[i]) / 2;
      if (below[i] > places[i]) hi[i] = middle;
      else if (lo[i] < hi[i]) lo[i] = middle + 1;
    }
  }
  std::vector<double> r;
  for (const uint64_t key : lo) r.push_back(number_of(key));
  return r;
}

// Of few numbers places of neighbouring quartiles pass each other.
std::vector<double> in_order(std::span<const double> v, const std::vector<int64_t>& places) {
  std::vector<size_t> rising(places.begin(), places.end());
  std::sort(rising.begin(), rising.end());
  rising.erase(std::unique(rising.begin(), rising.end()), rising.end());
  const std::vector<double> numbers = numbers_in_order(v, rising);
  std::vector<double> r;
  for (const int64_t p : places) r.push_back(numbers[size_t(std::lower_bound(rising.begin(), rising.end(), size_t(p)) - rising.begin())]);
  return r;
}

// Least, quartiles and largest of all pieces' numbers, `n` of them.
std::array<double, 5> quartiles(std::span<double> v, int64_t n, const Context& ctx) {
  std::array<double, 5> r{};
  std::vector<int64_t> places;
  for (int k = 0; k < 5; ++k) {
    const auto i = int64_t(k / 4.0 * double(n - 1));
    places.push_back(i), places.push_back(std::min(i + 1, n - 1));
  }
  const std::vector<double> at = ctx.communicator ? all_at(v, places, ctx) : in_order(v, places);
  for (size_t k = 0; k < 5; ++k) r[k] = between(at[2 * k], at[2 * k + 1], double(k) / 4.0 * double(n - 1) - double(places[2 * k]));
  return r;
}

// The power of two below the largest absolute value, with which squares stay within doubles; 1 where they do anyway.
double scale_of(std::span<const double> v, const Context& ctx) {
  double most = parallel_reduce(
      v.size(), values_per_chunk, 0.0,
      [&](size_t begin, size_t end) {
        double part = 0;
        for (size_t i = begin; i < end; ++i) part = std::max(part, std::fabs(v[i]));
        return part;
      },
      [](double a, double b) { return std::max(a, b); });
  most = all_most(most, ctx.communicator);
  return most > 1e140 || (most > 0 && most < 1e-140) ? std::ldexp(1.0, std::ilogb(most)) : 1;
}

// Columns that grow row by row.
struct Rows {
  std::vector<std::string> fields;
  std::vector<int32_t> field, association, component;
  std::vector<int64_t> count, missing, infinite;
  std::vector<double> number[9];
};
constexpr const char* number_names[9] = {"min", "quartile1", "median", "quartile3", "max", "mean", "deviation", "sum", "sum_of_squares"};

void add_row(Rows& rows, const FieldOfParts& parts, int component, const Context& ctx) {
  const Field& f = parts.first();
  const FiniteNumbers numbers = numbers_of(parts, component);
  const std::span<double> v = numbers.values();
  if (rows.fields.empty() || rows.fields.back() != f.name || rows.association.back() != int32_t(f.association)) {
    if (std::find(rows.fields.begin(), rows.fields.end(), f.name) == rows.fields.end()) rows.fields.push_back(f.name);
  }
  rows.field.push_back(int32_t(std::find(rows.fields.begin(), rows.fields.end(), f.name) - rows.fields.begin()));
  rows.association.push_back(int32_t(f.association));
  rows.component.push_back(component);
  int64_t counts[] = {int64_t(v.size()), int64_t(numbers.missing()), int64_t(numbers.infinite())};
  all_sum(std::span<int64_t>(counts), ctx.communicator);
  rows.count.push_back(counts[0]), rows.missing.push_back(counts[1]), rows.infinite.push_back(counts[2]);
  double row[9];
  std::fill_n(row, 9, std::nan(""));
  if (counts[0] > 0) {
    const double n = double(counts[0]), s = scale_of(v, ctx);
    const auto [sum, squares] = exact_sums(
        v, [&](double x) { return x / s; }, [&](double x) { return (x / s) * (x / s); }, ctx);
    const double mean = sum / n;
    row[7] = sum * s, row[5] = mean * s, row[8] = squares * s * s;
    // Two passes: the squares of differences from the mean do not cancel.
    const auto apart = exact_sums(
        v, [&](double x) { return (x / s - mean) * (x / s - mean); }, [](double) { return 0.0; }, ctx);
    row[6] = n > 1 ? s * std::sqrt(apart[0] / (n - 1)) : 0;
    const std::array<double, 5> q = quartiles(v, counts[0], ctx);
    std::copy(q.begin(), q.end(), row);
  }
  for (int i = 0; i < 9; ++i) rows.number[i].push_back(row[i]);
}

}  // namespace

TablePtr statistics(const DatasetPtr& in, const StatisticsParams& p, Context& ctx) { return statistics_of_all({&in, 1}, p, ctx); }

TablePtr statistics_of_all(std::span<const DatasetPtr> parts, const StatisticsParams& p, Context& ctx) {
  std::vector<FieldOfParts> fields;
  const auto add = [&](const DatasetPtr& part, const Field& f) {
    const auto same = std::find_if(fields.begin(), fields.end(), [&](const FieldOfParts& other) {
      const Field& o = other.first();
      return other.parts.back().first != part && o.name == f.name && o.association == f.association && o.components() == f.components();
    });
    if (same == fields.end()) fields.push_back({{{part, f}}});
    else same->parts.emplace_back(part, f);
  };
  for (const std::string& name : p.fields) {
    bool found = false;
    for (const DatasetPtr& part : parts)
      if (const Field* f = part->fields().find(name)) add(part, *f), found = true;
    if (!found && !parts.empty()) (void)parts[0]->fields().require(name);  // lists what there is
  }
  if (p.fields.empty())
    for (const DatasetPtr& part : parts)
      for (const Field& f : part->fields())
        if (f.association != Association::whole) add(part, f);
  Rows rows;
  std::string infinite;
  for (const FieldOfParts& field : fields) {
    const Field& f = field.first();
    ctx.check();
    int64_t n = 0;
    for (int c = 0; c < f.components(); ++c) add_row(rows, field, c, ctx), n += rows.infinite.back();
    if (f.components() > 1) add_row(rows, field, -1, ctx);
    if (n > 0) infinite += fmt::format("{}'{}' ({})", infinite.empty() ? "" : ", ", f.name, n);
  }
  if (!infinite.empty()) ctx.warn(fmt::format("statistics: infinite values are counted separately: {}", infinite));
  auto t = std::make_shared<Table>();
  add_column(*t, "field", std::move(rows.field), rows.fields);
  add_column(*t, "association", std::move(rows.association), {"point", "cell", "whole"});
  add_column(*t, "component", std::move(rows.component));
  add_column(*t, "count", std::move(rows.count));
  add_column(*t, "missing", std::move(rows.missing));
  add_column(*t, "infinite", std::move(rows.infinite));
  for (int i = 0; i < 9; ++i) add_column(*t, number_names[i], std::move(rows.number[i]));
  return t;
}

TablePtr histogram(const DatasetPtr& in, const HistogramParams& p, Context& ctx) {
  const Field* f = p.field.empty() ? in->fields().active() : &in->fields().require(p.field.name);
  if (!f) fail_usage("there is no scalar field", "histogram field", "name one");
  if (p.component >= f->components())
    fail_usage(fmt::format("asks for component {} of {}", p.component, f->components()), "histogram component", "components count from 0");
  const int component = f->components() == 1 ? 0 : p.component;
  const FieldOfParts alone{{{in, *f}}};
  const FiniteNumbers numbers = numbers_of(alone, component);
  const std::span<const double> v = numbers.values();
  if (numbers.infinite() > 0)
    ctx.warn(fmt::format("histogram: {} infinite values of '{}' are not in any bin", numbers.infinite(), f->name));
  double lo = HUGE_VAL, hi = -HUGE_VAL;
  for (const double x : v) lo = std::min(lo, x), hi = std::max(hi, x);
  const Range all = over_all(Range{lo, hi}, ctx);
  const int64_t numbers_in_all = all_sum(int64_t(v.size()), ctx.communicator);
  lo = p.min.value_or(all.lo), hi = p.max.value_or(all.hi);
  if (!(lo <= hi))
    fail_usage(numbers_in_all == 0 ? "has no finite numbers" : fmt::format("has the range from {} to {}", lo, hi), "histogram",
               "min must not be above max");
  if (lo == hi) hi = std::nextafter(lo + std::max(std::fabs(lo), 1.0) * 1e-6, HUGE_VAL);  // one value: the first bin holds it
  const auto bins = size_t(p.bins);
  std::vector<double> edge(bins + 1);
  const bool far = !std::isfinite(hi - lo);  // then halves: the difference is meaningless
  for (size_t i = 0; i <= bins; ++i) {
    const double t = double(i) / double(bins);
    edge[i] = i == bins ? hi : far ? lo * (1 - t) + hi * t : lo + (hi - lo) * t;
  }
  std::vector<int64_t> count(bins, 0);
  for (const double x : v) {
    if (!(x >= lo && x <= hi)) continue;
    const double t = far ? (x / 2 - lo / 2) / (hi / 2 - lo / 2) : (x - lo) / (hi - lo);
    auto b = std::min(size_t(t * double(bins)), bins - 1);
    while (b > 0 && x < edge[b]) --b;  // the edges decide, not the rounding of the division
    while (b + 1 < bins && x >= edge[b + 1]) ++b;
    ++count[b];
  }
  all_sum(std::span(count), ctx.communicator);
  std::vector<double> fraction;
  for (const int64_t n : count) fraction.push_back(numbers_in_all == 0 ? 0 : double(n) / double(numbers_in_all));
  auto t = std::make_shared<Table>();
  add_column(*t, "lo", std::vector<double>(edge.begin(), edge.end() - 1));
  add_column(*t, "hi", std::vector<double>(edge.begin() + 1, edge.end()));
  t->columns[0].unit = t->columns[1].unit = f->unit;
  add_column(*t, "count", std::move(count));
  add_column(*t, "fraction", std::move(fraction));
  return t;
}

}  // namespace sg
