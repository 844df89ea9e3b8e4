// SPDX-License-Identifier: Apache-2.0
#include "base/error.h"

#include <algorithm>
#include <cctype>

namespace sg {

Error::Error(ErrorKind kind, std::string problem, std::string where, std::string hint)
    : kind_(kind), problem_(std::move(problem)), where_(std::move(where)), hint_(std::move(hint)) {
  compose();
}

void Error::add_context(std::string doing) {
  context_.push_back(std::move(doing));
  compose();
}

void Error::compose() {
  text_ = where_.empty() ? problem_ : where_ + ": " + problem_;
  if (!hint_.empty()) text_ += "; " + hint_;
  if (context_.empty()) return;
  text_ += " (while ";
  for (size_t i = 0; i < context_.size(); ++i) text_ += (i ? ", while " : "") + context_[i];
  text_ += ")";
}

int Error::exit_code() const noexcept {
  switch (kind_) {
    case ErrorKind::usage: return 2;
    case ErrorKind::data: return 3;
    case ErrorKind::internal: return 4;
    case ErrorKind::cancelled: return 130;
  }
  return 4;
}

void fail_usage(std::string problem, std::string where, std::string hint) {
  throw Error(ErrorKind::usage, std::move(problem), std::move(where), std::move(hint));
}
void fail_data(std::string problem, std::string where, std::string hint) {
  throw Error(ErrorKind::data, std::move(problem), std::move(where), std::move(hint));
}
void fail_internal(std::string problem, std::string where) { throw Error(ErrorKind::internal, std::move(problem), std::move(where)); }

namespace {

// Optimal string alignment distance: insertion, deletion, substitution, swap of neighbours, each 1.
size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<size_t> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  for (size_t j = 0; j <= b.size(); ++j) last[j] = j;
  for (size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (a[i - 1] != b[j - 1])});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) row[j] = std::min(row[j], before[j - 2] + 1);
    }
    std::swap(before, last);
    std::swap(last, row);
  }
  return last[b.size()];
}

std::string lower(std::string_view s) {
  std::string r(s);
  for (char& c : r) c = char(std::tolower(static_cast<unsigned char>(c)));
  return r;
}

}  // namespace

std::string nearest_name(std::string_view name, std::span<const std::string> candidates) {
  const std::string wanted = lower(name);
  std::string best;
  size_t best_distance = std::max<size_t>(1, (wanted.size() + 1) / 2);  // more than half wrong: not meant
  for (const std::string& candidate : candidates) {
    const std::string have = lower(candidate);
    size_t d = edit_distance(wanted, have);
    if (wanted.size() >= 3 && have.starts_with(wanted)) d = std::min<size_t>(d, 1);
    if (d < best_distance || (d == best_distance && best.empty())) best_distance = d, best = candidate;
  }
  return best;
}

std::string unknown_name_hint(std::string_view name, std::span<const std::string> candidates) {
  if (candidates.empty()) return "none are available";
  std::string hint;
  if (std::string near = nearest_name(name, candidates); !near.empty()) hint = "did you mean '" + near + "'? ";
  hint += "available: ";
  constexpr size_t shown = 24;
  for (size_t i = 0; i < std::min(candidates.size(), shown); ++i) hint += (i ? ", " : "") + candidates[i];
  if (candidates.size() > shown) hint += ", ... (" + std::to_string(candidates.size()) + " in all)";
  return hint;
}

}  // namespace sg
