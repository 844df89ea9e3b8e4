// SPDX-License-Identifier: Apache-2.0
// What nobody means to give an operation: meshes, values, words and time series.
#pragma once
#include <string>
#include <vector>

#include "data/dataset.h"
#include "pipeline/operation/operation.h"

namespace sg::test::hostile {

/// plain: noise; flat: the same, with vectors of two components; infinite: some of both signs.
enum class Values { none, plain, nan, zero, huge, flat, smooth, infinite };

struct Input {
  std::string name;
  Data data;
  bool slow = false;  ///< not for the usual run
};

/// The mesh with a scalar "s", a vector "v", tensors "t" (6) and "m" (9) and "labels", on points and on cells.
DatasetPtr with(const DatasetPtr& mesh, Values values);

/// Meshes that are empty, bare, of one cell, collapsed, huge, tiny; of every kind; values of NaN, zero, huge; parts unlike each other.
const std::vector<Input>& inputs();
/// A grid, a flat grid and a surface: one of them suits most operations.
const std::vector<Input>& plain_inputs();

/// Those that operations of several inputs get in pairs: empty ones, bare ones, of all kinds of cells.
const std::vector<Input>& unlike_inputs();

/// NAME=VALUE for values that nobody means.
std::vector<std::string> words(const ParamDecl& d);

struct Times {
  std::string name;
  std::vector<double> times;
  std::vector<Data> steps;
};

/// Series of no step, of one, of times that do not rise, of steps unlike each other; `all`: of each of inputs() as well.
std::vector<Times> series(bool all);

}  // namespace sg::test::hostile
