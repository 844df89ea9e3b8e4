// SPDX-License-Identifier: Apache-2.0
#include "simulate/pde/mesh/mesh_numbers.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "filter/field/calc/calc.h"

namespace sg::pde {

MeshNumbers mesh_numbers(const DatasetPtr& mesh, const std::string& expression, double time, const std::string& who,
                         const Context& context) {
  DatasetParts parts = mesh->parts();
  parts.time = time;
  Context inner(context, 0, 1);
  constexpr const char* result = "heat_on_mesh result";
  const DatasetPtr d = with_context(who, [&] { return calc(make_dataset(std::move(parts)), {.expr = expression, .name = result}, inner); });
  const Field& f = d->fields().require(result);
  if (f.components() != 1) fail_usage(fmt::format("the expression gives {} numbers", f.components()), who, "one number is needed");
  MeshNumbers numbers;
  numbers.of_cells = f.association == Association::cell;
  numbers.at.resize(f.array.count());
  dispatch(f.array, [&](auto v) {
    for (size_t i = 0; i < numbers.at.size(); ++i) numbers.at[i] = double(v(i, 0));
  });
  return numbers;
}

std::vector<double> simplex_numbers(const Simplices& s, const MeshNumbers& numbers) {
  std::vector<double> out(s.size());
  for (size_t t = 0; t < out.size(); ++t) {
    if (numbers.of_cells) {
      out[t] = numbers.at[s.cell[t]];
      continue;
    }
    double sum = 0, count = 0;
    for (int v = 0; v <= s.dimension; ++v)
      if (const uint32_t i = s.corners[t][size_t(v)]; i < s.points) sum += numbers.at[i], ++count;
    out[t] = sum / count;
  }
  return out;
}

std::vector<double> point_numbers(const Simplices& s, const MeshNumbers& numbers) {
  const size_t n = s.at.size();
  std::vector<double> out(n);
  if (!numbers.of_cells) std::copy(numbers.at.begin(), numbers.at.end(), out.begin());
  if (!numbers.of_cells && n == s.points) return out;
  const std::vector<double> of_simplices = simplex_numbers(s, numbers);
  std::vector<double> share(n);
  std::array<Vec3, 4> g;
  for (size_t t = 0; t < s.size(); ++t) {
    const double size = simplex_gradients(s, t, g);
    for (int v = 0; v <= s.dimension; ++v)
      if (const uint32_t i = s.corners[t][size_t(v)]; numbers.of_cells || i >= s.points) out[i] += size * of_simplices[t], share[i] += size;
  }
  for (size_t i = 0; i < n; ++i)
    if (share[i] > 0) out[i] /= share[i];
  return out;
}

std::vector<uint8_t> marked_points(const Simplices& s, const MeshNumbers& numbers) {
  std::vector<uint8_t> marked(s.at.size());
  const auto marks = [](double v) { return v != 0 && !std::isnan(v); };
  if (!numbers.of_cells)
    for (size_t i = 0; i < s.points; ++i) marked[i] = marks(numbers.at[i]);
  else
    for (size_t t = 0; t < s.size(); ++t)
      for (int k = 0; marks(numbers.at[s.cell[t]]) && k <= s.dimension; ++k) marked[s.corners[t][size_t(k)]] = 1;
  return marked;
}

}  // namespace sg::pde
