// SPDX-License-Identifier: Apache-2.0
#include "pipeline/offline/page.h"

#include "base/file/file.h"
#include "base/parallel.h"
#include "pipeline/picture/picture.h"
#include "support/test.h"

using namespace sg;
using test::contains;
using test::error_of;

namespace {

PipelineFile pipeline_with(const std::string& step, const std::string& show, const std::string& picture = "") {
  return parse_pipeline("sightglass: 1\nsteps:\n  a: " + step + "\nshow:\n  - " + show + "\npicture: {size: 120x80" + picture + "}\n", "",
                        picture_vocabulary());
}

Page page_of(const std::string& step, const std::string& show, const std::string& max = "8M", const std::string& times = "") {
  Context context;
  FilmParams film;
  film.times = times;
  return make_page(pipeline_with(step, show), {max}, film, {}, context);
}

size_t count_of(const std::string& text, std::string_view part) {
  size_t n = 0;
  for (size_t at = text.find(part); at != text.npos; at = text.find(part, at + 1)) ++n;
  return n;
}

}  // namespace

TEST_CASE("pages: the file names no other, asks for nothing, and forbids the browser to") {
  const Page page = page_of("{sphere: {size: 12}}", "{surface: {}}");
  CHECK(page.html.starts_with("<!doctype html>"));
  CHECK(contains(page.html, "content=\"default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:\""));
  for (const char* word : {"http:", "https:", "src=\"/", "href=\"", "@import", "url("}) {
    CAPTURE(word);
    CHECK(!contains(page.html, word));
  }
  CHECK(contains(page.html, "\"kind\":\"surface\""));
  CHECK(count_of(page.html, "</script>") == count_of(page.html, "<script"));
}

TEST_CASE("pages: a picture on a surface is told to be shown by the colours of its points") {
  Context context;
  PipelineFile file = parse_pipeline(
      "sightglass: 1\nsteps:\n  a: {sphere: {size: 12}}\n  b: {contour: {values: [0]}, from: a}\n  c: {texture_coordinates: {map: sphere}, "
      "from: b}\nshow:\n  - {surface: {pattern: checker, color: red}, of: c}\npicture: {size: 120x80}\n",
      "", picture_vocabulary());
  const Page page = make_page(std::move(file), {}, {}, {}, context);
  CHECK(contains(page.html, "\"kind\":\"direct\""));
  REQUIRE(page.notes.size() == 1);
  CHECK(contains(page.notes[0], "at the surface's points"));
}

TEST_CASE("pages: texts of the data cannot end what they stand in") {
  Context context;
  const Page page = make_page(pipeline_with("{sphere: {size: 8}}", "{surface: {}}", ", title: \"</script><b>&\""), {}, {}, {}, context);
  CHECK(contains(page.html, "<title>&lt;/script>&lt;b>&amp;</title>"));
  CHECK(count_of(page.html, "</script>") == count_of(page.html, "<script"));
}

TEST_CASE("pages: no larger than stated, and what is coarser for that is told") {
  const std::string volume = "{gyroid: {size: 64}}", show = "{volume: {opacity: \"0:0,1:0.3\"}}";
  const Page all = page_of(volume, show);
  CHECK(all.html.size() > 400 << 10);
  CHECK(contains(all.html, "\"dims\":[64.0,64.0,64.0]"));
  CHECK(contains(all.html, "\"bits\":16"));
  for (const int kilobytes : {380, 220, 160}) {
    const Page less = page_of(volume, show, std::to_string(kilobytes) + "K");
    CAPTURE(kilobytes);
    CHECK(less.html.size() <= size_t(kilobytes) << 10);
    CHECK(less.html.size() > size_t(kilobytes) << 9);  // and not much coarser than it has to be
    REQUIRE(!less.notes.empty());
    CHECK(contains(less.notes.back(), "a volume of 64x64x64 has "));
    CHECK(contains(less.notes.back(), " values of 8 bits"));
  }
}

