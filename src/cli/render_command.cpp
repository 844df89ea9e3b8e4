// SPDX-License-Identifier: Apache-2.0
// render, run and open: each makes a PipelineFile and hands it on.
#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>

#include "base/error.h"
#include "base/file/file.h"
#include "base/file/file_fence.h"
#include "base/text/replace.h"
#include "base/text/text.h"
#include "base/text/utf8.h"
#include "cli/chain.h"
#include "cli/cli.h"
#include "cli/hints/step_files.h"
#include "cli/info.h"
#include "cli/outputs.h"
#include "cli/say.h"
#include "color/legend_content.h"
#include "filter/mesh/select/piece.h"
#include "image/codec.h"
#include "io/file_series.h"
#include "io/film/movie.h"
#include "io/formats.h"
#include "pipeline/film/film.h"
#include "pipeline/graph/slabs.h"
#include "pipeline/graph/step_report.h"
#include "pipeline/offline/page.h"
#include "pipeline/picture/layers/picture_layers.h"
#include "pipeline/picture/picture.h"
#include "pipeline/picture/picture_cost.h"
#include "pipeline/picture/picture_sets.h"
#include "render/render.h"

namespace sg {

namespace {

constexpr std::string_view standard_output = "-";  // as the name of a picture

// A picture that cannot be written is found out before any work is done.
void check_output(const std::string& path) {
  if (path == standard_output) {
    if (::isatty(1)) fail_usage("standard output is a terminal, not a file", "-o -", "send it on: ... -o - > picture.png");
    return;
  }
  const std::string ext = extension_of(path);
  const auto& known = image_extensions();
  if (std::find(known.begin(), known.end(), ext) == known.end()) {
    std::string list;
    for (const std::string& e : known) list += (list.empty() ? "." : " .") + e;
    list += " .html";
    fail_usage(fmt::format("'{}' is not a picture format", ext), path,
               fmt::format("supported: {}{}", list, ext.empty() ? "" : "; data is written by: sightglass convert IN -o NAME." + ext));
  }
  AtomicFile probe(path);  // missing folder, no permission, a folder of that name: removed again at once
}

// When the program began, about: before main().
const auto program_start = std::chrono::steady_clock::now();

std::string describe(const PictureDraft& d) {
  if (d.light) return light_text(*d.light);
  std::string text = fmt::format("{}, a voxel covers at most {:.3g} pixel{}", d.made_of, d.voxel_pixels, d.voxel_pixels == 1 ? "" : "s");
  if (d.compared)
    text +=
        fmt::format("; half as many voxels along each axis change it by {:.2g} of full scale on average, {:.2g} at most", d.mean, d.most);
  return text;
}

// Writes each picture as soon as it is there. Messages about one continue when the next begins.
void set_drafts(PictureOptions& options, const PipelineFile& file, const std::string& output, const Options& o) {
  if (!o.progressive && !(o.within > 0)) return;
  options.on_draft = [&file, output, quiet = o.quiet](const Picture& picture, const PictureDraft& draft) {
    Image image = picture.image;
    attach_recipe(image, file, output);
    write_image(output, image);
    if (quiet) return;
    const std::chrono::duration<double> since = std::chrono::steady_clock::now() - program_start;
    say(fmt::format("{}: after {:.2f} s: {}\n", printable(output), since.count(), describe(draft)));
    std::fflush(stdout);
  };
  if (o.within > 0) {
    const double drawing = o.within - std::min(0.15, 0.1 * o.within);  // the rest is for writing
    options.until = program_start + std::chrono::duration_cast<std::chrono::steady_clock::duration>(std::chrono::duration<double>(drawing));
  }
}

int render_to(PipelineFile& file, const std::string& output, const std::string& layers, PictureOptions options, const Options& o,
              Context& context) {
  if (o.explain) {
    print_explanation(file, true);
    return 0;
  }
  check_output(output);
  if (!layers.empty()) format_to_write(layers), options.layers = true;
  if (o.memory > 0) check_memory(build_graph(file), o);
  const bool streamed = output == standard_output;
  if (streamed && (o.progressive || o.within > 0))
    fail_usage("drafts are replaced by better ones, but a stream cannot be", "-o -", "name a file");
  set_drafts(options, file, output, o);
  Picture picture = make_picture(file, options, context);
  attach_recipe(picture.image, file, streamed ? "picture.png" : output);
  if (streamed) {
    const std::vector<uint8_t> png = encode_png(picture.image);
    if (std::fwrite(png.data(), 1, png.size(), stdout) != png.size()) fail_data("cannot write to standard output");
    return 0;
  }
  const StopWatch watch;
  if (!layers.empty()) write_data(layers, layers_of(picture), {}, context);
  write_image(output, picture.image);
  context.log(LogLevel::debug, fmt::format("writing '{}': {}", output, watch.text()));
  if (!o.quiet) {
    std::string line = printable(output);
    if (!picture.drafts.empty()) {
      const std::chrono::duration<double> since = std::chrono::steady_clock::now() - program_start;
      picture.notes.insert(picture.notes.begin(), fmt::format("after {:.2f} s: {}", since.count(), describe(picture.drafts.back())));
    }
    for (size_t i = 0; i < picture.notes.size(); ++i) line += (i ? "; " : ": ") + printable(picture.notes[i]);
    say(line + "\n");
  }
  return 0;
}

}  // namespace

namespace {

// The parameters of the film, set from the command line.
void take_film_flags(const Options& o, FilmParams& film) {
  Schema schema = schema_of(film);
  set_params(schema, o.film, "film");
}

int render_page(PipelineFile file, const PageParams& params, const FilmParams& film, const PictureOptions& options, const Options& o,
                Context& context) {
  const Page page = write_page(std::move(file), params, film, options, context);
  if (o.quiet) return 0;
  std::string line = fmt::format("{}: {}", printable(film.output), human_bytes(page.html.size()));
  if (page.steps > 1) line += fmt::format(", {} time steps", page.steps);
  for (const std::string& note : page.notes) line += "; " + printable(note);
  say(line + "\n");
  return 0;
}

// Makes a picture, the pictures of a film, or a page, whatever the output is.
int render_into(PipelineFile file, const FilmParams& film, const PictureOptions& options, const Options& o, Context& context) {
  PageParams page;
  if (!film.layers.empty() && is_page(film.output))
    fail_usage("a page has no layers", "--layers", "name a picture or a film with -o, or leave out layers");
  if (is_page(film.output)) {
    take_page_words(file, page);
    if (!o.explain) return render_page(std::move(file), page, film, options, o, context);
  }
  if (is_film(film.output) && !o.explain) {
    const FilmWritten written = write_film(std::move(file), film, options, context);
    const size_t count = written.times.size();
    const double rate = pictures_per_second(film, count);
    if (!o.quiet)
      say(fmt::format(
          "{}: {} pictures, {}{}\n", printable(written.what), count,
          film.turntable > 0 ? "once around"
                             : fmt::format("times {} to {}", short_number(written.times.front()), short_number(written.times.back())),
          is_movie(film.output) ? fmt::format(", in {} s (--fps {})", short_number(double(count) / rate, 2), short_number(rate)) : ""));
    return 0;
  }
  if ((word_value(o.film, "times") || film.turntable > 0) && !o.explain)
    fail_usage("several pictures are asked for, but the output name is a single one", film.turntable > 0 ? "--turntable" : "--times",
               "number them with -o out_{n}.png, or make a film with -o film.webm");
  return render_to(file, film.output, film.layers, options, o, context);
}

}  // namespace

int run_render(const Options& o, Context& context) {
  if (const std::string series = as_series(o.inputs); !series.empty() && o.layout.empty())
    context.info(fmt::format("{} files whose names differ by numbers are drawn together in one picture; as steps of one series: {}",
                             o.inputs.size(), series));
  PipelineFile file = pipeline_of(o);
  PictureOptions options;
  options.coloring = coloring_words(o);
  FilmParams film;
  take_film_flags(o, film);
  const char* unnamed = film.turntable > 0 ? "{name}.webm" : "{name}.png";
  film.output = output_name(o.output.empty() ? unnamed : o.output, o.inputs.empty() ? file.steps[0].operation : stem_of(o.inputs[0]));
  if ((is_film(film.output) || is_page(film.output)) && (o.progressive || o.within > 0))
    fail_usage(is_page(film.output) ? "a page is final from the start" : "the pictures of a series are final from the start",
               o.progressive ? "--progressive" : "--within", "leave it out, or render a single picture");
  return render_into(std::move(file), film, options, o, context);
}

int run_pipeline_file(const Options& o, Context& context) {
  for (const std::string& path : o.inputs) {
    PipelineFile file = read_pipeline(path, picture_vocabulary());
    if (!o.size.empty()) file.picture.push_back("size=" + o.size);
    FilmParams film;
    film.output = stem_of(path) + ".png";
    std::erase_if(file.picture, [&](const std::string& w) { return is_film_word(w) && word_value(o.film, w.substr(0, w.find('='))); });
    take_film_words(file, film);
    take_film_flags(o, film);
    film.output = o.output.empty() ? path_beside(path, film.output) : output_name(o.output, stem_of(path));
    if (!film.layers.empty() && !word_value(o.film, "layers")) film.layers = path_beside(path, film.layers);
    if (!is_page(film.output)) std::erase_if(file.picture, [](const std::string& w) { return is_page_word(w); });
    render_into(std::move(file), film, {}, o, context);
  }
  return 0;
}

namespace {

// Around all that a recipe out of a picture makes this process do.
struct Fence {
  Fence(const std::string& picture, const std::string& output) {
    set_file_fence({{folder_of(picture), ""}, {output}, fmt::format("the recipe in '{}'", picture)});
  }
  ~Fence() { remove_file_fence(); }
  Fence(const Fence&) = delete;
  Fence& operator=(const Fence&) = delete;
};

}  // namespace

int run_open(const Options& o, Context& context) {
  for (const std::string& path : o.inputs) {
    const Image image = read_png(path);
    if (o.recipe) {
      say(emit_pipeline(recipe_in(image, path)));
      continue;
    }
    const std::string output = !o.output.empty() ? o.output : folder_of(path) + stem_of(path) + "-again.png";
    const Fence fence(path, output);
    std::vector<std::string> changed;
    PipelineFile file = recipe_in(image, path, changed);
    for (const std::string& c : changed) context.warn(fmt::format("'{}' has changed since the picture was made", c));
    if (!o.size.empty()) file.picture.push_back("size=" + o.size);
    render_to(file, output, "", {}, o, context);
  }
  return 0;
}

// What is in the result of filters.
int run_info_of_pipeline(const Options& o, Context& context) {
  if (o.inputs.size() > 1) fail_usage("filters one file at a time", "sightglass info");
  const PipelineFile file = pipeline_of(o);
  const PipelineGraph built = build_graph(file);
  if (o.explain) {
    print_explanation(file);
    return 0;
  }
  check_memory(built, o);
  const Data data = built.graph.evaluate(built.last, {}, context);
  const std::string name = o.inputs.empty() ? o.source : o.inputs[0];
  say(o.json ? info_json(data, o.quick) : info_text(data, name, o.quick));
  return 0;
}

}  // namespace sg
