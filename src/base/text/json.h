// SPDX-License-Identifier: Apache-2.0
// JSON read into a bounded tree that never changes: copies share it. Query the type of a value before taking it: a file may contain
// anything.
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace sg {

class Json {
 public:
  using Members = std::vector<std::pair<std::string, Json>>;

  Json() = default;  ///< null
  explicit Json(bool v) : value_(v) {}
  explicit Json(uint64_t v) : value_(v) {}
  explicit Json(int64_t v) : value_(v) {}
  explicit Json(double v) : value_(v) {}
  Json(const char*) = delete;  ///< would be taken for a bool
  explicit Json(std::string v) : value_(std::make_shared<const std::string>(std::move(v))) {}
  explicit Json(std::vector<Json> list) : value_(std::make_shared<const std::vector<Json>>(std::move(list))) {}
  /// In that order; of members with the same name the last wins, at the position of the first.
  explicit Json(Members members);

  bool is_null() const { return is<std::monostate>(); }
  bool is_bool() const { return is<bool>(); }
  bool is_text() const { return is<Shared<std::string>>(); }
  bool is_list() const { return is<Shared<std::vector<Json>>>(); }
  bool is_object() const { return is<Shared<Object>>(); }
  bool is_number() const { return is<uint64_t>() || is<int64_t>() || is<double>(); }
  bool is_whole() const { return is<uint64_t>(); }  ///< written as an integer from 0 on that fits 64 bits
  bool is_real() const { return is<double>(); }     ///< written with a point or an exponent, or too large for an integer

  // The value if it has that type; else false, 0 and "".
  bool boolean() const;
  uint64_t whole() const;
  int64_t negative() const;  ///< of an integer below 0 that fits 64 bits
  double number() const;     ///< of any number
  const std::string& text() const;

  /// Items of a list or members of an object; 0 for anything else.
  size_t size() const;
  bool empty() const { return size() == 0; }
  /// Item i of a list; null when there is none.
  const Json& operator[](size_t i) const;
  /// The member of an object; a null pointer when there is none, and for anything else.
  const Json* find(std::string_view key) const;
  bool contains(std::string_view key) const { return find(key) != nullptr; }
  /// The member, or null.
  const Json& operator[](std::string_view key) const;
  /// Empty for all but lists, and for all but objects.
  const std::vector<Json>& items() const;
  const Members& members() const;

  /// As JSON without spaces.
  std::string dump() const;

 private:
  struct Object {
    Members members;
    std::vector<uint32_t> by_name;  ///< indices in the order of names, once there are many
  };
  template <class T>
  using Shared = std::shared_ptr<const T>;
  template <class T>
  bool is() const {
    return std::holds_alternative<T>(value_);
  }
  std::variant<std::monostate, bool, uint64_t, int64_t, double, Shared<std::string>, Shared<std::vector<Json>>, Shared<Object>> value_;
};

constexpr int deepest_json = 64;

/// Throws Error(data) naming `path` for what is not JSON and for what is nested deeper than deepest_json.
Json parse_json(std::string_view text, const std::string& path);

}  // namespace sg
