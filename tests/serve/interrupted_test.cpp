// SPDX-License-Identifier: Apache-2.0
// Pictures by paths that are interrupted go on where they were.
#include "serve/renderer/unfinished.h"

#include <cstdlib>
#include <string>

#include "base/error.h"
#include "pipeline/picture/picture.h"
#include "serve/renderer/local_renderer.h"
#include "support/test.h"

using namespace sg;
using namespace sg::serve;

namespace {

PipelineFile ball(const std::string& color, const std::string& words = "") {
  PipelineFile file = parse_pipeline(
      "sightglass: 1\nsteps:\n  ball: {sphere: {size: 24}}\n  skin: {contour: {values: 0}, from: ball}\nshow:\n  - {surface: {color: " +
          color + "}, of: skin}\n",
      "", picture_vocabulary());
  file.picture = {"integrator=path", "noise=0.0001", "paths=64"};
  if (!words.empty()) file.picture.push_back(words);
  return file;
}

DrawRequest looking(double x = 3) {
  DrawRequest r;
  r.width = 120, r.height = 90;
  r.camera = ViewCamera{{x, -4, 2}, {0, 0, 0}, {0, 0, 1}, true, 30, 2.5};
  return r;
}

// Paths a pixel of the first picture on the way; after that one the picture is cancelled.
double begun(LocalRenderer& renderer, const DrawRequest& r) {
  Context context;
  double paths = 0;
  try {
    renderer.draw(
        r,
        [&](const DrawnView& d) {
          if (paths == 0) paths = std::atof(d.told.c_str());
          context.cancel();
        },
        context);
  } catch (const Error& e) {
    CHECK(e.kind() == ErrorKind::cancelled);
  }
  CHECK(context.cancelled());
  return paths;
}

std::string finished(LocalRenderer& renderer, const DrawRequest& r) {
  Context context;
  return *renderer
              .draw(
                  r, [](const DrawnView&) {}, context)
              .bytes;
}

}  // namespace

TEST_CASE("interrupted: an interrupted picture goes on, and has the bytes of one that was not interrupted") {
  for (const char* const words : {"", "environment=sky", "denoise=true"}) {
    CAPTURE(words);
    Context context;
    LocalRenderer whole(64 << 20, {}), renderer(64 << 20, {});
    whole.load(ball("tomato", words), context), renderer.load(ball("tomato", words), context);
    double paths = begun(renderer, looking());
    for (int i = 0; i < 3; ++i) {
      const double next = begun(renderer, looking());
      CHECK(next > paths);
      paths = next;
    }
    CHECK(finished(renderer, looking()) == finished(whole, looking()));
  }
}

TEST_CASE("interrupted: another camera, size, picture or a view that has gone begins anew") {
  Context context;
  LocalRenderer renderer(64 << 20, {});
  renderer.load(ball("tomato"), context);
  const double first = begun(renderer, looking());
  CHECK(begun(renderer, looking()) > first);
  CHECK(begun(renderer, looking(3.5)) <= first + 1);
  CHECK(begun(renderer, looking()) == first);  // the other camera took its place
  DrawRequest wide = looking();
  wide.width = 121;
  CHECK(begun(renderer, wide) <= first + 1);
  begun(renderer, looking());
  renderer.forget(0);
  CHECK(begun(renderer, looking()) == first);
  renderer.load(ball("tomato"), context);
  CHECK(begun(renderer, looking()) > first);  // the same picture
  renderer.load(ball("teal"), context);
  CHECK(begun(renderer, looking()) == first);
}

TEST_CASE("interrupted: what is kept has a limit, beyond which older ones go") {
  const auto so_far = [](size_t bytes) { return LightSoFar{nullptr, bytes}; };
  const auto of = [](int view) {
    DrawRequest r = looking();
    r.view = view;
    return r;
  };
  Unfinished kept(100);
  kept.keep(of(1), 7, so_far(60));
  kept.keep(of(2), 7, so_far(40));
  kept.keep(of(3), 7, so_far(50));
  CHECK(kept.take(of(1), 7).bytes == 0);
  CHECK(kept.take(of(2), 8).bytes == 0);
  CHECK(kept.take(of(3), 7).bytes == 50);
  CHECK(kept.take(of(3), 7).bytes == 0);
  kept.keep(of(1), 7, so_far(101));
  CHECK(kept.take(of(1), 7).bytes == 0);
}
