// SPDX-License-Identifier: Apache-2.0
#include "filter/stats/statistics.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "support/test.h"

using namespace sg;

namespace {

DatasetPtr with_values(std::vector<double> v) {
  PointCloud c;
  c.points.xyz = Array::from_vector(std::vector<float>(v.size() * 3, 0.f), 3);
  FieldSet f;
  f.add({"v", Association::point, Array::from_vector(std::move(v)), "m", Role::scalars});
  return make_dataset(Mesh(c), std::move(f));
}

double cell(const TablePtr& t, const char* column, size_t row = 0) {
  for (const Field& f : t->columns)
    if (f.name == column) return f.array.get(row);
  FAIL("no column");
  return 0;
}

}  // namespace

TEST_CASE("statistics: closed forms of 1..n, NaN counted apart") {
  std::vector<double> v;
  for (int i = 101; i >= 1; --i) v.push_back(i);
  v.push_back(NAN);
  Context ctx;
  const TablePtr t = statistics(with_values(v), {}, ctx);
  CHECK(cell(t, "count") == 101);
  CHECK(cell(t, "missing") == 1);
  CHECK(cell(t, "min") == 1);
  CHECK(cell(t, "quartile1") == 26);
  CHECK(cell(t, "median") == 51);
  CHECK(cell(t, "quartile3") == 76);
  CHECK(cell(t, "max") == 101);
  CHECK(cell(t, "mean") == 51);
  CHECK(cell(t, "sum") == 5151);
  CHECK(cell(t, "sum_of_squares") == 101.0 * 102 * 203 / 6);
  CHECK(cell(t, "deviation") == doctest::Approx(std::sqrt(101.0 * 102 / 12)).epsilon(1e-14));
  CHECK(*t->words(0) == std::vector<std::string>{"v"});
}

TEST_CASE("statistics: a small deviation about a large mean survives") {
  std::vector<double> v;
  for (int i = 0; i < 1000; ++i) v.push_back(1e9 + (i % 2));
  Context ctx;
  CHECK(cell(statistics(with_values(v), {}, ctx), "deviation") == doctest::Approx(0.5 * std::sqrt(1000.0 / 999)).epsilon(1e-12));
}

TEST_CASE("statistics: one row per component and one for the length; empty fields have no numbers") {
  PointCloud c;
  c.points.xyz = Array::from_vector(std::vector<float>{0, 0, 0, 1, 1, 1}, 3);
  FieldSet f;
  f.add({"u", Association::point, Array::from_vector(std::vector<float>{3, 4, 0, 0, 0, 5}, 3), "", Role::vectors});
  f.add({"none", Association::point, Array::from_vector(std::vector<float>{NAN, NAN}), "", Role::none});
  Context ctx;
  const TablePtr t = statistics(make_dataset(Mesh(c), std::move(f)), {}, ctx);
  CHECK(t->columns[0].array.count() == 5);
  CHECK(cell(t, "component", 3) == -1);
  CHECK(cell(t, "mean", 3) == 5);
  CHECK(cell(t, "count", 4) == 0);
  CHECK(std::isnan(cell(t, "mean", 4)));
}

TEST_CASE("statistics: quartiles of many numbers are those of their order, with any signs, repeats and magnitudes") {
  for (const int kind : {0, 1, 2}) {
    std::vector<double> v;
    uint64_t state = 7;
    for (int i = 0; i < 2500003; ++i) {
      state = state * 6364136223846793005u + 1442695040888963407u;
      const double x = double(int64_t(state >> 20)) - double(int64_t(1) << 43);
      v.push_back(kind == 0 ? x : kind == 1 ? double(int64_t(x) >> 38) : std::ldexp(x, int(state >> 60) * 30 - 200));
    }
    std::vector<double> order = v;
    std::sort(order.begin(), order.end());
    const auto at = [&](double q) {
      const double place = q * double(order.size() - 1);
      const auto i = size_t(place);
      return i + 1 < order.size() ? order[i] + (place - double(i)) * (order[i + 1] - order[i]) : order[i];
    };
    Context ctx;
    const TablePtr t = statistics(with_values(v), {}, ctx);
    CAPTURE(kind);
    CHECK(cell(t, "min") == order.front());
    CHECK(cell(t, "quartile1") == at(0.25));
    CHECK(cell(t, "median") == at(0.5));
    CHECK(cell(t, "quartile3") == at(0.75));
    CHECK(cell(t, "max") == order.back());
  }
}

TEST_CASE("statistics: the same numbers for any number of threads") {
  std::vector<double> v;
  for (int i = 0; i < 300000; ++i) v.push_back(std::sin(i * 0.7) * 1e3);
  Context ctx;
  set_thread_count(1);
  const double one = cell(statistics(with_values(v), {}, ctx), "sum");
  set_thread_count(8);
  CHECK(cell(statistics(with_values(v), {}, ctx), "sum") == one);
  set_thread_count(0);
}

