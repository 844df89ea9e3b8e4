// SPDX-License-Identifier: Apache-2.0
// Small classic netCDF files, byte by byte, for the tests of the readers on netCDF.
#pragma once
#include <bit>
#include <string>
#include <vector>

#include "base/bytes.h"
#include "data/array.h"

namespace sg::test {

/// A classic file in the making: dimensions (length 0 = records), variables with their numbers, attributes.
class NcBytes {
 public:
  /// version 1, 2 (64-bit offsets) or 5 (64-bit sizes).
  explicit NcBytes(int version = 1) : version_(version) {}

  int dim(const std::string& name, size_t length) {
    dims_.push_back({name, length});
    return int(dims_.size()) - 1;
  }
  template <class T>
  NcBytes& var(const std::string& name, const std::vector<int>& dims, const std::vector<T>& values) {
    Var v{name, dims, type_of<T>(), sizeof(T), {}, {}};
    for (const T& x : values) v.data += big(x);
    vars_.push_back(std::move(v));
    return *this;
  }
  /// Text of rows of one width, padded by zeros.
  NcBytes& words(const std::string& name, const std::vector<int>& dims, const std::vector<std::string>& rows) {
    std::vector<char> all;
    for (const std::string& row : rows)
      for (size_t i = 0; i < dims_[size_t(dims.back())].second; ++i) all.push_back(i < row.size() ? row[i] : '\0');
    return var(name, dims, all);
  }
  /// Attributes of the last variable, of the file before there is one.
  NcBytes& att(const std::string& name, const std::string& text) { return add({name, 2, text.size(), text}); }
  NcBytes& num(const std::string& name, const std::vector<double>& numbers) {
    Att a{name, 6, numbers.size(), {}};
    for (const double x : numbers) a.data += big(x);
    return add(std::move(a));
  }
  NcBytes& num32(const std::string& name, float number) { return add({name, 5, 1, big(number)}); }
  NcBytes& records(size_t n) {
    records_ = n;
    return *this;
  }

  std::string bytes() const {
    const size_t head = header(std::vector<size_t>(vars_.size(), 0)).size();
    std::vector<size_t> begins(vars_.size(), 0);
    size_t at = head, record = 0, record_vars = 0;
    for (size_t i = 0; i < vars_.size(); ++i)
      if (!is_record(vars_[i])) begins[i] = at, at += padded(vars_[i].data.size());
    for (size_t i = 0; i < vars_.size(); ++i)
      if (is_record(vars_[i])) begins[i] = at + record, record += padded(record_size(vars_[i])), ++record_vars;
    std::string file = header(begins);
    for (const Var& v : vars_)
      if (!is_record(v)) file += pad(v.data);
    for (size_t r = 0; r < records_; ++r)
      for (const Var& v : vars_)
        if (is_record(v)) {
          const std::string part = v.data.substr(r * record_size(v), record_size(v));
          file += record_vars == 1 ? part : pad(part);
        }
    return file;
  }

 private:
  struct Att {
    std::string name;
    int type;
    size_t count;
    std::string data;
  };
  struct Var {
    std::string name;
    std::vector<int> dims;
    int type;
    size_t size;
    std::string data;
    std::vector<Att> atts;
  };

  template <class T>
  static std::string big(T x) {
    std::string s(reinterpret_cast<const char*>(&x), sizeof x);
    return {s.rbegin(), s.rend()};
  }
  template <class T>
  static int type_of() {
    if constexpr (std::is_same_v<T, char>) return 2;
    else if constexpr (std::is_same_v<T, int8_t>) return 1;
    else if constexpr (std::is_same_v<T, int16_t>) return 3;
    else if constexpr (std::is_same_v<T, int32_t>) return 4;
    else if constexpr (std::is_same_v<T, float>) return 5;
    else if constexpr (std::is_same_v<T, double>) return 6;
    else return 10;  // 64-bit integers, version 5 only
  }
  static size_t padded(size_t n) { return (n + 3) / 4 * 4; }
  static std::string pad(std::string s) { return s.resize(padded(s.size()), '\0'), s; }
  bool is_record(const Var& v) const { return !v.dims.empty() && dims_[size_t(v.dims[0])].second == 0; }
  size_t record_size(const Var& v) const { return records_ ? v.data.size() / records_ : 0; }
  std::string count(size_t n) const { return version_ == 5 ? big(uint64_t(n)) : big(uint32_t(n)); }
  std::string name(const std::string& s) const { return count(s.size()) + pad(s); }
  std::string list(uint32_t tag, size_t n) const { return big(uint32_t(n ? tag : 0)) + count(n); }
  std::string atts(const std::vector<Att>& all) const {
    std::string s = list(12, all.size());
    for (const Att& a : all) s += name(a.name) + big(uint32_t(a.type)) + count(a.count) + pad(a.data);
    return s;
  }
  std::string header(const std::vector<size_t>& begins) const {
    std::string s = std::string("CDF") + char(version_) + count(records_) + list(10, dims_.size());
    for (const auto& [n, length] : dims_) s += name(n) + count(length);
    s += atts(atts_) + list(11, vars_.size());
    for (size_t i = 0; i < vars_.size(); ++i) {
      const Var& v = vars_[i];
      s += name(v.name) + count(v.dims.size());
      for (const int d : v.dims) s += count(size_t(d));
      s += atts(v.atts) + big(uint32_t(v.type)) + count(padded(is_record(v) ? record_size(v) : v.data.size()));
      s += version_ == 1 ? big(uint32_t(begins[i])) : big(uint64_t(begins[i]));
    }
    return s;
  }
  NcBytes& add(Att a) {
    (vars_.empty() ? atts_ : vars_.back().atts).push_back(std::move(a));
    return *this;
  }

  int version_;
  size_t records_ = 0;
  std::vector<std::pair<std::string, size_t>> dims_;
  std::vector<Att> atts_;
  std::vector<Var> vars_;
};

}  // namespace sg::test
