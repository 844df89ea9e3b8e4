// SPDX-License-Identifier: Apache-2.0
// Pictures that are saved from a window: their kinds, their names, and recipes that work where the browser has put them.
#include <filesystem>
#include <span>

#include "base/file/file.h"
#include "base/file/file_fence.h"
#include "image/codec.h"
#include "pipeline/picture/picture.h"
#include "serve/renderer/local_renderer.h"
#include "serve/session/saved_picture.h"
#include "serve/session/session.h"
#include "serve/support/window.h"
#include "support/test.h"

using namespace sg;
using namespace sg::serve;
using sg::test::contains;
using sg::test::Window;
namespace fs = std::filesystem;

namespace {

std::string grid(int last) {
  return "# vtk DataFile Version 3.0\nt\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 2 2 2\nORIGIN 0 0 0\nSPACING 1 1 1\n"
         "POINT_DATA 8\nSCALARS heat float 1\nLOOKUP_TABLE default\n0 1 2 3 4 5 6 " +
         std::to_string(last) + "\n";
}

// work/data/room.vtk and an empty folder beside work.
struct Place {
  std::string top, work, data, elsewhere;
  explicit Place(const std::string& name)
      : top(test::fresh_folder(name)), work(top + "work/"), data(work + "data/"), elsewhere(top + "downloads/") {
    fs::create_directories(data), fs::create_directories(elsewhere);
    write_file(data + "room.vtk", grid(7));
  }
};

// The folder in which the program would have been started.
struct Working {
  explicit Working(const std::string& folder) : before(fs::current_path()) { fs::current_path(folder); }
  ~Working() { fs::current_path(before); }
  fs::path before;
};

std::shared_ptr<Session> session_over(const std::string& path, const std::string& title, const std::string& pictures_in = "") {
  PipelineFile file = parse_pipeline("sightglass: 1\nsteps:\n  room: {read: \"" + path + "\"}\nshow:\n  - {volume: {opacity: 0.3}}\n", "",
                                     picture_vocabulary());
  return Session::open(std::make_unique<LocalRenderer>(64 << 20, std::vector<std::string>{}), std::move(file), title, pictures_in);
}

Saved saved_by(Session& session, Window& window, const std::string& more = "") {
  window.say("{'do':'save','n':7,'size':[60,40]" + more + "}");
  const Json answer = window.next("saved");
  const auto kept = session.saved(answer["url"].text().substr(7));
  REQUIRE(kept);
  CHECK(answer["name"].text() == kept->name);
  return *kept;
}

std::string refused_to_save(Window& window, const std::string& message) {
  window.say(message);
  return window.next("refused")["errors"][0]["text"].text();
}

// What `sightglass open PATH` writes beside it.
std::string opened_again(const std::string& path) {
  const Image image = read_png(path);
  std::vector<std::string> changed;
  PipelineFile recipe = recipe_in(image, path, changed);
  CHECK(changed.empty());
  Context context;
  Picture again = make_picture(recipe, {}, context);
  const std::string output = path.substr(0, path.size() - 4) + "-again.png";
  attach_recipe(again.image, recipe, output);
  return encode_image(output, again.image);
}

std::string recipe_text(const Saved& s) { return emit_pipeline(recipe_in(decode_png(std::as_bytes(std::span(*s.bytes)), s.name), s.name)); }

}  // namespace

TEST_CASE("saving: a picture of a file is made again, byte for byte, wherever the browser has put it") {
  const Place p("saving_view");
  const Working here(p.work);
  const auto session = session_over("data/room.vtk", "room.vtk");
  Window window(*session);
  window.next("state");
  const Saved s = saved_by(*session, window, ",'type':'png'");
  CHECK(s.name == "room.png");
  CHECK(contains(recipe_text(s), p.data + "room.vtk"));
  const std::string kept = p.elsewhere + "room.png";
  write_file(kept, *s.bytes);
  CHECK(opened_again(kept) == *s.bytes);
  // Where the data do not lie below the working folder, whoever opens it has to want that.
  const Working there(p.elsewhere);
  CHECK(contains(test::error_of([&] { opened_again(kept); }), "--read-anywhere"));
  allow_reading_anywhere();
  CHECK(opened_again(kept) == *s.bytes);
  ::unsetenv("SIGHTGLASS_READ_ANYWHERE");
}

