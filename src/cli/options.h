// SPDX-License-Identifier: Apache-2.0
// The command line as data.
#pragma once
#include <string>
#include <vector>

#include "io/io.h"

namespace sg {

enum class Command {
  none,
  render,
  view,
  serve,
  info,
  convert,
  run,
  open,
  ops,
  colormap,
  samples,
  lookdev,
  demo,
  completions,
  complete,
  man
};
constexpr auto enum_words(Command) {
  using enum Command;
  return std::array{Word{"render", render},           Word{"view", view},         Word{"serve", serve},     Word{"info", info},
                    Word{"convert", convert},         Word{"run", run},           Word{"open", open},       Word{"ops", ops},
                    Word{"colormap", colormap},       Word{"samples", samples},   Word{"lookdev", lookdev}, Word{"demo", demo},
                    Word{"completions", completions}, Word{"complete", complete}, Word{"man", man}};
}

struct Options {
  Command command = Command::none;   ///< none: --help or --version: nothing left to do
  std::vector<std::string> inputs;   ///< files, or what the command names
  std::vector<std::string> filters;  ///< each one -f: operation and key=value words
  std::vector<std::string> shows;    ///< each one --show
  std::string source;                ///< --source: a source operation instead of a file
  std::string output;
  bool progressive = false;  ///< render: coarse pictures first
  double noise = 0.03;       ///< lookdev: standard error of its pictures
  double within = 0;         ///< render: seconds, 0 = no limit
  std::string camera, size, title, background, field, map, scale, range, below, above, legend, layout, views;
  std::vector<std::string> notes;    ///< each one --note
  std::vector<std::string> lights;   ///< each one --light
  std::vector<std::string> light;    ///< key=value for the picture, from the flags about light; a value may hold blanks
  std::vector<std::string> picture;  ///< key=value for the picture, from --picture
  ReadOptions read;
  std::vector<std::string> written;  ///< convert: key=value for the writer
  std::string times;                 ///< convert: those of a series
  std::vector<std::string> film;     ///< key=value of FilmParams, checked
  std::vector<std::string> serve;    ///< view, serve: key=value of ServeParams, checked
  std::vector<std::string> samples;  ///< key=value of SampleStudyParams, checked
  std::string add_user;              ///< serve: "NAME RIGHTS"
  std::string sheet;                 ///< demo: contact sheet
  int threads = 0;
  size_t memory = 0;
  bool read_anywhere = false;  ///< files and recipes may name any file
  bool json = false, cpp = false, other_names = false, no_browser = false, quick = false, all_times = false, quiet = false, verbose = false,
       explain = false, recipe = false,
       series = false,  ///< series: all inputs are one
      resume = false;   ///< convert: go on with a series
};

/// Parses; for --help and --version prints to stdout and sets command to none. Throws Error(usage).
Options parse_options(int argc, char** argv);

/// A flag of a command, for the man page and completions.
struct FlagDoc {
  std::vector<std::string> names;  ///< "-o", "--output"
  bool takes_value = false;
  std::string doc;
  std::vector<std::string> choices;  ///< of its value; empty = others
};
struct CommandDoc {
  std::string name, doc;
  std::string input;               ///< what it takes besides flags: "File to read"; "" = nothing
  std::vector<std::string> words;  ///< ... where these are all
  std::vector<FlagDoc> flags;
};
/// Every command of the help, from the same declarations that parse_options() reads.
std::vector<CommandDoc> command_docs();
/// What the flags say about a file in this format. Throws Error(usage) for flags that it does not take.
WriteOptions writing(const Options& o, const Format& format);

}  // namespace sg
