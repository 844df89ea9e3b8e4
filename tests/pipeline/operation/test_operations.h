// SPDX-License-Identifier: Apache-2.0
// Operations that count their runs, for the tests of the pipeline.
#pragma once
#include <atomic>
#include <functional>
#include <map>
#include <mutex>
#include <span>
#include <string>

#include "pipeline/graph/graph.h"

namespace sg::test {

/// Runs of each test operation since reset().
int runs(const std::string& name);
int all_runs();
void reset_runs();
/// Called inside every run, when set.
extern std::function<void(const std::string& name, Context& context)> on_run;

/// ramp: source; scale, shift: filters with a field; add: two inputs; join: any number; whole: sees collections; fail: throws;
/// measure: a table; moment: source with a time.
std::span<const Operation> counted_operations();

/// 1-D lattice of `n` points with the point fields named, each 0..n-1.
DatasetPtr line_of(size_t n, const std::vector<std::string>& fields = {"T"});
/// The first value of a field.
double first(const Data& data, const std::string& field = "T");
double value_at(const Data& data, size_t i, const std::string& field = "T");

}  // namespace sg::test
