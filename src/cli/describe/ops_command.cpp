// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

#include "base/error.h"
#include "base/text/text.h"
#include "cli/cli.h"
#include "cli/describe/cpp_header.h"
#include "pipeline/catalog/catalog.h"
#include "scene/show/other_names.h"

namespace sg {

namespace {

std::string formats_line(const std::vector<CatalogEntry>& all, EntryKind kind) {
  std::string r;
  for (const CatalogEntry& e : all)
    if (e.kind == kind) r += (r.empty() ? "  " : ", ") + e.name;
  return r + "\n";
}

std::string overview(const std::vector<CatalogEntry>& all) {
  std::string shows = "\nways to show (--show)\n", others = "\nother parameters\n", lights = "\nlights (--light)\n",
              environments = "\nenvironments (--environment)\n", nodes = "\nscenes (scene: in pipeline files)\n";
  for (const CatalogEntry& e : all) {
    const std::string line = fmt::format("  {:<16} {}\n", e.name, e.sentence);
    switch (e.kind) {
      case EntryKind::source:
      case EntryKind::operation:
      case EntryKind::reader:
      case EntryKind::writer: break;
      case EntryKind::show: shows += line; break;
      case EntryKind::light: lights += line; break;
      case EntryKind::environment: environments += line; break;
      case EntryKind::node: nodes += line; break;
      case EntryKind::read:
      case EntryKind::camera:
      case EntryKind::picture:
      case EntryKind::film:
      case EntryKind::page: others += line; break;
    }
  }
  return ops_help() + shows + lights + environments + nodes + others + "\nreadable formats\n" + formats_line(all, EntryKind::reader) +
         "\nwritable formats\n" + formats_line(all, EntryKind::writer) +
         "\nsightglass ops NAME lists its parameters, and knows many names of other programs (ops --other-names: all of them).\n";
}

// What other programs call things, and how it is said here.
std::string other_names_list() {
  std::string r;
  for (const OtherName& n : other_names()) {
    const auto all = words(n.words);
    const auto some = all.begin() + std::ptrdiff_t(std::min<size_t>(all.size(), 4));
    r += fmt::format("{:<58} {}\n", fmt::format("{}", fmt::join(all.begin(), some, ", ")), n.here);
  }
  r += "\nno operation\n";
  for (const MissingName& n : missing_names())
    r += fmt::format("{:<58} {}\n", words(n.words)[0], n.nearest.empty() ? "-" : fmt::format("nearest: {}", n.nearest));
  return r;
}

std::string explained(const CatalogEntry& e) {
  const std::string params = params_help(e.schema);
  return fmt::format("{}: {}\n{}{}{}", e.name, e.sentence, e.operation ? "  " + kinds_help(*e.operation) + "\n" : "",
                     params.empty() ? "  No parameters.\n" : params, e.operation ? words_help(*e.operation) : "");
}

}  // namespace

int run_ops(const Options& o, Context&) {
  if (o.cpp) {
    std::fputs(cpp_header().c_str(), stdout);
    return 0;
  }
  if (o.other_names) {
    std::fputs(other_names_list().c_str(), stdout);
    return 0;
  }
  const std::vector<CatalogEntry> all = catalog();
  if (o.inputs.empty()) std::fputs((o.json ? catalog_json(all) : overview(all)).c_str(), stdout);
  for (const std::string& name : o.inputs) {
    bool found = false;
    for (const CatalogEntry& e : all)
      if (equal_ignoring_case(e.name, name)) std::fputs((o.json ? entry_json(e) + "\n" : explained(e)).c_str(), stdout), found = true;
    if (found) continue;
    std::vector<std::string> names;
    for (const CatalogEntry& e : all) names.push_back(e.name);
    fail_usage(fmt::format("unknown operation '{}'", name), "sightglass ops", said_here(name, names));
  }
  return 0;
}

}  // namespace sg
