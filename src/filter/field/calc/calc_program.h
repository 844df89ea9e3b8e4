// SPDX-License-Identifier: Apache-2.0
// An expression as a list of instructions over blocks of tuples: what calc_parse makes and calc runs.
#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "filter/field/calc/units.h"

namespace sg::calc_detail {

enum class Op : uint8_t {
  constant,
  field,
  position,
  negate,
  logical_not,
  add,
  subtract,
  multiply,
  divide,
  modulo,
  power,
  less,
  less_equal,
  greater,
  greater_equal,
  equal,
  not_equal,
  logical_and,
  logical_or,
  choose,
  component,
  call1,
  minimum,
  maximum,
  atan2,
  hypot,
  clamp,
  mag,
  norm,
  dot,
  cross,
  vec,
  sum,
  trace,
  det
};

/// Which function call1 is: for those who evaluate over other numbers than double.
enum class Call : uint8_t {
  none,
  sin,
  cos,
  tan,
  asin,
  acos,
  atan,
  sinh,
  cosh,
  tanh,
  exp,
  log,
  log10,
  log2,
  sqrt,
  cbrt,
  abs,
  sign,
  floor,
  ceil,
  round,
  isnan
};

/// Makes register `out` (of `components` numbers a tuple) from registers a, b, c.
struct Instruction {
  Op op = Op::constant;
  int components = 1;
  int a = -1, b = -1, c = -1;
  double value = 0;                      ///< constant; component: its number
  double (*function)(double) = nullptr;  ///< call1
  Call call = Call::none;                ///< call1: the same by name
  size_t field = 0;                      ///< place in Program::fields
};

struct Program {
  std::vector<Instruction> code;    ///< instruction i fills register i; the last is the result
  std::vector<std::string> fields;  ///< names used
  bool needs_position = false;
  Unit unit;
  std::string note;  ///< about units, or ""
};

/// What the parser must know of a name.
struct Symbol {
  bool known = false;
  int components = 0;
  Unit unit;
};

/// Throws Error(usage) with the place. `lookup` finds fields, `names` are for "did you mean".
Program parse(std::string_view text, const std::function<Symbol(std::string_view)>& lookup, const std::vector<std::string>& names,
              double time);

}  // namespace sg::calc_detail
