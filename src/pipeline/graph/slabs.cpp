// SPDX-License-Identifier: Apache-2.0
#include "pipeline/graph/slabs.h"

#include <fmt/core.h>

#include "base/error.h"
#include "base/text/text.h"
#include "pipeline/operation/operation.h"
#include "simulate/analytic_grid.h"

namespace sg {

namespace {

bool says(const std::string& word, std::string_view key) {
  return word.size() > key.size() && word.starts_with(key) && word[key.size()] == '=';
}

std::vector<std::string> without_grid(const std::vector<std::string>& words) {
  std::vector<std::string> out;
  for (const std::string& w : words)
    if (!says(w, "size") && !says(w, "dims") && !says(w, "bounds")) out.push_back(w);
  return out;
}

std::string bounds_word(Vec3 lo, Vec3 hi) {
  return fmt::format("bounds={},{},{},{},{},{}", exact_number(lo.x), exact_number(hi.x), exact_number(lo.y), exact_number(hi.y),
                     exact_number(lo.z), exact_number(hi.z));
}

}  // namespace

SlabSource slabs_of_source(const std::string& operation, const std::vector<std::string>& words, Context& context) {
  const Operation& op = find_operation(operation);
  if (op.kind != OperationKind::source) fail_usage("is not a source", operation, "see: sightglass ops");
  const ParamSet params = make_params(op, words);  // all mistakes before any work
  const bool by_place =
      params.schema.find("dims") && params.schema.find("bounds") && params.schema.find("size") && !params.schema.find("seed");
  if (!by_place) return slabs_of_dataset(single_dataset(run_operation(op, {}, words, context), operation), operation, context);

  // A few points of it give its box, its field and its type.
  std::vector<std::string> few = without_grid(words);
  for (const std::string& w : words)
    if (says(w, "bounds")) few.push_back(w);
  few.emplace_back("size=2");
  const DatasetPtr sample = single_dataset(run_operation(op, {}, few, context), operation);
  SlabSource s = slabs_of_dataset(sample, operation, context);
  const UniformGrid small = *sample->as<UniformGrid>();
  Box3 box;
  box.lo = small.origin;
  for (int a = 0; a < 3; ++a)
    box.hi[a] = small.origin[a] + (small.dims[size_t(a)] > 1 ? small.spacing[a] * double(small.dims[size_t(a)] - 1) : 0);
  GridParams grid;
  grid.size = int(std::get<int64_t>(params.schema.find("size")->ref.get())),
  grid.dims = std::get<std::vector<int64_t>>(params.schema.find("dims")->ref.get());
  s.grid = analytic_grid(grid, box, operation.c_str(), Context());
  s.slab = [=, &op, g = s.grid, field = s.field, base = without_grid(words), &context](size_t first, size_t count) {
    std::vector<std::string> part = base;
    part.push_back(fmt::format("dims={},{},{}", g.dims[0], g.dims[1], count));
    Vec3 lo = g.origin, hi = box.hi;
    lo.z = g.origin.z + g.spacing.z * double(first), hi.z = g.origin.z + g.spacing.z * double(first + count - 1);
    part.push_back(bounds_word(lo, hi));
    return single_dataset(run_operation(op, {}, part, context), op.name)->fields().require(field, Association::point).array;
  };
  return s;
}

}  // namespace sg
