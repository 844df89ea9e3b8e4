// SPDX-License-Identifier: Apache-2.0
// Derivatives by duals and by the tape against those that symbolic rules give.
#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include "base/autodiff/dual.h"
#include "base/autodiff/tape.h"
#include "support/property.h"
#include "support/test.h"

using namespace sg;
using namespace sg::autodiff;

namespace {

enum class Rule {
  number,
  variable,
  plus,
  minus,
  times,
  over,
  power,
  sine,
  cosine,
  tangent,
  exponential,
  logarithm,
  root,
  tanh,
  arctan,
  square
};
struct Term;
using TermPtr = std::shared_ptr<const Term>;
struct Term {
  Rule rule;
  double number = 0;  // its value, the variable, the exponent
  TermPtr a, b;
};
TermPtr make(Rule r, TermPtr a = {}, TermPtr b = {}, double n = 0) {
  return std::make_shared<Term>(Term{r, n, std::move(a), std::move(b)});
}
TermPtr number(double v) { return make(Rule::number, {}, {}, v); }
TermPtr operator+(TermPtr a, TermPtr b) { return make(Rule::plus, a, b); }
TermPtr operator-(TermPtr a, TermPtr b) { return make(Rule::minus, a, b); }
TermPtr operator*(TermPtr a, TermPtr b) { return make(Rule::times, a, b); }
TermPtr operator/(TermPtr a, TermPtr b) { return make(Rule::over, a, b); }

template <class X>
X value(const TermPtr& t, const std::vector<X>& x) {
  using std::sin, std::cos, std::tan, std::exp, std::log, std::sqrt, std::tanh, std::atan, std::pow;
  switch (t->rule) {
    case Rule::number: return X(t->number);
    case Rule::variable: return x[size_t(t->number)];
    case Rule::plus: return value(t->a, x) + value(t->b, x);
    case Rule::minus: return value(t->a, x) - value(t->b, x);
    case Rule::times: return value(t->a, x) * value(t->b, x);
    case Rule::over: return value(t->a, x) / value(t->b, x);
    case Rule::power: return pow(value(t->a, x), t->number);
    case Rule::sine: return sin(value(t->a, x));
    case Rule::cosine: return cos(value(t->a, x));
    case Rule::tangent: return tan(value(t->a, x));
    case Rule::exponential: return exp(value(t->a, x));
    case Rule::logarithm: return log(value(t->a, x));
    case Rule::root: return sqrt(value(t->a, x));
    case Rule::tanh: return tanh(value(t->a, x));
    case Rule::arctan: return atan(value(t->a, x));
    case Rule::square: return value(t->a, x) * value(t->a, x);
  }
  return X(0);
}

TermPtr derivative(const TermPtr& t, int by) {
  const auto& a = t->a;
  const auto& b = t->b;
  const auto of = [&](TermPtr slope) { return slope * derivative(a, by); };
  switch (t->rule) {
    case Rule::number: return number(0);
    case Rule::variable: return number(int(t->number) == by);
    case Rule::plus: return derivative(a, by) + derivative(b, by);
    case Rule::minus: return derivative(a, by) - derivative(b, by);
    case Rule::times: return derivative(a, by) * b + a * derivative(b, by);
    case Rule::over: return (derivative(a, by) * b - a * derivative(b, by)) / (b * b);
    case Rule::power: return of(number(t->number) * make(Rule::power, a, {}, t->number - 1));
    case Rule::sine: return of(make(Rule::cosine, a));
    case Rule::cosine: return of(number(-1) * make(Rule::sine, a));
    case Rule::tangent: return of(number(1) / make(Rule::square, make(Rule::cosine, a)));
    case Rule::exponential: return of(t);
    case Rule::logarithm: return of(number(1) / a);
    case Rule::root: return of(number(0.5) / t);
    case Rule::tanh: return of(number(1) - t * t);
    case Rule::arctan: return of(number(1) / (number(1) + a * a));
    case Rule::square: return of(number(2) * a);
  }
  return {};
}

// Arguments stay where the functions are smooth, so that rounding is not blown up.
TermPtr some_term(test::Random& random, int depth) {
  if (depth == 0) return random.chance(0.7) ? make(Rule::variable, {}, {}, random.whole(0, 2)) : number(random.in(-2, 2));
  const TermPtr a = some_term(random, depth - 1), b = some_term(random, depth - 1), tame = make(Rule::tanh, a),
                positive = number(1.5) + make(Rule::sine, a);
  switch (random.whole(0, 12)) {
    case 0: return a + b;
    case 1: return a - b;
    case 2: return make(Rule::sine, a) * b;
    case 3: return a / (number(2) + make(Rule::cosine, b));
    case 4: return make(Rule::power, positive, {}, random.in(-2, 3));
    case 5: return make(Rule::power, tame, {}, random.whole(2, 4));
    case 6: return make(Rule::cosine, a);
    case 7: return make(Rule::tangent, tame);
    case 8: return make(Rule::exponential, tame);
    case 9: return make(Rule::logarithm, positive);
    case 10: return make(Rule::root, positive);
    case 11: return make(Rule::arctan, a);
    default: return tame;
  }
}

}  // namespace

