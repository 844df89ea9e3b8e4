// SPDX-License-Identifier: Apache-2.0
#include "cli/cli.h"

#include <signal.h>
#include <unistd.h>

#include <cstdio>
#include <new>

#include "base/error.h"
#include "base/mapped_watch.h"
#include "base/parallel.h"
#include "cli/info.h"
#include "data/memory_budget.h"
#include "io/plugin.h"

namespace sg {

namespace {

Context* interruptible = nullptr;

void on_interrupt(int) {
  if (interruptible) interruptible->cancel();
}

// Messages go to stderr, so that stdout holds results alone.
void connect(Context& context, const Options& o) {
  context.memory_limit = o.memory;
  set_memory_limit(o.memory);
  set_plugin_memory(o.memory);
  context.on_log = [quiet = o.quiet, verbose = o.verbose](LogLevel level, std::string_view text) {
    if (quiet || (level == LogLevel::debug && !verbose)) return;
    std::fprintf(stderr, "%s%.*s\n", level == LogLevel::warning ? "warning: " : "note: ", int(text.size()), text.data());
  };
  if (!o.quiet && ::isatty(2))
    context.on_progress = [](double fraction, std::string_view doing) {
      if (fraction >= 1) std::fprintf(stderr, "\r\x1b[K");
      else std::fprintf(stderr, "\r%3.0f%% %.*s\x1b[K", fraction * 100, int(std::min<size_t>(doing.size(), 60)), doing.data());
    };
}

int dispatch_command(const Options& o, Context& context) {
  struct Command {
    std::string_view name;
    int (*run)(const Options&, Context&);
  };
  static constexpr Command commands[] = {{"info", run_info}, {"render", run_render}, {"convert", run_convert},   {"run", run_pipeline_file},
                                         {"open", run_open}, {"ops", run_ops},       {"colormap", run_colormap}, {"demo", run_demo}};
  for (const Command& c : commands)
    if (c.name == o.command) return c.run(o, context);
  return 0;  // --help or --version: all is said
}

// A message may quote what it was given; it stays one line all the same.
std::string one_line(std::string s) {
  for (char& c : s)
    if (c == '\n' || c == '\r') c = ' ';
  return s;
}

}  // namespace

int cli_main(int argc, char** argv) {
  try {
    const Options o = parse_options(argc, argv);
    if (o.threads > 0) set_thread_count(o.threads);
    Context context;
    connect(context, o);
    interruptible = &context;
    ::signal(SIGINT, on_interrupt);
    ::signal(SIGPIPE, SIG_IGN);
    const int status = dispatch_command(o, context);
    interruptible = nullptr;
    check_files_unchanged();  // what was said on stdout
    if (std::fflush(stdout) != 0) fail_data("standard output cannot be written");
    return status;
  } catch (const Error& e) {
    interruptible = nullptr;
    // What an operation said of numbers that changed under it misleads.
    const std::string changed = e.kind() == ErrorKind::cancelled ? "" : mapped_watch().changed(1);
    if (!changed.empty()) {
      std::fprintf(stderr, "sightglass: %s: the file changed while it was read; read it again when it is written completely\n",
                   one_line(changed).c_str());
      return 3;
    }
    std::fprintf(stderr, "sightglass: %s\n", one_line(e.what()).c_str());
    return e.exit_code();
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "sightglass: not enough memory; state a smaller region or fewer fields\n");
    return 3;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "sightglass: internal error: %s; please report it with the command and the file\n", one_line(e.what()).c_str());
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
    std::fwrite(text.data(), 1, text.size(), stdout);
  }
  return 0;
}

}  // namespace sg
