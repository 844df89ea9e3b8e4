// SPDX-License-Identifier: Apache-2.0
#include "python/core/calls.h"

#include <signal.h>

#include <atomic>
#include <thread>

namespace sightglass::python {

namespace {

std::thread::id main_thread;
std::atomic<const Context*> interrupted_context{nullptr};
struct sigaction before;

void on_interrupt(int signal, siginfo_t* info, void* machine) {
  if (const Context* context = interrupted_context.load()) context->cancel();
  if (before.sa_flags & SA_SIGINFO) before.sa_sigaction(signal, info, machine);
  else if (before.sa_handler != SIG_DFL && before.sa_handler != SIG_IGN) before.sa_handler(signal);
}

}  // namespace

void remember_main_thread() { main_thread = std::this_thread::get_id(); }

Interruptible::Interruptible(const Context& context) {
  if (std::this_thread::get_id() != main_thread || interrupted_context.load()) return;
  struct sigaction now {};
  if (sigaction(SIGINT, nullptr, &now) != 0) return;
  const bool handled = (now.sa_flags & SA_SIGINFO) || (now.sa_handler != SIG_DFL && now.sa_handler != SIG_IGN);
  if (!handled) return;  // ends the program, or was told not to matter
  before = now;
  interrupted_context = &context;
  struct sigaction ours {};
  ours.sa_sigaction = on_interrupt, ours.sa_flags = SA_SIGINFO;
  active_ = sigaction(SIGINT, &ours, nullptr) == 0;
  if (!active_) interrupted_context = nullptr;
}

Interruptible::~Interruptible() {
  if (!active_) return;
  sigaction(SIGINT, &before, nullptr);
  interrupted_context = nullptr;
}

void Messages::deliver() const {
  if (said_.empty()) return;
  const auto say = pybind11::module_::import("sightglass._errors").attr("say");
  for (const auto& [warning, text] : said_) say(warning, text);
}

}  // namespace sightglass::python
