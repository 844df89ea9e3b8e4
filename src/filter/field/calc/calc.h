// SPDX-License-Identifier: Apache-2.0
// Arithmetic on fields: calc 'expr=mag(velocity)*rho'.
#pragma once
#include <vector>

#include "base/context.h"
#include "base/schema/schema.h"
#include "base/text/help_word.h"
#include "data/dataset.h"

namespace sg {

/// Where the result is.
enum class CalcPlace { point, cell };
constexpr auto enum_words(CalcPlace) {
  using enum CalcPlace;
  return std::array{Word{"point", point}, Word{"cell", cell}};
}

struct CalcParams {
  std::string expr;
  std::string name = "result";
  std::optional<CalcPlace> on;
};

inline void describe(Schema& s, CalcParams& p) {
  s("expr", p.expr,
    "Expression, e.g. mag(velocity)*rho. Field names as they are, or in \"quotes\"; also x, y, z, position, time, pi. Operators and "
    "functions are listed below.");
  s("name", p.name, "Name of the new field.");
  s("on", p.on, "Where to compute: auto follows the fields of the expression (points if it has none).");
}

/// Adds a field computed from others, tuple by tuple, in double; the result is f32 when every field used is f32 or a small
/// integer, else f64; comparisons are 0 or 1. NaN propagates.
///
///   expression   or && ||, comparison < <= > >= == !=, + -, * / %, ^ (right to left), - !, a ? b : c, a.x .y .z, a[i], (a)
///   numbers      1.5e-3, pi, e, nan
///   coordinates  x y z and position (of points, or of cell centres) where no field has that name; time
///   functions    sin cos tan asin acos atan sinh cosh tanh exp log log10 log2 sqrt cbrt abs sign floor ceil round
///                atan2 pow mod min max hypot clamp(a,lo,hi) if(c,a,b) isnan
///   vectors      mag norm dot cross vec(a,b,c) sum; a scalar meets each component of a vector; trace det of 3x3 tensors
///
/// Units are carried: products and powers combine them, sums need equal ones (otherwise the result has no unit, and a note says so).
/// Throws Error(usage) with the place in the expression, and for point fields mixed with cell fields.
DatasetPtr calc(const DatasetPtr& in, const CalcParams& p, Context& ctx);

/// Every name in an expression that may be a field's, also those of an expression with mistakes.
std::vector<std::string> names_in_expression(std::string_view expression);

/// Operators, names and functions of expressions, for help.
std::vector<HelpWord> calc_words();

}  // namespace sg
