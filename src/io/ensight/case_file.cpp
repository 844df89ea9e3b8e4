// SPDX-License-Identifier: Apache-2.0
#include "io/ensight/case_file.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/file/file.h"
#include "base/file/file_fence.h"
#include "base/text/text.h"

namespace sg::ensight {

namespace {

constexpr int64_t most_steps = 10'000'000;

struct Line {
  size_t number;
  std::string key;        // lower case, before the colon; "" for lines that go on
  std::string_view text;  // behind the colon
};

bool is_section(std::string_view s) {
  for (const char* name : {"FORMAT", "GEOMETRY", "VARIABLE", "TIME", "FILE", "MATERIAL", "BLOCK_CONTINUATION", "SCRIPTS"})
    if (s == name) return true;
  return false;
}

class Parser {
 public:
  explicit Parser(const std::string& path) : file_(path) { case_.path = path; }

  CaseFile run() {
    std::string_view rest = file_.text();
    std::string section;
    bool typed = false;
    for (number_ = 1; !rest.empty(); ++number_) {
      const size_t end = std::min(rest.find('\n'), rest.size());
      std::string_view line = trim(rest.substr(0, end));
      rest.remove_prefix(std::min(end + 1, rest.size()));
      if (line.empty() || line[0] == '#') continue;
      if (is_section(line)) {
        section = line;
        list_ = nullptr, numbers_ = nullptr;
        continue;
      }
      const size_t colon = line.find(':');
      const bool keyed = colon != std::string_view::npos;
      const std::string key = keyed ? to_lower(trim(line.substr(0, colon))) : std::string();
      const std::string_view value = trim(keyed ? line.substr(colon + 1) : line);
      if (section == "FORMAT") {
        if (key == "type") case_.gold = is_gold(value), typed = true;
      } else if (section == "GEOMETRY") {
        geometry(key, value);
      } else if (section == "VARIABLE") {
        variable(key, value);
      } else if (section == "TIME") {
        time(key, value);
      } else if (section == "FILE") {
        file_set(key, value);
      } else if (section.empty()) {
        fail("precedes the first section", "the first word of a case file is FORMAT");
      } else if (list_once_ != section) {
        case_.left_out.push_back("section " + section), list_once_ = section;
      }
    }
    number_ = 0;
    if (!typed) fail("does not state its type", "expected a section FORMAT with 'type: ensight gold' or 'type: ensight'");
    finish();
    return std::move(case_);
  }

 private:
  [[noreturn]] void fail(const std::string& problem, const std::string& hint = {}) const {
    fail_data(number_ ? fmt::format("line {}: {}", number_, problem) : problem, case_.path, hint);
  }

  bool is_gold(std::string_view value) const {
    std::string type;
    for (std::string_view w : words(value)) type += (type.empty() ? "" : " ") + to_lower(w);
    if (type != "ensight gold" && type != "ensight")
      fail(fmt::format("type '{}' is not supported", value), "EnSight Gold ('type: ensight gold') and EnSight 6 ('type: ensight') are");
    return type == "ensight gold";
  }

  // Leading whole numbers, as many as leave `needed` words: time set, file set.
  void take_sets(std::vector<std::string>& w, size_t needed, FileRef& ref) const {
    int* const sets[2] = {&ref.time_set, &ref.file_set};
    for (int k = 0; k < 2 && w.size() > needed; ++k) {
      const auto n = parse_int(w.front());
      if (!n) break;
      if (*n < 1 || *n > 1'000'000) fail(fmt::format("'{}' is not a set number", w.front()));
      *sets[k] = int(*n);
      w.erase(w.begin());
    }
  }

  std::vector<std::string> value_words(std::string_view value) const {
    try {
      return quoted_words(value);
    } catch (const Error& e) {
      fail(e.problem());
    }
  }

  void geometry(const std::string& key, std::string_view value) {
    std::vector<std::string> w = value_words(value);
    if (key != "model" && key != "measured") {
      if (!key.empty()) case_.left_out.push_back("geometry '" + key + "'");
      return;
    }
    FileRef ref;
    take_sets(w, 1, ref);
    if (w.empty()) fail(fmt::format("'{}:' does not name a file", key));
    ref.name = w[0];
    if (key == "model") case_.model = ref;
    else case_.measured = ref;
  }

