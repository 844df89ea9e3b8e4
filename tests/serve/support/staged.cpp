// SPDX-License-Identifier: Apache-2.0
#include "serve/support/staged.h"

#include <thread>
#include <utility>

#include "serve/renderer/local_renderer.h"
#include "serve/support/looking.h"
#include "support/test.h"

namespace sg::test {

void Count::add() {
  const std::lock_guard lock(mutex_);
  ++count_;
  changed_.notify_all();
}

int Count::now() const {
  const std::lock_guard lock(mutex_);
  return count_;
}

void Count::wait_for(int least) {
  std::unique_lock lock(mutex_);
  REQUIRE(changed_.wait_for(lock, std::chrono::seconds(60), [&] { return count_ >= least; }));
}

void Stage::be_slow(Context& context) {
  const int before = moved.now();
  begun.add();
  while (!released && moved.now() - before < until_moved) {
    if (context.cancelled()) stopped.add();
    context.check();
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

namespace {

class Staged : public serve::LocalRenderer {
 public:
  explicit Staged(Stage& stage) : LocalRenderer(64 << 20, {}), stage_(stage) {}
  PipelineFile load(const PipelineFile& pipeline, Context& context) override {
    if (stage_.slow_steps) stage_.be_slow(context);
    return LocalRenderer::load(pipeline, context);
  }
  Json::Members tell(Context& context) override {
    if (stage_.slow_state) stage_.be_slow(context);
    return LocalRenderer::tell(context);
  }
  using LocalRenderer::draw;
  serve::DrawnView draw(const serve::DrawRequest& request, const serve::OnFiner& on_finer, Context& context) override {
    if (stage_.slow_pictures && request.quality == serve::Quality::exact) stage_.be_slow(context);
    serve::DrawnView drawn = LocalRenderer::draw(request, on_finer, context);
    if (request.view >= 0 && request.quality == serve::Quality::moving) stage_.moved.add();
    return drawn;
  }
  Json::Members answer(const Json& question, Context& context) override {
    if (stage_.slow_questions) stage_.be_slow(context);
    return LocalRenderer::answer(question, context);
  }
  std::string save(const serve::DrawRequest& request, const std::string& name, Context& context) override {
    stage_.be_slow(context);
    return LocalRenderer::save(request, name, context);
  }

 private:
  Stage& stage_;
};

}  // namespace

std::shared_ptr<serve::Session> session_of(Stage& stage, std::chrono::milliseconds longest) {
  PipelineFile file = parsed("sightglass: 1\nsteps:\n  ball: {sphere: {size: 9}}\nshow:\n  - {outline: , of: ball}\n");
  return serve::Session::open(std::make_unique<Staged>(stage), std::move(file), "ball", "", longest);
}

}  // namespace sg::test
