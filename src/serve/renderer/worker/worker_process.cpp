// SPDX-License-Identifier: Apache-2.0
#include "serve/renderer/worker/worker_process.h"

#include <fmt/core.h>
#include <sys/resource.h>

#include <algorithm>
#include <condition_variable>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <new>
#include <thread>
#include <vector>

#include "base/error.h"
#include "base/file/file_fence.h"
#include "base/text/text.h"
#include "base/text/utf8.h"
#include "data/memory/memory_budget.h"
#include "pipeline/picture/picture.h"
#include "serve/renderer/local_renderer.h"
#include "serve/renderer/tell.h"
#include "serve/renderer/worker/channel.h"
#include "serve/renderer/worker/request_json.h"

namespace sg::serve {

namespace {

class Worker {
 public:
  explicit Worker(int socket) : channel_(socket) {}

  void run() {
    std::vector<std::thread> threads;
    // Each caller waits for its answer: no call waits behind another one.
    for (int i = 0; i < Renderer::most_callers; ++i) threads.emplace_back([this] { work(); });
    while (auto message = channel_.receive()) {
      const std::lock_guard lock(mutex_);
      const Json& head = message->head;
      if (head.contains("cancel")) {
        const auto it = contexts_.find(head["cancel"].whole());
        if (it != contexts_.end()) it->second->cancel();
        continue;
      }
      calls_.push_back(head);
      contexts_[head["id"].whole()] = std::make_unique<Context>();
      wake_.notify_one();
    }
    {
      const std::lock_guard lock(mutex_);
      over_ = true;
      for (auto& [id, context] : contexts_) context->cancel();
    }
    wake_.notify_all();
    for (std::thread& t : threads) t.join();
  }

 private:
  void work() {
    std::unique_lock lock(mutex_);
    while (!over_) {
      if (calls_.empty()) {
        wake_.wait(lock);
        continue;
      }
      const Json call = calls_.front();
      calls_.pop_front();
      const uint64_t id = call["id"].whole();
      Context& context = *contexts_[id];
      lock.unlock();
      context.on_progress = [this, id](double share, std::string_view doing) {
        channel_.send(Json(Json::Members{{"id", Json(id)}, {"progress", number(share)}, {"doing", text(std::string(doing))}}));
      };
      answer(call, context);
      lock.lock();
      contexts_.erase(id);
    }
  }

  static Json::Members failed(const Json& call, const Error& e) {
    return {{"id", call["id"]}, {"error", text(e.what())}, {"kind", Json(int64_t(e.kind()))}};
  }

  Error for_want_of_memory(const std::string& what) const {
    if (process_memory_ == 0) return Error(ErrorKind::usage, what, "", "ask for less");
    return Error(ErrorKind::usage, fmt::format("{}: a worker may take {} here", what, human_bytes(process_memory_)), "",
                 "ask for less, or start the server with a larger --worker-memory");
  }

  void answer(const Json& call, Context& context) {
    Json::Members reply{{"id", call["id"]}};
    std::string bytes;
    try {
      do_call(call, reply, bytes, context);
    } catch (const Error& e) {
      // As arrays say it (Buffer::allocate).
      if (process_memory_ > 0 && e.problem().starts_with("not enough memory")) reply = failed(call, for_want_of_memory(e.what()));
      else reply = failed(call, e);
    } catch (const std::bad_alloc&) {
      reply = failed(call, for_want_of_memory("not enough memory"));
    } catch (const std::exception& e) {
      reply = failed(call, Error(ErrorKind::internal, e.what()));
    }
    channel_.send(Json(std::move(reply)), bytes);
  }

  void do_call(const Json& call, Json::Members& reply, std::string& bytes, Context& context) {
    const auto what = value_of_word<Call>(call["call"].text());
    if (what == Call::start) {
      std::vector<std::string> coloring;
      for (const Json& w : call["coloring"].items()) coloring.push_back(bytes_of_text(w.text()));
      if (call["memory"].whole() > 0) set_memory_limit(call["memory"].whole());
      FileFence fence;
      for (const Json& folder : call["folders"].items()) fence.read_below.push_back(bytes_of_text(folder.text()));
      fence.who = "a window";
      if (!fence.read_below.empty()) set_file_fence(std::move(fence));
      uint64_t cache = allowed_memory() / 2;
      if (process_memory_ = call["process_memory"].whole(); process_memory_ > 0) {
        // What a process has allocated, in whatever way; files that are mapped do not count.
        const rlimit limit{process_memory_, process_memory_};
        if (::setrlimit(RLIMIT_DATA, &limit) != 0) fail_internal("the memory of a worker cannot be bounded");
        cache = std::min(cache, process_memory_ / 4);
      }
      renderer_ = std::make_unique<LocalRenderer>(cache, std::move(coloring));
    } else if (what == Call::load) {
      const PipelineFile file =
          parse_pipeline(bytes_of_text(call["pipeline"].text()), bytes_of_text(call["origin"].text()), picture_vocabulary());
      reply.emplace_back("pipeline", text(emit_pipeline(renderer_->load(file, context))));
    } else if (what == Call::tell) {
      reply.emplace_back("members", Json(renderer_->tell(context)));
    } else if (what == Call::draw) {
      const auto on_finer = [&](const DrawnView& drawn) {
        channel_.send(Json(Json::Members{{"id", call["id"]}, {"finer", drawn_json(drawn)}}), *drawn.bytes);
      };
      const DrawnView drawn = renderer_->draw(request_from(call["request"]), on_finer, context);
      reply.emplace_back("drawn", drawn_json(drawn)), bytes = *drawn.bytes;
    } else if (what == Call::forget) {
      renderer_->forget(int(call["view"].number()));
    } else if (what == Call::answer) {
      reply.emplace_back("members", Json(renderer_->answer(call["question"], context)));
    } else if (what == Call::save) {
      bytes = renderer_->save(request_from(call["request"]), bytes_of_text(call["name"].text()), context);
    }
  }

  Channel channel_;
  std::unique_ptr<Renderer> renderer_;
  uint64_t process_memory_ = 0;  // 0: any
  std::mutex mutex_;
  std::condition_variable wake_;
  bool over_ = false;
  std::deque<Json> calls_;
  std::map<uint64_t, std::unique_ptr<Context>> contexts_;
};

}  // namespace

void run_worker(int socket) { Worker(socket).run(); }

}  // namespace sg::serve
