// SPDX-License-Identifier: Apache-2.0
#include "base/schema/value.h"

#include <cmath>

#include "base/overloaded.h"
#include "base/text/text.h"

namespace sg {

namespace {

template <class T, class F>
std::string joined(const std::vector<T>& v, F&& text) {
  std::string r;
  for (size_t i = 0; i < v.size(); ++i) r += (i ? "," : "") + text(v[i]);
  return r;
}

std::string json_number(double v) { return std::isfinite(v) ? exact_number(v) : json_string(exact_number(v)); }

}  // namespace

std::string value_text(const Value& value) {
  return std::visit(Overloaded{
                        [](std::monostate) { return std::string("auto"); },
                        [](bool v) { return std::string(v ? "true" : "false"); },
                        [](int64_t v) { return std::to_string(v); },
                        [](double v) { return exact_number(v); },
                        [](const std::string& v) { return v; },
                        [](const std::vector<int64_t>& v) { return joined(v, [](int64_t i) { return std::to_string(i); }); },
                        [](const std::vector<double>& v) { return joined(v, exact_number); },
                        [](const std::vector<std::string>& v) { return joined(v, [](const std::string& s) { return s; }); },
                    },
                    value);
}

std::string value_json(const Value& value) {
  return std::visit(
      Overloaded{
          [](std::monostate) { return std::string("null"); },
          [](bool v) { return std::string(v ? "true" : "false"); },
          [](int64_t v) { return std::to_string(v); },
          [](double v) { return json_number(v); },
          [](const std::string& v) { return json_string(v); },
          [](const std::vector<int64_t>& v) { return "[" + joined(v, [](int64_t i) { return std::to_string(i); }) + "]"; },
          [](const std::vector<double>& v) { return "[" + joined(v, json_number) + "]"; },
          [](const std::vector<std::string>& v) { return "[" + joined(v, [](const std::string& s) { return json_string(s); }) + "]"; },
      },
      value);
}

}  // namespace sg
