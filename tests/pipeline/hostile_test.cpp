// SPDX-License-Identifier: Apache-2.0
// Every operation of this build with what nobody means to give it: it answers or throws sg::Error, soon, without asking for gigabytes.
// SG_HOSTILE_ALL=1: also curved solids of many nodes, and series of every mesh. SG_HOSTILE_ONLY=OPERATION: that one alone, all
// of its cases, each told before it runs and with its time.
#include "pipeline/hostile_inputs.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <ctime>
#include <fstream>

#include "support/test.h"

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define SG_SHADOW_MEMORY 1
#endif

using namespace sg;
using namespace sg::test;

namespace {

// Within its life the process may have one gigabyte more than before.
class MemoryFence {
 public:
  MemoryFence() {
#ifndef SG_SHADOW_MEMORY
    getrlimit(RLIMIT_AS, &before_);
    size_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages;
    rlimit fence = before_;
    fence.rlim_cur = std::min<rlim_t>(before_.rlim_max, pages * 4096 + (size_t(1) << 30));
    setrlimit(RLIMIT_AS, &fence);
#endif
  }
  ~MemoryFence() {
#ifndef SG_SHADOW_MEMORY
    setrlimit(RLIMIT_AS, &before_);
#endif
  }

 private:
  rlimit before_{};
};

const char* only() { return std::getenv("SG_HOSTILE_ONLY"); }
bool all_asked() { return only() || std::getenv("SG_HOSTILE_ALL"); }
bool tells() { return only() || std::getenv("SG_HOSTILE_TELL"); }
bool wanted(const Operation& o) { return !only() || o.name == only(); }

size_t refused, answered;

// Runs it; what it does besides answering or throwing sg::Error is a failed check.
void stays_calm(const Operation& o, const std::string& what, const std::function<Data(Context&)>& run) {
#ifdef SG_SHADOW_MEMORY  // ten times as slow: every fourth case
  static size_t turn = 0;
  if (!all_asked() && turn++ % 4 != 0) return;
#endif
  if (tells()) fmt::print(stderr, "{}: {}", o.name, what);  // where it fell
  const std::clock_t start = std::clock();                  // of the processor: other programs may be at work
  std::string failure;
  try {
    Context context;
    run(context);
    ++answered;
  } catch (const Error& e) {
    ++refused;
    if (tells()) fmt::print(stderr, " [{}]", e.what());
    if (std::string_view(e.what()).empty() || e.kind() == ErrorKind::internal) failure = fmt::format("an internal error: {}", e.what());
  } catch (const std::exception& e) {
    failure = fmt::format("{}: {}", typeid(e).name(), e.what());
  }
  const double took = double(std::clock() - start) / CLOCKS_PER_SEC;
  if (tells()) fmt::print(stderr, ": {:.2f} s\n", took);
#ifndef SG_SHADOW_MEMORY
  if (took > 5) failure += fmt::format(" took {:.1f} s", took);
#endif
  if (!failure.empty()) FAIL_CHECK(fmt::format("{}: {}: {}", o.name, what, failure));
}

// Words before the hostile one: pictures and grids of default size take too long.
std::vector<std::string> words_for(const Operation& o, const std::string& word) {
  std::vector<std::string> r;
  const ParamSet params = o.make_params();
  for (const char* name : {"size", "resolution", "density"}) {
    const ParamDecl* d = params.schema.find(name);
    const bool surface_texture = d && d->name == "density" && !params.schema.find("resolution");
    const bool takes = d && (std::get_if<int*>(&d->ref) || std::get_if<int64_t*>(&d->ref) || surface_texture);
    if (takes && !word.starts_with(d->name + "=")) r.push_back(d->name + "=8");
  }
  if (o.name.ends_with("_surface") && params.schema.find("spacing") && !word.starts_with("spacing=")) r.push_back("spacing=0.1");
  if (!word.empty()) r.push_back(word);
  return r;
}

std::vector<Data> enough(const Operation& o, const Data& data, bool most) {
  const int n = std::max(1, most && o.max_inputs > o.min_inputs ? o.min_inputs + 1 : o.min_inputs);
  return std::vector<Data>(size_t(n), data);
}

// The first of the plain inputs that it answers.
const Data& suitable(const Operation& o) {
  for (const hostile::Input& in : hostile::plain_inputs()) try {
      Context context;
      run_operation(o, enough(o, in.data, false), words_for(o, {}), context);
      return in.data;
    } catch (const Error&) {
      continue;
    }
  return hostile::plain_inputs()[0].data;
}

std::vector<std::string> words_of(const Operation& o) {
  std::vector<std::string> r;
  const ParamSet params = o.make_params();
  for (const ParamDecl& d : params.schema.decls())
    for (std::string& word : hostile::words(d)) r.push_back(std::move(word));
  return r;
}

}  // namespace

