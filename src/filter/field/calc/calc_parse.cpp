// SPDX-License-Identifier: Apache-2.0
// Recursive descent from text to instructions; sizes and units are checked here, so that running is pure arithmetic.
#include <fmt/core.h>

#include <algorithm>
#include <numbers>

#include "base/error.h"
#include "base/text/text.h"
#include "filter/field/calc/calc.h"
#include "filter/field/calc/calc_program.h"

namespace sg::calc_detail {

namespace {

constexpr int deepest = 200;
constexpr size_t most_instructions = 2000;

double sign_of(double x) { return x > 0 ? 1 : x < 0 ? -1 : x; }
double is_nan(double x) { return std::isnan(x) ? 1 : 0; }

struct Function1 {
  std::string_view name, form, sentence;
  double (*f)(double);
  enum { keeps_unit, drops_unit, square_root, cube_root } unit;
  Call call;
};
constexpr Function1 functions1[] = {
    {"sin", "sin(a)", "Sine of an angle in radians.", [](double x) { return std::sin(x); }, Function1::drops_unit, Call::sin},
    {"cos", "cos(a)", "Cosine of an angle in radians.", [](double x) { return std::cos(x); }, Function1::drops_unit, Call::cos},
    {"tan", "tan(a)", "Tangent of an angle in radians.", [](double x) { return std::tan(x); }, Function1::drops_unit, Call::tan},
    {"asin", "asin(a)", "Angle in radians, -pi/2 to pi/2, whose sine is a.", [](double x) { return std::asin(x); }, Function1::drops_unit,
     Call::asin},
    {"acos", "acos(a)", "Angle in radians, 0 to pi, whose cosine is a.", [](double x) { return std::acos(x); }, Function1::drops_unit,
     Call::acos},
    {"atan", "atan(a)", "Angle in radians, -pi/2 to pi/2, whose tangent is a.", [](double x) { return std::atan(x); },
     Function1::drops_unit, Call::atan},
    {"sinh", "sinh(a)", "Hyperbolic sine.", [](double x) { return std::sinh(x); }, Function1::drops_unit, Call::sinh},
    {"cosh", "cosh(a)", "Hyperbolic cosine.", [](double x) { return std::cosh(x); }, Function1::drops_unit, Call::cosh},
    {"tanh", "tanh(a)", "Hyperbolic tangent.", [](double x) { return std::tanh(x); }, Function1::drops_unit, Call::tanh},
    {"exp", "exp(a)", "e to the power a.", [](double x) { return std::exp(x); }, Function1::drops_unit, Call::exp},
    {"log", "log(a)", "Natural logarithm.", [](double x) { return std::log(x); }, Function1::drops_unit, Call::log},
    {"log10", "log10(a)", "Logarithm to base 10.", [](double x) { return std::log10(x); }, Function1::drops_unit, Call::log10},
    {"log2", "log2(a)", "Logarithm to base 2.", [](double x) { return std::log2(x); }, Function1::drops_unit, Call::log2},
    {"sqrt", "sqrt(a)", "Square root.", [](double x) { return std::sqrt(x); }, Function1::square_root, Call::sqrt},
    {"cbrt", "cbrt(a)", "Cube root, also of negative numbers.", [](double x) { return std::cbrt(x); }, Function1::cube_root, Call::cbrt},
    {"abs", "abs(a)", "Absolute value.", [](double x) { return std::fabs(x); }, Function1::keeps_unit, Call::abs},
    {"sign", "sign(a)", "1, -1 or 0 as a is positive, negative or zero.", sign_of, Function1::drops_unit, Call::sign},
    {"floor", "floor(a)", "Largest whole number not above a.", [](double x) { return std::floor(x); }, Function1::keeps_unit, Call::floor},
    {"ceil", "ceil(a)", "Smallest whole number not below a.", [](double x) { return std::ceil(x); }, Function1::keeps_unit, Call::ceil},
    {"round", "round(a)", "Nearest whole number; halves are rounded away from zero.", [](double x) { return std::round(x); },
     Function1::keeps_unit, Call::round},
    {"isnan", "isnan(a)", "1 where a is NaN, else 0.", is_nan, Function1::drops_unit, Call::isnan},
};

struct FunctionN {
  std::string_view name, form, sentence;
  Op op;
  int arguments;
};
constexpr FunctionN functions_n[] = {
    {"atan2", "atan2(a, b)", "Angle in radians, -pi to pi, of the point (b, a).", Op::atan2, 2},
    {"pow", "pow(a, b)", "a to the power b, as a ^ b.", Op::power, 2},
    {"mod", "mod(a, b)", "Remainder of a / b, as a % b.", Op::modulo, 2},
    {"min", "min(a, b)", "The smaller of two numbers.", Op::minimum, 2},
    {"max", "max(a, b)", "The larger of two numbers.", Op::maximum, 2},
    {"hypot", "hypot(a, b)", "Square root of a^2 + b^2.", Op::hypot, 2},
    {"clamp", "clamp(a, b, c)", "a, limited to the range from b to c.", Op::clamp, 3},
    {"if", "if(a, b, c)", "b where a is not 0, else c; as a ? b : c.", Op::choose, 3},
    {"mag", "mag(u)", "Length of a vector: square root of the sum of squares.", Op::mag, 1},
    {"norm", "norm(u)", "The vector divided by its length.", Op::norm, 1},
    {"dot", "dot(u, v)", "Scalar product of two vectors of the same size.", Op::dot, 2},
    {"cross", "cross(u, v)", "Vector product of two vectors of three numbers.", Op::cross, 2},
    {"vec", "vec(a, b, c)", "A vector of three numbers.", Op::vec, 3},
    {"sum", "sum(u)", "Sum of the components.", Op::sum, 1},
    {"trace", "trace(t)", "Sum of the diagonal of a 3x3 tensor.", Op::trace, 1},
    {"det", "det(t)", "Determinant of a 3x3 tensor.", Op::det, 1},
};

// Besides functions. In all forms a, b, c are numbers or fields of any size, u and v vectors, t a tensor of nine numbers, rows first.
constexpr HelpWord other_words[] = {
    {"operator", "a + b", "Sum; a number is added to each component of a vector."},
    {"operator", "a - b", "Difference."},
    {"operator", "a * b", "Product, component by component."},
    {"operator", "a / b", "Quotient, component by component."},
    {"operator", "a % b", "Remainder of a / b, with the sign of a."},
    {"operator", "a ^ b", "Power; right to left: a ^ b ^ c is a ^ (b ^ c), and -a ^ b is -(a ^ b)."},
    {"operator", "-a", "Negative."},
    {"operator", "a < b", "1 where true, else 0."},
    {"operator", "a <= b", "1 where true, else 0."},
    {"operator", "a > b", "1 where true, else 0."},
    {"operator", "a >= b", "1 where true, else 0."},
    {"operator", "a == b", "1 where true, else 0."},
    {"operator", "a != b", "1 where true, else 0."},
    {"operator", "a && b", "1 where both are not 0, else 0."},
    {"operator", "a || b", "1 where one of them is not 0, else 0."},
    {"operator", "!a", "1 where a is 0, else 0."},
    {"operator", "a ? b : c", "b where a is not 0, else c."},
    {"operator", "u.x", "First component; also .y and .z."},
    {"operator", "u[1]", "Component by number, counted from 0."},
    {"operator", "(a)", "Parentheses are evaluated first."},
    {"name", "\"a\"", "A field by its quoted name, for names with spaces or operators."},
    {"name", "x", "x coordinate of the point or cell centre, unless a field has that name; also y and z."},
    {"name", "position", "The three coordinates as a vector."},
    {"name", "time", "Time of the data."},
    {"name", "pi", "3.14159..."},
    {"name", "e", "2.71828..."},
    {"name", "nan", "Not a number: no value."},
};

class Parser {
 public:
  Parser(std::string_view text, const std::function<Symbol(std::string_view)>& lookup, const std::vector<std::string>& names, double time)
      : text_(text), lookup_(lookup), names_(names), time_(time) {}

