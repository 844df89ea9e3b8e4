// SPDX-License-Identifier: Apache-2.0
#include "base/schema/param_ref.h"

#include <algorithm>
#include <utility>

namespace sg::detail {

template <class T, ParamType Type, class Held>
Value PlainParam<T, Type, Held>::get(const T& v) {
  return Held(v);
}
template <class T, ParamType Type, class Held>
T PlainParam<T, Type, Held>::from(const Value& v) {
  return T(std::get<Held>(v));
}
template struct PlainParam<bool, ParamType::boolean>;
template struct PlainParam<int, ParamType::integer, int64_t>;
template struct PlainParam<int64_t, ParamType::integer>;
template struct PlainParam<double, ParamType::number>;
template struct PlainParam<std::string, ParamType::word>;
template struct PlainParam<std::vector<int64_t>, ParamType::integers>;
template struct PlainParam<std::vector<double>, ParamType::numbers>;
template struct PlainParam<std::vector<std::string>, ParamType::words>;

Value ParamTraits<size_t>::get(const size_t& v) { return int64_t(std::min<size_t>(v, INT64_MAX)); }
size_t ParamTraits<size_t>::from(const Value& v) { return size_t(std::get<int64_t>(v)); }

Value ParamTraits<FieldName>::get(const FieldName& v) { return v.name; }
FieldName ParamTraits<FieldName>::from(const Value& v) { return {std::get<std::string>(v)}; }

Value ParamTraits<Vec3>::get(const Vec3& v) { return std::vector<double>{v.x, v.y, v.z}; }
Vec3 ParamTraits<Vec3>::from(const Value& v) {
  const auto& c = std::get<std::vector<double>>(v);
  return {c[0], c[1], c[2]};
}

Value value_of(std::string_view word) { return std::string(word); }
std::string_view word_in(const Value& value) { return std::get<std::string>(value); }

}  // namespace sg::detail
