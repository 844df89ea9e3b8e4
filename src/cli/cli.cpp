// SPDX-License-Identifier: Apache-2.0
#include "cli/cli.h"

#include <fmt/core.h>
#include <signal.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <mutex>
#include <new>
#include <set>

#include "base/error.h"
#include "base/file/file_fence.h"
#include "base/file/mapped_watch.h"
#include "base/file/partial_file.h"
#include "base/parallel.h"
#include "base/text/utf8.h"
#include "base/vector_width.h"
#include "cli/info.h"
#include "cli/progress.h"
#include "cli/say.h"
#include "cli/spool.h"
#include "data/memory/memory_budget.h"
#include "io/plugin.h"
#include "serve/renderer/worker/worker_process.h"
#include "serve/serve.h"

namespace sg {

namespace {

Context* interruptible = nullptr;
volatile std::sig_atomic_t stopped_by = 0;

constexpr unsigned grace = 3;  // seconds for work to stop by itself

// The first signal lets the work stop and clean up after itself; the second ends the program at once, and so does the alarm when the work
// is somewhere that does not ask (a library that lays out text, parses or packs).
void on_signal(int signal) {
  if (signal != SIGALRM && interruptible && !interruptible->cancelled()) {
    stopped_by = signal;
    interruptible->cancel();
    ::alarm(grace);
    return;
  }
  if (signal == SIGALRM && CleaningUp::any()) {
    ::alarm(grace);
    return;
  }
  const int by = signal == SIGALRM ? int(stopped_by) : signal;
  remove_partials_at_exit();
  ::signal(by, SIG_DFL);
  ::raise(by);
}

void catch_signals() {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction before {
    }, ours{};
    ::sigaction(signal, nullptr, &before);
    if (before.sa_handler == SIG_IGN) continue;  // nohup, or a shell's background
    ours.sa_handler = on_signal;
    ::sigemptyset(&ours.sa_mask);
    ::sigaction(signal, &ours, nullptr);
  }
  struct sigaction timer {};
  timer.sa_handler = on_signal;
  ::sigfillset(&timer.sa_mask);
  ::sigdelset(&timer.sa_mask, SIGINT), ::sigdelset(&timer.sa_mask, SIGTERM), ::sigdelset(&timer.sa_mask, SIGHUP);
  ::sigaction(SIGALRM, &timer, nullptr);
  ::signal(SIGPIPE, SIG_IGN);
}

// A pipe may deliver at most this much, unless --memory allows more.
constexpr size_t most_piped = size_t(1) << 30;

Options with_streams(Options o, const Context& context) {
  if (o.command == Command::ops || o.command == Command::samples || o.command == Command::demo || o.command == Command::complete ||
      o.command == Command::serve || o.command == Command::completions)
    return o;
  for (std::string& path : o.inputs) path = spooled(path, o.memory ? o.memory : most_piped, context);
  return o;
}

// Messages go to stderr, so that stdout has only results.
void connect(Context& context, const Options& o) {
  context.memory_limit = o.memory;
  set_memory_limit(o.memory);
  set_plugin_memory(o.memory);
  const auto line = std::make_shared<ProgressLine>();
  struct Told {
    std::mutex mutex;
    std::set<std::string, std::less<>> texts;
  };
  context.on_log = [line, told = std::make_shared<Told>(), quiet = o.quiet, verbose = o.verbose](LogLevel level, std::string_view text) {
    if (quiet || (level == LogLevel::debug && !verbose)) return;
    {  // what many parts say alike is said once
      const std::lock_guard lock(told->mutex);
      if (!told->texts.emplace(text).second && !verbose) return;
    }
    line->print((level == LogLevel::warning ? "warning: " : "note: ") + std::string(text));
  };
  if (!o.quiet && ::isatty(2)) context.on_progress = [line](double fraction, std::string_view doing) { line->show(fraction, doing); };
}

int dispatch_command(const Options& o, Context& context) {
  switch (o.command) {
    case Command::none: return 0;
    case Command::render: return run_render(o, context);
    case Command::view: return run_view(o, context);
    case Command::serve: return run_serve(o, context);
    case Command::info: return run_info(o, context);
    case Command::convert: return run_convert(o, context);
    case Command::run: return run_pipeline_file(o, context);
    case Command::open: return run_open(o, context);
    case Command::ops: return run_ops(o, context);
    case Command::colormap: return run_colormap(o, context);
    case Command::samples: return run_samples(o, context);
    case Command::lookdev: return run_lookdev(o, context);
    case Command::demo: return run_demo(o, context);
    case Command::completions: return run_completions(o, context);
    case Command::complete: return run_complete(o, context);
    case Command::man: return run_man(o, context);
  }
  return 0;
}

}  // namespace

int cli_main(int argc, char** argv) {
  try {
    cap_vector_width();
    if (argc == 3 && std::string_view(argv[1]) == serve::worker_command) {
      serve::run_worker(std::atoi(argv[2]));
      return 0;
    }
    const Options o = parse_options(argc, argv);
    if (o.threads > 0) set_thread_count(o.threads);
    Context context;
    connect(context, o);
    context.log(LogLevel::debug, "vector code for " + vector_target());
    if (o.read_anywhere) allow_reading_anywhere();
    interruptible = &context;
    catch_signals();
    const int status = dispatch_command(with_streams(o, context), context);
    interruptible = nullptr;
    check_files_unchanged();  // what was written to stdout
    // A reader that closes the pipe has seen enough.
    if (std::fflush(stdout) != 0 && errno != EPIPE) fail_data("cannot write to standard output");
    return status;
  } catch (const Error& e) {
    interruptible = nullptr;
    // What an operation reported about numbers that changed meanwhile is misleading.
    const std::string changed = e.kind() == ErrorKind::cancelled ? "" : mapped_watch().changed(1);
    if (!changed.empty()) {
      say_error("sightglass: " + changed + ": the file changed while it was being read; read it again once it has been written completely");
      return 3;
    }
    say_error(std::string("sightglass: ") + e.what());
    return e.kind() == ErrorKind::cancelled && stopped_by ? 128 + stopped_by : e.exit_code();
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "sightglass: not enough memory; read a smaller region or fewer fields\n");
    return 3;
  } catch (const std::exception& e) {
    say_error(fmt::format("sightglass: internal error: {}; please report it with the command and the file", e.what()));
    return 4;
  }
}

int run_info(const Options& o, Context& context) {
  if (!o.filters.empty() || !o.source.empty()) return run_info_of_pipeline(o, context);
  if (o.inputs.empty()) fail_usage("name a file to read", "sightglass info", "see: sightglass info --help");
  ReadOptions read = o.read;
  read.header_only = o.quick;
  for (const std::string& path : o.inputs) {
    std::string text;
    if (o.all_times) {
      const Series series = open_series(path, read, context);
      const SeriesRange range = series_range(series, context);
      text = o.json ? series_json(range, series.times) : series_text(range, path, series.times);
    } else {
      const Data data = read_data(path, read, context);
      const std::vector<double> times = file_times(path, read, context);
      text = o.json ? info_json(data, o.quick, times) : info_text(data, path, o.quick, times);
    }
    say(text);
  }
  return 0;
}

}  // namespace sg