TEST_CASE("property: automatic derivatives equal symbolic ones, first and second, forward and backward") {
  for (const uint64_t seed : test::property_seeds(300)) {
    CAPTURE(seed);
    test::Random random(seed);
    const TermPtr f = some_term(random, random.whole(1, 4));
    std::vector<double> x;
    for (int i = 0; i < 3; ++i) x.push_back(random.in(-1, 1));
    using D = Dual<double, 3>;
    std::vector<D> dx;
    std::vector<Dual<D, 3>> ddx;
    Tape<double> tape;
    Tape<D> tape_of_duals;
    std::vector<Var<double>> vx;
    std::vector<Var<D>> vdx;
    for (int i = 0; i < 3; ++i) {
      const double v = x[size_t(i)];
      dx.push_back(D::variable(v, i)), ddx.push_back(Dual<D, 3>::variable(D::variable(v, i), i));
      vx.push_back(tape.input(v)), vdx.push_back(tape_of_duals.input(D::variable(v, i)));
    }
    const double plain_value = value(f, x);
    const D forward = value(f, dx);
    const auto twice = value(f, ddx);
    const auto on_tape = value(f, vx);
    const auto gradient = tape.adjoints(on_tape);
    const auto mixed_on_tape = value(f, vdx);
    const auto mixed = tape_of_duals.adjoints(mixed_on_tape);
    CHECK(forward.value == plain_value);
    CHECK(on_tape.value == plain_value);
    for (int i = 0; i < 3; ++i) {
      const TermPtr by_i = derivative(f, i);
      const double first = value(by_i, x), scale = 1e-12 * (1 + std::abs(first));
      CHECK(std::abs(forward.d[size_t(i)] - first) <= scale);
      const bool known = size_t(vx[size_t(i)].node) < gradient.size();
      CHECK(std::abs((known ? gradient[size_t(vx[size_t(i)].node)] : 0) - first) <= scale);
      for (int j = 0; j < 3; ++j) {
        const double second = value(derivative(by_i, j), x), scale2 = 1e-10 * (1 + std::abs(second));
        CHECK(std::abs(twice.d[size_t(i)].d[size_t(j)] - second) <= scale2);
        CHECK(std::abs(mixed[size_t(vdx[size_t(i)].node)].d[size_t(j)] - second) <= scale2);
      }
    }
  }
}

TEST_CASE("autodiff: every elementary function against its closed derivative") {
  using D = Dual<double>;
  const double x = 0.37;
  const D a = D::variable(x, 0);
  const auto is = [](double got, double want) { CHECK(std::abs(got - want) <= 4e-16 * (1 + std::abs(want))); };
  is(asin(a).d[0], 1 / std::sqrt(1 - x * x)), is(acos(a).d[0], -1 / std::sqrt(1 - x * x)), is(atan(a).d[0], 1 / (1 + x * x));
  is(sinh(a).d[0], std::cosh(x)), is(cosh(a).d[0], std::sinh(x)), is(tan(a).d[0], 1 / std::pow(std::cos(x), 2));
  is(log2(a).d[0], 1 / (x * std::log(2))), is(log10(a).d[0], 1 / (x * std::log(10))), is(cbrt(a).d[0], std::pow(x, -2.0 / 3) / 3);
  is(abs(-a).d[0], 1), is(abs(a).d[0], 1), is(abs(D::variable(0, 0)).d[0], 0);
  is(pow(a, a).d[0], std::pow(x, x) * (std::log(x) + 1)), is(pow(2.0, a).d[0], std::pow(2, x) * std::log(2));
  is(atan2(a, D(2)).d[0], 2 / (4 + x * x)), is(atan2(D(2), a).d[0], -2 / (4 + x * x)), is(hypot(a, D(3)).d[0], x / std::hypot(x, 3));
  is(min(a, D(1)).d[0], 1), is(min(a, D(0)).d[0], 0), is(max(a, D(1)).d[0], 0), is((1.0 / a).d[0], -1 / (x * x));
  // Whole powers are smooth at 0, as often as they are derived.
  using DD = Dual<Dual<double>>;
  const DD zero = DD::variable(D::variable(0, 0), 0);
  CHECK(pow(zero, 2).d[0].d[0] == 2);
  CHECK(pow(zero, 1).d[0].d[0] == 0);
  CHECK(pow(zero, 0).d[0].d[0] == 0);
}

TEST_CASE("autodiff: a gradient costs one sweep, however many inputs there are; constants leave no trace") {
  Tape<double> tape;
  std::vector<Var<double>> x;
  for (int i = 0; i < 1000; ++i) x.push_back(tape.input(i));
  Var<double> sum = 0;
  for (const auto& v : x) sum += v * v * 0.5;
  CHECK(tape.size() < 5000);
  const auto& g = tape.adjoints(sum);
  for (size_t i = 0; i < 1000; ++i) CHECK(g[i] == double(i));
  const size_t before = tape.size();
  const Var<double> c = sin(Var<double>(2)) * 3.0;
  CHECK(tape.size() == before);
  CHECK(tape.adjoints(c)[0] == 0);
}
