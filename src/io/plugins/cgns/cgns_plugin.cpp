// SPDX-License-Identifier: Apache-2.0
// The CGNS plug-in: bases, their zones and time steps.
#include <fmt/core.h>

#include "base/parallel.h"
#include "io/isolated/isolated.h"
#include "io/plugin.h"
#include "io/plugins/cgns/cgns_zone.h"

namespace sg::cg {

namespace {

double version_of(const CgFile& file) {
  for (const Node& n : file.children(file.root(), "CGNSLibraryVersion_t"))
    if (const Array a = file.numbers(n); a.count() > 0) return a.get(0);
  return 0;
}

std::vector<Node> bases_of(const CgFile& file) {
  std::vector<Node> bases = file.children(file.root(), "CGNSBase_t");
  if (bases.empty()) file.fail("has no base", file.root(), "a CGNS file holds at least one CGNSBase_t");
  return bases;
}

/// Time values of a base; their numbers when only iterations are given.
std::vector<double> times_of(const CgFile& file, const std::vector<Node>& parts) {
  const Node* iterative = CgFile::labelled(parts, "BaseIterativeData_t");
  if (!iterative) return {};
  const std::vector<Node> arrays = file.children(*iterative);
  for (const char* name : {"TimeValues", "IterationValues"})
    if (const Node* n = CgFile::named(arrays, name); n && n->type != "C1" && n->count() > 0) {
      const Array a = file.numbers(*n).converted(ElementType::f64);
      return {a.view<double>().data, a.view<double>().data + a.count()};
    }
  return {};
}

/// Zones that exist at the step, if the file states it (ZonePointers); else all.
std::vector<Node> zones_at(const CgFile& file, const std::vector<Node>& parts, size_t step) {
  std::vector<Node> zones;
  std::vector<std::string> active;
  if (const Node* iterative = CgFile::labelled(parts, "BaseIterativeData_t")) {
    const std::vector<Node> arrays = file.children(*iterative);
    const Node* pointers = CgFile::named(arrays, "ZonePointers");
    if (pointers && pointers->dims.size() == 3) {
      const std::vector<std::string> names = file.names(*pointers);
      const size_t most = pointers->dims[1];
      for (size_t i = step * most; i < std::min(names.size(), (step + 1) * most); ++i) active.push_back(names[i]);
    }
  }
  for (const Node& n : parts)
    if (n.label == "Zone_t" && (active.empty() || std::find(active.begin(), active.end(), n.name) != active.end())) zones.push_back(n);
  return zones;
}

// Descriptors, and the numbers of the reference state.
void add_notes(const CgFile& file, const std::vector<Node>& parts, Base& base) {
  for (const Node& n : parts) {
    if (n.label == "Descriptor_t") base.notes.emplace_back(n.name, file.text(n));
    if (n.label != "ReferenceState_t") continue;
    for (const Node& r : file.children(n)) {
      if (r.label == "Descriptor_t") base.notes.emplace_back(r.name, file.text(r));
      if (r.label == "DataArray_t" && r.type != "C1" && r.count() == 1)
        base.notes.emplace_back("reference " + r.name, fmt::format("{}", file.numbers(r).get(0)));
    }
  }
}

Data read(const std::string& path, const ReadOptions& options, Context& context) {
  const CgFile file(path);
  const double version = version_of(file);
  Collection all;
  std::vector<double> first_times;
  const std::vector<Node> bases = bases_of(file);
  for (const Node& node : bases) {
    Base base;
    base.node = node;
    base.version = version;
    const std::vector<int64_t> dims = file.integers(node);
    if (dims.size() != 2 || dims[0] < 1 || dims[0] > 3 || dims[1] < dims[0] || dims[1] > 3) file.fail("has an unknown dimension", node);
    base.cell_dimension = int(dims[0]), base.physical_dimension = int(dims[1]);
    const std::vector<Node> parts = file.children(node);
    std::vector<double> times = times_of(file, parts);
    // Bases without times of their own go with those of the first.
    if (first_times.empty()) first_times = times;
    if (!times.empty()) {
      base.has_steps = true;
      base.step = chosen_step(times, options, path);
      base.time = times[base.step];
    }
    add_notes(file, parts, base);
    Collection zones;
    for (const Node& zone : zones_at(file, parts, base.step)) {
      context.check();
      zones.parts.push_back({zone.name, read_zone(file, base, zone, options, context)});
    }
    if (!zones.parts.empty()) all.parts.push_back({node.name, std::make_shared<const Collection>(std::move(zones))});
  }
  if (first_times.empty() && options.step > 0) chosen_step(first_times, options, path);  // throws
  if (all.parts.empty()) file.fail("has no zones", file.root());
  return std::make_shared<const Collection>(std::move(all));
}

std::vector<double> times(const std::string& path, const ReadOptions&, Context&) {
  const CgFile file(path);
  for (const Node& node : bases_of(file))
    if (std::vector<double> t = times_of(file, file.children(node)); !t.empty()) return t;
  return {};
}

}  // namespace

namespace {

// Debian's library checks with assert(): a damaged file ends the program. It works in a process of its own.
Data read_apart(const std::string& path, const ReadOptions& options, Context& context) {
  return read_isolated(
      path, [&](Context& c) { return read(path, options, c); }, context);
}

std::vector<double> times_apart(const std::string& path, const ReadOptions& options, Context& context) {
  return times_isolated(
      path, [&](Context& c) { return times(path, options, c); }, context);
}

}  // namespace

}  // namespace sg::cg

SG_PLUGIN_FORMATS({"cgns", sg::cg::read_apart, nullptr, sg::cg::times_apart})
