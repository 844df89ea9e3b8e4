// SPDX-License-Identifier: Apache-2.0
#include "filter/tensor/diffusion/gradient_table.h"

#include <fmt/core.h>

#include "base/error.h"
#include "base/file/file.h"
#include "base/text/text.h"

namespace sg {

namespace {

// All numbers of a text file, row by row; every row must have as many as the first.
std::vector<double> read_rows(const std::string& path, size_t& columns) {
  const MappedFile file(path);
  std::vector<double> r;
  size_t line_number = 0;
  columns = 0;
  for (std::string_view line : split(file.text(), '\n')) {
    ++line_number;
    size_t n = 0;
    for (std::string_view w : words(line)) {
      const auto v = parse_double(w);
      if (!v) fail_data(fmt::format("line {}: '{}' is not a number", line_number, w.substr(0, 40)), path);
      r.push_back(*v), ++n;
    }
    if (n == 0) continue;
    if (columns == 0) columns = n;
    if (n != columns)
      fail_data(fmt::format("line {} has {} numbers, the first has {}", line_number, n, columns), path, "rows must have equal length");
  }
  if (r.empty()) fail_data("it contains no numbers", path);
  return r;
}

std::vector<double> read_bvals(const std::string& path) {
  size_t columns = 0;
  std::vector<double> r = read_rows(path, columns);
  if (columns != 1 && columns != r.size())
    fail_data(fmt::format("{} rows of {} numbers", r.size() / columns, columns), path,
              "b-values are one row or one column; three rows are directions");
  return r;
}

std::vector<Vec3> read_bvecs(const std::string& path, size_t count) {
  size_t columns = 0;
  const std::vector<double> v = read_rows(path, columns);
  const size_t rows = v.size() / columns;
  if (rows * columns != 3 * count || (rows != 3 && columns != 3))
    fail_data(fmt::format("{} rows of {} numbers do not fit {} b-values", rows, columns, count), path,
              fmt::format("expected 3 rows of {0}, or {0} rows of 3", count));
  std::vector<Vec3> g(count);
  for (size_t i = 0; i < count; ++i)
    g[i] = columns == count && rows == 3 ? Vec3(v[i], v[count + i], v[2 * count + i]) : Vec3(v[3 * i], v[3 * i + 1], v[3 * i + 2]);
  return g;
}

const Field& whole_field(const Dataset& d, const char* name, int components, const char* parameter) {
  const Field* f = d.fields().find(name, Association::whole);
  if (!f || f->components() != components)
    fail_usage(fmt::format("there are no diffusion gradients: {} names no file, and the data has no field '{}' of the whole dataset",
                           parameter, name),
               "tensor_fit", "give bvals=FILE bvecs=FILE");
  return *f;
}

}  // namespace

GradientTable read_gradients(const Dataset& d, const std::string& bvals, const std::string& bvecs, double b0) {
  GradientTable t;
  if (!bvals.empty()) t.b = read_bvals(bvals);
  else {
    const Array& a = whole_field(d, "bval", 1, "bvals").array;
    for (size_t i = 0; i < a.count(); ++i) t.b.push_back(a.get(i));
  }
  if (!bvecs.empty()) t.g = read_bvecs(bvecs, t.b.size());
  else {
    const Array& a = whole_field(d, "bvec", 3, "bvecs").array;
    if (a.count() != t.b.size()) fail_usage(fmt::format("{} directions for {} b-values", a.count(), t.b.size()), "tensor_fit");
    for (size_t i = 0; i < a.count(); ++i) t.g.push_back({a.get(i, 0), a.get(i, 1), a.get(i, 2)});
  }
  const std::string where = bvals.empty() ? "tensor_fit" : bvals;
  for (size_t i = 0; i < t.size(); ++i) {
    if (!(t.b[i] >= 0) || !std::isfinite(t.b[i]))
      fail_data(fmt::format("b-value {} is {}", i + 1, t.b[i]), where, "b-values are in s/mm^2, 0 or more");
    const double l = length(t.g[i]);
    if (l > 0 && std::isfinite(l)) t.g[i] = t.g[i] / l;
    else if (t.b[i] <= b0) t.g[i] = {0, 0, 0};
    else fail_data(fmt::format("volume {} has b = {} but no direction", i + 1, t.b[i]), bvecs.empty() ? where : bvecs);
  }
  return t;
}

void turn_to_world(GradientTable& t, const Dataset& d, GradientFrame frame) {
  const auto* grid = d.as<UniformGrid>();
  if (frame == GradientFrame::world || !grid) return;
  const Mat3& axes = grid->direction;
  const double flip = frame == GradientFrame::fsl && determinant(axes) * grid->spacing.x * grid->spacing.y * grid->spacing.z > 0 ? -1 : 1;
  for (Vec3& g : t.g) g = axes * Vec3(flip * g.x, g.y, g.z);
}

}  // namespace sg
