// SPDX-License-Identifier: Apache-2.0
// Random operations and ways to show on random data with random words: each answers or throws sg::Error, soon, without asking for
// gigabytes. SG_HOSTILE_ONLY=NAME: that operation or way to show alone; SG_HOSTILE_TELL=1: each case before it runs, with its time.
// SG_HOSTILE_SLOW=N: all may take N times as long (valgrind).
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "pipeline/hostile/hostile_random.h"
#include "pipeline/hostile/hostile_watch.h"
#include "pipeline/operation/operation.h"
#include "pipeline/picture/picture_parts.h"
#include "scene/show/show.h"
#include "support/test.h"

using namespace sg;
using namespace sg::test;

namespace {

std::string about(const Data& data) {
  std::string s;
  for_each_dataset(data, [&](const std::string&, const DatasetPtr& d) {
    s += (s.empty() ? "" : " and ") + summary(*d);
    for (const Field& f : d->fields())
      s += fmt::format(", {} {}x{} on {}s", f.name, f.components(), element_name(f.array.type()), association_name(f.association));
  });
  return s.empty() ? "nothing or a table" : s;
}

struct Count {
  size_t answered = 0, refused = 0;
};

// Runs it; what it does besides answering or throwing sg::Error is a failed check.
void stays_calm(const std::string& what, Count& count, const std::function<void(Context&)>& run) {
  CAPTURE(what);
  const bool tells = std::getenv("SG_HOSTILE_TELL") != nullptr;
  if (tells) fmt::print(stderr, "{}", what);
  const std::clock_t start = std::clock();  // of the processor: other programs may be at work
  std::string failure;
  try {
    Context context;
    const hostile::Watch watch(context, hostile::seconds(60), what);
    run(context);
    ++count.answered;
  } catch (const Error& e) {
    ++count.refused;
    if (tells) fmt::print(stderr, " [{}]", e.what());
    if (std::string_view(e.what()).empty() || e.kind() == ErrorKind::internal) failure = fmt::format("an internal error: {}", e.what());
  } catch (const std::exception& e) {
    failure = fmt::format("{}: {}", typeid(e).name(), e.what());
  }
  const double took = double(std::clock() - start) / CLOCKS_PER_SEC;
  if (tells) fmt::print(stderr, ": {:.2f} s\n", took);
  // A few curved cells with random places and values are cut into hundreds of thousands of straight ones, or searched part by part.
  if (took > hostile::seconds(40)) failure += fmt::format(" took {:.1f} s", took);
  CHECK(failure == "");
}

void run_one(uint64_t seed, Count& count) {
  Random random(seed);
  const auto all = operations();
  const Operation& o = hostile::only() ? find_operation(hostile::only()) : all[size_t(random.whole(0, int(all.size()) - 1))];
  std::vector<Data> inputs;
  if (o.kind != OperationKind::source)
    for (int n = std::max(1, o.min_inputs + (o.max_inputs > o.min_inputs || o.max_inputs < 0 ? random.whole(0, 1) : 0)); n > 0; --n)
      inputs.push_back(hostile::random_data(random));
  const Schema schema = o.make_params().schema;
  std::vector<std::string> words = hostile::small_sizes(schema, o.name, inputs);
  const Data none = CollectionPtr(std::make_shared<Collection>());
  for (std::string& w : hostile::random_words(random, schema, inputs.empty() ? none : inputs[0], random.one_of({0.0, 0.1, 0.3})))
    if (!w.starts_with("size=") && !w.starts_with("dims=") && !w.starts_with("resolution=") && !w.starts_with("density=") &&
        !w.starts_with("spacing="))
      words.push_back(std::move(w));  // large grids take their time
  std::string what = fmt::format("seed {}: {} {} of", seed, o.name, fmt::join(words, " "));
  for (const Data& d : inputs) what += " (" + about(d) + ")";
  stays_calm(what, count, [&](Context& context) {
    const Data result = run_operation(o, inputs, words, context);
    for_each_dataset(result, [](const std::string&, const DatasetPtr& d) {  // what it made can be used
      validate(d->mesh());
      for (const Field& f : d->fields()) (void)d->stats(f);
      (void)d->bounds();
    });
  });
}

template <class P>
std::vector<std::string> words_of(Random& random, const Data& data, double chance) {
  P p;
  Schema s;
  describe(s, p);
  return hostile::random_words(random, s, data, chance);
}

// What `render --show` does with it, in a picture of 32x32 or so.
void draw(const std::vector<DatasetPtr>& parts, const std::vector<std::pair<std::string_view, std::vector<std::string>>>& shows,
          const std::vector<std::string>& camera_stated, Random& random, Context& context) {
  Scene scene;
  Annotation annotation;
  Box3 box;
  for (const DatasetPtr& d : parts) {
    box.add(d->bounds());
    for (const auto& [kind, words] : shows)
      if (const auto legend = add_show(scene, kind, d, words, context); legend && annotation.legends.size() < 2)
        annotation.legends.push_back(*legend);
  }
  StatedPicture stated;
  stated.width = random.whole(1, 40), stated.height = random.whole(1, 40);
  stated.picture.samples = random.whole(0, 3), stated.picture.adaptive = random.chance(0.3) ? 0.05 : 0;
  CameraParams params;
  Schema schema;
  describe(schema, params);
  set_params(schema, camera_stated, "camera");
  if (random.chance(0.7) && !box.empty()) annotation.box = box;
  const Vec3 direction = normalize(Vec3(random.in(-1, 1), random.in(-1, 1), 0.2));
  CameraDefaults defaults;
  defaults.direction = direction, defaults.parallel = random.chance(0.5);
  if (random.chance(0.3)) defaults.axes = random.chance(0.5) ? graphics_axes : patient_view_axes;
  annotation.patient_letters = random.chance(0.3);
  Camera camera = make_camera(params, box, double(stated.width) / stated.height, defaults, 0.1);
  Box3 all = scene_bounds(scene);
  all.add(box);
  fit_planes(camera, all);
  if (annotation.box) scene.items.emplace_back(back_edges(box, camera));
  draw_picture(scene, camera, stated, annotation, {}, context);
}

void show_one(uint64_t seed, Count& count) {
  Random random(seed);
  const Data data = hostile::random_data(random);
  std::vector<DatasetPtr> parts;
  for_each_dataset(data, [&](const std::string&, const DatasetPtr& d) { parts.push_back(d); });
  if (parts.empty()) return;
  const double chance = random.one_of({0.0, 0.05, 0.15});
  const auto kinds = show_kinds();
  std::vector<std::pair<std::string_view, std::vector<std::string>>> shows;
  for (int n = random.chance(0.3) ? 2 : 1; n > 0; --n) {
    const std::string_view kind = hostile::only()      ? find_show(hostile::only()).name
                                  : random.chance(0.3) ? "volume"
                                                       : kinds[size_t(random.whole(0, int(kinds.size()) - 1))].name;
    shows.emplace_back(kind, hostile::random_words(random, find_show(kind).make_params().schema, data, chance));
    if (kind == "volume" && random.chance(0.3))
      shows.back().second.push_back("method=" + random.one_of<std::string>({"ray", "splat", "slices", "shear_warp", "fourier"}));
  }
  const std::vector<std::string> camera = words_of<CameraParams>(random, data, random.chance(0.2) ? 0.2 : 0);
  std::string what = fmt::format("seed {}: ", seed);
  for (const auto& [kind, words] : shows) what += fmt::format("{} {}, ", kind, fmt::join(words, " "));
  what += fmt::format("camera {} of {}", fmt::join(camera, " "), about(data));
  stays_calm(what, count, [&](Context& context) { draw(parts, shows, camera, random, context); });
}

}  // namespace

TEST_CASE("property: every operation answers or refuses random data and words, soon and without gigabytes") {
  if (hostile::only() && std::any_of(show_kinds().begin(), show_kinds().end(), [](const ShowKind& k) { return k.name == hostile::only(); }))
    return;
  Count count;
  for (const uint64_t seed : property_seeds(250)) {
    CAPTURE(seed);
    const hostile::MemoryFence fence(2);
    run_one(seed, count);
  }
  MESSAGE(count.answered << " answered, " << count.refused << " refused");
}

TEST_CASE("property: every way to show draws or refuses random data and words, soon and without gigabytes") {
  if (hostile::only() &&
      std::none_of(show_kinds().begin(), show_kinds().end(), [](const ShowKind& k) { return k.name == hostile::only(); }))
    return;
  Count count;
  for (const uint64_t seed : property_seeds(150)) {
    CAPTURE(seed);
    const hostile::MemoryFence fence(2);
    show_one(seed, count);
  }
  MESSAGE(count.answered << " answered, " << count.refused << " refused");
}
