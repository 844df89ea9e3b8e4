// SPDX-License-Identifier: Apache-2.0
// XDMF: Function items. "$0 + $1" and the like number by number, in double; JOIN puts its arguments side by side.
#include <fmt/core.h>

#include <algorithm>

#include "base/text/text.h"
#include "io/text/text_scan.h"
#include "io/xdmf/xdmf.h"

namespace sg::xdmf {

namespace {

using Values = std::vector<double>;  // one number counts for all places

class Evaluator {
 public:
  Evaluator(std::string_view text, const std::vector<Item>& arguments, const std::string& where)
      : text_(text), p_(text.data()), end_(text.data() + text.size()), arguments_(arguments), where_(where) {}

  Values run() {
    Values v = sum(0);
    blanks();
    if (p_ != end_) fail(fmt::format("has '{}' left over", std::string_view(p_, size_t(end_ - p_))));
    return v;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    fail_data(fmt::format("the function '{}' {}", text_.substr(0, 200), what), where_,
              "supported: + - * / ( ), numbers, $0 ..., ABS SQRT EXP LOG SIN COS TAN, JOIN");
  }
  void blanks() {
    while (p_ < end_ && is_space(*p_)) ++p_;
  }
  bool take(char c) {
    blanks();
    if (p_ == end_ || *p_ != c) return false;
    ++p_;
    return true;
  }
  template <class F>
  Values combine(const Values& a, const Values& b, F f) const {
    if (a.size() != b.size() && a.size() != 1 && b.size() != 1) fail(fmt::format("combines {} with {} numbers", a.size(), b.size()));
    Values r(std::max(a.size(), b.size()));
    if (a.empty() || b.empty()) return {};
    for (size_t i = 0; i < r.size(); ++i) r[i] = f(a[a.size() == 1 ? 0 : i], b[b.size() == 1 ? 0 : i]);
    return r;
  }
  Values sum(int depth) {
    if (depth > 64) fail("is nested too deeply");
    Values v = term(depth);
    for (;;) {
      if (take('+')) v = combine(v, term(depth), [](double a, double b) { return a + b; });
      else if (take('-')) v = combine(v, term(depth), [](double a, double b) { return a - b; });
      else return v;
    }
  }
  Values term(int depth) {
    Values v = factor(depth);
    for (;;) {
      if (take('*')) v = combine(v, factor(depth), [](double a, double b) { return a * b; });
      else if (take('/')) v = combine(v, factor(depth), [](double a, double b) { return a / b; });
      else return v;
    }
  }
  Values factor(int depth) {
    if (depth > 64) fail("is nested too deeply");
    if (take('-')) return combine({0.0}, factor(depth + 1), [](double a, double b) { return a - b; });
    if (take('(')) {
      Values v = sum(depth + 1);
      if (!take(')')) fail("lacks a ')'");
      return v;
    }
    if (take('$')) return argument();
    blanks();
    double number = 0;
    if (p_ < end_ && (is_digit(*p_) || *p_ == '.') && scan_number(p_, end_, number)) return {number};
    const char* begin = p_;
    while (p_ < end_ && std::isalpha(static_cast<unsigned char>(*p_))) ++p_;
    return call(to_lower({begin, size_t(p_ - begin)}), depth);
  }
  Values argument() {
    int64_t i = -1;
    if (!scan_number(p_, end_, i) || i < 0 || size_t(i) >= arguments_.size())
      fail(fmt::format("names an argument that does not exist; it has {}", arguments_.size()));
    const Array a = arguments_[size_t(i)].values.converted(ElementType::f64);
    const auto v = a.view<double>();
    Values r(a.count());
    for (size_t k = 0; k < r.size(); ++k) r[k] = v(k);
    return r;
  }
  Values call(const std::string& name, int depth) {
    if (name.empty() || !take('(')) fail(name.empty() ? "ends too early" : fmt::format("has '{}' without '('", name));
    std::vector<Values> list;
    do list.push_back(sum(depth + 1));
    while (take(',') || take(';'));
    if (!take(')')) fail("lacks a ')'");
    if (name == "join") {  // tuple by tuple: argument 0, argument 1, ...
      size_t n = 0;
      for (const Values& v : list) n = std::max(n, v.size());
      Values r;
      r.reserve(n * list.size());
      for (const Values& v : list)
        if (v.size() != n && v.size() != 1) fail(fmt::format("joins {} with {} numbers", n, v.size()));
      for (size_t i = 0; i < n; ++i)
        for (const Values& v : list) r.push_back(v[v.size() == 1 ? 0 : i]);
      return r;
    }
    constexpr std::pair<const char*, double (*)(double)> functions[] = {
        {"abs", [](double x) { return std::fabs(x); }}, {"sqrt", [](double x) { return std::sqrt(x); }},
        {"exp", [](double x) { return std::exp(x); }},  {"log", [](double x) { return std::log(x); }},
        {"sin", [](double x) { return std::sin(x); }},  {"cos", [](double x) { return std::cos(x); }},
        {"tan", [](double x) { return std::tan(x); }}};
    for (const auto& [known, f] : functions)
      if (name == known && list.size() == 1) {
        for (double& x : list[0]) x = f(x);
        return std::move(list[0]);
      }
    fail(fmt::format("calls '{}' with {} arguments", name, list.size()));
  }

  std::string_view text_;
  const char *p_, *end_;
  const std::vector<Item>& arguments_;
  const std::string& where_;
};

}  // namespace

Item evaluate_function(std::string_view text, const std::vector<Item>& arguments, const std::string& where) {
  Values v = Evaluator(text, arguments, where).run();
  // Results are as wide as the widest argument: f64, or f32 when all fit.
  bool narrow = !arguments.empty();
  for (const Item& a : arguments) narrow = narrow && (a.values.type() == ElementType::f32 || element_size(a.values.type()) < 4);
  Item item{Array::from_vector(std::move(v)), {}};
  if (narrow) item.values = item.values.converted(ElementType::f32);
  item.dims = {item.values.count()};
  for (const Item& a : arguments)
    if (a.values.count() == item.values.count()) item.dims = a.dims;
  return item;
}

}  // namespace sg::xdmf
