// SPDX-License-Identifier: Apache-2.0
// ParamRef: a member of a parameter struct, whatever its type, read and changed as a Value.
#pragma once
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/schema/enum_words.h"
#include "base/schema/value.h"
#include "base/vec.h"

namespace sg {

/// Name of a field in the input; empty = chosen by the operation (its help says how); "none" where no field is allowed.
struct FieldName {
  std::string name;
  bool empty() const { return name.empty(); }
  bool none() const { return name == "none"; }
  friend bool operator==(const FieldName&, const FieldName&) = default;
};

/// Type of a parameter, and the alternative of Value that represents it.
enum class ParamType {
  boolean,   ///< bool
  integer,   ///< int64_t
  number,    ///< double
  word,      ///< std::string; one of a few words where the member is an enum
  field,     ///< std::string: the name of a field
  point,     ///< std::vector<double> of three: a place or a direction
  integers,  ///< std::vector<int64_t>
  numbers,   ///< std::vector<double>
  words,     ///< std::vector<std::string>
};

namespace detail {

// What is not a template itself is defined in param_ref.cpp: nearly every file includes this header, and would compile Value's copies.
template <class T, ParamType Type, class Held = T>
struct PlainParam {
  static constexpr ParamType type = Type;
  static Value get(const T& v);
  static T from(const Value& v);
};

template <class T>
struct ParamTraits;
template <>
struct ParamTraits<bool> : PlainParam<bool, ParamType::boolean> {};
template <>
struct ParamTraits<int> : PlainParam<int, ParamType::integer, int64_t> {};
template <>
struct ParamTraits<int64_t> : PlainParam<int64_t, ParamType::integer> {};
template <>
struct ParamTraits<size_t> {
  static constexpr ParamType type = ParamType::integer;
  static Value get(const size_t& v);
  static size_t from(const Value& v);
};
template <>
struct ParamTraits<double> : PlainParam<double, ParamType::number> {};
template <>
struct ParamTraits<std::string> : PlainParam<std::string, ParamType::word> {};
template <>
struct ParamTraits<std::vector<int64_t>> : PlainParam<std::vector<int64_t>, ParamType::integers> {};
template <>
struct ParamTraits<std::vector<double>> : PlainParam<std::vector<double>, ParamType::numbers> {};
template <>
struct ParamTraits<std::vector<std::string>> : PlainParam<std::vector<std::string>, ParamType::words> {};
template <>
struct ParamTraits<FieldName> {
  static constexpr ParamType type = ParamType::field;
  static Value get(const FieldName& v);
  static FieldName from(const Value& v);
};
template <>
struct ParamTraits<Vec3> {
  static constexpr ParamType type = ParamType::point;
  static Value get(const Vec3& v);
  static Vec3 from(const Value& v);
};
Value value_of(std::string_view word);
std::string_view word_in(const Value& value);
template <WordedEnum E>
struct ParamTraits<E> {
  static constexpr ParamType type = ParamType::word;
  using Enum = E;
  static Value get(const E& v) { return value_of(word_of(v)); }
  static E from(const Value& v) { return value_of_word<E>(word_in(v)).value_or(E{}); }
};
template <WordedEnum E>
struct ParamTraits<std::vector<E>> {
  static constexpr ParamType type = ParamType::words;
  using Enum = E;
  static Value get(const std::vector<E>& v) {
    std::vector<std::string> words;
    for (const E e : v) words.emplace_back(word_of(e));
    return words;
  }
  static std::vector<E> from(const Value& v) {
    std::vector<E> values;
    for (const std::string& w : std::get<std::vector<std::string>>(v)) values.push_back(value_of_word<E>(w).value_or(E{}));
    return values;
  }
};
template <class T>
struct ParamTraits<std::optional<T>> : ParamTraits<T> {
  using Inner = ParamTraits<T>;
  static constexpr bool optional = true;
  static Value get(const std::optional<T>& v) { return v ? Inner::get(*v) : Value{}; }
  static std::optional<T> from(const Value& v) {
    if (std::holds_alternative<std::monostate>(v)) return std::nullopt;
    return Inner::from(v);
  }
};

/// What ParamRef knows of a type of members.
struct ParamAccess {
  ParamType type;
  bool optional;                            ///< may be left to the operation
  int64_t least, most;                      ///< what a whole number may hold
  std::span<const std::string_view> words;  ///< of an enum
  Value (*get)(const void*);
  void (*set)(void*, const Value&);
};

template <class E>
inline constexpr auto words_alone = [] {
  constexpr auto table = enum_words(E{});
  std::array<std::string_view, table.size()> words;
  for (size_t i = 0; i < table.size(); ++i) words[i] = table[i].word;
  return words;
}();

template <class T>
concept MayBeOpen = ParamTraits<T>::optional;
template <class T>
concept HasWords = std::is_enum_v<typename ParamTraits<T>::Enum>;

template <class T>
constexpr ParamAccess make_param_access() {
  using Traits = ParamTraits<T>;
  ParamAccess a{Traits::type, MayBeOpen<T>, INT64_MIN, INT64_MAX, {}, nullptr, nullptr};
  if constexpr (std::is_same_v<T, int> || std::is_same_v<T, std::optional<int>>) a.least = INT32_MIN, a.most = INT32_MAX;
  if constexpr (std::is_same_v<T, size_t> || std::is_same_v<T, std::optional<size_t>>) a.least = 0;
  if constexpr (HasWords<T>) a.words = words_alone<typename Traits::Enum>;
  a.get = [](const void* member) { return Traits::get(*static_cast<const T*>(member)); };
  a.set = [](void* member, const Value& v) { *static_cast<T*>(member) = Traits::from(v); };
  return a;
}

template <class T>
inline constexpr ParamAccess param_access = make_param_access<T>();

template <class View, class T>
inline constexpr ParamAccess view_access = {
    View::type,
    View::optional,
    INT64_MIN,
    INT64_MAX,
    {},
    [](const void* member) { return View::get(*static_cast<const T*>(member)); },
    [](void* member, const Value& v) { View::set(*static_cast<T*>(member), v); },
};

}  // namespace detail

/// A member that outlives the reference: bool, int, int64_t, size_t, double, std::string, FieldName, Vec3, an enum with words
/// (enum_words.h), lists of int64_t, double, std::string or such enums, and std::optional of any of these; or a view of a member of
/// another type.
class ParamRef {
 public:
  template <class T>
  explicit ParamRef(T& member) : access_(&detail::param_access<T>), member_(&member) {}
  /// `View` is a struct with `static constexpr ParamType type`, `static constexpr bool optional`, `static Value get(const T&)` and
  /// `static void set(T&, const Value&)`.
  template <class View, class T>
  static ParamRef seen_as(T& member) {
    return ParamRef(&detail::view_access<View, T>, &member);
  }

  ParamType type() const { return access_->type; }
  bool optional() const { return access_->optional; }
  int64_t least() const { return access_->least; }
  int64_t most() const { return access_->most; }
  std::span<const std::string_view> words() const { return access_->words; }

  Value get() const { return access_->get(member_); }
  /// `value` holds the alternative of type(), or nothing where optional(); a word is one of words(). set_value() sees to that.
  void set(const Value& value) const { access_->set(member_, value); }

 private:
  ParamRef(const detail::ParamAccess* access, void* member) : access_(access), member_(member) {}
  const detail::ParamAccess* access_;
  void* member_;
};

}  // namespace sg