TEST_CASE("pages: surfaces, points and glyphs have a share of what there is, and it is told") {
  const auto last = [](const Page& p) { return p.notes.empty() ? "" : p.notes.back(); };
  CHECK(contains(last(page_of("{gyroid: {size: 80}}", "{points: {}}", "250K")), " points one of "));
  PipelineFile file = parse_pipeline(
      "sightglass: 1\nsteps:\n  a: {gyroid: {size: 80}}\n  b: {contour: {}}\nshow:\n  - {surface: {}}\npicture: {size: 120x80}\n", "",
      picture_vocabulary());
  Context context;
  const Page surface = make_page(file, {"300K"}, {}, {}, context);
  CHECK(surface.html.size() <= 300 << 10);
  CHECK(contains(last(surface), "a surface of "));
}

TEST_CASE("pages: too small a budget is refused with what would do") {
  CHECK(contains(error_of([] { page_of("{sphere: {size: 8}}", "{surface: {}}", "10K"); }), "no room for a page"));
  CHECK(contains(error_of([] { page_of("{sphere: {size: 8}}", "{surface: {}}", "much"); }), "write e.g. 8M"));
  CHECK(contains(error_of([] { page_of("{sphere: {size: 8}}", "{surface: {}}", "0"); }), "not an amount"));
}

TEST_CASE("pages: the same bytes for any number of threads") {
  const auto make = [](int threads) {
    set_thread_count(threads);
    Page p = page_of("{gyroid: {size: 48}}", "{volume: {opacity: \"0:0,1:0.3\"}}", "250K");
    set_thread_count(0);
    return p.html;
  };
  const std::string one = make(1);
  CHECK(make(3) == one);
  CHECK(make(8) == one);
}

TEST_CASE("pages: a series has its steps, stores once what stays, and thins them where they have no room") {
  const std::string gyre = "{double_gyre: {dims: [41, 21, 1]}}", show = "{surface: {field: velocity}}";
  const Page page = page_of(gyre, show, "8M", "0:1:5");
  CHECK(page.steps == 5);
  CHECK(count_of(page.html, "\"time\":") == 5);
  // The positions of all steps are one array.
  const size_t first = page.html.find("\"positions\":{\"array\":"), number = first + std::string_view("\"positions\":{\"array\":").size();
  REQUIRE(first != page.html.npos);
  const std::string positions = page.html.substr(first, page.html.find(',', number) - first + 1);
  CHECK(count_of(page.html, positions) == 5);
  const Page one = page_of(gyre, show, "8M", "0,1");
  CHECK(one.steps == 2);
}

TEST_CASE("pages: several panels and turntables are refused") {
  Context context;
  CHECK(contains(
      error_of([&] { make_page(pipeline_with("{sphere: {size: 8}}", "{surface: {}}", ", views: [front, top]"), {}, {}, {}, context); }),
      "leave out layout and views"));
  FilmParams film;
  film.turntable = 10;
  CHECK(contains(error_of([&] { make_page(pipeline_with("{sphere: {size: 8}}", "{surface: {}}"), {}, film, {}, context); }),
                 "turned by hand"));
}

TEST_CASE("pages: written beside and renamed; an error leaves nothing, and a page that was there as it was") {
  const std::string folder = test::fresh_folder("page");
  Context context;
  FilmParams film;
  film.output = folder + "a.html";
  write_page(pipeline_with("{sphere: {size: 8}}", "{surface: {}}"), {}, film, {}, context);
  CHECK(folder_entries(folder) == std::vector<std::string>{"a.html"});
  const std::string before(MappedFile(film.output).text());
  error_of([&] { write_page(pipeline_with("{sphere: {size: 8}}", "{surface: {}}"), {"10K"}, film, {}, context); });
  CHECK(folder_entries(folder) == std::vector<std::string>{"a.html"});
  CHECK(MappedFile(film.output).text() == before);
}
