// SPDX-License-Identifier: Apache-2.0
#include <netcdf.h>

#include "base/parallel.h"
#include "base/text/text.h"
#include "io/plugins/netcdf/cf.h"

namespace sg::nc {

namespace {

constexpr size_t numbers_per_chunk = 1 << 16;
constexpr double nan_value = std::numeric_limits<double>::quiet_NaN();

struct Coding {
  std::vector<double> missing;
  double lo = -HUGE_VAL, hi = HUGE_VAL;  // valid packed values
  double scale = 1, offset = 0;
  bool scaled = false, default_fill = false;
  bool plain() const { return missing.empty() && !scaled && lo == -HUGE_VAL && hi == HUGE_VAL; }
};

Coding coding_of(const NcFile& file, const Variable& v) {
  Coding c;
  for (const char* name : {"_FillValue", "missing_value"})
    for (const double m : file.numbers(&v, name)) c.missing.push_back(m);
  if (const auto range = file.numbers(&v, "valid_range"); range.size() == 2) c.lo = range[0], c.hi = range[1];
  if (const auto lo = file.number(&v, "valid_min")) c.lo = *lo;
  if (const auto hi = file.number(&v, "valid_max")) c.hi = *hi;
  if (const auto s = file.number(&v, "scale_factor")) c.scale = *s, c.scaled = true;
  if (const auto o = file.number(&v, "add_offset")) c.offset = *o, c.scaled = true;
  // What the library leaves where nothing was written.
  if (c.missing.empty() && v.type == NC_FLOAT) c.missing.push_back(double(NC_FILL_FLOAT));
  if (c.missing.empty() && v.type == NC_DOUBLE) c.missing.push_back(NC_FILL_DOUBLE);
  return c;
}

template <class T, class Out>
Array decode(const View<T>& in, const Coding& c) {
  // A value is missing when it equals the marker as the variable's type holds it (1e20 as float is not 1e20 as double).
  std::vector<T> missing;
  for (const double m : c.missing)
    if (std::is_floating_point_v<T> || (m >= double(std::numeric_limits<T>::lowest()) && m <= double(std::numeric_limits<T>::max())))
      missing.push_back(T(m));
  Out* out = nullptr;
  Array r = Array::make<Out>(in.count, 1, &out);
  parallel_for(in.count, numbers_per_chunk, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const T v = in[i];
      bool good = double(v) >= c.lo && double(v) <= c.hi;
      for (const T m : missing) good = good && v != m;
      if constexpr (std::is_same_v<T, Out>) out[i] = good ? (c.scaled ? Out(double(v) * c.scale + c.offset) : v) : Out(nan_value);
      else out[i] = good ? Out(double(v) * c.scale + c.offset) : Out(nan_value);
    }
  });
  return r;
}

bool is_unsigned(const NcFile& file, const Variable& v) { return equal_ignoring_case(file.text(&v, "_Unsigned"), "true"); }

ElementType unsigned_of(ElementType t) {
  return t == ElementType::i8 ? ElementType::u8 : t == ElementType::i16 ? ElementType::u16 : t == ElementType::i32 ? ElementType::u32 : t;
}

// f32 where it holds every value that small stored numbers can represent.
bool narrow(const Coding& c, ElementType stored) {
  const bool small = element_size(stored) <= 2 || stored == ElementType::f32;
  const auto single = [](double x) { return double(float(x)) == x; };
  return small && single(c.scale) && single(c.offset);
}

}  // namespace

ElementType decoded_type(const NcFile& file, const Variable& v) {
  const ElementType stored = is_unsigned(file, v) ? unsigned_of(v.element()) : v.element();
  const Coding c = coding_of(file, v);
  return c.plain() ? stored : narrow(c, stored) ? ElementType::f32 : ElementType::f64;
}

Array decoded(const NcFile& file, const Variable& v, const Array& read) {
  Array stored = read;
  if (is_unsigned(file, v) && !is_float(read.type())) stored = Array(read.buffer(), unsigned_of(read.type()), read.count());
  const Coding c = coding_of(file, v);
  if (c.plain()) return stored;
  const bool single = narrow(c, stored.type());
  return dispatch(stored, [&](const auto& in) {
    using T = std::remove_cvref_t<decltype(in[0])>;
    return single ? decode<T, float>(in, c) : decode<T, double>(in, c);
  });
}

}  // namespace sg::nc