TEST_CASE("saving: from a served folder recipes name files as they lie in it, and work there") {
  const Place p("saving_serve");
  const auto session = session_over(p.data + "room.vtk", "room.vtk", p.work);
  Window window(*session);
  window.next("state");
  const Saved s = saved_by(*session, window);
  CHECK(contains(recipe_text(s), "data/room.vtk"));
  for (const auto& [key, text] : decode_png(std::as_bytes(std::span(*s.bytes)), s.name).text) CHECK_FALSE(contains(text, p.top));
  write_file(p.work + "mine.png", *s.bytes);
  CHECK(opened_again(p.work + "mine.png") == *s.bytes);
}

TEST_CASE("saving: pictures are of the type that is asked for, and other types and sizes are refused with those that there are") {
  const Place p("saving_types");
  const auto session = session_over(p.data + "room.vtk", "room.vtk");
  Window window(*session);
  const Json state = window.next("state");
  CHECK(state["saves"]["most_pixels"].number() == 4096 * 4096);
  struct Expected {
    std::string type, name, media, begins;
  };
  const std::vector<Expected> all{{"png", "room.png", "image/png", "\x89PNG"},
                                  {"jpg", "room.jpg", "image/jpeg", "\xff\xd8\xff"},
                                  {"webp", "room.webp", "image/webp", "RIFF"}};
  REQUIRE(state["saves"]["types"].size() == all.size());
  for (size_t i = 0; i < all.size(); ++i) {
    CHECK(state["saves"]["types"][i].text() == all[i].type);
    const Saved s = saved_by(*session, window, ",'type':'" + all[i].type + "'");
    CHECK(s.name == all[i].name);
    CHECK(s.type == all[i].media);
    CHECK(s.bytes->starts_with(all[i].begins));
  }
  CHECK(saved_by(*session, window).type == "image/png");
  const std::string said = refused_to_save(window, "{'do':'save','n':8,'size':[60,40],'type':'tiff'}");
  for (const char* word : {"tiff", "png", "jpg", "webp"}) CHECK(contains(said, word));
  CHECK(contains(refused_to_save(window, "{'do':'save','n':8,'size':[8192,8192]}"), "16777216 pixels"));
  CHECK(contains(refused_to_save(window, "{'do':'save','n':8,'size':[16400,64],'type':'webp'}"), "too many for WebP"));
}

TEST_CASE("saving: a picture of a series is called as the file that it shows") {
  const Place p("saving_series");
  for (int k = 0; k < 3; ++k) write_file(p.data + "wave_" + std::to_string(k) + ".5.vtk", grid(10 * (k + 1)));
  const auto session = session_over(p.data + "wave_*.vtk", "wave_*.vtk");
  Window window(*session);
  REQUIRE(window.next("state")["times"].size() == 3);
  CHECK(saved_by(*session, window).name == "wave_0.5.png");
  window.say("{'do':'time','n':2,'time':2}");
  window.next("state");
  CHECK(saved_by(*session, window, ",'type':'jpg'").name == "wave_2.5.jpg");
}

TEST_CASE("saving: steps within files of a series are numbered, and a step that is stated counts") {
  const Place p("saving_steps");
  for (int k = 0; k < 2; ++k) write_file(p.data + "wave_" + std::to_string(k) + ".vtk", grid(9));
  PipelineFile file;
  file.steps.push_back({"a", "read", {"path=" + p.data + "wave_{n}.vtk"}, {}, 0});
  FilmTimes film;
  film.times = {0, 0.1, 0.2, 0.3}, film.steps = {0, 1, 2, 3};
  CHECK(picture_stem("wave_{n}.vtk", file, film, 3) == "wave_003");
  CHECK(picture_stem("wave_{n}.vtk", file, film, std::nullopt) == "wave_000");
  file.steps[0].words.emplace_back("time=0.21");
  CHECK(picture_stem("wave_{n}.vtk", file, film, std::nullopt) == "wave_002");
  file.steps[0].words.back() = "step=1";
  CHECK(picture_stem("wave_{n}.vtk", file, std::nullopt, std::nullopt) == "wave_1");
  CHECK(picture_stem("head.nii.gz", {}, std::nullopt, std::nullopt) == "head");
  CHECK(picture_stem("", {}, std::nullopt, std::nullopt) == "picture");
}