  void variable(const std::string& key, std::string_view value) {
    if (key.empty() && !case_.variables.empty() && case_.variables.back().kind == VariableKind::constant) {  // a long list continues
      for (std::string_view w : words(value)) case_.variables.back().constants.push_back(number(w));
      return;
    }
    if (key.empty()) fail("is not a variable", "write e.g. 'scalar per node: pressure p.****'");
    Variable v;
    const std::vector<std::string_view> k = words(key);
    auto has = [&](std::string_view word) { return std::find(k.begin(), k.end(), word) != k.end(); };
    std::vector<std::string> w = value_words(value);
    if (has("constant")) return constant(v, has("file"), w);
    v.complex = has("complex");
    v.measured = has("measured");
    if (has("element")) v.association = Association::cell;
    else if (!has("node")) return void(case_.left_out.push_back("variable '" + key + "'"));
    if (has("scalar")) v.kind = VariableKind::scalar;
    else if (has("vector")) v.kind = VariableKind::vector;
    else if (has("tensor")) v.kind = has("asym") || has("asymm") ? VariableKind::tensor_asym : VariableKind::tensor_symm;
    else return void(case_.left_out.push_back("variable '" + key + "'"));
    take_sets(w, v.complex ? 3 : 2, v.file);
    if (w.size() < (v.complex ? 3u : 2u)) fail("a variable needs a name and a file", "write e.g. 'scalar per node: pressure p.****'");
    v.name = w[0];
    v.file.name = w[1];
    if (v.complex) v.imaginary = v.file, v.imaginary.name = w[2];
    case_.variables.push_back(std::move(v));
  }

  void constant(Variable& v, bool from_file, std::vector<std::string>& w) {
    v.kind = VariableKind::constant;
    v.association = Association::whole;
    take_sets(w, 2, v.file);
    if (w.size() < 2) fail("a constant needs a name and a value");
    v.name = w[0];
    if (from_file) {
      v.file.name = w[1];
      read_list(w[1], v.constants);
      if (v.constants.empty()) fail(fmt::format("'{}' has no values", w[1]));
    } else {
      for (size_t i = 1; i < w.size(); ++i) v.constants.push_back(number(w[i]));
    }
    case_.variables.push_back(std::move(v));
  }

  double number(std::string_view word) const {
    const auto v = parse_double(word);
    if (!v) fail(fmt::format("'{}' is not a number", word.substr(0, 40)));
    return *v;
  }
  int64_t integer(std::string_view word) const {
    const auto v = parse_int(word);
    if (!v || *v < -most_steps * 100 || *v > most_steps * 100)
      fail(fmt::format("'{}' is not a valid whole number here", word.substr(0, 40)));
    return *v;
  }

  void read_list(const std::string& name, std::vector<double>& out) const {
    const MappedFile f(named_file(case_.path, name));
    for (std::string_view w : words(f.text())) out.push_back(number(w));
  }

  TimeSet& time_set() {
    if (case_.time_sets.empty()) case_.time_sets.emplace_back(), start_.emplace_back(), step_.emplace_back(1), count_.emplace_back(-1);
    return case_.time_sets.back();
  }

  void time(const std::string& key, std::string_view value) {
    if (key == "time set") {
      const auto w = words(value);
      case_.time_sets.emplace_back(), start_.emplace_back(), step_.emplace_back(1), count_.emplace_back(-1);
      if (!w.empty()) time_set().number = int(integer(w[0]));
      list_ = nullptr, numbers_ = nullptr;
      return;
    }
    TimeSet& t = time_set();
    if (!key.empty()) list_ = nullptr, numbers_ = nullptr;
    if (key == "number of steps") count_.back() = integer(value);
    else if (key == "filename start number") start_.back() = integer(value);
    else if (key == "filename increment") step_.back() = integer(value);
    else if (key == "filename numbers") numbers_ = &t.file_numbers;
    else if (key == "time values") list_ = &t.times;
    else if (key == "time values file") return read_list(std::string(value), t.times);
    else if (key == "filename numbers file") {
      std::vector<double> v;
      read_list(std::string(value), v);
      for (const double d : v) t.file_numbers.push_back(integer(exact_number(d)));
      return;
    } else if (!key.empty()) return void(case_.left_out.push_back("time '" + key + "'"));
    if (list_)
      for (std::string_view w : words(value)) list_->push_back(number(w));
    else if (numbers_)
      for (std::string_view w : words(value)) numbers_->push_back(integer(w));
    else if (key.empty()) fail(fmt::format("'{}' does not belong to anything", value.substr(0, 40)));
  }

  void file_set(const std::string& key, std::string_view value) {
    if (key == "file set") {
      case_.file_sets.push_back({int(integer(value)), {}, {}});
      index_ = -1;
      return;
    }
    if (case_.file_sets.empty()) case_.file_sets.emplace_back();
    if (key == "filename index") index_ = integer(value);
    else if (key == "number of steps") {
      const int64_t n = integer(value);
      if (n < 1 || n > most_steps) fail(fmt::format("has {} steps in a file", n));
      case_.file_sets.back().index.push_back(index_);
      case_.file_sets.back().steps.push_back(n);
    } else fail(fmt::format("unknown key '{}' in section FILE", key));
  }