  Program run() {
    const int last = ternary();
    blanks();
    if (at_ < text_.size()) fail("is not expected here");
    if (size_t(last) + 1 != program_.code.size()) {  // the result is the last register: copy an earlier one by adding nothing
      Instruction copy = {Op::vec, components(last), last};
      program_.code.push_back(copy), units_.push_back(units_[size_t(last)]);
    }
    program_.unit = units_.back();
    return std::move(program_);
  }

 private:
  [[noreturn]] void fail(const std::string& problem, const std::string& hint = {}, size_t at = SIZE_MAX) {
    const size_t place = at == SIZE_MAX ? at_ : at;
    const std::string what =
        place < text_.size() ? fmt::format("'{}' {}", text_.substr(place, 20), problem) : "the expression ends too early";
    fail_usage(fmt::format("{} (character {} of '{}')", what, place + 1, text_.substr(0, 200)), "calc expr", hint);
  }
  void blanks() {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t' || text_[at_] == '\n')) ++at_;
  }
  bool take(std::string_view token) {
    blanks();
    if (text_.substr(at_, token.size()) != token) return false;
    at_ += token.size();
    return true;
  }
  void expect(std::string_view token) {
    if (!take(token)) fail("is not expected here", fmt::format("a '{}' is missing", token));
  }
  int components(int r) const { return program_.code[size_t(r)].components; }
  const Unit& unit(int r) const { return units_[size_t(r)]; }
  int emit(Instruction i, Unit unit) {
    if (program_.code.size() >= most_instructions) fail_usage(fmt::format("has more than {} terms", most_instructions), "calc expr");
    program_.code.push_back(i);
    units_.push_back(std::move(unit));
    return int(program_.code.size()) - 1;
  }
  int constant(double v) { return emit({Op::constant, 1, -1, -1, -1, v}, {}); }

