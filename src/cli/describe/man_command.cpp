// SPDX-License-Identifier: Apache-2.0
// The manual page, from the declarations of commands, operations and ways to show.
#include <algorithm>
#include <cstdio>

#include "base/text/text.h"
#include "cli/cli.h"
#include "pipeline/operation/operation.h"
#include "scene/show/show.h"

namespace sg {

namespace {

// Text escaped for troff.
std::string plain(std::string_view text) {
  std::string r;
  for (const char c : text) {
    if (c == '\\') r += "\\e";
    else if (c == '-') r += "\\-";
    else if (c == '\'') r += "\\(aq";
    else if (c == '.' && r.empty()) r += "\\&.";
    else if (c == '^') r += "\\(ha";
    else if (c == '~') r += "\\(ti";
    else if (c == '`') r += "\\(ga";
    else r += c;
  }
  return r;
}

// A paragraph with a hanging head.
std::string entry(const std::string& head, std::string_view text) { return ".TP\n.B " + head + "\n" + plain(text) + "\n"; }

std::string names_of(const FlagDoc& flag) {
  std::string r;
  for (const std::string& n : flag.names) r += (r.empty() ? "" : ", ") + n;
  if (!flag.takes_value) return plain(r);
  std::string value = "VALUE";
  if (!flag.choices.empty()) {
    value.clear();
    for (const std::string& c : flag.choices) value += (value.empty() ? "" : "|") + c;
  }
  return plain(r + " " + value);
}

bool has_flag(const CommandDoc& command, const FlagDoc& flag) {
  return std::any_of(command.flags.begin(), command.flags.end(), [&](const FlagDoc& f) { return f.names == flag.names; });
}

std::string commands_text(const std::vector<CommandDoc>& commands) {
  // Options common to all commands are listed once.
  const auto common = [&](const FlagDoc& f) {
    return std::all_of(commands.begin(), commands.end(), [&](const CommandDoc& c) { return has_flag(c, f); });
  };
  std::string r = ".SH COMMANDS\n";
  for (const CommandDoc& c : commands) {
    r += ".SS " + plain("sightglass " + c.name) + "\n" + plain(c.doc) + "\n";
    for (const FlagDoc& f : c.flags)
      if (!common(f)) r += entry(names_of(f), f.doc);
  }
  r += ".SH COMMON OPTIONS\n";
  for (const FlagDoc& f : commands.front().flags)
    if (common(f)) r += entry(names_of(f), f.doc);
  return r;
}

std::string operations_text() {
  std::vector<std::string_view> families;
  for (const Operation& o : operations())
    if (std::find(families.begin(), families.end(), o.family) == families.end()) families.push_back(o.family);
  std::string r =
      ".SH OPERATIONS\nSources (\\-\\-source) compute data, the others (\\-f) process it;\n.B sightglass ops NAME\n"
      "lists the parameters of each with units, ranges and choices.\n";
  for (const std::string_view family : families) {
    r += ".SS " + plain(family) + "\n";
    for (const Operation& o : operations())
      if (o.family == family) r += entry(plain(o.name), o.sentence);
  }
  r += ".SH WAYS TO SHOW\nArguments of \\-\\-show.\n";
  for (const ShowKind& k : show_kinds()) r += entry(plain(k.name), k.sentence);
  return r;
}

}  // namespace

int run_man(const Options&, Context&) {
  std::string r = ".\\\" Made by `sightglass man`.\n.TH SIGHTGLASS 1 \"\" \"Sightglass " SG_VERSION "\" \"User Commands\"\n";
  r += ".SH NAME\nsightglass \\- render simulation and scanner data\n.SH SYNOPSIS\n";
  const std::vector<CommandDoc> commands = command_docs();
  for (const CommandDoc& c : commands)
    r += ".B sightglass " + plain(c.name) + "\n[\\fIoptions\\fR]" +
         (c.input.empty() ? std::string() : " \\fI" + (c.words.empty() ? "input" : plain("name")) + "\\fR") + "\n.br\n";
  r += ".SH DESCRIPTION\nReads meshes and images, filters them, and renders surfaces and volumes with legends, axes and units. Whatever\n"
       "is not specified is chosen from the data, and one line says what was chosen and why. Every PNG contains its recipe, which\n"
       ".B sightglass open\nfollows. The same input gives the same bytes on any number of threads.\n";
  r += commands_text(commands) + operations_text();
  r += ".SH EXIT STATUS\n0 done, 2 usage, 3 data, 4 internal; 130, 143 and 129 when stopped by SIGINT, SIGTERM and SIGHUP.\n";
  r += ".SH ENVIRONMENT\n";
  r += entry("SIGHTGLASS_PLUGINS",
             "The only folder to search for plug-ins (readers that need large libraries); default: those of the installation.");
  r += ".SH EXAMPLES\n.nf\n" +
       plain(
           "sightglass render head.mhd -o head.png\n"
           "sightglass render can.vtu --field EQPS --show 'surface range=0,1 edges=true' -o can.png\n"
           "sightglass render flow.vtk -f 'streamlines min_speed=0.05' -f tubes -o flow.png\n"
           "sightglass convert bunny.ply -f 'transform scale=1000,1000,1000' -o bunny.stl\n") +
       ".fi\n";
  std::fputs(r.c_str(), stdout);
  return 0;
}

}  // namespace sg
