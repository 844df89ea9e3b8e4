// SPDX-License-Identifier: Apache-2.0
#include "serve/guard/users.h"

#include <fmt/core.h>
#include <sys/stat.h>

#include <algorithm>
#include <set>

#include "base/error.h"
#include "base/file/file.h"
#include "base/text/text.h"
#include "serve/guard/token.h"

namespace sg::serve {

namespace {

constexpr size_t most_users = 10'000, most_bytes = size_t(4) << 20;
constexpr std::string_view hash_mark = "sha256:";

bool is_name(std::string_view name) {
  const auto right = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' || c == '-' || c == '_' || c == '@';
  };
  return !name.empty() && name.size() <= 64 && std::all_of(name.begin(), name.end(), right);
}

bool is_hash(std::string_view text) {
  if (!text.starts_with(hash_mark) || text.size() != hash_mark.size() + 64) return false;
  const std::string_view digits = text.substr(hash_mark.size());
  return digits.find_first_not_of("0123456789abcdef") == digits.npos;
}

}  // namespace

std::string user_line(std::string_view name, Rights rights, std::string_view token) {
  if (!is_name(name))
    fail_usage(fmt::format("'{}' cannot be the name of a user", name), "users", "use letters, digits, '.', '-', '_' and '@', at most 64");
  return fmt::format("{} {} {}\n", name, word_of(rights), token_hash(token));
}

std::vector<User> parse_users(std::string_view text, const std::string& path) {
  std::vector<User> users;
  std::set<std::string, std::less<>> names, hashes;
  size_t number = 0;
  while (!text.empty()) {
    const size_t end = text.find('\n');
    const std::string_view line = trim(text.substr(0, end));
    text = end == text.npos ? std::string_view() : text.substr(end + 1);
    ++number;
    if (line.empty() || line[0] == '#') continue;
    const auto fail = [&](const std::string& what) {
      fail_data(what, fmt::format("{}, line {}", path, number), "NAME RIGHTS HASH, as in 'anna edit sha256:' and 64 hexadecimal digits");
    };
    const auto parts = words(line);
    if (parts.size() != 3) fail(fmt::format("has {} words", parts.size()));
    const auto rights = value_of_word<Rights>(parts[1]);
    if (!is_name(parts[0])) fail("the name is none");
    if (!rights) fail("the rights are neither 'view' nor 'edit'");
    if (!is_hash(parts[2])) fail("the hash is none");
    if (!names.emplace(parts[0]).second) fail(fmt::format("'{}' comes twice", parts[0]));
    if (!hashes.emplace(parts[2]).second) fail("another user has the same token");
    if (users.size() == most_users) fail(fmt::format("there are more than {} users", most_users));
    users.push_back({std::string(parts[0]), *rights, std::string(parts[2])});
  }
  return users;
}

std::vector<User> read_users(const std::string& path) {
  const MappedFile file(path);
  struct stat st {};
  if (::stat(path.c_str(), &st) == 0 && (st.st_mode & (S_IWGRP | S_IWOTH)) != 0)
    fail_data("others than its owner may write it", path, fmt::format("chmod go-w '{}'", path));
  if (file.size() > most_bytes) fail_data("is too large for a file of users", path);
  return parse_users(file.text(), path);
}

}  // namespace sg::serve
