// SPDX-License-Identifier: Apache-2.0
#include "filter/mesh/select/extract_ids.h"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>
#include <unordered_set>

#include "base/error.h"
#include "base/text/text.h"
#include "data/cells/cell_reader.h"
#include "filter/mesh/select/cell_centers.h"
#include "filter/mesh/select/extract.h"

namespace sg {

namespace {

// 1 for each chosen cell or point.
std::vector<uint8_t> chosen(const DatasetPtr& in, const ExtractParams& p, size_t count) {
  std::vector<uint8_t> yes(count, 0);
  if (p.by.empty()) {
    for (const int64_t id : p.ids) {
      if (id < 0 || size_t(id) >= count)
        fail_usage(fmt::format("there is no {} {}", word_of(p.of), id), "extract ids",
                   count ? fmt::format("0 to {}", count - 1) : "there are none");
      yes[size_t(id)] = 1;
    }
    return yes;
  }
  const Association on = p.of == IdsOf::cell && !in->as<PointCloud>() ? Association::cell : Association::point;
  const Field& f = in->fields().require(p.by.name, on);
  if (f.components() != 1)
    fail_usage(fmt::format("field '{}' has {} components", f.name, f.components()), "extract by", "ids must be single numbers");
  const std::unordered_set<int64_t> wanted(p.ids.begin(), p.ids.end());
  for (size_t i = 0; i < count; ++i) {
    const double v = f.array.get(i);
    yes[i] = std::isfinite(v) && std::fabs(v) < 9e15 && v == std::floor(v) && wanted.count(int64_t(v)) > 0;
  }
  return yes;
}

bool has_region(const ImplicitParams& p) {
  return p.origin || p.normal != ImplicitParams().normal || p.position || p.axis != CutAxis::none || names_shape(p);
}

// Cells (or points of a cloud) in the region.
void keep_region(const DatasetPtr& in, const ExtractParams& p, std::vector<uint8_t>& yes, Context& ctx) {
  const ImplicitFunction f = implicit_function(p.region, in, nullptr, "extract", ctx);
  if (p.by_center && f.evaluate)
    return keep_centers(
        in, [&](Vec3 x) { return f(x) <= 0; }, yes, ctx);
  CellReader reader(in);
  if (in->as<AmrGrid>()) {
    if (!f.evaluate) fail_usage("a function of fields cannot be evaluated at AMR points", "extract function", "use only x, y, z");
    for (size_t c = 0; c < yes.size(); ++c) {
      reader.open(c);
      size_t inside = 0;
      for (const Vec3& x : reader.at()) inside += f(x) <= 0;
      yes[c] = yes[c] && (p.all_points ? inside == reader.at().size() : inside > 0);
    }
    return;
  }
  const Array values = values_at_points(f, in, ctx);
  const auto v = values.view<double>();
  for (size_t c = 0; c < yes.size(); ++c) {
    reader.open(c);
    size_t inside = 0;
    double sum = 0;
    for (const int64_t id : reader.ids()) inside += v[size_t(id)] <= 0, sum += v[size_t(id)];
    if (p.by_center) {  // a function of fields is known at points alone
      yes[c] = yes[c] && !reader.ids().empty() && sum <= 0;
      continue;
    }
    yes[c] = yes[c] && (p.all_points ? inside == reader.ids().size() : inside > 0) && !reader.ids().empty();
  }
}

void keep_types(const DatasetPtr& in, const std::vector<std::string>& names, std::vector<uint8_t>& yes) {
  bool wanted[256] = {};
  std::vector<std::string> known;
  for (const auto& [name, count] : cell_type_counts(in->mesh())) known.emplace_back(name);
  for (const std::string& name : names) {
    bool found = false;
    for (int t = 0; t < 256; ++t)
      if (const CellTypeInfo* info = cell_type_info(uint8_t(t)))
        if (info->name.size() == name.size() && std::equal(name.begin(), name.end(), info->name.begin(), [](char a, char b) {
              return std::tolower(uint8_t(a)) == std::tolower(uint8_t(b));
            }))
          wanted[t] = found = true;
    if (!found) fail_usage(fmt::format("there is no cell type '{}'", name), "extract types", unknown_name_hint(name, known));
  }
  CellReader reader(in);
  for (size_t c = 0; c < yes.size(); ++c) {
    reader.open(c);
    yes[c] = yes[c] && wanted[uint8_t(reader.type())];
  }
}

void keep_levels(const DatasetPtr& in, const std::vector<int64_t>& levels, std::vector<uint8_t>& yes) {
  const AmrGrid* g = in->as<AmrGrid>();
  if (!g) fail_usage(fmt::format("a {} mesh has no levels", in->kind()), "extract levels", "only AMR grids have levels");
  std::vector<uint8_t> here(yes.size(), 0);
  for (const int64_t l : levels) {
    if (l < 0 || size_t(l) >= g->levels.size())
      fail_usage(fmt::format("there is no level {}", l), "extract levels", fmt::format("0 to {}", g->levels.size() - 1));
    for (const auto& patch : g->levels[size_t(l)].patches) {
      const auto n = patch.cells();
      std::fill_n(here.begin() + ptrdiff_t(patch.cell_offset), n[0] * n[1] * n[2], uint8_t(1));
    }
  }
  for (size_t c = 0; c < yes.size(); ++c) yes[c] &= here[c];
}

void add_parts(const Data& data, const std::string& path, std::vector<Collection::Part>& out) {
  const auto* c = std::get_if<CollectionPtr>(&data);
  if (!c) return void(out.push_back({path, data}));
  for (const Collection::Part& part : (*c)->parts) add_parts(part.data, path.empty() ? part.name : path + "/" + part.name, out);
}

// The paths in a collection whose last names are `wanted`, each once: of parts, and of the collections that hold them.
std::vector<std::string> paths_ending_in(const std::vector<Collection::Part>& parts, const std::string& wanted, bool whole_parts) {
  std::vector<std::string> found;
  for (const Collection::Part& part : parts)
    for (size_t end = whole_parts ? part.name.size() : part.name.find('/'); end != std::string::npos;
         end = end == part.name.size() ? std::string::npos : std::min(part.name.find('/', end + 1), part.name.size())) {
      std::string path = part.name.substr(0, end);
      if (path.ends_with("/" + wanted) && std::find(found.begin(), found.end(), path) == found.end()) found.push_back(std::move(path));
    }
  return found;
}

// The one path that ends in `wanted`; "" for none. Throws Error(usage) that lists them where there are several.
std::string path_ending_in(const std::vector<Collection::Part>& parts, const std::string& wanted, bool whole_parts, const char* where) {
  const std::vector<std::string> found = paths_ending_in(parts, wanted, whole_parts);
  if (found.size() < 2) return found.empty() ? "" : found[0];
  constexpr size_t most_listed = 10;
  std::string list;
  for (size_t i = 0; i < std::min(found.size(), most_listed); ++i) list += (i ? ", '" : "'") + found[i] + "'";
  fail_usage(fmt::format("{} parts are called '{}'", found.size(), wanted), where,
             fmt::format("name one by its path: {}{}", list, found.size() > most_listed ? ", ..." : ""));
}

Data part_named(const Data& in, const std::string& wanted) {
  if (!std::holds_alternative<CollectionPtr>(in)) fail_usage("the input is no collection", "extract part", "leave part out");
  const std::vector<Collection::Part> parts = all_parts(in);
  const auto number = wanted.starts_with('#') ? parse_int(wanted.substr(1)) : std::nullopt;
  if (number && *number >= 0 && size_t(*number) < parts.size()) return parts[size_t(*number)].data;
  std::vector<std::string> names;
  for (const Collection::Part& part : parts) {
    if (part.name == wanted) return part.data;
    names.push_back(part.name);
  }
  if (const std::string path = path_ending_in(parts, wanted, true, "extract part"); !path.empty())
    for (const Collection::Part& part : parts)
      if (part.name == path) return part.data;
  fail_usage(fmt::format("there is no part '{}'", wanted), "extract part", unknown_name_hint(wanted, names));
}

}  // namespace

std::vector<Collection::Part> all_parts(const Data& data) {
  std::vector<Collection::Part> parts;
  add_parts(data, "", parts);
  return parts;
}

DatasetPtr extract(const DatasetPtr& in, const ExtractParams& p, Context& ctx) {
  const bool region = has_region(p.region);
  if (p.ids.empty() && !region && p.types.empty() && p.levels.empty())
    fail_usage("nothing is selected", "extract ids", "give e.g. ids=3,7,12, or a region (box=...), types or levels");
  const bool cloud = in->as<PointCloud>();
  const bool by_points = p.of == IdsOf::point && !cloud;
  const size_t cells = cloud ? in->point_count() : in->cell_count();
  std::vector<uint8_t> yes(cells, 1);
  if (!p.ids.empty()) {
    yes = chosen(in, p, by_points ? in->point_count() : cells);
    if (by_points) {
      std::vector<uint8_t> users(cells, 0);
      CellReader reader(in);
      for (size_t c = 0; c < cells; ++c) {
        reader.open(c);
        for (const int64_t id : reader.ids()) users[c] |= yes[size_t(id)];
      }
      yes = std::move(users);
    }
  }
  if (region) keep_region(in, p, yes, ctx);
  if (!p.types.empty()) keep_types(in, p.types, yes);
  if (!p.levels.empty()) keep_levels(in, p.levels, yes);
  if (p.invert)
    for (uint8_t& y : yes) y = !y;
  return extract_marked(in, yes, "extract");
}

Data extract_blocks(const Data& in, const ExtractParams& p, Context& ctx) {
  const bool of_cells = !p.ids.empty() || has_region(p.region) || !p.types.empty() || !p.levels.empty();
  Data chosen = p.part.empty() ? in : part_named(in, p.part);
  if (!p.part.empty() && !p.blocks.empty()) fail_usage("one part and blocks are asked for", "extract part", "state one of them");
  if (!p.part.empty() && !of_cells) return chosen;
  if (!p.blocks.empty()) {
    const auto* c = std::get_if<CollectionPtr>(&in);
    if (!c) fail_usage("the input is not a collection", "extract blocks", "leave out blocks");
    std::vector<std::string> names;
    for_each_dataset(in, [&](const std::string& name, const DatasetPtr&) { names.push_back(name); });
    for (const auto& part : (*c)->parts) names.push_back(part.name);
    auto r = std::make_shared<Collection>();
    for (const std::string& wanted : p.blocks) {
      const size_t before = r->parts.size();
      const bool digits = !wanted.empty() && wanted.size() < 10 && wanted.find_first_not_of("0123456789") == std::string::npos;
      for (const auto& part : (*c)->parts)
        if (part.name == wanted) r->parts.push_back(part);
      if (r->parts.size() == before && digits && std::stoul(wanted) < (*c)->parts.size())
        r->parts.push_back((*c)->parts[std::stoul(wanted)]);
      const auto add_below = [&](const std::string& path) {
        for_each_dataset(in, [&](const std::string& name, const DatasetPtr& d) {
          if (name == path || name.starts_with(path + "/")) r->parts.push_back({name, d});
        });
      };
      if (r->parts.size() == before) add_below(wanted);
      if (r->parts.size() == before)
        if (const std::string path = path_ending_in(all_parts(in), wanted, false, "extract blocks"); !path.empty()) add_below(path);
      if (r->parts.size() == before)
        fail_usage(fmt::format("there is no block '{}'", wanted), "extract blocks", unknown_name_hint(wanted, names));
    }
    chosen = CollectionPtr(r);
    if (!of_cells) return chosen;
  }
  if (auto* d = std::get_if<DatasetPtr>(&chosen)) return extract(*d, p, ctx);
  return map_datasets(chosen, [&](const DatasetPtr& d) {
    const DatasetPtr r = extract(d, p, ctx);
    return r->cell_count() > 0 || (r->as<PointCloud>() && r->point_count() > 0) ? r : nullptr;
  });
}

}  // namespace sg