  // The size of a result of two operands; a scalar is combined with every component of the other.
  int joint(int a, int b, size_t place) {
    const int m = components(a), n = components(b);
    if (m != n && m != 1 && n != 1) fail(fmt::format("combines {} numbers with {}", m, n), "use components, e.g. v.x or v[0]", place);
    return std::max(m, n);
  }
  void note_units(const Unit& a, const Unit& b, const char* what) {
    if (a != b && !a.none() && !b.none() && program_.note.empty())
      program_.note = fmt::format("'{}' and '{}' are {}: the result has no unit", a.text(), b.text(), what);
  }
  int binary(Op op, int a, int b, size_t place) {
    const int n = joint(a, b, place);
    Unit u;
    if (op == Op::multiply) u = unit(a).times(unit(b));
    else if (op == Op::divide) u = unit(a).times(unit(b).to_power(-1));
    else if (op == Op::power) {
      const Instruction& e = program_.code[size_t(b)];
      if (e.op == Op::constant) u = unit(a).to_power(e.value);
    } else if (op == Op::add || op == Op::subtract || op == Op::modulo || op == Op::minimum || op == Op::maximum || op == Op::hypot) {
      note_units(unit(a), unit(b), "added or compared");
      if (unit(a) == unit(b)) u = unit(a);
      else if (unit(a).none()) u = unit(b);  // a bare number takes the other's unit
      else if (unit(b).none()) u = unit(a);
    } else if (op != Op::logical_and && op != Op::logical_or && op != Op::atan2) {
      note_units(unit(a), unit(b), "added or compared");
    }
    return emit({op, n, a, b}, u);
  }

