// SPDX-License-Identifier: Apache-2.0
// The one file that sees CLI11.
#include "cli/options.h"

#include <fmt/core.h>
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>

#include "base/error.h"
#include "base/text/text.h"
#include "io/file_series.h"

namespace sg {

namespace {

struct RawText {
  std::string dims, type, spacing, endian = "little", memory, within;
  std::string time, region, stride, fields, piece;  // of any file: which part of it
  size_t header = 0;
  int components = 1;
};

void add_common(CLI::App& a, Options& o, RawText& raw) {
  a.add_option("--threads", o.threads, "Worker threads; 0 = all cores");
  a.add_option("--memory", raw.memory, "Memory to stay within, like 2G");
  a.add_flag("--quiet,-q", o.quiet, "Print errors only");
  a.add_flag("--verbose,-v", o.verbose, "Print what is done, step by step");
  a.add_flag("--read-anywhere", o.read_anywhere,
             "Files and recipes may name files anywhere, not only below their own folder and the working folder");
}

void add_reading(CLI::App& a, Options& o, RawText& raw) {
  a.add_option("--time", raw.time, "Time series: the step nearest to this time");
  a.add_flag("--series", o.series, "The files are one series in time (like 'flow_*.vtk' in quotes, or flow_{n}.vtk, which need no flag)");
  a.add_option("--series-times", o.read.times, "Times of the files of a series: START:STEP, like 0:0.5, or a list");
  a.add_option("--step", o.read.step, "Time series: this step, counted from 0")->check(CLI::NonNegativeNumber);
  a.add_option("--fields", raw.fields, "Read only these fields, like T,velocity");
  a.add_option("--region", raw.region, "Grids: read points i0,i1,j0,j1,k0,k1 only");
  a.add_option("--stride", raw.stride, "Grids: read every n-th point, like 2 or 2,2,1");
  a.add_option("--piece", raw.piece, "Read one piece of several, like 0/4, or 0/4/1 with a layer of ghost cells");
  a.add_option("--csv-header", o.read.csv_header, "Delimited text: whether the first line names the columns; auto: by its cells")
      ->check(CLI::IsMember({"auto", "yes", "no"}));
  a.add_option("--dims", raw.dims, "Raw brick: size, like 256,256,128");
  a.add_option("--type", raw.type, "Raw brick: element type: u8 i8 u16 i16 u32 i32 f32 f64");
  a.add_option("--spacing", raw.spacing, "Raw brick: distance of samples, like 1,1,2");
  a.add_option("--endian", raw.endian, "Raw brick: byte order")->check(CLI::IsMember({"little", "big"}));
  a.add_option("--header", raw.header, "Raw brick: bytes to skip");
  a.add_option("--components", raw.components, "Raw brick: numbers per sample")->check(CLI::PositiveNumber);
}

void add_pipeline(CLI::App& a, Options& o) {
  a.add_option(
       "-f,--filter", o.filters,
       "An operation and its parameters: 'contour field=T values=300,400'; may be repeated, they chain. with=FILE: a further input, or a "
       "step of the chain by its operation or by the name in front ('seeds: topology_seeds'); on=STEP: that one instead of the step "
       "before; 'input' is what is read (calc on=cell: on its cells, unless a step has that name)")
      ->allow_extra_args(false);
  a.add_option("-s,--source", o.source, "Compute the data instead of reading a file: 'gyroid size=128'");
  a.add_flag("--explain", o.explain, "Print the plan and what it will cost, run nothing");
}

void add_series(CLI::App& a, Options& o) {
  a.add_option(
      "--times", o.times,
      "With {n} in the output, or a film: the times to draw, like 0:10:101 (first:last:count), 0,0.5,1 or 0:114 (the steps of the file in "
      "between); default: all of the file. A parameter written as {t} takes the time");
  a.add_option("--fps", o.fps, "Films: pictures per second")->check(CLI::Range(0.1, 1000.0))->each([&o](const std::string&) {
    o.fps_stated = true;
  });
}

void add_picture(CLI::App& a, Options& o, RawText& raw) {
  a.add_option("--show", o.shows, "How to show it: 'surface|volume|lines|points|labels|outline key=value ...'; may be repeated")
      ->allow_extra_args(false);
  a.add_option("--field", o.field, "Field to colour by");
  a.add_option("--map", o.map, "Colour map (see: sightglass colormap), or a file: FILE.cpt, FILE.json:NAME, FILE.css:NAME");
  a.add_option("--scale", o.scale, "linear, log or symlog");
  a.add_option("--camera", o.camera, "'top', 'front', 'iso', or key=value words: 'azimuth=30 elevation=10 zoom=1.5'");
  a.add_option("--size", o.size, "Pixels, like 1920x1080");
  a.add_option("--title", o.title, "Text above the picture");
  a.add_option("--background", o.background, "Colour, or 'transparent'");
  a.add_option("--picture", o.picture, "Further key=value of the picture (see: sightglass ops picture)")->allow_extra_args(false);
  add_series(a, o);
  a.add_flag("--progressive", o.progressive,
             "Volumes that memory does not hold: write a coarse picture at once, and finer ones in its place until it is the final one");
  a.add_option(
      "--within", raw.within,
      "Volumes that memory does not hold: the best picture that is ready after this time, like 2s or 500ms, with its level and error");
  a.add_option("-o,--output", o.output,
               "Picture to write: .png .jpg .webp; {n} in its name numbers the pictures of a time series; .webm, .mp4: a film of them");
}

Vec3 triple(const std::string& text, const char* option, double least) {
  const auto parts = split(text, ',');
  Vec3 v;
  for (int i = 0; i < 3; ++i) {
    const auto x = parts.size() == 3 ? parse_double(parts[size_t(i)]) : std::nullopt;
    if (!x || !(*x >= least)) fail_usage(fmt::format("'{}' is not three positive numbers", text), option, "like 256,256,128");
    v[i] = *x;
  }
  return v;
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

void finish_parts(const RawText& raw, ReadOptions& r) {
  if (!raw.time.empty()) {
    r.time = parse_double(raw.time);
    if (!r.time) fail_usage(fmt::format("'{}' is no number", raw.time), "--time", "like 0.25");
  }
  for (std::string_view name : split(raw.fields, ','))
    if (!name.empty()) r.fields.emplace_back(name);
  if (!raw.region.empty()) {
    const auto n = whole_numbers(raw.region, ',', "--region", "like 0,99,0,99,20,40");
    if (n.size() != 6) fail_usage(fmt::format("'{}' is not six numbers", raw.region), "--region", "like 0,99,0,99,20,40");
    for (size_t a = 0; a < 3; ++a) {
      r.region.lo[a] = n[2 * a], r.region.hi[a] = n[2 * a + 1];
      if (r.region.lo[a] > r.region.hi[a])
        fail_usage(fmt::format("'{}' ends before it begins", raw.region), "--region", "first,last along x, y, z");
    }
  }
  if (!raw.stride.empty()) {
    const auto n = whole_numbers(raw.stride, ',', "--stride", "like 2 or 2,2,1");
    if (n.size() != 1 && n.size() != 3)
      fail_usage(fmt::format("'{}' is not one or three numbers", raw.stride), "--stride", "like 2 or 2,2,1");
    for (size_t a = 0; a < 3; ++a) {
      r.region.stride[a] = n[n.size() == 3 ? a : 0];
      if (r.region.stride[a] == 0) fail_usage("a stride of 0", "--stride", "1 reads every point");
    }
  }
  if (!raw.piece.empty()) {
    const auto n = whole_numbers(raw.piece, '/', "--piece", "like 0/4");
    if (n.size() < 2 || n.size() > 3 || n[0] >= n[1] || n[1] > 1000000 || (n.size() == 3 && n[2] > 1000))
      fail_usage(fmt::format("'{}' is not a piece of several", raw.piece), "--piece", "like 0/4: pieces count from 0");
    r.piece = int(n[0]), r.pieces = int(n[1]), r.ghost_levels = n.size() == 3 ? int(n[2]) : 0;
  }
}

void finish_raw(const RawText& raw, Options& o) {
  finish_parts(raw, o.read);
  if (o.threads < 0 || o.threads > 4096)
    fail_usage(fmt::format("{} is no number of threads", o.threads), "--threads", "from 0 (all cores) to 4096");
  if (!raw.dims.empty()) {
    const Vec3 d = triple(raw.dims, "--dims", 1);
    for (int i = 0; i < 3; ++i) {
      if (d[i] != std::floor(d[i]) || d[i] > 1e9)
        fail_usage(fmt::format("'{}' is not three whole numbers", raw.dims), "--dims", "like 256,256,128");
      o.read.raw_dims[size_t(i)] = size_t(d[i]);
    }
    if (raw.type.empty()) fail_usage("a raw brick needs its element type too", "--type", "one of u8 i8 u16 i16 u32 i32 u64 i64 f32 f64");
  } else if (!raw.type.empty()) {
    fail_usage("--type describes a raw brick, whose size is missing", "--dims", "like --dims 256,256,128");
  }
  if (!raw.spacing.empty()) o.read.raw_spacing = triple(raw.spacing, "--spacing", 1e-300);
  o.read.raw_type = raw.type;
  o.read.raw_big_endian = raw.endian == "big";
  o.read.raw_header = raw.header;
  o.read.raw_components = raw.components;
  if (!raw.within.empty()) {
    std::string_view number = raw.within;
    const double unit = number.ends_with("ms") ? 1e-3 : 1;
    number.remove_suffix(number.ends_with("ms") ? 2 : number.ends_with('s') ? 1 : 0);
    const auto time = parse_double(number);
    if (!time || !(*time > 0) || !std::isfinite(*time))
      fail_usage(fmt::format("'{}' is no time", raw.within), "--within", "like 2s or 500ms");
    o.within = *time * unit;
  }
  if (!raw.memory.empty()) {
    const auto bytes = parse_bytes(raw.memory);
    if (!bytes || *bytes == 0) fail_usage(fmt::format("'{}' is not an amount of memory", raw.memory), "--memory", "like 512M or 2G");
    o.memory = size_t(*bytes);
  }
}

// CLI11 says "The following argument was not expected: --sise"; say what was meant.
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
    const std::string near = nearest_name(word, names);
    fail_usage(fmt::format("unknown argument '{}'", word), "sightglass " + command.get_name(),
               near.empty() ? fmt::format("see: sightglass {} --help", command.get_name()) : fmt::format("did you mean '{}'?", near));
  }
  fail_usage(text, "sightglass " + command.get_name(), fmt::format("see: sightglass {} --help", command.get_name()));
}

const char* const overview =
    "Sightglass: from the numbers of simulations and scanners to pictures that can be trusted.\n\n"
    "  sightglass render IN... [-f 'OP key=value ...']... [--show 'surface|volume|lines|points|labels|outline key=value ...']...\n"
    "             [--camera ...] [--size 1920x1080] [-o OUT.png]      a picture; without options it looks at the data and chooses\n"
    "  sightglass info IN [--json] [--quick] [--all-times]           what is in a file\n"
    "  sightglass convert IN [-f ...]... -o OUT.vtu                  filter and write data\n"
    "  sightglass run PIPELINE.yaml                                  run a pipeline file\n"
    "  sightglass open PICTURE.png                                   make a picture again from the recipe inside it\n"
    "  sightglass ops [NAME] [--json]                                operations and their parameters\n"
    "  sightglass colormap [NAME or FILE[:NAME]]                 colour maps and their lightness analysis\n"
    "  sightglass demo                                               some pictures of what it can do, into out/\n"
    "  sightglass completions bash|zsh|fish                          completion of commands, operations and parameters for a shell\n"
    "  sightglass man                                                the manual page: sightglass man | man -l -\n\n"
    "Each command has --help. Exit codes: 0 done, 2 usage, 3 data, 4 internal.\n";

const std::vector<std::string> commands = {
    "render", "info",     "convert",     "run", "ops",     "open",
    "demo",   "colormap", "completions", "man", "complete"};  // the last one is for completions alone

// The flags and arguments of a command.
void declare(const std::string& first, CLI::App& a, Options& o, RawText& raw) {
  a.set_help_flag("-h,--help", "This text");
  add_common(a, o, raw);
  if (first == "render") {
    a.description("Makes a picture of the data. Without options it looks at the data and chooses.");
    a.add_option("input", o.inputs, "Files to read");
    add_reading(a, o, raw), add_pipeline(a, o), add_picture(a, o, raw);
  } else if (first == "info") {
    a.description("Says what is in a file: mesh, sizes, cell types, bounds, fields with their ranges.");
    a.add_option("input", o.inputs, "Files to read");
    a.add_flag("--json", o.json, "For programs");
    add_pipeline(a, o);
    a.add_flag("--quick", o.quick, "Without ranges: touches no value");
    a.add_flag("--all-times", o.all_times, "Ranges over all steps of a series, one step in memory at a time");
    add_reading(a, o, raw);
  } else if (first == "convert") {
    a.description("Reads, filters and writes data; the extension of the output chooses the format.");
    a.add_option("input", o.inputs, "File to read");
    a.add_option("-o,--output", o.output, "File to write")->required();
    a.add_option("--encoding", o.write.encoding, "VTK XML")->check(CLI::IsMember({"ascii", "base64", "appended"}));
    a.add_option("--compression", o.write.compression, "VTK XML, NRRD, Zarr")
        ->check(CLI::IsMember({"none", "zlib", "lz4", "lzma", "gzip", "zstd"}));
    a.add_option("--chunk", o.write.chunk, "Zarr: samples along each axis of a chunk")->check(CLI::Range(8, 512));
    a.add_flag("!--ascii", o.write.binary, "STL and PLY as text");
    a.add_option("--pieces", o.write.pieces, ".pvti .pvtr .pvts .pvtu .pvtp .vtm: cut each mesh into so many files")
        ->check(CLI::Range(1, 100000));
    add_reading(a, o, raw), add_pipeline(a, o);
  } else if (first == "run") {
    a.description("Runs a pipeline file.");
    a.add_option("input", o.inputs, "Pipeline file (YAML)")->required();
    a.add_option("-o,--output", o.output,
                 "Write the picture here instead; {n} in its name numbers the pictures of a time series; .webm, .mp4: a film of them");
    a.add_option("--size", o.size, "Pixels, like 1920x1080");
    add_series(a, o);
    a.add_flag("--explain", o.explain, "Print the plan and what it will cost, run nothing");
  } else if (first == "open") {
    a.description("Makes a picture again from the recipe inside it.");
    a.add_option("input", o.inputs, "Picture (PNG)")->required();
    a.add_option("-o,--output", o.output, "Write the picture here; default: NAME-again.png beside it");
    a.add_option("--size", o.size, "Pixels, like 1920x1080");
    a.add_flag("--recipe", o.recipe, "Print the recipe and stop");
  } else if (first == "ops") {
    a.description("Lists operations, or explains one.");
    a.add_option("name", o.inputs, "Operation, way to show, 'camera' or 'picture'");
    a.add_flag("--json", o.json, "For programs: JSON schema of the parameters");
    a.add_flag("--cpp", o.cpp, "For C++ programs: all operations and ways to show as structs (sightglass/operations.h)");
  } else if (first == "colormap") {
    a.description("Lists colour maps, or prints the lightness analysis of one.");
    a.add_option("name", o.inputs, "Colour map; NAME_r is its reverse");
    a.add_option("-o,--output", o.output, "Write a picture of the map");
    a.add_flag("--json", o.json, "For programs");
  } else if (first == "completions") {
    a.description("Prints the completion of a shell: source <(sightglass completions bash); installed packages have it in place.");
    a.add_option("shell", o.inputs, "bash, zsh or fish")->required()->expected(1)->check(CLI::IsMember({"bash", "zsh", "fish"}));
  } else if (first == "man") {
    a.description("Prints the manual page in troff.");
  } else {
    a.description("Renders some pictures of what Sightglass can do.");
    a.add_option("folder", o.inputs, "Render every file in this folder onto the sheet instead")->expected(0, 1);
    a.add_option("-o,--out", o.output, "Folder; default out/");
    a.add_option("--sheet", o.sheet, "All pictures on one sheet: file to write");
  }
}

}  // namespace

