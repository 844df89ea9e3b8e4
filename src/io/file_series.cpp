// SPDX-License-Identifier: Apache-2.0
#include "io/file_series.h"

#include <fmt/core.h>
#include <sys/stat.h>

#include <algorithm>
#include <map>
#include <mutex>

#include "base/file/file.h"
#include "base/text/text.h"
#include "data/trusted.h"

namespace sg {

namespace {

constexpr std::string_view number_mark = "{n}";

bool is_pattern(std::string_view s) { return s.find('*') != s.npos || s.find('?') != s.npos || s.find(number_mark) != s.npos; }

// A list's parts, commas inside names restored.
std::vector<std::string> list_parts(std::string_view path) {
  std::vector<std::string> parts(1);
  for (size_t i = 0; i < path.size(); ++i) {
    if (path[i] == '\\' && i + 1 < path.size() && path[i + 1] == ',') parts.back() += path[++i];
    else if (path[i] == ',') parts.emplace_back();
    else parts.back() += path[i];
  }
  return parts;
}

std::string escaped(const std::string& name) {
  std::string r;
  for (const char c : name) r += c == ',' ? std::string("\\,") : std::string(1, c);
  return r;
}

bool is_digit(char c) { return c >= '0' && c <= '9'; }

// Whether `name` has the form of `pattern`. reach[i]: the pattern so far can end before letter i; never more than letters times marks.
bool matches(std::string_view pattern, std::string_view name) {
  if (!name.empty() && name[0] == '.' && (pattern.empty() || pattern[0] != '.')) return false;
  std::vector<char> reach(name.size() + 1, 0);
  reach[0] = 1;
  for (size_t p = 0; p < pattern.size();) {
    std::vector<char> next(reach.size(), 0);
    if (pattern[p] == '*') {
      bool any = false;
      for (size_t i = 0; i < reach.size(); ++i) next[i] = any = any || reach[i];
      ++p;
    } else if (pattern.substr(p).starts_with(number_mark)) {
      for (size_t i = 1; i < reach.size(); ++i) next[i] = is_digit(name[i - 1]) && (reach[i - 1] || next[i - 1]);
      p += number_mark.size();
    } else {
      for (size_t i = 1; i < reach.size(); ++i) next[i] = reach[i - 1] && (pattern[p] == '?' || pattern[p] == name[i - 1]);
      ++p;
    }
    reach = std::move(next);
  }
  return reach.back();
}

// Folder by folder; `base` ends in '/' or is empty.
void expand(const std::string& base, std::string_view rest, std::vector<std::string>& out) {
  const size_t slash = rest.find('/');
  const std::string_view part = rest.substr(0, slash);
  const bool last = slash == rest.npos;
  const auto go_on = [&](const std::string& name) {
    if (last) out.push_back(base + name);
    else if (is_folder(base + name) || name.empty()) expand(base + name + "/", rest.substr(slash + 1), out);
  };
  if (!is_pattern(part)) {
    if (!last || file_exists(base + std::string(part))) go_on(std::string(part));
    return;
  }
  if (!base.empty() && !is_folder(base)) return;
  for (const std::string& name : folder_entries(base.empty() ? "." : base))
    if (matches(part, name)) go_on(name);
}

[[noreturn]] void fail_no_match(const std::string& pattern) {
  const std::string name = file_name_of(pattern), folder = folder_of(pattern);
  if (is_pattern(folder)) fail_data(fmt::format("no file matches '{}'", pattern), {}, "{n} is a number, * any text, ? one letter");
  if (!folder.empty() && !is_folder(folder)) fail_data("no such folder", folder, fmt::format("looked for '{}' there", name));
  const std::vector<std::string> have = folder_entries(folder.empty() ? "." : folder);
  std::string plain = name;
  if (const size_t at = plain.find(number_mark); at != plain.npos) plain.replace(at, number_mark.size(), "0");
  std::erase(plain, '*');
  const std::string near = nearest_name(plain, have);
  std::string few;
  for (size_t i = 0; i < std::min<size_t>(have.size(), 4); ++i) few += (i ? ", " : "") + have[i];
  if (have.size() > 4) few += fmt::format(", ... ({} in all)", have.size());
  fail_data(fmt::format("no file matches '{}'", name), folder.empty() ? "the current folder" : folder,
            !near.empty()  ? fmt::format("the nearest name is '{}'", near)
            : have.empty() ? "it is empty"
                           : "it contains: " + few);
}

struct Stamp {
  int64_t size = 0, modified = 0;
  friend bool operator==(const Stamp&, const Stamp&) = default;
};

std::vector<Stamp> stamps_of(const std::vector<std::string>& files) {
  std::vector<Stamp> out;
  for (const std::string& f : files) {
    struct stat st {};
    if (::stat(f.c_str(), &st) == 0) out.push_back({st.st_size, int64_t(st.st_mtim.tv_sec) * 1'000'000'000 + st.st_mtim.tv_nsec});
    else fail_data("no such file", f);
  }
  return out;
}

/// The steps of a series: which file holds each, and its number there (-1: the file is one step).
struct Steps {
  std::vector<std::string> files;
  std::vector<Stamp> stamps;
  std::vector<double> times;
  std::vector<std::pair<size_t, int64_t>> places;
};

std::optional<double> time_inside(const std::string& file, ReadOptions options, Context& context) {
  options.header_only = true;
  std::optional<double> time;
  for_each_dataset(read_data(file, options, context), [&](const std::string&, const DatasetPtr& d) {
    if (!time) time = d->time();
  });
  return time;
}

std::vector<double> stated_times(const std::string& text, size_t steps) {
  const char* hint = "give START:STEP, e.g. 0:0.5, or as many times as there are steps";
  std::vector<double> times;
  if (const auto ends = split(text, ':'); ends.size() == 2) {
    const auto start = parse_double(ends[0]), step = parse_double(ends[1]);
    if (!start || !step || !std::isfinite(*start) || !std::isfinite(*step) || !(*step > 0))
      fail_usage(fmt::format("'{}' does not give the times of the files", text), "times", hint);
    for (size_t i = 0; i < steps; ++i) times.push_back(*start + *step * double(i));
    return times;
  }
  for (const std::string_view part : split(text, ',')) {
    const auto t = parse_double(part);
    if (!t || !std::isfinite(*t)) fail_usage(fmt::format("'{}' does not give the times of the files", text), "times", hint);
    times.push_back(*t);
  }
  if (times.size() != steps) fail_usage(fmt::format("{} times for {} steps", times.size(), steps), "times", hint);
  return times;
}

// Finds the steps, and the times given in the files themselves; false when these are to be counted. `order`: they have to grow.
bool own_times(Steps& s, bool order, const ReadOptions& options, Context& context) {
  bool known = true, inside = false;
  for (size_t i = 0; i < s.files.size(); ++i) {
    context.check();
    const std::vector<double> times = file_times(s.files[i], options, context);
    for (size_t k = 0; k < times.size(); ++k) s.places.emplace_back(i, int64_t(k)), s.times.push_back(times[k]);
    if (!times.empty()) continue;
    std::optional<double> time;
    if (i == 0 || inside) time = time_inside(s.files[i], options, context);
    inside = inside || (i == 0 && time);
    known = known && time && std::isfinite(*time);
    s.places.emplace_back(i, -1), s.times.push_back(time.value_or(0));
  }
  if (!known || !order || s.files.size() == 1) return known;
  const bool all_same =
      s.times.size() == s.files.size() && std::all_of(s.times.begin(), s.times.end(), [&](double t) { return t == s.times[0]; });
  if (all_same) return false;
  for (size_t k = 1; k < s.times.size(); ++k) {
    if (s.places[k].first == s.places[k - 1].first || s.times[k] > s.times[k - 1]) continue;
    fail_data(fmt::format("begins at the time {}, but the previous file, '{}', ends at {}", exact_number(s.times[k]),
                          file_name_of(s.files[s.places[k - 1].first]), exact_number(s.times[k - 1])),
              s.files[s.places[k].first], "list the files in order of time, or give the times: times=START:STEP");
  }
  return true;
}

std::shared_ptr<const Steps> steps_of(const std::string& path, ReadOptions options, Context& context) {
  static std::mutex mutex;
  static std::map<std::string, std::shared_ptr<const Steps>> known;
  const std::string key = path + '\n' + options.times + '\n' + options.format;
  auto steps = std::make_shared<Steps>();
  steps->files = series_files(path);
  steps->stamps = stamps_of(steps->files);
  {
    const std::lock_guard lock(mutex);
    if (const auto at = known.find(key); at != known.end() && at->second->files == steps->files && at->second->stamps == steps->stamps)
      return at->second;
  }
  const std::string stated = options.times;
  options.times.clear(), options.time.reset(), options.step = -1;
  const bool have = own_times(*steps, stated.empty(), options, context);
  if (!stated.empty()) steps->times = stated_times(stated, steps->times.size());
  else if (!have)
    for (size_t k = 0; k < steps->times.size(); ++k) steps->times[k] = double(k);
  const std::lock_guard lock(mutex);
  if (known.size() > 64) known.clear();
  return known[key] = std::move(steps);
}

}  // namespace

bool names_series(const std::string& path) { return (is_pattern(path) || path.find(',') != path.npos) && !file_exists(path); }

std::vector<std::string> series_files(const std::string& path) {
  std::vector<std::string> files;
  for (const std::string& part : list_parts(path)) {
    if (!is_pattern(part) || file_exists(part)) {
      if (!file_exists(part)) fail_data("no such file", part.empty() ? "''" : part, fmt::format("it is in the list '{}'", path));
      files.push_back(part);
      continue;
    }
    std::vector<std::string> some;
    const bool absolute = part.starts_with('/');
    expand(absolute ? "/" : "", std::string_view(part).substr(absolute ? 1 : 0), some);
    if (some.empty()) fail_no_match(part);
    std::sort(some.begin(), some.end(), natural_less);
    files.insert(files.end(), some.begin(), some.end());
  }
  return files;
}

std::string series_path(std::vector<std::string> files, bool sorted) {
  if (sorted) std::sort(files.begin(), files.end(), natural_less);
  std::string path;
  for (const std::string& f : files) path += (path.empty() ? "" : ",") + escaped(f);
  return path;
}

std::string map_series(const std::string& path, const std::function<std::string(const std::string&)>& f) {
  if (path.find(',') == path.npos || file_exists(path)) return f(path);
  std::string out;
  for (const std::string& part : list_parts(path)) out += (out.empty() ? "" : ",") + escaped(f(part));
  return out;
}

std::string series_beside(const std::string& beside, const std::string& path) {
  if (const std::string whole = path_beside(beside, path); file_exists(whole)) return whole;
  return map_series(path, [&](const std::string& part) { return path_beside(beside, part); });
}

std::vector<double> times_of_series(const std::string& path, const ReadOptions& options, Context& context) {
  return steps_of(path, options, context)->times;
}

Data read_of_series(const std::string& path, const ReadOptions& options, Context& context) {
  const auto steps = steps_of(path, options, context);
  const size_t step = chosen_step(steps->times, options, path);
  const auto [file, inside] = steps->places[step];
  ReadOptions one = options;
  one.times.clear(), one.time.reset();
  one.step = inside;
  return map_datasets(read_data(steps->files[file], one, context), [&](const DatasetPtr& d) {
    DatasetParts parts = d->parts();
    parts.time = steps->times[step];
    parts.notes.emplace_back("file", file_name_of(steps->files[file]));
    return make_trusted_dataset(std::move(parts));
  });
}

}  // namespace sg
