// SPDX-License-Identifier: Apache-2.0
#include "render/annotate/overlay/pango.h"

#include <dlfcn.h>
#include <fmt/core.h>

#include "base/error.h"
#include "render/annotate/overlay/overlay.h"

namespace sg {

namespace {

// Never unloaded: GLib keeps threads and types for as long as the process lives.
Pango load_pango(const std::string& library) {
  const auto fail = [](const std::string& why) {
    fail_internal(fmt::format("Pango cannot be loaded, so pictures cannot have text ({}); install the package libpangocairo-1.0-0", why),
                  "annotate");
  };
  void* handle = ::dlopen(library.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!handle) fail(::dlerror());
  Pango p;
  // Those of Cairo and GLib are found as well: Pango depends on them.
#define SG_PANGO_FIND(name)                                            \
  p.name = reinterpret_cast<decltype(p.name)>(::dlsym(handle, #name)); \
  if (!p.name) fail(fmt::format("{} has no function {}", library, #name));
  SG_PANGO_FUNCTIONS(SG_PANGO_FIND)
#undef SG_PANGO_FIND
  return p;
}

}  // namespace

void load_text_library(const std::string& name) { load_pango(name); }

const Pango& pango() {
  static const Pango loaded = load_pango("libpangocairo-1.0.so.0");
  return loaded;
}

}  // namespace sg
