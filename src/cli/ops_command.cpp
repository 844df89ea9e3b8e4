// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <cstdio>

#include "base/error.h"
#include "base/text/text.h"
#include "cli/cli.h"
#include "cli/cpp_header.h"
#include "pipeline/file/read_params.h"
#include "pipeline/picture/picture.h"
#include "scene/camera_params.h"
#include "scene/show/show.h"

namespace sg {

namespace {

// Parameter groups that are no operations.
struct Group {
  std::string_view name, sentence;
  std::string (*help)();
  std::string (*json)();
};
template <class P>
constexpr Group group(std::string_view name, std::string_view sentence) {
  return {name, sentence,
          [] {
            P p;
            return params_help(schema_of(p));
          },
          [] {
            P p;
            return params_json(schema_of(p));
          }};
}
constexpr Group groups[] = {
    group<ReadParams>("read", "Reads a file (a step of pipeline files)."),
    group<CameraParams>("camera", "Where the picture is taken from (--camera)."),
    group<PictureParams>("picture", "Size, background and annotations (--picture)."),
};

std::string all_json() {
  std::string r = ops_json();
  while (!r.empty() && (r.back() == '\n' || r.back() == '}')) r.pop_back();
  r += ",\"show\":[";
  bool first = true;
  for (const ShowKind& k : show_kinds()) {
    r += fmt::format("{}{{\"name\":\"{}\",\"sentence\":{},\"params\":{}}}", first ? "" : ",", k.name, json_string(k.sentence),
                     params_json(k.make_params().schema));
    first = false;
  }
  r += "]";
  for (const Group& g : groups) r += fmt::format(",\"{}\":{}", g.name, g.json());
  return r + "}\n";
}

void print_all() {
  std::fputs(ops_help().c_str(), stdout);
  std::printf("\nways to show (--show)\n");
  for (const ShowKind& k : show_kinds()) std::printf("  %-16s %s\n", std::string(k.name).c_str(), std::string(k.sentence).c_str());
  std::printf("\nother parameters\n");
  for (const Group& g : groups) std::printf("  %-16s %s\n", std::string(g.name).c_str(), std::string(g.sentence).c_str());
  std::printf("\nsightglass ops NAME lists the parameters of one.\n");
}

}  // namespace

int run_ops(const Options& o, Context&) {
  if (o.cpp) {
    std::fputs(cpp_header().c_str(), stdout);
    return 0;
  }
  if (o.inputs.empty()) {
    if (o.json) std::fputs(all_json().c_str(), stdout);
    else print_all();
    return 0;
  }
  for (const std::string& name : o.inputs) {
    bool done = false;
    auto print = [&](std::string_view sentence, const std::string& help, const std::string& json, const std::string& more = {}) {
      if (o.json) std::printf("{\"name\":%s,\"params\":%s%s}\n", json_string(name).c_str(), json.c_str(), more.c_str());
      else std::printf("%s: %s\n%s", name.c_str(), std::string(sentence).c_str(), help.c_str());
      done = true;
    };
    for (const ShowKind& k : show_kinds())
      if (k.name == name) {
        const ParamSet params = k.make_params();
        print(k.sentence, params_help(params.schema), params_json(params.schema));
      }
    for (const Group& g : groups)
      if (g.name == name) print(g.sentence, g.help(), g.json());
    for (const Operation& op : operations())
      if (op.name == name) {
        const ParamSet params = op.make_params();
        print(op.sentence, params_help(params.schema) + (o.json ? std::string() : words_help(op)), params_json(params.schema),
              op.words ? ",\"words\":" + words_json(op) : "");
      }
    if (done) continue;
    std::vector<std::string> names;
    for (const Operation& op : operations()) names.emplace_back(op.name);
    for (const ShowKind& k : show_kinds()) names.emplace_back(k.name);
    for (const Group& g : groups) names.emplace_back(g.name);
    fail_usage(fmt::format("unknown operation '{}'", name), "sightglass ops", unknown_name_hint(name, names));
  }
  return 0;
}

}  // namespace sg
