// SPDX-License-Identifier: Apache-2.0
#include "simulate/mechanics/expression.h"

#include <algorithm>

namespace sg::mechanics {

Expression::Expression(std::string_view text, const std::vector<std::string>& variables, const std::string& word) {
  using calc_detail::Op;
  const auto lookup = [&](std::string_view name) {
    return calc_detail::Symbol{std::find(variables.begin(), variables.end(), name) != variables.end(), 1, {}};
  };
  try {
    program_ = calc_detail::parse(text, lookup, variables, 0);
  } catch (const Error& e) {
    throw Error(e.kind(), e.problem(), "mechanics " + word, e.hint());
  }
  if (program_.needs_position)
    fail_usage("x, y, z or position is no coordinate of this system", "mechanics " + word, "name it in coordinates");
  for (size_t k = 0; k < program_.code.size(); ++k) {
    const calc_detail::Instruction& i = program_.code[k];
    const bool of_vectors = i.op == Op::mag || i.op == Op::norm || i.op == Op::dot || i.op == Op::cross || i.op == Op::sum ||
                            i.op == Op::trace || i.op == Op::det || i.op == Op::component;
    if (of_vectors || i.components != 1) fail_usage("vectors have no place in it", "mechanics " + word, "write it in numbers");
  }
  for (const std::string& f : program_.fields)
    variable_.push_back(size_t(std::find(variables.begin(), variables.end(), f) - variables.begin()));
}

}  // namespace sg::mechanics
