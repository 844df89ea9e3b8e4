// SPDX-License-Identifier: Apache-2.0
// EnSight's server of servers (.sos): a model whose portions are cases of their own, one for each server. A part that several of them have
// is a collection of its portions.
#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>

#include "base/file/file.h"
#include "base/file/file_fence.h"
#include "base/text/text.h"
#include "io/ensight/case_file.h"
#include "io/ensight/servers_file.h"
#include "io/formats.h"
#include "io/vtk/vtk_missing.h"

namespace sg {

using namespace ensight;

namespace {

struct FoundCase {
  size_t number;
  std::string path;
};

// Paths of data are those of the machines where the servers ran: where they do not lead to the case file, it is looked for beside the
// .sos file, as after a copy.
std::string case_path(const std::string& path, const ServerCase& c) {
  const bool absolute = c.case_file.starts_with('/');
  const std::string beside = absolute ? file_name_of(c.case_file) : c.case_file;
  if (c.data_path.empty() && !absolute) return named_file(path, beside);
  std::string there;
  try {
    there = named_file(path, absolute ? c.case_file : c.data_path + "/" + c.case_file);
    if (file_exists(there)) return there;
  } catch (const Error&) {
    if (!file_exists(named_file(path, beside))) throw;
  }
  const std::string copied = named_file(path, beside);
  return there.empty() || file_exists(copied) ? copied : there;
}

std::vector<FoundCase> cases_of(const std::string& path, Context* warn) {
  vtk::MissingFiles missing;
  std::vector<FoundCase> found;
  std::set<std::filesystem::path> known;  // servers that divide one case among them name it repeatedly, in whatever spelling
  for (const ServerCase& c : parse_servers(path)) {
    std::string file = case_path(path, c);
    std::error_code error;
    if (const auto place = std::filesystem::weakly_canonical(file, error); !error && !known.insert(place).second) continue;
    if (missing.lacks(file)) continue;
    missing.found();
    found.push_back({c.number, std::move(file)});
  }
  Context quiet;
  missing.tell(path, warn ? *warn : quiet);
  return found;
}

// The same in all cases, if they are portions of one model; else each is read at its step nearest to the chosen time.
std::vector<double> times_of_servers(const std::vector<FoundCase>& cases) {
  std::vector<double> all;
  for (const FoundCase& c : cases) {
    const std::vector<double> times = parse_case(c.path).times();
    all.insert(all.end(), times.begin(), times.end());
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
  }
  return all;
}

// Parts of the same name; of several in one case the first goes with the first of the others.
struct Portions {
  std::string name;
  std::vector<Collection::Part> parts;
};

class PortionsOf {
 public:
  void add(const FoundCase& from, const Data& data) {
    std::map<std::string, size_t> met;
    const auto* collection = std::get_if<CollectionPtr>(&data);
    if (!collection) return;
    for (const Collection::Part& part : (*collection)->parts) {
      const auto key = std::pair(part.name, met[part.name]++);
      const auto [at, is_new] = index_.emplace(key, all_.size());
      if (is_new) all_.push_back({part.name, {}});
      all_[at->second].parts.push_back({fmt::format("server {}", from.number), part.data});
    }
  }

  Data joined() {
    auto out = std::make_shared<Collection>();
    for (Portions& p : all_) {
      // All cases list all parts: those that are empty at a server are no portions.
      const auto filled = [](const Collection::Part& part) {
        const auto* d = std::get_if<DatasetPtr>(&part.data);
        return !d || (*d)->point_count() > 0;
      };
      std::vector<Collection::Part> kept;
      std::copy_if(p.parts.begin(), p.parts.end(), std::back_inserter(kept), filled);
      if (kept.empty()) kept.push_back(p.parts[0]);
      if (kept.size() == 1) {
        out->parts.push_back({p.name, kept[0].data});
        continue;
      }
      auto inner = std::make_shared<Collection>();
      inner->parts = std::move(kept);
      out->parts.push_back({p.name, CollectionPtr(std::move(inner))});
    }
    return CollectionPtr(std::move(out));
  }

 private:
  std::map<std::pair<std::string, size_t>, size_t> index_;
  std::vector<Portions> all_;
};

}  // namespace

bool sniff_ensight_servers(std::span<const std::byte> head) {
  const std::string_view text(reinterpret_cast<const char*>(head.data()), head.size());
  bool format = false;
  for (const std::string_view line : split(text, '\n')) {
    if (line.empty() || line[0] == '#') continue;
    if (format) return line.starts_with("type") && line.find("master_server") != line.npos;
    if (line != "FORMAT" && line != "FORMAT:") return false;
    format = true;
  }
  return false;
}

std::vector<double> times_ensight_servers(const std::string& path, const ReadOptions&, Context&) {
  return times_of_servers(cases_of(path, nullptr));
}

Data read_ensight_servers(const std::string& path, const ReadOptions& options, Context& context) {
  if (options.pieces < 1 || options.piece < 0 || options.piece >= options.pieces)
    fail_usage(fmt::format("piece {} of {}", options.piece, options.pieces), path, "pieces count from 0");
  const std::vector<FoundCase> cases = cases_of(path, &context);
  const std::vector<double> times = times_of_servers(cases);
  ReadOptions one = options;
  one.piece = 0, one.pieces = 1;
  if (!times.empty()) one.time = times[chosen_step(times, options, path)], one.step = -1;
  const size_t begin = cases.size() * size_t(options.piece) / size_t(options.pieces);
  const size_t end = cases.size() * size_t(options.piece + 1) / size_t(options.pieces);
  PortionsOf portions;
  for (size_t i = begin; i < end; ++i) {
    context.check();
    portions.add(cases[i],
                 with_context(fmt::format("reading the cases of '{}'", path), [&] { return read_ensight(cases[i].path, one, context); }));
  }
  return portions.joined();
}

}  // namespace sg
