// SPDX-License-Identifier: Apache-2.0
// OpenFOAM cases: a folder with constant/polyMesh, time folders with fields, perhaps cut into processor* folders and regions.
#include <fmt/core.h>

#include <algorithm>

#include "base/file/file.h"
#include "base/text/text.h"
#include "data/field_ops.h"
#include "io/formats.h"
#include "io/mesh/unread.h"
#include "io/openfoam/foam_field.h"
#include "io/openfoam/foam_file.h"

namespace sg {

using namespace openfoam;

namespace {

struct TimeFolder {
  double time = 0;
  std::string name;
};

/// The folder of a case from what was named: the folder, its .foam file, or system/controlDict.
std::string case_folder(const std::string& path) {
  if (is_folder(path)) return path + "/";
  const std::string folder = folder_of(path);
  return file_name_of(path).starts_with("controlDict") ? folder + "../" : folder.empty() ? "./" : folder;
}

std::vector<TimeFolder> time_folders(const std::string& folder) {
  std::vector<TimeFolder> r;
  for (const std::string& name : folder_entries(folder)) {
    const auto t = parse_double(name);
    if (t && std::isfinite(*t) && is_folder(folder + name)) r.push_back({*t, name});
  }
  std::sort(r.begin(), r.end(),
            [](const TimeFolder& a, const TimeFolder& b) { return a.time != b.time ? a.time < b.time : a.name < b.name; });
  // "1" and "1.0" are one time.
  r.erase(std::unique(r.begin(), r.end(), [](const TimeFolder& a, const TimeFolder& b) { return a.time == b.time; }), r.end());
  return r;
}

/// processor0/, processor1/, ... in order.
std::vector<std::string> processor_folders(const std::string& folder) {
  std::vector<std::string> r;
  for (const std::string& name : folder_entries(folder))
    if (name.starts_with("processor") && name.size() > 9 && is_folder(folder + name)) {
      const auto n = parse_int(name.substr(9));
      if (n && *n >= 0) r.push_back(name);
    }
  return r;
}

bool has_mesh(const std::string& constant) { return is_folder(constant + "/polyMesh"); }

/// "" for the mesh of the case itself, and the names of regions with a mesh of their own.
std::vector<std::string> regions_of(const std::string& folder) {
  std::vector<std::string> r;
  if (has_mesh(folder + "constant")) r.push_back("");
  if (is_folder(folder + "constant"))
    for (const std::string& name : folder_entries(folder + "constant"))
      if (name != "polyMesh" && has_mesh(folder + "constant/" + name)) r.push_back(name);
  return r;
}

/// One mesh with its fields at one time.
class Part {
 public:
  Part(std::string folder, std::string region, const std::vector<TimeFolder>& times, size_t step, const ReadOptions& o, Context& context)
      : folder_(std::move(folder)), region_(region.empty() ? "" : region + "/"), times_(times), step_(step), o_(o), context_(context) {}

  CollectionPtr read() {
    mesh_ = read_mesh([&](const std::string& name) { return find(name); });
    inner_.mesh = make_cells(mesh_, context_);
    for (const Patch& p : mesh_.patches) {
      patches_.emplace_back();
      points_.emplace_back();
      patches_.back().mesh = make_patch(mesh_, p, points_.back());
      patches_.back().notes.emplace_back("type", p.type);
    }
    if (!times_.empty()) fields(folder_ + times_[step_].name + "/" + region_);
    zones();
    auto boundary = std::make_shared<Collection>();
    for (size_t i = 0; i < patches_.size(); ++i) {
      stamp(patches_[i]);
      boundary->parts.push_back({mesh_.patches[i].name, make_dataset(std::move(patches_[i]))});
    }
    stamp(inner_);
    auto r = std::make_shared<Collection>();
    r->parts.push_back({"internalMesh", make_dataset(std::move(inner_))});
    if (!boundary->parts.empty()) r->parts.push_back({"boundary", CollectionPtr(boundary)});
    return r;
  }

 private:
  // Meshes may move: the last time folder so far that has the file takes precedence over constant.
  std::string find(const std::string& name) const {
    for (size_t i = times_.empty() ? 0 : step_ + 1; i-- > 0;)
      if (std::string p = existing(folder_ + times_[i].name + "/" + region_ + "polyMesh/" + name); !p.empty()) return p;
    return existing(folder_ + "constant/" + region_ + "polyMesh/" + name);
  }

  void stamp(DatasetParts& d) const {
    if (!times_.empty()) d.time = times_[step_].time;
  }

  void fields(const std::string& folder) {
    if (!is_folder(folder)) return;
    for (const std::string& entry : folder_entries(folder)) {
      const std::string name = entry.ends_with(".gz") ? entry.substr(0, entry.size() - 3) : entry;
      if (!is_wanted(o_.fields, name) || is_folder(folder + entry)) continue;
      context_.check();
      add(folder + entry, name);
    }
  }

