// SPDX-License-Identifier: Apache-2.0
// The one file that sees CLI11.
#include "cli/options.h"

#include <fmt/core.h>
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>

#include "base/error.h"
#include "base/file/file.h"
#include "base/schema/other_words.h"
#include "base/text/text.h"
#include "cli/hints/loose_words.h"
#include "io/file_series.h"
#include "io/options.h"
#include "pipeline/film/film_params.h"
#include "pipeline/picture/picture.h"
#include "render/trace/sampling/sample_study.h"
#include "scene/choose/coloring.h"
#include "scene/show/other_names.h"
#include "serve/serve.h"

namespace sg {

namespace {

// What is parsed behind CLI11.
struct RawText {
  std::string memory, within, piece;
};

// The flag of a parameter where it is not the parameter's own name. "": it has none; '!' in front: a switch that makes it false.
struct FlagName {
  std::string_view param, flag, about = {};  // about: of a switch
};
constexpr FlagName reading_flags[] = {
    {"format", "input-format"}, {"times", "series-times"}, {"big_endian", ""}, {"piece", ""}, {"pieces", ""}, {"ghost_levels", ""}};
constexpr FlagName writing_flags[] = {{"binary", "!ascii", "Write numbers as text."}};

std::string flag_of(std::string_view param, std::span<const FlagName> names) {
  for (const FlagName& n : names)
    if (n.param == param) return std::string(n.flag);
  std::string flag(param);
  std::replace(flag.begin(), flag.end(), '_', '-');
  return flag;
}

std::string_view about_of(const ParamDecl& d) {
  for (const FlagName& n : writing_flags)
    if (n.param == d.name) return n.about;
  return d.doc;
}

std::string bare(const std::string& flag) { return flag.starts_with('!') ? flag.substr(1) : flag; }

// A flag made of a declaration. `given` gets the text.
template <class Given>
CLI::Option* add_flag(CLI::App& a, const ParamDecl& d, const std::string& flag, const std::string& about, Given given) {
  if (flag.starts_with('!'))
    return a.add_flag_callback(
        "--" + bare(flag), [given] { given("false"); }, about);
  // command_docs() finds the choices in the braces.
  std::string choices;
  for (const std::string& c : d.choices_) choices += (choices.empty() ? "" : ",") + c;
  const std::string type = choices.empty() ? std::string(param_type(d)) : "{" + choices + "}";
  return a.add_option_function<std::string>("--" + flag, given, about)->type_name(type);
}

template <class P>
std::string doc_of(std::string_view param) {
  P p;
  return schema_of(p).find(param)->doc;
}

void add_common(CLI::App& a, Options& o, RawText& raw) {
  a.add_option("--threads", o.threads, "Worker threads; 0 = all cores");
  a.add_option("--memory", raw.memory, "Memory limit, e.g. 2G");
  a.add_flag("--quiet,-q", o.quiet, "Print errors only");
  a.add_flag("--verbose,-v", o.verbose, "Print each step as it is done");
  a.add_flag("--read-anywhere", o.read_anywhere,
             "Let files and recipes name files anywhere, not only below their own folder and the working folder");
}

void add_reading(CLI::App& a, Options& o, RawText& raw) {
  // The declarations bound to the read options, under the names of the flags, so that errors use these names.
  const auto schema = std::make_shared<Schema>(schema_of(o.read));
  for (ParamDecl& d : schema->decls()) {
    const std::string flag = flag_of(d.name, reading_flags);
    if (flag.empty()) continue;
    d.name = "--" + flag;
    add_flag(a, d, flag, d.doc, [schema, name = d.name](const std::string& text) { set_param(*schema, name, text, ""); });
  }
  a.add_flag("--series", o.series, "Treat the files as one time series ('flow_*.vtk' in quotes and flow_{n}.vtk need no flag)");
  a.add_option("--piece", raw.piece, "Read one piece of several, e.g. 0/4, or 0/4/1 with one layer of ghost cells");
  a.add_option_function<std::string>(
       "--endian", [&o](const std::string& order) { o.read.raw_big_endian = order == "big"; }, "Raw bricks: byte order")
      ->check(CLI::IsMember({"little", "big"}));
}

// A flag for each option that some writer has, with the formats that take it.
void add_writing(CLI::App& a, Options& o) {
  struct Flag {
    ParamDecl decl;
    std::string formats;
  };
  std::vector<Flag> flags;
  WriteOptions any;
  for (const Format& f : formats()) {
    if (!f.describe_write) continue;
    Schema schema;
    f.describe_write(schema, any);
    for (const ParamDecl& d : schema.decls()) {
      const auto have = std::find_if(flags.begin(), flags.end(), [&](const Flag& x) { return x.decl.name == d.name; });
      if (have == flags.end()) flags.push_back({d, std::string(f.name)});
      else {
        have->formats += fmt::format(", {}", f.name);
        for (const std::string& c : d.choices_)
          if (std::find(have->decl.choices_.begin(), have->decl.choices_.end(), c) == have->decl.choices_.end())
            have->decl.choices_.push_back(c);
      }
    }
  }
  for (const auto& [d, formats] : flags)
    add_flag(a, d, flag_of(d.name, writing_flags), fmt::format("{}: {}", formats, about_of(d)),
             [&o, name = d.name](const std::string& text) { o.written.push_back(name + "=" + text); });
}

void add_pipeline(CLI::App& a, Options& o) {
  a.add_option(
       "-f,--filter", o.filters,
       "An operation and its parameters, e.g. 'contour field=T values=300,400'; repeat to chain operations. with=X adds a further input: a "
       "file, or a step of the chain by its operation or its name ('seeds: topology_seeds' or 'topology_seeds name=seeds' names a step: -f "
       "'skin: contour values=500' -f 'bone: contour values=1150 on=input' --show 'surface of=skin opacity=0.3' --show 'surface of=bone'). "
       "on=STEP takes that step as input "
       "instead of the previous one; 'input' is the data read (calc on=cell: its cells, unless a step has that name)")
      ->allow_extra_args(false);
  a.add_option("-s,--source", o.source, "Compute the data instead of reading a file, e.g. 'gyroid size=128'");
  a.add_flag("--explain", o.explain, "Print the plan and its estimated cost without running it");
}

void add_film(CLI::App& a, Options& o) {
  FilmParams params;
  const Schema film = schema_of(params);
  for (const ParamDecl& d : film.decls()) {
    if (d.name == "output") continue;  // -o
    add_flag(a, d, d.name, d.doc, [&o, name = d.name](const std::string& text) {
      FilmParams checked;
      Schema schema = schema_of(checked);
      schema.find(name)->name = "--" + name;
      set_param(schema, "--" + name, text, "");
      o.film.push_back(name + "=" + text);
    });
  }
}

// Those of its names: a token for a user alone has no use where there is one session.
void add_serving(CLI::App& a, Options& o, std::initializer_list<std::string_view> names) {
  serve::ServeParams params;
  const Schema schema = schema_of(params);
  for (const std::string_view name : names) {
    const ParamDecl& d = *schema.find(name);
    const std::string flag = flag_of(d.name, {});
    add_flag(a, d, flag, d.doc, [&o, key = d.name, flag = "--" + flag](const std::string& text) {
      serve::ServeParams checked;
      Schema words = schema_of(checked);
      words.find(key)->name = flag;
      set_param(words, flag, text, "");
      o.serve.push_back(key + "=" + text);
    });
  }
}

void add_size(CLI::App& a, Options& o) { a.add_option("--size", o.size, doc_of<PictureParams>("size")); }

void add_output(CLI::App& a, Options& o) {
  a.add_option("-o,--output", o.output,
               doc_of<FilmParams>("output") +
                   " Still pictures: .png, .jpg, .webp; '-': a PNG to standard output. {name} is the name of the first input.");
}

void add_look(CLI::App& a, Options& o) {
  a.add_option(
       "--show", o.shows,
       "How to show the data: 'surface|volume|lines|points|labels|glyphs|outline key=value ...'; may be repeated. of=STEP shows that step "
       "of the chain, by its operation or its name, instead of the last one: 'lines of=isolines'")
      ->allow_extra_args(false);
  a.add_option("--field", o.field, doc_of<ColoringParams>("field"));
  a.add_option("--map", o.map, doc_of<ColoringParams>("map"));
  a.add_option("--scale", o.scale, doc_of<ColoringParams>("scale"));
  a.add_option("--range", o.range, doc_of<ColoringParams>("range"));
  a.add_option("--below", o.below, doc_of<ColoringParams>("below"));
  a.add_option("--above", o.above, doc_of<ColoringParams>("above"));
  a.add_option("--legend", o.legend,
               "'false' draws none, 'bottom' (top, left) puts it there; else words of the legend: \"title='Wall temperature' unit=K "
               "ticks=0,50,100 format=.1f place=bottom bar=0.5\"; count=5 asks for about five round numbers in place of ticks");
  a.add_option("--camera", o.camera,
               "A named view ('top', 'front', 'iso', ...) or key=value words, e.g. 'azimuth=30 elevation=10 zoom=1.5'");
  add_size(a, o);
  a.add_option("--title", o.title, doc_of<PictureParams>("title"));
  a.add_option("--note", o.notes,
               "A text in the picture with its place: 'Inlet @ 0.1,0.9' or 'Outlet @ top-right size=1.5'; may be repeated (see: "
               "sightglass ops picture)")
      ->allow_extra_args(false);
  a.add_option("--layout", o.layout, doc_of<PictureParams>("layout"));
  a.add_option("--views", o.views, doc_of<PictureParams>("views"));
  // Before those that add to it, which would be lost.
  a.add_option("--picture", o.picture, "Further picture parameters as key=value (see: sightglass ops picture)")->allow_extra_args(false);
  a.add_option("--light", o.lights,
               "A light, as a kind and key=value words: 'rectangle from=left-above size=0.5', 'sun elevation=20'; may be repeated (see: "
               "sightglass ops picture)")
      ->allow_extra_args(false);
  const auto add_light = [&](const char* name) {
    a.add_option_function<std::string>(
        fmt::format("--{}", name), [&o, name](const std::string& text) { o.light.push_back(fmt::format("{}={}", name, text)); },
        doc_of<PictureParams>(name));
  };
  add_light("environment"), add_light("integrator"), add_light("noise"), add_light("denoise");
  a.add_option("--background", o.background, doc_of<PictureParams>("background"));
}

void add_picture(CLI::App& a, Options& o, RawText& raw) {
  add_look(a, o), add_film(a, o);
  a.add_flag("--progressive", o.progressive,
             "Volumes larger than memory, and with an integrator: write a coarse picture at once, then replace it by finer ones up to the "
             "final one");
  a.add_option(
      "--within", raw.within,
      "Volumes larger than memory, and with an integrator: write the best picture ready after this time, e.g. 2s or 500ms, and report its "
      "level and error");
  add_output(a, o);
}

std::vector<size_t> whole_numbers(const std::string& text, char separator, const char* option, const char* hint) {
  std::vector<size_t> out;
  for (std::string_view part : split(text, separator)) {
    const auto v = parse_int(part);
    if (!v || *v < 0) fail_usage(fmt::format("'{}' is not a list of whole numbers", text), option, hint);
    out.push_back(size_t(*v));
  }
  return out;
}

void finish_raw(const RawText& raw, Options& o) {
  if (!raw.piece.empty()) {
    const auto n = whole_numbers(raw.piece, '/', "--piece", "write e.g. 0/4");
    if (n.size() < 2 || n.size() > 3 || n[0] >= n[1] || n[1] > 1000000 || (n.size() == 3 && n[2] > 1000))
      fail_usage(fmt::format("'{}' is not a piece of several", raw.piece), "--piece", "write e.g. 0/4; pieces count from 0");
    o.read.piece = int(n[0]), o.read.pieces = int(n[1]), o.read.ghost_levels = n.size() == 3 ? int(n[2]) : 0;
  }
  if (!o.read.raw_type.empty() && o.read.raw_dims[0] == 0)
    fail_usage("--type describes a raw brick, but its size is missing", "--dims", "add e.g. --dims 256,256,128");
  check(o.read);
  if (o.threads < 0 || o.threads > 4096)
    fail_usage(fmt::format("{} is not a valid number of threads", o.threads), "--threads", "give 0 (all cores) to 4096");
  if (!raw.within.empty()) {
    std::string_view number = raw.within;
    const double unit = number.ends_with("ms") ? 1e-3 : 1;
    number.remove_suffix(number.ends_with("ms") ? 2 : number.ends_with('s') ? 1 : 0);
    const auto time = parse_double(number);
    if (!time || !(*time > 0) || !std::isfinite(*time))
      fail_usage(fmt::format("'{}' is not a valid time", raw.within), "--within", "write e.g. 2s or 500ms");
    o.within = *time * unit;
  }
  if (!raw.memory.empty()) {
    const auto bytes = parse_bytes(raw.memory);
    if (!bytes || *bytes == 0) fail_usage(fmt::format("'{}' is not an amount of memory", raw.memory), "--memory", "write e.g. 512M or 2G");
    o.memory = size_t(*bytes);
  }
}

// CLI11 says "The following argument was not expected: --sise"; suggest what was meant.
[[noreturn]] void fail_unknown(const CLI::App& command, const CLI::ParseError& e) {
  const std::string text = e.what();
  const size_t at = text.find(": ");
  if (e.get_exit_code() == int(CLI::ExitCodes::ExtrasError) && at != std::string::npos) {
    const std::string word(words(std::string_view(text).substr(at + 2)).at(0));
    std::vector<std::string> names;
    if (word.starts_with("-")) {
      for (const CLI::Option* option : command.get_options())
        for (const std::string& n : option->get_lnames()) names.push_back("--" + n);
    }
    const std::string same = same_word(word, names);
    if (const std::string said = known_elsewhere(word); same.empty() && !said.empty())
      fail_usage(fmt::format("unknown argument '{}'", word), "sightglass " + command.get_name(), said);
    const std::string near = same.empty() ? nearest_name(word, names) : same;
    fail_usage(fmt::format("unknown argument '{}'", word), "sightglass " + command.get_name(),
               near.empty() ? fmt::format("see: sightglass {} --help", command.get_name()) : fmt::format("did you mean '{}'?", near));
  }
  fail_usage(text, "sightglass " + command.get_name(), fmt::format("see: sightglass {} --help", command.get_name()));
}

const char* const general_help =
    "Sightglass: trustworthy pictures from simulation and scanner data.\n\n"
    "  sightglass render IN... [-f 'OP key=value ...']... [--show 'surface|volume|lines|points|labels|glyphs|outline key=value ...']...\n"
    "             [--camera ...] [--size 1920x1080] [-o OUT.png]      render a picture; anything left open is chosen from the data\n"
    "  sightglass IN                                                 the same\n"
    "  sightglass view IN... [-f ...]... [--show ...]                open it in a window of the browser\n"
    "  sightglass serve FOLDER                                       the same for a team, with all files of a folder\n"
    "  sightglass info IN [--json] [--quick] [--all-times]           describe what is in a file\n"
    "  sightglass convert IN [-f ...]... -o OUT.vtu                  filter data and write it to another file\n"
    "  sightglass convert --source 'smoke' --times 0:5:0.1 -o OUT.vtkhdf   the steps of a run, as they are made\n"
    "  sightglass run PIPELINE.yaml                                  run a pipeline file\n"
    "  sightglass open PICTURE.png                                   remake a picture from the recipe stored in it\n"
    "  sightglass ops [NAME] [--json]                                list operations and their parameters\n"
    "  sightglass colormap [NAME or FILE[:NAME]]                     list colour maps and analyse their lightness\n"
    "  sightglass samples [--sampler sobol] [--count 256] [-o ...]   show how samples of the path tracer lie\n"
    "  sightglass lookdev [gold glass ...] [-o SHEET.png]            show the materials of the path tracer\n"
    "  sightglass demo                                               render sample pictures into out/\n"
    "  sightglass completions bash|zsh|fish                          print a shell's completion script\n"
    "  sightglass man                                                print the manual page: sightglass man | man -l -\n\n"
    "Every command takes --help. Exit codes: 0 done, 2 usage, 3 data, 4 internal.\n";

void declare_render(CLI::App& a, Options& o, RawText& raw) {
  a.add_option("input", o.inputs, "Files to read");
  add_reading(a, o, raw), add_pipeline(a, o), add_picture(a, o, raw);
}

void declare_view(CLI::App& a, Options& o, RawText& raw) {
  a.add_option("input", o.inputs, "Files to read, or one pipeline file (YAML)");
  add_serving(a, o, {"address", "port", "workers", "worker_memory", "origin"});
  a.add_flag("--no-browser", o.no_browser, "Print the address, and leave the browser to you");
  add_reading(a, o, raw), add_pipeline(a, o), add_look(a, o);
  a.footer(
      "The address that is printed has a token which counts once. Ctrl-C ends the server, and with it the session: save pictures and the "
      "pipeline from the window.");
}

void declare_serve(CLI::App& a, Options& o, RawText&) {
  a.add_option("folder", o.inputs, "Folder of the data; nothing above it can be reached")->required()->expected(1);
  add_serving(a, o, {"address", "port", "users", "workers", "worker_memory", "most_seconds", "origin"});
  a.add_option("--add-user", o.add_user, "Print a token for a new user, and the line for the file of users: 'NAME view' or 'NAME edit'");
}

void declare_info(CLI::App& a, Options& o, RawText& raw) {
  a.add_option("input", o.inputs, "Files to read");
  a.add_flag("--json", o.json, "Print JSON, for programs");
  add_pipeline(a, o);
  a.add_flag("--quick", o.quick, "Leave out ranges and read no values");
  a.add_flag("--all-times", o.all_times, "Give ranges over all steps of a series, with one step in memory at a time");
  add_reading(a, o, raw);
}

void declare_convert(CLI::App& a, Options& o, RawText& raw) {
  a.add_option("input", o.inputs, "File to read");
  a.add_option("-o,--output", o.output, "File to write")->required();
  a.add_option(
      "--times", o.times,
      "Write a series: the times of its steps, e.g. 0:10:101 (first:last:count), 0:10:0.1 (first:last:step), 0,0.5,1, or of a file "
      "0:114 (its steps in between). -o takes .vtkhdf, .ome.zarr, .pvd, or numbered files of any format: flow_{n}.vtu. Each step is "
      "in its place when it has been made");
  a.add_flag("--all-times", o.all_times, "The same with all steps of the file");
  a.add_flag("--resume", o.resume, "With --times: go on behind the steps that are there already");
  add_writing(a, o);
  add_reading(a, o, raw), add_pipeline(a, o);
}

void declare_run(CLI::App& a, Options& o, RawText&) {
  a.add_option("input", o.inputs, "Pipeline file (YAML)")->required();
  add_output(a, o), add_size(a, o), add_film(a, o);
  a.add_flag("--explain", o.explain, "Print the plan and its estimated cost without running it");
  a.footer(
      "A pipeline file names steps, each from a file, a source or other steps, and what to show of them:\n\n"
      "  sightglass: 1\n"
      "  steps:\n"
      "    wing: {read: wing.vtu}\n"
      "    shock: {contour: {field: mach, values: 1}, from: wing}\n"
      "  show:\n"
      "    - {surface: {field: pressure}, of: wing}\n"
      "    - {surface: {color: \"#e0e0e0\", opacity: 0.5}, of: shock}\n"
      "  picture: {size: 1920x1080, title: Wing, camera: {view: front}}\n\n"
      "The words are those of -f, --show, --picture and --camera: see sightglass ops [NAME]. The pipeline of any picture made here is in "
      "it:\n"
      "sightglass open PICTURE.png --recipe");
}

void declare_open(CLI::App& a, Options& o, RawText&) {
  a.add_option("input", o.inputs, "Picture (PNG)")->required();
  a.add_option("-o,--output", o.output, "Picture to write; default: NAME-again.png beside the original");
  add_size(a, o);
  a.add_flag("--recipe", o.recipe, "Print the recipe instead of following it");
}

void declare_ops(CLI::App& a, Options& o, RawText&) {
  a.add_option("name", o.inputs, "An operation, a way to show, a format, 'read', 'camera', 'picture', 'film' or 'page'");
  a.add_flag("--json", o.json, "Print JSON Schemas of the parameters, for programs");
  a.add_flag("--cpp", o.cpp, "Print a C++ header with every operation and way to show as a struct (sightglass/operations.h)");
  a.add_flag("--other-names", o.other_names, "Print what other programs call things, and how it is said here");
}

void declare_colormap(CLI::App& a, Options& o, RawText&) {
  a.add_option("name", o.inputs, "Colour map, or file of colour maps (FILE[:NAME]); NAME_r is reversed");
  a.add_option("-o,--output", o.output, "Write a picture of the map");
  a.add_flag("--json", o.json, "Print JSON, for programs");
}

void declare_samples(CLI::App& a, Options& o, RawText&) {
  trace::SampleStudyParams params;
  const Schema declared = schema_of(params);
  for (const ParamDecl& d : declared.decls())
    add_flag(a, d, d.name, d.doc, [&o, name = d.name](const std::string& text) {
      trace::SampleStudyParams checked;
      Schema schema = schema_of(checked);
      schema.find(name)->name = "--" + name;
      set_param(schema, "--" + name, text, "");
      o.samples.push_back(name + "=" + text);
    });
  a.add_option("-o,--output", o.output,
               "Write a picture: the points of one pixel, their power spectrum, the errors of 96 x 96 pixels with so many samples");
  a.add_flag("--json", o.json, "Print JSON, for programs");
}

void declare_lookdev(CLI::App& a, Options& o, RawText&) {
  a.add_option("material", o.inputs, "Materials to show; default: all");
  a.add_option("-o,--output", o.output, "Picture to write; default: lookdev.png");
  a.add_option("--noise", o.noise, "Standard error of the pictures, as a share of full scale")->check(CLI::Range(0.0005, 1.0));
}

void declare_demo(CLI::App& a, Options& o, RawText&) {
  a.add_option("folder", o.inputs, "Instead, render every file below this folder onto the sheet")->expected(0, 1);
  a.add_option("-o,--out", o.output, "Folder for the pictures; default: out/");
  a.add_option("--sheet", o.sheet, "File to write with all pictures on one contact sheet");
}

void declare_completions(CLI::App& a, Options& o, RawText&) {
  a.add_option("shell", o.inputs, "bash, zsh or fish")->required()->expected(1)->check(CLI::IsMember({"bash", "zsh", "fish"}));
}

void declare_man(CLI::App&, Options&, RawText&) {}

struct Declaration {
  Command command;
  const char* about;
  void (*declare)(CLI::App&, Options&, RawText&);
};
constexpr Declaration declarations[] = {
    {Command::render, "Render a picture of the data. Whatever is not given is chosen from the data.", declare_render},
    {Command::view, "Open data in a window of the browser: turn it, change its looks, ask for values.", declare_view},
    {Command::serve, "Serve a folder of data to browsers, each file in a session of its own.", declare_serve},
    {Command::info, "Describe what is in a file: mesh, sizes, cell types, bounds, fields and their ranges.", declare_info},
    {Command::convert, "Read, filter and write data; the extension of the output determines its format.", declare_convert},
    {Command::run, "Run a pipeline file.", declare_run},
    {Command::open, "Remake a picture from the recipe stored in it.", declare_open},
    {Command::ops, "List operations, or describe one.", declare_ops},
    {Command::colormap, "List colour maps, or print the lightness analysis of one.", declare_colormap},
    {Command::samples, "Show how the samples of a sampler of the path tracer lie.", declare_samples},
    {Command::lookdev, "Show the materials of the path tracer: a ball of each on one sheet.", declare_lookdev},
    {Command::demo, "Render sample pictures of what Sightglass can do.", declare_demo},
    {Command::completions, "Print a shell's completion script, e.g. for: source <(sightglass completions bash). Packages install it.",
     declare_completions},
    {Command::man, "Print the manual page as troff source.", declare_man},
};

// The flags and arguments of a command.
void declare(const Declaration& d, CLI::App& a, Options& o, RawText& raw) {
  a.set_help_flag("-h,--help", "This text");
  a.description(d.about);
  add_common(a, o, raw);
  d.declare(a, o, raw);
}

// `sightglass FILE ...` is a picture of it. A name with a dot or a slash is no command that was mistyped.
bool names_input(const std::string& word) {
  return word == "-" || (!word.starts_with('-') && (word.find_first_of("./") != word.npos || file_exists(word)));
}

}  // namespace

WriteOptions writing(const Options& o, const Format& format) {
  WriteOptions options;
  Schema schema;
  if (format.describe_write) format.describe_write(schema, options);
  std::string has;
  for (const ParamDecl& d : schema.decls()) has += (has.empty() ? "--" : " --") + bare(flag_of(d.name, writing_flags));
  for (const std::string& word : o.written)
    if (const std::string param = word.substr(0, word.find('=')); !schema.find(param))
      fail_usage(fmt::format("{} files do not take --{}", format.name, bare(flag_of(param, writing_flags))), o.output,
                 has.empty() ? "they take no options" : "they take " + has);
  return write_options(format, o.written);
}

Options parse_options(int argc, char** argv) {
  Options o;
  const std::string first = argc > 1 ? argv[1] : "--help";
  if (first == "--help" || first == "-h" || first == "help") {
    std::fputs(general_help, stdout);
    return o;
  }
  if (first == "--version") {
    std::printf("sightglass %s\n", SG_VERSION);
    return o;
  }
  auto command = value_of_word<Command>(first);
  int words_from = 2;
  if (!command && names_input(first)) command = Command::render, words_from = 1;
  if (!command) {
    std::vector<std::string> names;
    for (const Declaration& d : declarations) names.emplace_back(word_of(d.command));
    fail_usage(fmt::format("unknown command '{}'", first), "sightglass", unknown_name_hint(first, names));
  }
  if (*command == Command::complete) {  // its words are those of another command, flags too
    o.command = *command;
    o.inputs.assign(argv + 2, argv + argc);
    return o;
  }
  RawText raw;
  CLI::App a{"", std::string(word_of(*command))};
  for (const Declaration& d : declarations)
    if (d.command == *command) declare(d, a, o, raw);
  try {
    std::vector<std::string> args(argv + words_from, argv + argc);
    std::reverse(args.begin(), args.end());  // CLI11 takes them from the back
    a.parse(std::move(args));
  } catch (const CLI::CallForHelp&) {
    std::fputs(a.help().c_str(), stdout);
    return o;
  } catch (const CLI::ParseError& e) {
    fail_unknown(a, e);
  }
  finish_raw(raw, o);
  for (std::string& input : o.inputs)
    if (input == "-") input = "/dev/stdin";
  if (*command == Command::render || *command == Command::view || *command == Command::convert || *command == Command::info)
    refuse_loose_words({argv + words_from, argv + argc}, o.inputs, std::string(word_of(*command)));
  if (o.series && o.inputs.empty()) fail_usage("names no files", "--series", "write e.g. --series flow_*.vtk");
  if (o.series) o.inputs = {series_path(std::move(o.inputs), true)};
  o.command = *command;
  return o;
}

std::vector<CommandDoc> command_docs() {
  std::vector<CommandDoc> docs;
  for (const Declaration& d : declarations) {
    const std::string name(word_of(d.command));
    Options o;
    RawText raw;
    CLI::App a{"", name};
    declare(d, a, o, raw);
    CommandDoc doc{name, a.get_description(), {}, {}, {}};
    for (const CLI::Option* option : a.get_options()) {
      std::vector<std::string> choices;  // CLI11 lists them in the text of the type: "TEXT:{a,b}"
      const std::string type = option->get_type_name();
      const size_t open = type.find('{'), close = type.find('}');
      if (open != type.npos && close != type.npos)
        for (const std::string_view c : split(std::string_view(type).substr(open + 1, close - open - 1), ',')) choices.emplace_back(c);
      if (option->get_positional()) {
        doc.input = option->get_description(), doc.words = choices;
        continue;
      }
      FlagDoc flag{{}, option->get_items_expected_max() > 0, option->get_description(), choices};
      for (const std::string& s : option->get_snames()) flag.names.push_back("-" + s);
      for (const std::string& l : option->get_lnames()) flag.names.push_back("--" + l);
      doc.flags.push_back(std::move(flag));
    }
    docs.push_back(std::move(doc));
  }
  return docs;
}

}  // namespace sg
