// SPDX-License-Identifier: Apache-2.0
// Completion and the manual page know what the program knows.
#include <algorithm>

#include "base/text/text.h"
#include "cli/options.h"
#include "cli/program.h"
#include "color/colormap.h"
#include "pipeline/operation/operation.h"
#include "scene/show/show.h"
#include "support/test.h"

using namespace sg;
using namespace sg::test;

namespace {

std::vector<std::string> completed(std::vector<std::string> words) {
  words.insert(words.begin(), "complete");
  const Ran r = sightglass(words);
  CHECK(r.status == 0);
  std::vector<std::string> lines;
  for (const std::string_view l : split(r.out, '\n'))
    if (!l.empty()) lines.emplace_back(l);
  return lines;
}

bool has(const std::vector<std::string>& list, std::string_view word) { return std::find(list.begin(), list.end(), word) != list.end(); }

}  // namespace

TEST_CASE("completion: commands, flags, choices of flags") {
  CHECK(has(completed({""}), "render"));
  CHECK(has(completed({"ren"}), "convert"));  // the shell chooses among them
  CHECK(has(completed({"render", "--pro"}), "--progressive"));
  CHECK(has(completed({"convert", "--compression", ""}), "lz4"));
  CHECK(completed({"render", "-o", ""}).empty());  // files
  CHECK(completed({"render", ""}).empty());
  CHECK(has(completed({"completions", ""}), "fish"));
}

TEST_CASE("completion: operations and their parameters inside of one quoted word") {
  const auto sources = completed({"render", "-s", ""}), filters = completed({"render", "x.vtu", "-f", ""});
  for (const Operation& o : operations()) CHECK(has(o.kind == OperationKind::source ? sources : filters, o.name));
  CHECK(has(completed({"render", "-f", "contour fi"}), "contour field="));
  CHECK(has(completed({"render", "-f", "contour normals=f"}), "contour normals=false"));
  CHECK(has(completed({"render", "-f", "name: contour field=T "}), "name: contour field=T values="));
  CHECK(has(completed({"render", "-f", "streamlines integrator=r"}), "streamlines integrator=rk4"));
  CHECK(has(completed({"render", "-f", "quality measures=scaled_jacobian,"}), "quality measures=scaled_jacobian,aspect_ratio"));
  CHECK(completed({"render", "-f", "nosuch x"}).empty());
}

TEST_CASE("completion: ways to show, views and colour maps") {
  const auto shows = completed({"render", "--show", ""}), maps = completed({"render", "--map", ""}),
             of_surface = completed({"render", "--show", "surface map="}), of_command = completed({"colormap", ""});
  for (const ShowKind& k : show_kinds()) CHECK(has(shows, k.name));
  for (const Colormap& m : colormaps()) {
    CHECK(has(maps, m.name));
    CHECK(has(of_surface, "surface map=" + m.name));
    CHECK(has(of_command, m.name));
  }
  CHECK(has(completed({"render", "--camera", ""}), "front"));
  CHECK(has(completed({"render", "--camera", "front azi"}), "front azimuth="));
  CHECK(has(completed({"render", "--legend", "title=T un"}), "title=T unit="));
  CHECK(has(completed({"ops", ""}), "picture"));
}

TEST_CASE("manual page: every command, flag, operation and way to show is in it") {
  const Ran r = sightglass({"man"});
  CHECK(r.status == 0);
  const auto told = [&](std::string text) {
    for (size_t at = 0; (at = text.find('-', at)) != text.npos; at += 2) text.insert(at, "\\");
    return r.out.find(text) != r.out.npos;
  };
  for (const CommandDoc& c : command_docs()) {
    CHECK(told("sightglass " + c.name));
    for (const FlagDoc& f : c.flags)
      for (const std::string& n : f.names) CHECK_MESSAGE(told(n), n);
  }
  for (const Operation& o : operations()) CHECK_MESSAGE(told(".B " + std::string(o.name)), o.name);
  for (const ShowKind& k : show_kinds()) CHECK(told(".B " + std::string(k.name)));
}

TEST_CASE("completion: the scripts of bash, zsh and fish ask the program") {
  for (const char* shell : {"bash", "zsh", "fish"}) CHECK(sightglass({"completions", shell}).out.find(" complete ") != std::string::npos);
  CHECK(sightglass({"completions", "tcsh"}).status == 2);
}
