// SPDX-License-Identifier: Apache-2.0
#include "serve/renderer/worker/worker_renderer.h"

#include <fmt/core.h>
#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>

#include "base/error.h"
#include "base/text/utf8.h"
#include "pipeline/picture/picture.h"
#include "serve/renderer/tell.h"
#include "serve/renderer/worker/request_json.h"

namespace sg::serve {

namespace {

constexpr auto glance = std::chrono::milliseconds(5);  // at whether a call was cancelled
constexpr auto patience = std::chrono::seconds(10);    // with a worker that does not stop when it is told to
constexpr int socket_there = 3;                        // the descriptor in the worker

Json word(Call call) { return text(std::string(word_of(call))); }

}  // namespace

// A started worker, and the thread that takes in what it says.
struct WorkerRenderer::Process {
  explicit Process(const std::vector<std::string>& command) {
    int ends[2];
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) fail_internal("no sockets for a worker");
    channel = std::make_unique<Channel>(ends[0]);
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_adddup2(&files, ends[1], socket_there);
    std::vector<std::string> words = command;
    words.push_back(std::to_string(socket_there));
    std::vector<char*> arguments;
    for (std::string& w : words) arguments.push_back(w.data());
    arguments.push_back(nullptr);
    // A worker does not end with the server's terminal by itself: the server says so.
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
    const int problem = ::posix_spawn(&pid, arguments[0], &files, &attributes, arguments.data(), environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&files);
    ::close(ends[1]);
    if (problem != 0) fail_internal("a worker cannot be started");
    listener = std::thread([this] { listen(); });
  }
  ~Process() {
    channel->shut();
    listener.join();
    if (!ended) ::kill(pid, SIGKILL);
    ::waitpid(pid, nullptr, 0);
  }

  void listen() {
    while (auto message = channel->receive()) {
      const std::lock_guard lock(mutex);
      const auto it = calls.find(message->head["id"].whole());
      if (it == calls.end()) continue;
      if (message->head.contains("progress")) {
        it->second.share = message->head["progress"].number(), it->second.doing = message->head["doing"].text(), it->second.told = true;
      } else if (message->head.contains("finer")) {
        it->second.finer = std::move(*message);  // in the place of one that was not taken
      } else {
        it->second.reply = std::move(*message);
      }
      came.notify_all();
    }
    const std::lock_guard lock(mutex);
    ended = true;
    came.notify_all();
  }

  struct Waiting {
    std::optional<ChannelMessage> reply, finer;
    bool told = false;
    double share = 0;
    std::string doing;
  };
  pid_t pid = 0;
  std::unique_ptr<Channel> channel;
  std::mutex mutex;
  std::condition_variable came;
  std::map<uint64_t, Waiting> calls;
  uint64_t last_id = 0;
  bool ended = false;
  std::thread listener;

  // Throws Error(data) when the process ends meanwhile.
  ChannelMessage call(Json::Members message, Context& context, const OnFiner& on_finer = {}) {
    std::unique_lock lock(mutex);
    const uint64_t id = ++last_id;
    calls[id] = {};
    message.emplace_back("id", Json(id));
    lock.unlock();
    channel->send(Json(std::move(message)));
    lock.lock();
    bool cancelled = false;
    std::chrono::steady_clock::time_point asked_to_stop;
    while (!calls[id].reply && !ended) {
      came.wait_for(lock, glance);
      if (calls[id].told) {
        calls[id].told = false;
        const double share = calls[id].share;
        const std::string doing = calls[id].doing;
        lock.unlock();
        context.progress(share, doing);
        lock.lock();
      }
      if (calls[id].finer) {
        ChannelMessage finer = std::move(*calls[id].finer);
        calls[id].finer.reset();
        lock.unlock();
        if (on_finer) on_finer(drawn_from(finer.head["finer"], std::move(finer.bytes)));
        lock.lock();
      }
      if (context.cancelled() && !cancelled) {
        cancelled = true, asked_to_stop = std::chrono::steady_clock::now();
        lock.unlock();
        channel->send(Json(Json::Members{{"cancel", Json(id)}}));
        lock.lock();
      }
      if (cancelled && std::chrono::steady_clock::now() - asked_to_stop > patience) ::kill(pid, SIGKILL);
    }
    const std::optional<ChannelMessage> reply = std::move(calls[id].reply);
    calls.erase(id);
    if (!reply) fail_data("the process that draws has ended, perhaps for want of memory", "renderer", "the session goes on with a new one");
    if (const Json* error = reply->head.find("error"))
      throw Error(ErrorKind(int(reply->head["kind"].number())), bytes_of_text(error->text()));
    return *reply;
  }
};

WorkerRenderer::WorkerRenderer(WorkerOptions options) : options_(std::move(options)) {}
WorkerRenderer::~WorkerRenderer() = default;

int WorkerRenderer::process() const {
  const std::lock_guard lock(mutex_);
  return process_ ? process_->pid : 0;
}

std::shared_ptr<WorkerRenderer::Process> WorkerRenderer::started(Context& context) {
  const std::lock_guard lock(mutex_);
  if (process_) {
    const std::lock_guard inside(process_->mutex);
    if (!process_->ended) return process_;
  }
  process_ = std::make_shared<Process>(options_.command);
  process_->call({{"call", word(Call::start)},
                  {"coloring", list(options_.coloring)},
                  {"folders", list(options_.folders)},
                  {"memory", Json(options_.memory)},
                  {"process_memory", Json(options_.process_memory)}},
                 context);
  if (!loaded_.empty()) process_->call(loaded_, context);
  return process_;
}

ChannelMessage WorkerRenderer::call(Json::Members message, Context& context) { return started(context)->call(std::move(message), context); }

PipelineFile WorkerRenderer::load(const PipelineFile& pipeline, Context& context) {
  const Json::Members message{{"call", word(Call::load)}, {"pipeline", text(emit_pipeline(pipeline))}, {"origin", text(pipeline.origin)}};
  const ChannelMessage reply = call(message, context);
  {
    const std::lock_guard lock(mutex_);
    loaded_ = message;
  }
  PipelineFile completed = parse_pipeline(bytes_of_text(reply.head["pipeline"].text()), "", picture_vocabulary());
  completed.origin = pipeline.origin;
  return completed;
}

Json::Members WorkerRenderer::tell(Context& context) { return call({{"call", word(Call::tell)}}, context).head["members"].members(); }

DrawnView WorkerRenderer::draw(const DrawRequest& request, const OnFiner& on_finer, Context& context) {
  ChannelMessage reply = started(context)->call({{"call", word(Call::draw)}, {"request", request_json(request)}}, context, on_finer);
  return drawn_from(reply.head["drawn"], std::move(reply.bytes));
}

void WorkerRenderer::forget(int view) {
  Context context;
  try {
    call({{"call", word(Call::forget)}, {"view", Json(int64_t(view))}}, context);
  } catch (const Error&) {  // a worker that has ended has forgotten
  }
}

Json::Members WorkerRenderer::answer(const Json& question, Context& context) {
  return call({{"call", word(Call::answer)}, {"question", question}}, context).head["members"].members();
}

std::string WorkerRenderer::save(const DrawRequest& request, const std::string& name, Context& context) {
  return call({{"call", word(Call::save)}, {"request", request_json(request)}, {"name", text(name)}}, context).bytes;
}

}  // namespace sg::serve