  void finish() {
    if (case_.model.name.empty()) fail("does not name a geometry", "expected a section GEOMETRY with 'model: FILE'");
    for (size_t i = 0; i < case_.time_sets.size(); ++i) {
      TimeSet& t = case_.time_sets[i];
      const std::string what = fmt::format("time set {}: ", t.number);
      if (count_[i] >= 0 && uint64_t(count_[i]) > t.times.size())
        fail(what + fmt::format("has {} steps, but {} time values", count_[i], t.times.size()));
      if (count_[i] >= 0) t.times.resize(size_t(count_[i]));
      if (t.times.empty()) fail(what + "has no time values");
      for (const double v : t.times)
        if (!std::isfinite(v)) fail(what + "a time is not finite");
      if (t.file_numbers.empty() && start_[i])
        for (size_t k = 0; k < t.times.size(); ++k) t.file_numbers.push_back(*start_[i] + int64_t(k) * step_[i]);
      if (!t.file_numbers.empty() && t.file_numbers.size() < t.times.size())
        fail(what + fmt::format("has {} file numbers for {} steps", t.file_numbers.size(), t.times.size()));
    }
    auto check = [&](FileRef& ref) {
      // A pattern without a set uses the only one there is.
      if (ref.time_set == 0 && ref.name.find('*') != std::string::npos && !case_.time_sets.empty())
        ref.time_set = case_.time_sets[0].number;
      if (ref.time_set && !find_time_set(case_, ref.time_set))
        fail(fmt::format("'{}' uses time set {}, which does not exist", ref.name, ref.time_set));
      if (ref.name.find('*') != std::string::npos && !ref.time_set) fail(fmt::format("'{}' has a pattern but no time set", ref.name));
    };
    check(case_.model);
    if (case_.measured) check(*case_.measured);
    for (Variable& v : case_.variables) {
      check(v.file);
      if (v.complex) check(v.imaginary);
    }
  }

  MappedFile file_;
  CaseFile case_;
  size_t number_ = 0;
  std::string list_once_;
  std::vector<double>* list_ = nullptr;
  std::vector<int64_t>* numbers_ = nullptr;
  std::vector<std::optional<int64_t>> start_;
  std::vector<int64_t> step_, count_;
  int64_t index_ = -1;
};

}  // namespace

int Variable::components() const {
  switch (kind) {
    case VariableKind::vector: return 3;
    case VariableKind::tensor_symm: return 6;
    case VariableKind::tensor_asym: return 9;
    default: return 1;
  }
}

std::vector<double> CaseFile::times() const {
  std::vector<double> all;
  for (const TimeSet& t : time_sets) all.insert(all.end(), t.times.begin(), t.times.end());
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

std::string with_number(const std::string& pattern, int64_t number) {
  const size_t a = pattern.find('*');
  if (a == std::string::npos) return pattern;
  size_t b = a;
  while (b < pattern.size() && pattern[b] == '*') ++b;
  return pattern.substr(0, a) + fmt::format("{:0{}}", number, std::min<size_t>(b - a, 30)) + pattern.substr(b);
}

CaseFile parse_case(const std::string& path) { return Parser(path).run(); }

const TimeSet* find_time_set(const CaseFile& c, int number) {
  for (const TimeSet& t : c.time_sets)
    if (t.number == number) return &t;
  return nullptr;
}

size_t step_at(const TimeSet& set, std::optional<double> time) {
  size_t best = 0;
  if (time)
    for (size_t i = 0; i < set.times.size(); ++i)
      if (set.times[i] <= *time && (set.times[best] > *time || set.times[i] >= set.times[best])) best = i;
  return best;
}

FileStep file_at(const CaseFile& c, const FileRef& ref, std::optional<double> time) {
  FileStep r;
  const TimeSet* set = ref.time_set ? find_time_set(c, ref.time_set) : nullptr;
  const size_t step = set ? step_at(*set, time) : 0;
  std::string name = ref.name;
  const FileSet* files = nullptr;
  for (const FileSet& f : c.file_sets)
    if (ref.file_set && f.number == ref.file_set) files = &f;
  if (ref.file_set && !files) fail_data(fmt::format("'{}' uses file set {}, which does not exist", ref.name, ref.file_set), c.path);
  if (files) {
    auto left = int64_t(step);
    size_t k = 0;
    while (k < files->steps.size() && left >= files->steps[k]) left -= files->steps[k++];
    if (k == files->steps.size()) fail_data(fmt::format("file set {} has no step {}", ref.file_set, step), c.path);
    if (files->index[k] >= 0) name = with_number(name, files->index[k]);
    r.step = left;
  } else if (set && name.find('*') != std::string::npos) {
    if (set->file_numbers.empty())
      fail_data(fmt::format("time set {} gives no numbers for '{}'", set->number, name), c.path,
                "expected 'filename start number:' and 'filename increment:', or 'filename numbers:'");
    name = with_number(name, set->file_numbers[step]);
  }
  r.path = named_file(c.path, name);
  return r;
}

}  // namespace sg::ensight