  void add(const std::string& path, const std::string& name) {
    FieldClass kind;
    try {
      kind = field_class(FoamFile(path).class_name());
    } catch (const Error&) {
      return;  // lists without a header and other programs' files lie in time folders too
    }
    if (kind.components == 0) return;
    try {
      FoamField f = read_field(path, name, mesh_, o_.header_only);
      inner_.fields.add(f.inner);
      for (size_t i = 0; i < f.patches.size(); ++i) {
        if (kind.on_points) f.patches[i].array = gather(f.inner.array, points_[i]);
        patches_[i].fields.add(std::move(f.patches[i]));
      }
    } catch (const Error& e) {
      // A field that depends on another file's macros must not hide the rest, unless it was requested.
      if (!o_.fields.empty() || e.problem().find("is not expanded") == std::string::npos) throw;
      context_.warn(fmt::format("field '{}' is left out: {}", name, e.what()));
    }
  }

  void zones() {
    if (mesh_.zones.empty() || !is_wanted(o_.fields, "cellZone")) return;
    std::vector<int32_t> zone(mesh_.cells, -1);
    std::string names;
    for (size_t z = 0; z < mesh_.zones.size(); ++z) {
      for (const int32_t c : mesh_.zones[z].cells) zone[size_t(c)] = int32_t(z);
      names += fmt::format("{}{} {}", names.empty() ? "" : "\n", z, mesh_.zones[z].name);
    }
    inner_.fields.add({"cellZone", Association::cell, Array::from_vector(std::move(zone)), "", Role::labels});
    inner_.notes.emplace_back("cellZone", names);
  }

  std::string folder_, region_;
  const std::vector<TimeFolder>& times_;
  size_t step_;
  const ReadOptions& o_;
  Context& context_;
  FoamMesh mesh_;
  DatasetParts inner_;
  std::vector<DatasetParts> patches_;
  std::vector<std::vector<int64_t>> points_;  // of each patch: the points of the mesh
};

/// All regions of a case or of one processor.
CollectionPtr read_folder(const std::string& folder, const std::vector<TimeFolder>& times, size_t step, const ReadOptions& o,
                          Context& context) {
  const std::vector<std::string> regions = regions_of(folder);
  if (regions.size() == 1 && regions[0].empty()) return Part(folder, "", times, step, o, context).read();
  auto r = std::make_shared<Collection>();
  for (const std::string& region : regions) {
    CollectionPtr part = Part(folder, region, times, step, o, context).read();
    r->parts.push_back({region.empty() ? "defaultRegion" : region, std::move(part)});
  }
  return r;
}

std::vector<TimeFolder> times_of(const std::string& folder) {
  std::vector<TimeFolder> t = time_folders(folder);
  if (!regions_of(folder).empty()) return t;
  const std::vector<std::string> p = processor_folders(folder);
  return p.empty() ? t : time_folders(folder + p[0] + "/");
}

}  // namespace

bool sniff_openfoam_folder(const std::string& path) {
  if (has_mesh(path + "/constant") || file_exists(path + "/system/controlDict")) return true;
  return is_folder(path + "/processor0/constant") && has_mesh(path + "/processor0/constant");
}

bool sniff_openfoam_control(std::span<const std::byte> head) {
  const std::string_view t(reinterpret_cast<const char*>(head.data()), head.size());
  const size_t header = t.find("FoamFile");
  if (header == std::string_view::npos) return false;
  const std::string_view h = t.substr(header, t.find('}', header) - header);
  const auto w = words(h);
  for (size_t i = 0; i + 1 < w.size(); ++i)
    if (w[i] == "object" && w[i + 1] == "controlDict;") return true;
  return false;
}

std::vector<double> times_openfoam(const std::string& path, const ReadOptions&, Context&) {
  std::vector<double> t;
  for (const TimeFolder& f : times_of(case_folder(path))) t.push_back(f.time);
  return t;
}

Data read_openfoam(const std::string& path, const ReadOptions& options, Context& context) {
  const std::string folder = case_folder(path);
  const std::vector<TimeFolder> times = times_of(folder);
  std::vector<double> values;
  for (const TimeFolder& t : times) values.push_back(t.time);
  // Folder 0 holds what the run began with; people want its result.
  const size_t step = values.empty() ? 0 : chosen_step(values, options, path, values.size() - 1);
  const int pieces = std::max(options.pieces, 1);
  if (!regions_of(folder).empty()) {
    if (options.piece > 0) return std::make_shared<const Collection>();  // one mesh in one folder: the first piece has it all
    return read_folder(folder, times, step, options, context);
  }
  const std::vector<std::string> processors = processor_folders(folder);
  if (processors.empty())
    fail_data("has no mesh", folder + "constant/polyMesh",
              "an OpenFOAM case has constant/polyMesh, or processor0/constant/polyMesh and more");
  auto r = std::make_shared<Collection>();
  const auto n = int64_t(processors.size());
  for (int64_t i = n * options.piece / pieces; i < n * (options.piece + 1) / pieces; ++i) {
    const std::string at = folder + processors[size_t(i)] + "/";
    if (regions_of(at).empty()) fail_data("has no mesh", at + "constant/polyMesh", "every processor folder needs one");
    const std::vector<TimeFolder> own = time_folders(at);
    size_t k = 0;
    while (k < own.size() && !times.empty() && own[k].time != times[step].time) ++k;
    if (k == own.size() && !times.empty())
      fail_data(fmt::format("has no time folder '{}'", times[step].name), at, "all processor folders need the same times");
    r->parts.push_back({processors[size_t(i)], read_folder(at, own, k, options, context)});
  }
  return r;
}

}  // namespace sg
