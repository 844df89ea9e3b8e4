// SPDX-License-Identifier: Apache-2.0
#include "io/ensight/servers_file.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/error.h"
#include "base/file/file.h"
#include "base/text/text.h"
#include "io/ensight/case_file.h"

namespace sg::ensight {

namespace {

constexpr int64_t most_servers = 100'000;
/// Characters of all names that a pattern stands for: a few bytes could mean gigabytes.
constexpr uint64_t most_characters = 64 << 20;

class ServersParser {
 public:
  explicit ServersParser(const std::string& path) : path_(path), file_(path) {}

  std::vector<ServerCase> run() {
    std::string_view rest = file_.text();
    std::string section;
    for (line_ = 1; !rest.empty(); ++line_) {
      const size_t end = std::min(rest.find('\n'), rest.size());
      const std::string_view line = trim(rest.substr(0, end));
      rest.remove_prefix(std::min(end + 1, rest.size()));
      if (line.empty() || line[0] == '#') continue;
      const size_t colon = line.find(':');
      const std::string_view head = trim(line.substr(0, colon));
      // Some writers put a colon behind the name of a section.
      if (is_servers_section(head) && (colon == line.npos || colon + 1 == line.size())) {
        section = head;
        continue;
      }
      const std::string key = colon == line.npos ? std::string() : to_lower(head);
      const std::string_view value = trim(colon == line.npos ? line : line.substr(colon + 1));
      if (section == "FORMAT") format(key, value);
      else if (section == "SERVERS") server(key, value);
      else if (section == "MULTIPLE_CASEFILES") several(key, value);
      else if (section.empty()) fail("precedes the first section", "the first word of the file is FORMAT");
    }
    line_ = 0;
    if (!typed_) fail("does not state its type", "expected a section FORMAT with 'type: master_server gold'");
    return finish();
  }

 private:
  [[noreturn]] void fail(const std::string& problem, const std::string& hint = {}) const {
    fail_data(line_ ? fmt::format("line {}: {}", line_, problem) : problem, path_, hint);
  }

  static bool is_servers_section(std::string_view s) {
    for (const char* name : {"FORMAT", "SERVERS", "NETWORK_INTERFACES", "MULTIPLE_CASEFILES"})
      if (s == name) return true;
    return false;
  }

  int64_t count(std::string_view word, int64_t least, int64_t most) const {
    const auto n = parse_int(word);
    if (!n || *n < least || *n > most)
      fail(fmt::format("'{}' is no valid number here", word.substr(0, 40)), fmt::format("a whole number from {} to {}", least, most));
    return *n;
  }

  static std::string unquoted(std::string_view name) {
    if (name.size() >= 2 && (name[0] == '"' || name[0] == '\'') && name.back() == name[0]) name = name.substr(1, name.size() - 2);
    return std::string(name);
  }

  void format(const std::string& key, std::string_view value) {
    if (key != "type") return;  // how servers share one case and where they run
    const auto w = words(value);
    const bool master = !w.empty() && equal_ignoring_case(w[0], "master_server");
    // Each case file states its own type; here only those are refused that would be no case files.
    const bool ours =
        w.size() < 2 || equal_ignoring_case(w[1], "gold") || equal_ignoring_case(w[1], "ensight6") || equal_ignoring_case(w[1], "ensight");
    if (!master || !ours)
      fail(fmt::format("type '{}' is not supported", value.substr(0, 80)), "'master_server gold' and 'master_server ensight6' are");
    typed_ = true;
  }

  // A machine, a second path or a second case file begins the next server: paths may stand before or behind their case file.
  void server(const std::string& key, std::string_view value) {
    if (key == "number of servers") {
      const auto w = words(value);
      announced_ = count(w.empty() ? "" : w[0], 1, most_servers);
      repeats_ = w.size() > 1 && equal_ignoring_case(w[1], "repeat");
    } else if (key == "machine id") {
      begin();
    } else if (key == "data_path") {
      if (!open_.data_path.empty()) begin();
      open_.data_path = unquoted(value);
    } else if (key == "casefile") {
      if (!open_.case_file.empty()) begin();
      open_.case_file = unquoted(value);
      if (open_.case_file.empty()) fail("'casefile:' does not name a file");
    }
  }

  void begin() {
    if (!open_.case_file.empty()) cases_.push_back(std::move(open_));
    open_ = {};
  }

  // More case files than servers: as a list or as a pattern.
  void several(const std::string& key, std::string_view value) {
    if (key == "total number of cfiles") total_ = count(value, 1, most_servers);
    else if (key == "cfiles global path") global_ = unquoted(value);
    else if (key == "cfiles pattern") pattern_ = unquoted(value);
    else if (key == "cfiles start number") start_ = count(value, 0, INT32_MAX);
    else if (key == "cfiles increment") step_ = count(value, 1, INT32_MAX);
    else if (key == "cfiles" || (key.empty() && !listed_.empty())) listed_.push_back(unquoted(value));
    else
      fail(fmt::format("'{}' in section MULTIPLE_CASEFILES is not supported", key.empty() ? value.substr(0, 40) : key),
           "name the files by 'cfiles:' or 'cfiles pattern:'");
  }

  std::vector<ServerCase> finish() {
    begin();
    if (total_ > 0) {
      cases_.clear();
      const size_t names = std::max(listed_.size(), pattern_.empty() ? size_t(0) : size_t(total_));
      if (names * (pattern_.size() + global_.size()) > most_characters)
        fail(fmt::format("names {} case files of {} characters", names, pattern_.size() + global_.size()));
      for (int64_t i = 0; !pattern_.empty() && i < total_; ++i) listed_.push_back(with_number(pattern_, start_ + i * step_));
      announced_ = total_;
      for (std::string& name : listed_) cases_.push_back({0, std::move(name), global_});
    } else if (announced_ == 0) {
      fail("does not say how many servers there are", "expected a section SERVERS with 'number of servers: 2'");
    }
    for (size_t i = 0; i < cases_.size(); ++i) cases_[i].number = i + 1;
    if (cases_.empty() || (int64_t(cases_.size()) < announced_ && !repeats_))
      fail(fmt::format("announces {} case files but names {}", announced_, cases_.size()), "the file is truncated");
    cases_.resize(std::min(cases_.size(), size_t(announced_)));
    return std::move(cases_);
  }

  std::string path_;
  MappedFile file_;
  size_t line_ = 0;
  bool typed_ = false, repeats_ = false;
  int64_t announced_ = 0, total_ = 0, start_ = 0, step_ = 1;
  ServerCase open_;
  std::vector<ServerCase> cases_;
  std::string global_, pattern_;
  std::vector<std::string> listed_;
};

}  // namespace

std::vector<ServerCase> parse_servers(const std::string& path) { return ServersParser(path).run(); }

}  // namespace sg::ensight