  int ternary() {
    if (++depth_ > deepest) fail("is nested too deeply");
    int r = logical_or();
    const size_t place = at_;
    if (take("?")) {
      const int a = ternary();
      expect(":");
      const int b = ternary();
      r = choose(r, a, b, place);
    }
    --depth_;
    return r;
  }
  int choose(int condition, int a, int b, size_t place) {
    const int n = joint(a, b, place);
    if (components(condition) != 1 && components(condition) != n) fail("has a condition of a different size", {}, place);
    return emit({Op::choose, n, condition, a, b}, unit(a) == unit(b) ? unit(a) : Unit());
  }
  int logical_or() {
    int r = logical_and();
    for (size_t p = at_; take("||"); p = at_) r = binary(Op::logical_or, r, logical_and(), p);
    return r;
  }
  int logical_and() {
    int r = comparison();
    for (size_t p = at_; take("&&"); p = at_) r = binary(Op::logical_and, r, comparison(), p);
    return r;
  }
  int comparison() {
    int r = sum();
    for (;;) {
      const size_t p = at_;
      if (take("<=")) r = binary(Op::less_equal, r, sum(), p);
      else if (take(">=")) r = binary(Op::greater_equal, r, sum(), p);
      else if (take("==")) r = binary(Op::equal, r, sum(), p);
      else if (take("!=")) r = binary(Op::not_equal, r, sum(), p);
      else if (take("<")) r = binary(Op::less, r, sum(), p);
      else if (take(">")) r = binary(Op::greater, r, sum(), p);
      else return r;
    }
  }
  int sum() {
    int r = product();
    for (;;) {
      const size_t p = at_;
      if (take("+")) r = binary(Op::add, r, product(), p);
      else if (take("-")) r = binary(Op::subtract, r, product(), p);
      else return r;
    }
  }
  int product() {
    int r = unary();
    for (;;) {
      const size_t p = at_;
      if (take("*")) r = binary(Op::multiply, r, unary(), p);
      else if (take("/")) r = binary(Op::divide, r, unary(), p);
      else if (take("%")) r = binary(Op::modulo, r, unary(), p);
      else return r;
    }
  }
  // -x^2 is -(x^2), as in mathematics.
  int unary() {
    if (++depth_ > deepest) fail("is nested too deeply");
    int r;
    blanks();
    if (take("-")) {
      const int a = unary();
      r = emit({Op::negate, components(a), a}, unit(a));
    } else if (text_.substr(at_, 1) == "!" && text_.substr(at_, 2) != "!=") {
      ++at_;
      const int a = unary();
      r = emit({Op::logical_not, components(a), a}, {});
    } else if (take("+")) {
      r = unary();
    } else {
      r = postfix();
      const size_t p = at_;
      if (take("^")) {
        const bool minus = take("-");
        int e = minus ? postfix() : unary();
        if (minus) {
          const Instruction& i = program_.code[size_t(e)];
          e = i.op == Op::constant ? constant(-i.value) : emit({Op::negate, components(e), e}, {});
        }
        r = binary(Op::power, r, e, p);
      }
    }
    --depth_;
    return r;
  }
  int postfix() {
    int r = primary();
    for (;;) {
      const size_t p = at_;
      int c = -1;
      if (text_.substr(at_, 1) == "." && at_ + 1 < text_.size() && text_[at_ + 1] >= 'x' && text_[at_ + 1] <= 'z') {
        c = text_[at_ + 1] - 'x';
        at_ += 2;
      } else if (take("[")) {
        blanks();
        size_t end = at_;
        while (end < text_.size() && text_[end] >= '0' && text_[end] <= '9') ++end;
        const auto v = parse_int(text_.substr(at_, end - at_));
        if (!v || *v > 1000) fail("is not a component number", "components count from 0");
        c = int(*v);
        at_ = end;
        expect("]");
      } else {
        return r;
      }
      if (c >= components(r)) fail(fmt::format("asks for component {} of {}", c, components(r)), "components count from 0", p);
      r = emit({Op::component, 1, r, -1, -1, double(c)}, unit(r));
    }
  }
  int primary() {
    blanks();
    const size_t place = at_;
    if (take("(")) {
      const int r = ternary();
      expect(")");
      return r;
    }
    if (at_ >= text_.size()) fail("");
    const char c = text_[at_];
    if ((c >= '0' && c <= '9') || c == '.') return number();
    if (c == '"' || c == '`') {
      const size_t end = text_.find(c, at_ + 1);
      if (end == text_.npos) fail("opens a quote that is not closed");
      const std::string_view name = text_.substr(at_ + 1, end - at_ - 1);
      at_ = end + 1;
      return field(name, place);
    }
    size_t end = at_;
    while (end < text_.size() &&
           (std::isalnum(static_cast<unsigned char>(text_[end])) || text_[end] == '_' || static_cast<unsigned char>(text_[end]) >= 0x80))
      ++end;
    if (end == at_) fail("is not expected here");
    const std::string_view name = text_.substr(at_, end - at_);
    at_ = end;
    return take("(") ? call(name, place) : field(name, place);
  }
  int number() {
    size_t end = at_;
    auto digits = [&] {
      while (end < text_.size() && ((text_[end] >= '0' && text_[end] <= '9') || text_[end] == '.')) ++end;
    };
    digits();
    if (end + 1 < text_.size() && (text_[end] == 'e' || text_[end] == 'E') &&
        ((text_[end + 1] >= '0' && text_[end + 1] <= '9') ||
         ((text_[end + 1] == '-' || text_[end + 1] == '+') && end + 2 < text_.size()))) {
      end += 2;
      digits();
    }
    const auto v = parse_double(text_.substr(at_, end - at_));
    if (!v) fail("is not a number");
    at_ = end;
    return constant(*v);
  }
  int field(std::string_view name, size_t place) {
    const Symbol s = lookup_(name);
    if (s.known) {
      size_t i = 0;
      while (i < program_.fields.size() && program_.fields[i] != name) ++i;
      if (i == program_.fields.size()) program_.fields.emplace_back(name);
      Instruction f = {Op::field, s.components};
      f.field = i;
      return emit(f, s.unit);
    }
    if (name == "pi") return constant(std::numbers::pi);
    if (name == "e") return constant(std::numbers::e);
    if (name == "nan") return constant(std::nan(""));
    if (name == "time") return constant(time_);
    if (name == "position" || name == "x" || name == "y" || name == "z") {
      program_.needs_position = true;
      const int r = emit({Op::position, 3}, {});
      return name == "position" ? r : emit({Op::component, 1, r, -1, -1, double(name[0] - 'x')}, {});
    }
    std::string hint = unknown_name_hint(std::string(name), names_);
    fail("is not a field", hint + (hint.empty() ? "" : "; ") + "also available: x, y, z, position, time, pi, e", place);
  }
  int call(std::string_view name, size_t place) {
    std::vector<int> a;
    if (!take(")")) {
      do a.push_back(ternary());
      while (take(","));
      expect(")");
    }
    auto need = [&](int n) {
      if (int(a.size()) != n) fail(fmt::format("takes {} argument{}, not {}", n, n == 1 ? "" : "s", a.size()), {}, place);
    };
    for (const Function1& f : functions1)
      if (f.name == name) {
        need(1);
        Unit u;
        if (f.unit == Function1::keeps_unit) u = unit(a[0]);
        if (f.unit == Function1::square_root) u = unit(a[0]).to_power(0.5);
        if (f.unit == Function1::cube_root) u = unit(a[0]).to_power(1.0 / 3);
        Instruction i = {Op::call1, components(a[0]), a[0]};
        i.function = f.f, i.call = f.call;
        return emit(i, u);
      }
    for (const FunctionN& f : functions_n)
      if (f.name == name) {
        need(f.arguments);
        return call_n(f, a, place);
      }
    std::vector<std::string> known;
    for (const Function1& f : functions1) known.emplace_back(f.name);
    for (const FunctionN& f : functions_n) known.emplace_back(f.name);
    fail("is not a function", unknown_name_hint(std::string(name), known), place);
  }
  void need_size(int r, int n, size_t place) {
    if (components(r) != n) fail(fmt::format("needs {} numbers, not {}", n, components(r)), {}, place);
  }
  // A number, like 0 for what a plane has not, has any unit.
  Unit common_unit(const std::vector<int>& a) const {
    std::optional<Unit> common;
    for (const int r : a) {
      if (program_.code[size_t(r)].op == Op::constant) continue;
      if (common && !(*common == units_[size_t(r)])) return {};
      common = units_[size_t(r)];
    }
    return common.value_or(Unit());
  }
  int call_n(const FunctionN& f, const std::vector<int>& a, size_t place) {
    switch (f.op) {
      case Op::mag: return emit({f.op, 1, a[0]}, unit(a[0]));
      case Op::sum: return emit({f.op, 1, a[0]}, unit(a[0]));
      case Op::norm: return emit({f.op, components(a[0]), a[0]}, {});
      case Op::trace:
      case Op::det: need_size(a[0], 9, place); return emit({f.op, 1, a[0]}, f.op == Op::trace ? unit(a[0]) : unit(a[0]).to_power(3));
      case Op::dot:
        if (components(a[0]) != components(a[1])) fail("needs two vectors of the same size", {}, place);
        return emit({f.op, 1, a[0], a[1]}, unit(a[0]).times(unit(a[1])));
      case Op::cross:
        need_size(a[0], 3, place), need_size(a[1], 3, place);
        return emit({f.op, 3, a[0], a[1]}, unit(a[0]).times(unit(a[1])));
      case Op::vec:
        for (const int r : a) need_size(r, 1, place);
        return emit({f.op, 3, a[0], a[1], a[2]}, common_unit(a));
      case Op::clamp: {
        const int n = joint(a[0], a[1], place);
        if (components(a[2]) != 1 && components(a[2]) != n) fail("has limits of a different size", {}, place);
        return emit({f.op, n, a[0], a[1], a[2]}, unit(a[0]));
      }
      case Op::choose: return choose(a[0], a[1], a[2], place);
      default: return binary(f.op, a[0], a[1], place);
    }
  }

