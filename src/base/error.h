// SPDX-License-Identifier: Apache-2.0
// Errors that say what is wrong, where, and what would be right.
#pragma once
#include <exception>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sg {

/// Who has to act: the caller (usage), the owner of the file (data), the developers (internal), nobody (cancelled).
enum class ErrorKind { usage, data, internal, cancelled };

/// The one exception type. what() reads "where: problem; hint (while A, while B)".
class Error : public std::exception {
 public:
  Error(ErrorKind kind, std::string problem, std::string where = {}, std::string hint = {});

  ErrorKind kind() const noexcept { return kind_; }
  const std::string& problem() const noexcept { return problem_; }
  const std::string& where() const noexcept { return where_; }
  const std::string& hint() const noexcept { return hint_; }
  const std::vector<std::string>& context() const noexcept { return context_; }
  const char* what() const noexcept override { return text_.c_str(); }

  /// Adds what was being done, innermost first ("reading 'a.vti'").
  void add_context(std::string doing);
  /// Process exit code: usage 2, data 3, internal 4, cancelled 130.
  int exit_code() const noexcept;

 private:
  void compose();
  ErrorKind kind_;
  std::string problem_, where_, hint_, text_;
  std::vector<std::string> context_;
};

[[noreturn]] void fail_usage(std::string problem, std::string where = {}, std::string hint = {});
[[noreturn]] void fail_data(std::string problem, std::string where = {}, std::string hint = {});
[[noreturn]] void fail_internal(std::string problem, std::string where = {});

/// Runs f and adds `doing` to the context chain of an Error that leaves it.
template <class F>
decltype(auto) with_context(std::string_view doing, F&& f) {
  try {
    return f();
  } catch (Error& e) {
    e.add_context(std::string(doing));
    throw;
  }
}

/// The candidate nearest to `name` (Damerau-Levenshtein, case ignored), or "" when none is close enough.
std::string nearest_name(std::string_view name, std::span<const std::string> candidates);

/// Hint for an unknown name: "did you mean 'temperature'? available: temperature, pressure".
std::string unknown_name_hint(std::string_view name, std::span<const std::string> candidates);

}  // namespace sg
