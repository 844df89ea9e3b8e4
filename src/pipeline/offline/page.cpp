// SPDX-License-Identifier: Apache-2.0
#include "pipeline/offline/page.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/error.h"
#include "base/file/file.h"
#include "base/text/replace.h"
#include "base/text/text.h"
#include "image/codec.h"
#include "pipeline/film/film.h"
#include "pipeline/film/film_times.h"
#include "pipeline/offline/pack/pack_page.h"
#include "pipeline/offline/page_script.h"

namespace sg {

namespace {

constexpr size_t usual_steps = 24;
constexpr int poster_width = 640;

std::string html_text(std::string text) {
  replace_all(text, "&", "&amp;");
  replace_all(text, "<", "&lt;");
  replace_all(text, "\"", "&quot;");
  return text;
}

// Shown while the page opens, and where the browser cannot draw.
Image poster_of(const offline::PageStep& step, Context& context) {
  StatedPicture small = step.stated;
  const double factor = std::min(1.0, poster_width / double(small.width));
  small.width = std::max(1, int(small.width * factor)), small.height = std::max(1, int(small.height * factor));
  return draw_picture(step.panel.scene, step.panel.camera, small, step.panel.annotation, {}, context).image;
}

std::string recipe_text(const PipelineFile& file, const std::string& output) {
  Image none(1, 1, 3);
  attach_recipe(none, file, output.empty() ? "scene.html" : output);
  const auto at = std::find_if(none.text.begin(), none.text.end(), [](const auto& t) { return t.first == "sightglass"; });
  return at == none.text.end() ? "" : at->second;
}

std::string json_in_script(std::string json) {
  replace_all(json, "<", "\\u003c");
  return json;
}

std::string page_text(const offline::PackedPage& packed, const std::string& title, const std::vector<uint8_t>& poster,
                      const std::string& recipe) {
  std::string html =
      "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; "
      "img-src data: blob:\">\n<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<meta name=\"generator\" "
      "content=\"Sightglass\">\n<title>" +
      html_text(title) + "</title>\n</head>\n<body>\n";
  html += "<img id=\"poster\" alt=\"\" src=\"data:image/png;base64," + offline::base64(poster.data(), poster.size()) + "\">\n";
  html += "<script type=\"application/json\" id=\"scene\">" + json_in_script(packed.description) + "</script>\n";
  html += "<script type=\"application/json\" id=\"recipe\">" + json_in_script(json_string(recipe)) + "</script>\n";
  const auto& arrays = packed.arrays.arrays();
  for (size_t i = 0; i < arrays.size(); ++i)
    html += fmt::format("<script type=\"text/plain\" id=\"a{}\">", i) + offline::base64(arrays[i].bytes.data(), arrays[i].bytes.size()) +
            "</script>\n";
  html += "<script>" + std::string(offline::page_script()) + "</script>\n</body>\n</html>\n";
  return html;
}

// Up to so many times spread over a series.
std::string spread_times(const std::vector<double>& times) {
  std::string list;
  const size_t n = std::min(usual_steps, times.size());
  for (size_t i = 0; i < n; ++i) list += (i ? "," : "") + exact_number(times[n < 2 ? 0 : i * (times.size() - 1) / (n - 1)]);
  return list;
}

// The times of a page; none for a single picture.
std::string times_of(const PipelineFile& file, const FilmParams& film, std::vector<std::string>& notes, Context& context) {
  if (!film.times.empty()) return film.times;
  try {
    Context silent(context, 0, 0);
    silent.on_progress = nullptr, silent.on_log = nullptr;
    const std::vector<double> times = film_times(file, "", silent).times;
    if (times.size() < 2) return "";
    if (times.size() > usual_steps) notes.push_back(fmt::format("{} of {} time steps (--times states others)", usual_steps, times.size()));
    return spread_times(times);
  } catch (const Error& e) {
    if (e.kind() != ErrorKind::usage) throw;
    return "";  // nothing has times
  }
}

}  // namespace

bool is_page(const std::string& output) {
  const std::string extension = extension_of(output);
  return extension == "html" || extension == "htm";
}

Page make_page(PipelineFile file, const PageParams& params, const FilmParams& film, PictureOptions options, Context& context,
               UnstatedTimes unstated) {
  const uint64_t budget = page_budget(params);
  if (film.turntable > 0) fail_usage("a page is turned by hand", "--turntable", "leave it out, or make a film: -o film.webm");
  Page page;
  std::vector<offline::PageStep> steps;
  options.on_panel = [&](const Panel& panel, const StatedPicture& stated) {
    steps.push_back({{}, panel, stated});
    return false;
  };
  std::string recipe;
  FilmParams moments = film;
  // What is at hand has one time.
  if (film.times.empty() && options.results.empty() && unstated == UnstatedTimes::spread)
    moments.times = times_of(file, film, page.notes, context);
  Context computing(context, 0, 0.6), packing(context, 0.6, 1);
  if (moments.times.empty()) {
    Picture picture = make_picture(file, options, computing);
    page.notes.insert(page.notes.begin(), picture.notes.begin(), picture.notes.end());
    recipe = recipe_text(file, film.output);
  } else {
    make_film(file, moments, options,
              {nullptr,
               [&](FilmFrame&& f) {
                 steps.back().time = f.time;
                 if (f.number == 0) recipe = recipe_text(f.pipeline, film.output);
               }},
              computing);
  }
  const std::vector<uint8_t> poster = encode_png(poster_of(steps[0], computing));
  const std::string& stated_title = steps[0].panel.annotation.title;
  const std::string title = stated_title.empty() ? "Sightglass" : stated_title;
  const std::string frame = page_text({}, title, poster, recipe);  // all but what is shown
  if (frame.size() >= budget)
    fail_usage(fmt::format("{} leave no room for a page: without any data it has {}", params.max, human_bytes(frame.size())), "max",
               "allow more");
  const offline::PackedPage packed = offline::pack_within(steps, budget - frame.size() - budget / 200, packing);
  page.steps = std::max<size_t>(1, steps.size());
  page.notes.insert(page.notes.end(), packed.notes.begin(), packed.notes.end());
  page.html = page_text(packed, title, poster, recipe);
  context.progress(1, "done");
  return page;
}

Page write_page(PipelineFile file, const PageParams& params, const FilmParams& film, const PictureOptions& options, Context& context) {
  { AtomicFile probe(film.output); }  // what cannot be written is found out before any work is done
  Page page = make_page(std::move(file), params, film, options, context);
  write_file(film.output, page.html);
  return page;
}

}  // namespace sg
