// SPDX-License-Identifier: Apache-2.0
// demo: pictures from built-in sources, or of every file in a folder, alone and on a contact sheet.
#include <dirent.h>
#include <fmt/core.h>
#include <sys/stat.h>

#include <algorithm>
#include <cstdio>

#include "base/error.h"
#include "base/file/file.h"
#include "base/text/text.h"
#include "base/text/utf8.h"
#include "cli/chain.h"
#include "cli/cli.h"
#include "cli/say.h"
#include "color/map_files/colormap_file.h"
#include "image/codec.h"
#include "io/formats.h"
#include "pipeline/picture/picture.h"
#include "render/annotate/contact_sheet.h"

namespace sg {

namespace {

struct Demo {
  const char *name, *sentence, *source;
  std::vector<const char*> filters, shows;
  const char* camera = "";
  bool with_surface = false;  ///< a second branch: the surface 0 of the source
};

std::vector<Demo> demos() {
  return {
      {"gyroid",
       "an isosurface of the gyroid, coloured by how steeply the function rises through it",
       "gyroid size=96",
       {"gradient", "magnitude", "contour values=0"},
       {"surface"}},
      {"tangle",
       "three nested translucent surfaces of the tangle cube",
       "tangle size=80",
       {"contour values=-4,0,6"},
       {"surface field='contour value' opacity=0.45"}},
      {"hydrogen",
       "the probability density of an electron in a hydrogen atom, as a volume",
       "hydrogen size=96 bounds=-18,18,-18,18,-18,18",
       {},
       {"volume", "outline"},
       "azimuth=20"},
      {"marschner_lobb",
       "the test signal of Marschner and Lobb, which shows what interpolation loses",
       "marschner_lobb size=64",
       {"contour values=0.5"},
       {"surface color=#d8c9a8"}},
      {"abc_flow",
       "a cut through the ABC flow, coloured by speed",
       "abc size=96",
       {"magnitude", "slice normal=1,-1,1"},
       {"surface lit=false", "outline"}},
      {"double_gyre",
       "the stream function of the double gyre: signed, so the map has two sides",
       "double_gyre dims=201,101,1",
       {},
       {"surface lit=false"}},
      {"taylor_green",
       "pressure between Taylor-Green vortices, whose flow is known in closed form",
       "taylor_green size=64",
       {},
       {"surface field=pressure lit=false"}},
      {"point_load",
       "stress in the ground under a point load, over decades on a log scale",
       "point_load size=96",
       {"slice axis=y position=0"},
       {"surface field='von Mises stress' scale=log map=ember lit=false", "outline"},
       "azimuth=20"},
      {"torus_in_fog",
       "an opaque torus inside the volume of its own distance field",
       "torus size=80",
       {},
       {"volume opacity=0:0,0.35:0,0.5:0.015,1:0.03"},
       "",
       true},
  };
}

PipelineFile pipeline_of_demo(const Demo& d) {
  Options o;
  o.command = Command::demo;
  o.source = d.source;
  for (const char* f : d.filters) o.filters.emplace_back(f);
  for (const char* s : d.shows) o.shows.emplace_back(s);
  o.camera = d.camera;
  PipelineFile file = pipeline_of(o);
  if (d.with_surface) {
    file.steps.push_back({"skin", "contour", {"values=0"}, {"source"}, 0});
    file.show.push_back({"surface", {"color=tomato"}, "skin", 0});
  }
  return file;
}

void make_folders(const std::string& path) {
  for (size_t at = 0; at != std::string::npos;) {
    at = path.find('/', at + 1);
    const std::string part = path.substr(0, at);
    struct stat st {};
    if (!part.empty() && ::stat(part.c_str(), &st) != 0 && ::mkdir(part.c_str(), 0777) != 0) fail_data("cannot create the folder", part);
  }
}

// The first reader of files of this extension; null: none.
auto reader_of_extension(std::string_view extension) -> decltype(Format::read) {
  for (const Format& f : formats())
    for (const std::string_view e : words(f.extensions))
      if (e == extension && f.read && f.read != read_raw) return f.read;
  return nullptr;
}

// Files below a folder with an extension that some reader knows, sorted.
void find_files(const std::string& folder, std::vector<std::string>& found) {
  std::vector<std::string> names;
  if (DIR* dir = ::opendir(folder.c_str())) {
    while (const dirent* e = ::readdir(dir))
      if (e->d_name[0] != '.') names.emplace_back(e->d_name);
    ::closedir(dir);
  } else {
    fail_data("no such folder", folder);
  }
  std::sort(names.begin(), names.end());
  for (const std::string& name : names) {
    const std::string path = folder + "/" + name;
    struct stat st {};
    if (::stat(path.c_str(), &st) != 0) continue;
    if (S_ISDIR(st.st_mode)) {
      find_files(path, found);
      continue;
    }
    if (reader_of_extension(extension_of(path))) found.push_back(path);
  }
}

// Why a file of a folder is passed over: it is a table or a colour map, which cannot be drawn directly. Broken files are not.
std::optional<std::string> why_skipped(const std::string& path) {
  const auto reads = reader_of_extension(extension_of(path));
  if (reads != read_csv && reads != read_json && reads != read_gml) return {};
  try {
    if (reads == read_json) return fmt::format("colour maps ({}), for --map", read_colormaps(path).size());
  } catch (const Error&) {  // none of those
  }
  try {
    Context quiet;
    bool any = false;
    for_each_dataset(read_data(path, {}, quiet), [&](const std::string&, const DatasetPtr&) { any = true; });
    return any ? std::nullopt : std::optional<std::string>("a table; table_to_points turns its rows into points");
  } catch (const Error&) {
    return {};
  }
}

int sheet_of_folder(const Options& o, Context& context) {
  std::vector<std::string> files;
  find_files(o.inputs[0], files);
  std::vector<CaptionedImage> pictures;
  size_t failed = 0, skipped = 0;
  for (const std::string& path : files) {
    CaptionedImage c;
    c.caption = path.substr(o.inputs[0].size() + (o.inputs[0].back() == '/' ? 0 : 1));
    if (const auto why = why_skipped(path)) {
      ++skipped;
      if (!o.quiet) say(fmt::format("{}: skipped: {}\n", printable(c.caption), printable(*why)));
      continue;
    }
    try {
      PipelineFile file;
      file.steps.push_back({"input", "read", {"path=" + path}, {}, 0});
      Context quiet(context, 0, 1);
      quiet.on_log = nullptr, quiet.on_progress = nullptr;
      Picture p = make_picture(file, {}, quiet);
      c.image = std::move(p.image);
      if (!o.quiet) say(fmt::format("{}: {}\n", printable(c.caption), p.notes.empty() ? "" : printable(p.notes[0])));
    } catch (const Error& e) {
      ++failed;
      if (!o.quiet) say(fmt::format("{}: refused: {}\n", printable(c.caption), printable(e.what())));
      c.caption += " (refused)";
    }
    pictures.push_back(std::move(c));
    context.check();
  }
  // Sheets of 48, so that each stays viewable.
  constexpr size_t per_sheet = 48;
  const std::string ext = extension_of(o.sheet), stem = o.sheet.substr(0, o.sheet.size() - ext.size() - 1);
  for (size_t begin = 0, n = 1; begin < pictures.size(); begin += per_sheet, ++n) {
    const std::vector<CaptionedImage> part(pictures.begin() + ptrdiff_t(begin),
                                           pictures.begin() + ptrdiff_t(std::min(pictures.size(), begin + per_sheet)));
    const std::string path = pictures.size() <= per_sheet ? o.sheet : fmt::format("{}-{}.{}", stem, n, ext);
    write_image(path, contact_sheet(part, 6, 400));
    if (!o.quiet) std::printf("%s\n", path.c_str());
  }
  if (!o.quiet) std::printf("%zu files, %zu refused, %zu skipped\n", files.size(), failed, skipped);
  if (pictures.empty()) fail_data("contains no file that can be drawn", o.inputs[0]);
  return 0;
}

}  // namespace

int run_demo(const Options& o, Context& context) {
  if (!o.inputs.empty()) {
    if (o.sheet.empty())
      fail_usage("no sheet to write was given", "sightglass demo", "write e.g. sightglass demo FOLDER --sheet sheet.png");
    return sheet_of_folder(o, context);
  }
  const std::string folder = o.output.empty() ? "out" : o.output;
  make_folders(folder);
  if (!folder_of(o.sheet).empty()) make_folders(folder_of(o.sheet).substr(0, folder_of(o.sheet).size() - 1));
  std::vector<CaptionedImage> pictures;
  for (const Demo& d : demos()) {
    PipelineFile file = pipeline_of_demo(d);
    const std::string path = folder + "/" + d.name + ".png";
    Picture p = with_context(fmt::format("rendering the demo '{}'", d.name), [&] { return make_picture(file, {}, context); });
    attach_recipe(p.image, file, path);
    write_image(path, p.image);
    if (!o.quiet) std::printf("%-28s %s\n", path.c_str(), d.sentence);
    if (!o.sheet.empty()) pictures.push_back({std::move(p.image), fmt::format("{}: {}", d.name, d.sentence)});
  }
  if (!o.sheet.empty()) write_image(o.sheet, contact_sheet(pictures, 3, 560));
  if (!o.quiet) std::printf("Each picture can be remade from the recipe stored in it: sightglass open %s/gyroid.png\n", folder.c_str());
  return 0;
}

}  // namespace sg
