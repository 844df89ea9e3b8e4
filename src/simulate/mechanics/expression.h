// SPDX-License-Identifier: Apache-2.0
// Expressions of `calc` over numbers of any kind, such as those that carry derivatives.
#pragma once
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/autodiff/functions.h"
#include "base/error.h"
#include "filter/field/calc/calc_program.h"

namespace sg::mechanics {

/// A formula of some variables, each a number.
class Expression {
 public:
  /// Throws Error(usage), naming `word`, for mistakes, for names that are not among the variables, and for vectors.
  Expression(std::string_view text, const std::vector<std::string>& variables, const std::string& word);

  /// Its value where the variables have these.
  template <class X>
  X value(std::span<const X> variables) const;

 private:
  calc_detail::Program program_;
  std::vector<size_t> variable_;  // of each of the program's fields
};

namespace detail {

template <class X>
X call(calc_detail::Call c, const X& a, double plain_result) {
  using calc_detail::Call;
  using std::sin, std::cos, std::tan, std::asin, std::acos, std::atan, std::sinh, std::cosh, std::tanh, std::exp, std::log, std::log2,
      std::log10, std::sqrt, std::cbrt, std::abs;
  switch (c) {
    case Call::sin: return sin(a);
    case Call::cos: return cos(a);
    case Call::tan: return tan(a);
    case Call::asin: return asin(a);
    case Call::acos: return acos(a);
    case Call::atan: return atan(a);
    case Call::sinh: return sinh(a);
    case Call::cosh: return cosh(a);
    case Call::tanh: return tanh(a);
    case Call::exp: return exp(a);
    case Call::log: return log(a);
    case Call::log10: return log10(a);
    case Call::log2: return log2(a);
    case Call::sqrt: return sqrt(a);
    case Call::cbrt: return cbrt(a);
    case Call::abs: return abs(a);
    default: return X(plain_result);  // steps, which are level between their ends
  }
}

}  // namespace detail

template <class X>
X Expression::value(std::span<const X> variables) const {
  using autodiff::plain;
  using calc_detail::Op;
  using std::min, std::max, std::pow, std::atan2, std::hypot;
  std::vector<X> r(program_.code.size());
  for (size_t k = 0; k < r.size(); ++k) {
    const calc_detail::Instruction& i = program_.code[k];
    const auto a = [&]() -> const X& { return r[size_t(i.a)]; };
    const auto b = [&]() -> const X& { return r[size_t(i.b)]; };
    switch (i.op) {
      case Op::constant: r[k] = X(i.value); break;
      case Op::field: r[k] = variables[variable_[i.field]]; break;
      case Op::negate: r[k] = -a(); break;
      case Op::add: r[k] = a() + b(); break;
      case Op::subtract: r[k] = a() - b(); break;
      case Op::multiply: r[k] = a() * b(); break;
      case Op::divide: r[k] = a() / b(); break;
      case Op::modulo: r[k] = a() - b() * X(std::floor(plain(a()) / plain(b()))); break;
      case Op::power: {
        const calc_detail::Instruction& e = program_.code[size_t(i.b)];
        r[k] = e.op == Op::constant ? pow(a(), e.value) : pow(a(), b());
        break;
      }
      case Op::less: r[k] = X(plain(a()) < plain(b())); break;
      case Op::less_equal: r[k] = X(plain(a()) <= plain(b())); break;
      case Op::greater: r[k] = X(plain(a()) > plain(b())); break;
      case Op::greater_equal: r[k] = X(plain(a()) >= plain(b())); break;
      case Op::equal: r[k] = X(plain(a()) == plain(b())); break;
      case Op::not_equal: r[k] = X(plain(a()) != plain(b())); break;
      case Op::logical_and: r[k] = X(plain(a()) != 0 && plain(b()) != 0); break;
      case Op::logical_or: r[k] = X(plain(a()) != 0 || plain(b()) != 0); break;
      case Op::logical_not: r[k] = X(plain(a()) == 0); break;
      case Op::choose: r[k] = plain(a()) != 0 ? b() : r[size_t(i.c)]; break;
      case Op::call1: r[k] = detail::call(i.call, a(), i.function(plain(a()))); break;
      case Op::minimum: r[k] = min(a(), b()); break;
      case Op::maximum: r[k] = max(a(), b()); break;
      case Op::atan2: r[k] = atan2(a(), b()); break;
      case Op::hypot: r[k] = hypot(a(), b()); break;
      case Op::clamp: r[k] = min(max(a(), b()), r[size_t(i.c)]); break;
      default: r[k] = a(); break;  // of one number: the copy at the end of a program
    }
  }
  return r.back();
}

}  // namespace sg::mechanics