  std::string_view text_;
  const std::function<Symbol(std::string_view)>& lookup_;
  const std::vector<std::string>& names_;
  double time_;
  size_t at_ = 0;
  int depth_ = 0;
  Program program_;
  std::vector<Unit> units_;
};

}  // namespace

Program parse(std::string_view text, const std::function<Symbol(std::string_view)>& lookup, const std::vector<std::string>& names,
              double time) {
  return Parser(text, lookup, names, time).run();
}

std::vector<HelpWord> words() {
  std::vector<HelpWord> all(std::begin(other_words), std::end(other_words));
  for (const Function1& f : functions1) all.push_back({"function", f.form, f.sentence});
  for (const FunctionN& f : functions_n) all.push_back({"function", f.form, f.sentence});
  return all;
}

}  // namespace sg::calc_detail

namespace sg {

std::vector<HelpWord> calc_words() { return calc_detail::words(); }

std::vector<std::string> names_in_expression(std::string_view text) {
  std::vector<std::string> names;
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  const auto in_name = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) || c == '_' || static_cast<unsigned char>(c) >= 0x80;
  };
  for (size_t at = 0; at < text.size();) {
    const char c = text[at];
    size_t end = at + 1;
    if (c == '"' || c == '`') {
      end = std::min(text.find(c, at + 1), text.size());
      names.emplace_back(text.substr(at + 1, end - at - 1));
      ++end;
    } else if (is_digit(c)) {  // a number with its letter e
      while (end < text.size() && (in_name(text[end]) || text[end] == '.')) ++end;
    } else if (in_name(c)) {
      while (end < text.size() && in_name(text[end])) ++end;
      const size_t next = text.find_first_not_of(" \t\n", end);
      if (next == text.npos || text[next] != '(') names.emplace_back(text.substr(at, end - at));
    }
    at = end;
  }
  return names;
}

}  // namespace sg