TEST_CASE("histogram: every value in one bin, upper end in the last, edges as printed") {
  std::vector<double> v;
  for (int i = 0; i <= 100; ++i) v.push_back(i);
  v.push_back(NAN);
  Context ctx;
  HistogramParams p;
  p.bins = 10;
  const TablePtr t = histogram(with_values(v), p, ctx);
  for (size_t b = 0; b < 10; ++b) {
    CHECK(cell(t, "lo", b) == doctest::Approx(10.0 * double(b)));
    CHECK(cell(t, "count", b) == (b == 9 ? 11 : 10));
  }
  CHECK(t->columns[0].unit == "m");
  p.min = 50, p.max = 60;
  const TablePtr part = histogram(with_values(v), p, ctx);
  CHECK(cell(part, "count", 0) == 1);
  CHECK(cell(part, "count", 9) == 2);
  p.min = 70;
  CHECK(test::error_of([&] { histogram(with_values(v), p, ctx); }).find("min must not be above max") != std::string::npos);
  p = {};
  CHECK(cell(histogram(with_values({4, 4, 4}), p, ctx), "count", 0) == 3);
}

TEST_CASE("statistics: infinities are counted and said, all else is of the finite values; histograms likewise") {
  const double inf = HUGE_VAL;
  FieldSet fields;
  fields.add({"T", Association::point, Array::from_vector(std::vector<double>{1, inf, 2, -inf, 3, NAN, 4}), "", Role::scalars});
  std::vector<double> xyz(21, 0.0);
  const DatasetPtr in = make_dataset(PointCloud{{Array::from_vector(xyz, 3), {}}}, fields);
  std::string said;
  Context ctx;
  ctx.on_log = [&](LogLevel level, std::string_view text) {
    if (level == LogLevel::warning) said += text;
  };
  const TablePtr t = statistics(in, {}, ctx);
  const auto cell = [](const TablePtr& table, const char* name, size_t row = 0) {
    for (const Field& f : table->columns)
      if (f.name == name) return f.array.get(row);
    return -12345.0;
  };
  CHECK(cell(t, "count") == 4);
  CHECK(cell(t, "missing") == 1);
  CHECK(cell(t, "infinite") == 2);
  CHECK(cell(t, "min") == 1);
  CHECK(cell(t, "max") == 4);
  CHECK(cell(t, "median") == 2.5);
  CHECK(cell(t, "mean") == 2.5);
  CHECK(cell(t, "sum") == 10);
  CHECK(cell(t, "deviation") == doctest::Approx(std::sqrt(5.0 / 3)));
  CHECK(said.find("'T' (2)") != std::string::npos);
  said.clear();
  HistogramParams p;
  p.bins = 3;
  const TablePtr h = histogram(in, p, ctx);
  CHECK(cell(h, "lo") == 1);
  CHECK(cell(h, "hi", 2) == 4);
  CHECK(cell(h, "count", 0) + cell(h, "count", 1) + cell(h, "count", 2) == 4);
  CHECK(cell(h, "fraction", 0) + cell(h, "fraction", 1) + cell(h, "fraction", 2) == doctest::Approx(1));
  CHECK(said.find("2 infinite values of 'T'") != std::string::npos);
}

TEST_CASE("statistics: values of any scale have their deviation, and vectors their length") {
  Context ctx;
  for (const double s : {1e-300, 1e-200, 1.0, 1e200, 4e307}) {
    CAPTURE(s);
    FieldSet fields;
    fields.add({"T", Association::point, Array::from_vector(std::vector<double>{1 * s, 2 * s, 3 * s, 4 * s}), "", Role::scalars});
    fields.add({"v", Association::point, Array::from_vector(std::vector<double>{3 * s, 0, 0, 0, 4 * s, 0, s, s, s, 0, 0, 0}, 3), "",
                Role::vectors});
    const DatasetPtr in = make_dataset(PointCloud{{Array::from_vector(std::vector<double>(12, 0.0), 3), {}}}, fields);
    const TablePtr t = statistics(in, {}, ctx);
    const auto cell = [&](const char* name, size_t row) {
      for (const Field& f : t->columns)
        if (f.name == name) return f.array.get(row) / s;
      return -12345.0;
    };
    CHECK(cell("mean", 0) == doctest::Approx(2.5));
    CHECK(cell("deviation", 0) == doctest::Approx(std::sqrt(5.0 / 3)));
    CHECK(cell("quartile1", 0) == doctest::Approx(1.75));
    CHECK(cell("max", 4) == doctest::Approx(4));
    CHECK(cell("median", 4) == doctest::Approx((std::sqrt(3.0) + 3) / 2));
  }
  // From one end of doubles to the other.
  FieldSet fields;
  fields.add({"T", Association::point, Array::from_vector(std::vector<double>{-1.7e308, 0, 1.7e308}), "", Role::scalars});
  const DatasetPtr in = make_dataset(PointCloud{{Array::from_vector(std::vector<double>(9, 0.0), 3), {}}}, fields);
  HistogramParams p;
  p.bins = 3;
  const TablePtr h = histogram(in, p, ctx);
  for (size_t b = 0; b < 3; ++b) CHECK(h->columns[2].array.get(b) == 1);
}