TEST_CASE("operations: none crashes, hangs or asks for gigabytes on meshes that are empty, bare, of one cell, of NaN, huge or tiny") {
  hostile::inputs();
  const MemoryFence fence;
  refused = answered = 0;
  for (const Operation& o : operations()) {
    if (o.kind == OperationKind::source || !wanted(o)) continue;
    for (const hostile::Input& in : hostile::inputs())
      for (const bool most : {false, true}) {
        if ((most && o.max_inputs == o.min_inputs) || (in.slow && !all_asked())) continue;
        stays_calm(o, in.name, [&](Context& c) { return run_operation(o, enough(o, in.data, most), words_for(o, {}), c); });
      }
  }
  MESSAGE(answered << " answered, " << refused << " refused");
}

TEST_CASE("operations: none crashes, hangs or asks for gigabytes when its inputs are unlike, and some of them empty") {
  hostile::unlike_inputs();
  const MemoryFence fence;
  refused = answered = 0;
  for (const Operation& o : operations()) {
    if (o.kind == OperationKind::source || !wanted(o) || o.max_inputs == 1) continue;
    for (const hostile::Input& first : hostile::unlike_inputs())
      for (const hostile::Input& second : hostile::unlike_inputs()) {
        std::vector<Data> data{first.data, second.data};
        while (int(data.size()) < o.min_inputs) data.push_back(first.data);
        stays_calm(o, first.name + " and " + second.name, [&](Context& c) { return run_operation(o, data, words_for(o, {}), c); });
      }
  }
  MESSAGE(answered << " answered, " << refused << " refused");
}

TEST_CASE("operations: none crashes, hangs or asks for gigabytes for numbers that are huge, negative or NaN, and words of any kind") {
  hostile::plain_inputs();
  const MemoryFence fence;
  refused = answered = 0;
  for (const Operation& o : operations()) {
    if (!wanted(o)) continue;
    const bool source = o.kind == OperationKind::source;
    const std::vector<Data> data = source ? std::vector<Data>() : enough(o, suitable(o), false);
    for (const std::string& word : words_of(o))
      stays_calm(o, word, [&](Context& c) { return run_operation(o, data, words_for(o, word), c); });
  }
  MESSAGE(answered << " answered, " << refused << " refused");
}

TEST_CASE("operations: those that take a time series stand any number of steps, times that do not rise, and steps unlike each other") {
  const std::vector<hostile::Times> cases = hostile::series(all_asked());
  const Data grid = hostile::plain_inputs()[0].data;
  const MemoryFence fence;
  refused = answered = 0;
  for (const Operation& o : operations()) {
    if (!o.run_series || !wanted(o)) continue;
    for (const hostile::Times& c : cases) {
      const Series series{c.times, [&](size_t i) { return c.steps.at(i); }};
      for (const bool second : {false, true})
        stays_calm(o, c.name, [&](Context& context) {
          const ParamSet params = make_params(o, words_for(o, {}));
          return o.run_series(series, second ? std::vector<Data>{grid} : std::vector<Data>{}, params, context);
        });
    }
    const Series moving{{0, 1, 2}, [&](size_t) { return grid; }};
    for (const std::string& word : words_of(o))
      stays_calm(o, word, [&](Context& context) {
        const ParamSet params = make_params(o, words_for(o, word));
        return o.run_series(moving, {}, params, context);
      });
  }
  MESSAGE(answered << " answered, " << refused << " refused");
}