Options parse_options(int argc, char** argv) {
  Options o;
  const std::string first = argc > 1 ? argv[1] : "--help";
  if (first == "--help" || first == "-h" || first == "help") {
    std::fputs(overview, stdout);
    return o;
  }
  if (first == "--version") {
    std::printf("sightglass %s\n", SG_VERSION);
    return o;
  }
  if (std::find(commands.begin(), commands.end(), first) == commands.end())
    fail_usage(fmt::format("unknown command '{}'", first), "sightglass",
               unknown_name_hint(first, std::vector<std::string>(commands.begin(), commands.end() - 1)));

  if (first == "complete") {  // its words are those of another command, flags too
    o.command = first;
    o.inputs.assign(argv + 2, argv + argc);
    return o;
  }
  RawText raw;
  CLI::App a{"", first};
  declare(first, a, o, raw);
  try {
    std::vector<std::string> args(argv + 2, argv + argc);
    std::reverse(args.begin(), args.end());  // CLI11 takes them from the back
    a.parse(std::move(args));
  } catch (const CLI::CallForHelp&) {
    std::fputs(a.help().c_str(), stdout);
    return o;
  } catch (const CLI::ParseError& e) {
    fail_unknown(a, e);
  }
  finish_raw(raw, o);
  if (o.series && o.inputs.empty()) fail_usage("names no files", "--series", "like --series flow_*.vtk");
  if (o.series) o.inputs = {series_path(std::move(o.inputs), true)};
  o.command = first;
  return o;
}

std::vector<CommandDoc> command_docs() {
  std::vector<CommandDoc> docs;
  for (const std::string& name : commands) {
    if (name == "complete") continue;
    Options o;
    RawText raw;
    CLI::App a{"", name};
    declare(name, a, o, raw);
    CommandDoc doc{name, a.get_description(), {}, {}, {}};
    for (const CLI::Option* option : a.get_options()) {
      std::vector<std::string> choices;  // CLI11 tells of them in the text of the type: "TEXT:{a,b}"
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
